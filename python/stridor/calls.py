"""Calls of verbs that take a scene, and the files that they write."""

from __future__ import annotations

import os
import tempfile
from pathlib import Path
from typing import Any, Mapping

from . import invocation, opening
from .scene import Place, Scene, Settings, as_scene


def call(verb: str, scene: Scene | Place, *, set: Settings | None = None,  # noqa: A002
         progress: invocation.Progress | None = None, **options: Any) -> dict[str, Any]:
    """Any verb that takes a scene, with all its options.

    Parameters
    ----------
    verb : str
        Its name on the command line, "threshold".
    scene : Scene or path
        A scene, or the path of its file.
    set : mapping, optional
        Keys of the scene that are set anew for this call: numbers in SI units, or texts with a unit.
    progress : callable, optional
        Is called a few times a second with the fraction done (0 to 1), the time left in s or None, and a text;
        what it raises ends the program in order and is raised again.
    **options
        The options of the verb on the command line, with ``_`` for ``-`` and an underscore behind words of Python.
        ``True`` is a flag; a list gives an option once for each value, a mapping once for each key and value.

    Returns
    -------
    dict
        The JSON object of the verb.

    Raises
    ------
    Error
        As its exit code says: `ConfigError`, `NumericalError`, `FileError` or `Stopped`.

    Examples
    --------
    >>> found = call("threshold", example("elastic_pads"), parameter="parameters.mu", from_=0.1, to=0.5)
    >>> round(found["roots"][0]["value"], 3)
    0.263
    """
    words = [verb, *as_scene(scene, set).words(), *invocation.arguments_of(options)]
    return invocation.call(words, progress)


def output_of(output: Place | None, name: str) -> str:
    """The file to write; without a name one in a new folder of its own."""
    return os.fspath(output) if output is not None else str(Path(tempfile.mkdtemp(prefix="stridor-")) / name)


def opened(file: str, answer: dict[str, Any]) -> Any:
    """A file that a verb has written, with what it said."""
    found = opening.open(file)
    found.raw = answer
    return found


def written(verb: str, scene: Scene | Place, output: Place | None, set: Settings | None,  # noqa: A002
            progress: invocation.Progress | None, options: Mapping[str, Any]) -> Any:
    """The file of a verb that writes one to ``--output``, opened."""
    file = output_of(output, verb + ".h5")
    return opened(file, call(verb, scene, set=set, progress=progress, output=file, **options))
