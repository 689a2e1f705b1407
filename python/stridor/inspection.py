"""Verbs that look before anything is computed, and after: scenes, files to import, run files, the keys."""

from __future__ import annotations

import os
from dataclasses import dataclass
from typing import Any, Mapping

from . import errors, invocation
from .files import ResultFile, counted
from .scene import Place, Scene, as_scene
from .verbs import Settings


@dataclass(frozen=True, repr=False)
class Findings:
    """What `check` finds.

    Attributes
    ----------
    problems : list of Problem
        What is wrong; nothing runs before it is mended.
    warnings : list of Problem
        What is hardly meant.
    imports : dict
        What the files of meshes and matrices hold, by body.
    stability : dict or None
        Of the steps along the path, with `stability=True`: ``steps_grow``, ``step_limit``, ``stable_step`` and
        ``places``.
    raw : dict
        The whole JSON object.
    """

    problems: list[errors.Problem]
    warnings: list[errors.Problem]
    imports: dict[str, Any]
    stability: dict[str, Any] | None
    raw: dict[str, Any]

    @property
    def ok(self) -> bool:
        """Whether nothing is wrong and, where it was looked at, no step grows."""
        return not self.problems and not (self.stability or {}).get("steps_grow", False)

    def __repr__(self) -> str:
        lines = [counted(len(self.problems), "problem") + ", " + counted(len(self.warnings), "warning")]
        if self.stability is not None:
            lines[0] += ", steps grow" if self.stability["steps_grow"] else ", steps are stable"
        listed = [*self.problems, *self.warnings]
        lines += [str(one) for one in listed[:4]] + (["..."] if len(listed) > 4 else [])
        return "<Findings: " + "\n ".join(lines) + ">"


def check(scene: Scene | Place, *, set: Settings | None = None, stability: bool = False,  # noqa: A002
          places: int | None = None, **options: Any) -> Findings:
    """What is wrong with a scene, what is hardly meant, and what its imported files hold.

    Parameters
    ----------
    stability : bool
        Also whether the steps are stable along the path.
    places : int, optional
        How many places of the path; default: 101.

    Returns
    -------
    Findings
        Also where something is wrong: faults of a scene are not raised.

    Raises
    ------
    ConfigError
        If an argument is wrong, or the scene has no steps whose stability could be looked at.
    FileError
        If there is no such scene.

    Examples
    --------
    >>> check(example("beam_on_beam"), stability=True, places=5)
    <Findings: 0 problems, 0 warnings, steps are stable>
    >>> found = check(example("beam_on_beam"), set={"contct.start": 0.03})
    >>> found.ok, [problem.key for problem in found.problems]
    (False, ['contct'])
    >>> check(example("from_abaqus")).imports["clip"]["matrices"]["unknowns"]
    24
    """
    progress = options.pop("progress", None)
    words = invocation.arguments_of({"stability": stability, "places": places, **options})
    try:
        raw = invocation.call(["check", *as_scene(scene, set).words(), *words], progress)
    except (errors.ConfigError, errors.NumericalError) as error:
        is_of_arguments = any(problem.key.startswith("--") for problem in error.problems)
        if "warnings" not in error.answer or is_of_arguments:
            raise
        raw = error.answer
    return Findings(errors.problems_of(raw.get("errors", [])), errors.problems_of(raw["warnings"]),
                    raw.get("imports", {}), raw.get("stability"), raw)


def info(run: ResultFile | Place, *, band: tuple[Any, Any] | None = None, **options: Any) -> dict[str, Any]:
    """What a file of results holds, as ``stridor info`` tells it: of a run its series, results and bursts.

    Parameters
    ----------
    run : Run, any other result or path
        Of kinds other than runs there are ``kind``, ``command``, ``arrays`` and ``results``; `open` reads their numbers.
    band : tuple, optional
        Lower and upper frequency between which bursts are sought anew, Hz or texts with a unit.

    Examples
    --------
    >>> grown = run(example("frozen_growth"))
    >>> info(grown, band=("1 kHz", "8 kHz"))["samples"] == len(grown.time)
    True
    """
    progress = options.pop("progress", None)
    file = os.fspath(run.path if isinstance(run, ResultFile) else run)
    return invocation.call(["info", file, *invocation.arguments_of({"band": band, **options})], progress)


def import_(*sources: Place | Mapping[str, Place], output: Place | None = None, **options: Any) -> dict[str, Any]:
    """What files of meshes, matrices and modal tests hold, before they are used in a scene.

    Parameters
    ----------
    *sources : path or mapping
        A mesh (``.msh``, ``.inp``), a universal file, or the matrices of a body with what belongs to them; a
        mapping where names do not tell which is which: ``{"mass": "a.mtx", "stiffness": "b.mtx"}``, also damping,
        unknowns, mesh, nodes, universal.
    output : path, optional
        A picture of the mesh with its surfaces to write, ``.png``, ``.svg`` or ``.pdf``.
    **options
        ``unknowns``, ``length_unit``, ``force_unit``, ``time_unit``, ``thickness``, ``frequencies``, ``force``: as
        of ``stridor import``.

    Returns
    -------
    dict
        ``mesh``, ``matrices`` or ``universal``, as far as the files have them; lengths of a mesh in its own unit
        unless ``length_unit`` says it.

    Raises
    ------
    FileError
        If a file is not there or not what it should be.
    ConfigError
        If the files do not belong together.

    Examples
    --------
    >>> import pathlib
    >>> folder = pathlib.Path(example("from_abaqus")).parent
    >>> import_(folder / "rail.inp", length_unit="mm")["mesh"]["elements"]
    {'hex8': 96}
    >>> clip = folder / "from_abaqus"
    >>> files = {"mass": clip / "clip_MASS1.mtx", "stiffness": clip / "clip_STIF1.mtx", "mesh": clip / "clip.inp"}
    >>> found = import_(files, frequencies=3)
    >>> found["matrices"]["unknowns"], len(found["matrices"]["frequencies"])
    (24, 3)
    """
    words: list[str] = []
    for one in sources:
        if isinstance(one, Mapping):
            words += [f"{role}={os.fspath(file)}" for role, file in one.items()]
        else:
            words.append(os.fspath(one))
    progress = options.pop("progress", None)
    picture = None if output is None else os.fspath(output)
    return invocation.call(["import", *words, *invocation.arguments_of({"output": picture, **options})], progress)


def schema(*, reference: bool = False) -> Any:
    """All keys of scenes: a JSON Schema, which editors and validators take.

    Parameters
    ----------
    reference : bool
        The reference page of all keys instead, a text of Markdown.

    Examples
    --------
    >>> keys = schema()
    >>> keys["title"], sorted(keys["properties"])[:3]
    ('scene', ['checkpoint', 'contact', 'contacts'])
    >>> schema(reference=True).splitlines()[0]
    '# Scene reference'
    """
    return invocation.text_of(["schema", "--reference"]) if reference else invocation.call(["schema"])
