"""The program: where it is, and calls of it."""

from __future__ import annotations

import json
import os
import re
import shutil
import signal
import subprocess
import sys
import threading
import warnings
from pathlib import Path
from typing import Any, Callable, Mapping, Sequence

from . import errors


def program() -> str:
    """The program that is called.

    The environment variable ``STRIDOR_PROGRAM`` names it; else it is the one beside this package in a
    source tree that has been built, else the one on the path.

    Returns
    -------
    str
        Its name, or its path.

    Raises
    ------
    FileError
        Where there is none.

    Examples
    --------
    >>> program().endswith("stridor")
    True
    """
    named = os.environ.get("STRIDOR_PROGRAM")
    built = Path(__file__).resolve().parents[2] / "build" / "release" / "stridor"
    found = named or (str(built) if built.exists() else shutil.which("stridor"))
    if found is None or shutil.which(found) is None:
        raise errors.FileError(
            [errors.Problem("the program is not there; build it with `./run build`, put it on the path, "
                            "or name it in STRIDOR_PROGRAM", file=found or "stridor")])
    return found


#: Options that take several words after one another: a key, first and last value, number.
_OF_SEVERAL_WORDS = ("speeds", "indentations", "x", "y")
#: Options that take both ends with a comma between.
_OF_BOTH_ENDS = ("band",)


def arguments_of(options: Mapping[str, Any]) -> list[str]:
    """Options of the command line from keyword arguments.

    ``None`` and ``False`` are left out, ``True`` is a flag, a list or an array gives the option once for each, a
    mapping once for each key and value.

    >>> arguments_of({"points": 5, "explain": True, "figure": None, "max_wall": 2.5, "input": ["a", "b"]})
    ['--points', '5', '--explain', '--max-wall', '2.5', '--input', 'a', '--input', 'b']
    >>> arguments_of({"node": {12: "pad.tip"}, "band": ("2 kHz", 5000), "speeds": (0.1, 10.0, 5)})
    ['--node', '12=pad.tip', '--band', '2 kHz,5000', '--speeds', '0.1', '10.0', '5']
    """
    words: list[str] = []
    for name, value in options.items():
        option = "--" + name.rstrip("_").replace("_", "-")
        if value is None or value is False:
            continue
        if value is True:
            words.append(option)
            continue
        values = _values(value)
        if name in _OF_SEVERAL_WORDS:
            words += [option, *values]
        elif name in _OF_BOTH_ENDS:
            words += [option, ",".join(values)]
        else:
            for one in values:
                words += [option, one]
    return words


def _values(value: Any) -> list[str]:
    """The words of one value or of several."""
    if isinstance(value, Mapping):
        return [f"{key}={_text(one)}" for key, one in value.items()]
    if isinstance(value, (list, tuple, range)):
        return [_text(one) for one in value]
    if hasattr(value, "tolist"):  # of numpy, an array or a number
        plain = value.tolist()
        return [_text(one) for one in plain] if isinstance(plain, list) else [_text(plain)]
    return [_text(value)]


def _text(value: Any) -> str:
    """A value as the command line takes it: bare numbers are SI."""
    return repr(float(value)) if isinstance(value, float) else str(value)


def setting(key: str, value: Any) -> str:
    """"key=value" as ``--set`` takes it.

    >>> setting("contact.friction.coefficient", 0.35)
    'contact.friction.coefficient=0.35'
    >>> setting("record.channels", ["contact.force"])
    'record.channels=["contact.force"]'
    >>> import numpy
    >>> setting("substructures.clip.damping.alpha", numpy.float32(0.5))
    'substructures.clip.damping.alpha=0.5'
    """
    if value is None:
        text = "null"
    elif isinstance(value, str):
        text = value
    else:
        text = json.dumps(value, default=_of_numpy)  # a list or a map of JSON is one of YAML
    return f"{key}={text}"


def _of_numpy(value: Any) -> Any:
    if hasattr(value, "tolist"):
        return value.tolist()
    if isinstance(value, os.PathLike):
        return os.fspath(value)
    raise TypeError(f"{value!r} is no value of a key: a number, a text, a list or a mapping is")


Progress = Callable[[float, "float | None", str], None]


def _follow(process: subprocess.Popen, progress: Progress) -> str:
    """Hands what the program tells of its progress to a function. Returns the rest of its messages."""
    rest = []
    assert process.stderr is not None
    for line in process.stderr:
        try:
            told = json.loads(line)
        except json.JSONDecodeError:
            rest.append(line)
            continue
        if not isinstance(told, dict) or "fraction" not in told:
            rest.append(line)
        elif told["fraction"] is not None:
            progress(told["fraction"], told["seconds_left"], ": ".join(filter(None, (told["phase"], told["text"]))))
    return "".join(rest)


def _communicate(process: subprocess.Popen, progress: Progress) -> tuple[str, str]:
    """Output and messages of a program whose progress is followed."""
    out: list[str] = []
    assert process.stdout is not None
    reader = threading.Thread(target=lambda: out.append(process.stdout.read()), daemon=True)
    reader.start()
    err = ""
    try:
        err = _follow(process, progress)
    except KeyboardInterrupt:
        process.send_signal(signal.SIGINT)
    except BaseException:
        process.send_signal(signal.SIGINT)
        raise
    finally:
        assert process.stderr is not None
        err += process.stderr.read()
        process.wait()
        reader.join()
        process.stderr.close()
        process.stdout.close()
    return "".join(out), err


def _finish(words: Sequence[str], progress: Progress | None = None) -> tuple[int, str, str]:
    """Runs the program to its end: exit code, output, messages. On Ctrl-C it is asked to end in order."""
    process = subprocess.Popen([program(), *words], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                               start_new_session=True)
    try:
        if progress is None:
            out, err = process.communicate()
        else:
            out, err = _communicate(process, progress)
    except KeyboardInterrupt:
        process.send_signal(signal.SIGINT)
        out, err = process.communicate()
    except BaseException:
        process.kill()
        process.wait()
        raise
    return process.returncode, out, err


def _warn(err: str) -> None:
    """Passes on what the program warns of, as warnings of the line that called this package."""
    level = 1
    while sys._getframe(level).f_globals.get("__package__") == __package__:
        level += 1
    for text in re.split("^stridor: ", err, flags=re.MULTILINE)[1:]:
        kind, _, told = text.partition("\n")
        if kind == "warning":
            warnings.warn(told.rstrip(), errors.SceneWarning, stacklevel=level + 1)


def call(words: Sequence[str], progress: Progress | None = None) -> dict[str, Any]:
    """Runs the program with ``--json``.

    On Ctrl-C the program is asked to end in order, which leaves a run resumable, and waited for. What it warns
    of is a `SceneWarning`.

    Parameters
    ----------
    progress : callable, optional
        Is called a few times a second with the fraction done of the phase at work, the time left in s
        or None, and a text; at last with 1. What it raises ends the program in order, as Ctrl-C does,
        and is raised again.

    Returns
    -------
    dict
        The JSON object that it printed.

    Raises
    ------
    Error
        As its exit code says: `ConfigError`, `NumericalError`, `FileError` or `Stopped`.
    """
    more = [] if progress is None else ["--progress", "json"]
    code, out, err = _finish([*words, "--json", *more], progress)
    try:
        answer = json.loads(out) if out.strip() else {}
    except json.JSONDecodeError:
        answer = {}
    _warn(err)
    if code == 0:
        if progress is not None:
            progress(1.0, 0.0, "done")
        return answer
    raise errors.of_exit_code(code, _problems(answer, err, code), answer)


def text_of(words: Sequence[str]) -> str:
    """What the program prints, of verbs that print a page.

    Raises
    ------
    Error
    """
    code, out, err = _finish(words)
    if code != 0:
        raise errors.of_exit_code(code, _problems({}, err, code), {})
    return out


def _problems(answer: Mapping[str, Any], err: str, code: int) -> list[errors.Problem]:
    told = errors.problems_of(answer.get("errors", []))
    return told or [errors.Problem(err.strip() or f"the program ended with {code}")]
