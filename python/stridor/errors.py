"""What a verb of the program fails with."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Iterable, Mapping


@dataclass(frozen=True)
class Problem:
    """One thing that is wrong, and where.

    Attributes
    ----------
    message : str
        What is wrong, in a sentence.
    file : str
        A file, or the setting that it came from ("--set key=value"); "" where it has no place.
    line, column : int
        Place in the file, counted from 1; 0 where there is none.
    key : str
        The key of the scene, "contact.friction.coefficient", or the option, "--points"; "" where it is of neither.
    code : str
        Its kind, "off-the-surface", which stays the same from version to version: docs/refusals.md has a section for
        each.
    """

    message: str
    file: str = ""
    line: int = 0
    column: int = 0
    key: str = ""
    code: str = ""

    def __str__(self) -> str:
        place = ":".join(str(part) for part in (self.file, self.line, self.column) if part)
        named = f"{self.key}: {self.message}" if self.key else self.message
        return f"{place}: {named}" if place else named


def problems_of(told: Iterable[Mapping[str, Any]]) -> list[Problem]:
    """Problems of those of the JSON object of a verb."""
    return [Problem(one.get("message", ""), one.get("file", ""), one.get("line", 0), one.get("column", 0),
                    one.get("key", ""), one.get("code", "")) for one in told]


class Error(Exception):
    """Any failure of the program.

    Attributes
    ----------
    problems : list of Problem
        All that is wrong, each with its place.
    exit_code : int
        Of the program: 2 of a `ConfigError`, 3 of a `NumericalError`, 4 of a `FileError`, 5 of `Stopped`, else 1.
    answer : dict
        The JSON object that the program printed all the same: the results of a run that missed what its scene
        expects (``verify=True``), contacts of which some did not converge.
    """

    exit_code = 1

    def __init__(self, problems: list[Problem], answer: Mapping[str, Any] | None = None):
        super().__init__("\n".join(str(problem) for problem in problems))
        self.problems = problems
        self.answer: dict[str, Any] = dict(answer or {})


class ConfigError(Error):
    """The scene or an argument is wrong: every problem with its place."""

    exit_code = 2


class NumericalError(Error):
    """The numbers failed: singular, diverged, persistent sliding lost."""

    exit_code = 3


class FileError(Error):
    """A file is missing, damaged, full or may not be overwritten."""

    exit_code = 4


class Stopped(Error):
    """The program was stopped, by Ctrl-C or `max_wall`.

    Attributes
    ----------
    file : str or None
        Of a run, the file with which it can go on: ``stridor.run(resume=error.file)``; of other verbs None.
    """

    exit_code = 5

    def __init__(self, problems: list[Problem], file: str | None = None, answer: Mapping[str, Any] | None = None):
        super().__init__(problems, answer)
        self.file = file


_BY_EXIT_CODE = {kind.exit_code: kind for kind in (ConfigError, NumericalError, FileError, Stopped)}


def of_exit_code(code: int, problems: list[Problem], answer: Mapping[str, Any]) -> Error:
    """The error of an exit code of the program."""
    return _BY_EXIT_CODE.get(code, Error)(problems, answer=answer)


class SceneWarning(UserWarning):
    """What the program warns of: a scene that is hardly meant, a locus of other bodies. See `warnings` of Python."""
