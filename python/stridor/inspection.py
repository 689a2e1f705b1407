"""Verbs that look before anything is computed, and after: scenes, files to import, run files, the keys."""

from __future__ import annotations

import os
from dataclasses import dataclass
from typing import Any, Mapping

from . import errors, invocation
from .files import ResultFile, counted, path_of
from .scene import Place, Quantity, Scene, Settings, as_scene


@dataclass(frozen=True, repr=False)
class Findings:
    """What `check` finds.

    Attributes
    ----------
    problems : list of Problem
        What is wrong, each with its place; nothing runs before it is mended.
    warnings : list of Problem
        What is hardly meant.
    imports : dict
        What the files of meshes and matrices hold, by body.
    stability : dict or None
        Of the steps along the path, where it was asked for: ``steps_grow``, ``step_limit`` and ``stable_step``, s, and
        ``places``; else None.
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
          places: int | None = None, progress: invocation.Progress | None = None, **options: Any) -> Findings:
    """What is wrong with a scene, what is hardly meant, and what its imported files hold.

    Parameters
    ----------
    scene : Scene or path
        A scene, or the path of its file.
    set : mapping, optional
        Keys of the scene that are set anew for this call: numbers in SI units, or texts with a unit.
    stability : bool, default: False
        Also whether the steps are stable along the path.
    places : int, optional
        With `stability`, at how many places of the path; default: 101.
    progress : callable, optional
        Is called a few times a second with the fraction done (0 to 1), the time left in s or None, and a text;
        what it raises ends the program in order and is raised again.
    **options
        ``threads`` (int): threads to use.

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


def info(run: ResultFile | Place, *, band: tuple[Quantity, Quantity] | None = None,
         progress: invocation.Progress | None = None) -> dict[str, Any]:
    """What a file of results holds, as ``stridor info`` tells it: of a run its series, results and bursts.

    Parameters
    ----------
    run : Run, any other result or path
        A result, or the path of its file.
    band : tuple, optional
        Lower and upper frequency between which bursts are sought anew, Hz or texts with a unit; default: those that the
        run found in ``measure.band`` of its scene.
    progress : callable, optional
        Is called a few times a second with the fraction done (0 to 1), the time left in s or None, and a text;
        what it raises ends the program in order and is raised again.

    Returns
    -------
    dict
        The JSON object of ``stridor info``. Of a run: ``samples``, ``time`` (``from`` and ``to``, s), ``series`` with
        their units, ``results`` and ``bursts``; of other kinds ``arrays`` with shapes and units, and ``results``.
        `open` reads the numbers.

    Raises
    ------
    FileError
        If there is no such file, or it is none of results.

    Examples
    --------
    >>> grown = run(example("frozen_growth"))
    >>> info(grown, band=("1 kHz", "8 kHz"))["samples"] == len(grown.time)
    True
    """
    return invocation.call(["info", path_of(run), *invocation.arguments_of({"band": band})], progress)


def import_(*sources: Place | Mapping[str, Place], output: Place | None = None, length_unit: str | None = None,
            force_unit: str | None = None, time_unit: str | None = None, frequencies: int | None = None,
            force: bool = False, progress: invocation.Progress | None = None, **options: Any) -> dict[str, Any]:
    """What files of meshes, matrices and modal tests hold, before they are used in a scene.

    Parameters
    ----------
    *sources : path or mapping
        A mesh (``.msh``, ``.inp``), a universal file, or the matrices of a body with what belongs to them; a
        mapping where names do not tell which is which: ``{"mass": "a.mtx", "stiffness": "b.mtx"}``, also damping,
        unknowns, mesh, nodes, universal.
    output : path, optional
        Picture to write, ``.png``, ``.svg`` or ``.pdf``: the mesh with its surfaces, or the nodes, lines and elements
        of a universal file; default: none.
    length_unit, force_unit, time_unit : str, optional
        Units of the files, "mm"; default: "m", "N", "s".
    frequencies : int, optional
        How many of the lowest frequencies of matrices to find; default: 10.
    force : bool, default: False
        Whether a picture that exists is written over.
    progress : callable, optional
        Is called a few times a second with the fraction done (0 to 1), the time left in s or None, and a text;
        what it raises ends the program in order and is raised again.
    **options
        ``unknowns`` ("all_of_mesh"): the rows of the matrices are all displacements of all nodes of the mesh;
        ``thickness`` (number): of a planar mesh, m, 1 by default.

    Returns
    -------
    dict
        ``mesh``, ``matrices`` or ``universal``, as far as the files have them. Lengths of a mesh are in m if
        `length_unit` says its unit, else as they stand in the file; frequencies are in Hz.

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
    asked = {"output": output, "length_unit": length_unit, "force_unit": force_unit, "time_unit": time_unit,
             "frequencies": frequencies, "force": force, **options}
    return invocation.call(["import", *words, *invocation.arguments_of(asked)], progress)


def schema(*, reference: bool = False) -> Any:
    """All keys of scenes: a JSON Schema, which editors and validators take.

    Parameters
    ----------
    reference : bool, default: False
        Whether the reference page of all keys is wanted instead.

    Returns
    -------
    dict or str
        The JSON Schema; with `reference` a text of Markdown.

    Examples
    --------
    >>> keys = schema()
    >>> keys["title"], sorted(keys["properties"])[:3]
    ('scene', ['checkpoint', 'contact', 'contacts'])
    >>> schema(reference=True).splitlines()[0]
    '# Scene reference'
    """
    return invocation.text_of(["schema", "--reference"]) if reference else invocation.call(["schema"])
