"""The program: where it is, and calls of it."""

from __future__ import annotations

import json
import os
import shutil
import signal
import subprocess
import threading
from pathlib import Path
from typing import Any, Callable, Mapping, Sequence

from . import errors


def program() -> str:
    """The program that is called.

    The environment variable ``STRIDOR_PROGRAM`` names it; else it is the one beside this package in a
    source tree that has been built, else the one on the path.

    Raises
    ------
    FileError
        Where there is none.
    """
    named = os.environ.get("STRIDOR_PROGRAM")
    built = Path(__file__).resolve().parents[2] / "build" / "release" / "stridor"
    found = named or (str(built) if built.exists() else shutil.which("stridor"))
    if found is None or shutil.which(found) is None:
        raise errors.FileError(
            [errors.Problem("the program is not there; build it with `./run build`, put it on the path, "
                            "or name it in STRIDOR_PROGRAM", file=found or "stridor")])
    return found


def arguments_of(options: Mapping[str, Any]) -> list[str]:
    """Options of the command line from keyword arguments.

    ``None`` and ``False`` are left out, ``True`` is a flag, a list gives the option once for each.

    >>> arguments_of({"points": 5, "explain": True, "figure": None, "max_wall": 2.5, "input": ["a", "b"]})
    ['--points', '5', '--explain', '--max-wall', '2.5', '--input', 'a', '--input', 'b']
    """
    words: list[str] = []
    for name, value in options.items():
        option = "--" + name.rstrip("_").replace("_", "-")
        if value is None or value is False:
            continue
        if value is True:
            words.append(option)
        elif isinstance(value, (list, tuple)):
            for one in value:
                words += [option, _text(one)]
        else:
            words += [option, _text(value)]
    return words


def _text(value: Any) -> str:
    """A value as the command line takes it: bare numbers are SI."""
    return repr(float(value)) if isinstance(value, float) else str(value)


def setting(key: str, value: Any) -> str:
    """"key=value" as ``--set`` takes it.

    >>> setting("contact.friction.coefficient", 0.35)
    'contact.friction.coefficient=0.35'
    >>> setting("record.channels", ["contact.force"])
    'record.channels=["contact.force"]'
    """
    if value is None:
        text = "null"
    elif isinstance(value, str):
        text = value
    else:
        text = json.dumps(value)  # a list or a map of JSON is one of YAML
    return f"{key}={text}"


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


def call(words: Sequence[str], progress: Progress | None = None) -> dict[str, Any]:
    """Runs the program with ``--json``.

    On Ctrl-C the program is asked to end in order, which leaves a run resumable, and waited for.

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
    process = subprocess.Popen([program(), *words, "--json", *more], stdout=subprocess.PIPE,
                               stderr=subprocess.PIPE, text=True, start_new_session=True)
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
    try:
        answer = json.loads(out) if out.strip() else {}
    except json.JSONDecodeError:
        answer = {}
    if process.returncode == 0:
        if progress is not None:
            progress(1.0, 0.0, "done")
        return answer
    raise errors.of_exit_code(process.returncode, _problems(answer, err, process.returncode))


def _problems(answer: Mapping[str, Any], err: str, code: int) -> list[errors.Problem]:
    told = answer.get("errors", [])
    if told:
        return [errors.Problem(one.get("message", ""), one.get("file", ""), one.get("line", 0),
                               one.get("column", 0), one.get("key", ""), one.get("code", ""))
                for one in told]
    return [errors.Problem(err.strip() or f"the program ended with {code}")]
