"""Verbs that follow a scene in time: transients, limit cycles, and sweeps of both."""

from __future__ import annotations

from typing import Any

from . import errors, invocation
from .calls import opened, output_of, written
from .files import ResultFile, path_of
from .invocation import Progress
from .results import Sweep
from .runs import Cycle, Run
from .scene import Place, Quantity, Scene, Settings, Spacing, as_scene


def run(scene: Scene | Place | None = None, *, output: Place | None = None, set: Settings | None = None,  # noqa: A002
        resume: Run | Place | None = None, max_wall: float | None = None, verify: bool = False, error: bool = False,
        predict: ResultFile | Place | None = None, force: bool = False, progress: Progress | None = None,
        **options: Any) -> Run:
    """A transient.

    Parameters
    ----------
    scene : Scene or path, optional
        A scene, or the path of its file; None with `resume`.
    output : path, optional
        Run file to write (HDF5); default: one in a new folder of its own.
    set : mapping, optional
        Keys of the scene that are set anew for this call: numbers in SI units, or texts with a unit.
    resume : Run or path, optional
        A run that was interrupted, or the path of its file, which goes on from its latest checkpoint.
    max_wall : number, optional
        Wall time, s, after which the run is stopped, resumable; default: none.
    verify : bool, default: False
        Whether the results are compared with what the scene expects (``expect``).
    error : bool, default: False
        Whether the error of the run is estimated, by a second, finer one.
    predict : Locus or path, optional
        A locus, or the path of its file, whose unstable windows are set beside the bursts.
    force : bool, default: False
        Whether files that exist are written over.
    progress : callable, optional
        Is called a few times a second with the fraction done (0 to 1), the time left in s or None, and a text;
        what it raises ends the program in order and is raised again.
    **options
        ``vtu`` (path): folder for the shapes of the bodies over time, for ParaView; ``vtu_interval`` (number or str):
        time between these, s, a hundredth of the run by default; ``threads`` (int): threads to use, of which a run
        takes one.

    Returns
    -------
    Run
        The file, open.

    Raises
    ------
    Stopped
        By Ctrl-C or `max_wall`; its `file` can be resumed.
    NumericalError
        If the motion diverged or persistent sliding was lost, or with `verify` a result is not what was expected.

    Examples
    --------
    >>> with run(example("frozen_growth"), set={"time.end": 0.1}) as found:
    ...     found.status, float(found.time[-1])
    ('done', 0.1)
    """
    file = path_of(resume) if resume is not None else output_of(output, "run.h5")
    if resume is not None:
        words = ["run", "--resume", file]
    else:
        if scene is None:
            raise TypeError("run() needs a scene, or `resume`")
        words = ["run", *as_scene(scene, set).words(), "--output", file]
    asked = {"max_wall": max_wall, "verify": verify, "error": error,
             "predict": None if predict is None else path_of(predict), "force": force, **options}
    try:
        answer = invocation.call([*words, *invocation.arguments_of(asked)], progress)
    except errors.Stopped as stopped:
        raise errors.Stopped(stopped.problems, file, stopped.answer) from None
    return opened(file, answer)


def cycle(scene: Scene | Place, *, output: Place | None = None, set: Settings | None = None,  # noqa: A002
          figure: Place | None = None, verify: bool = False, force: bool = False, progress: Progress | None = None,
          **options: Any) -> Cycle:
    """A periodic motion, one period of it with its multipliers.

    Parameters
    ----------
    scene : Scene or path
        A scene, or the path of its file.
    output : path, optional
        HDF5 file to write; default: one in a new folder of its own.
    set : mapping, optional
        Keys of the scene that are set anew for this call: numbers in SI units, or texts with a unit.
    figure : path, optional
        Picture of one period to write: ``.png``, ``.svg`` or ``.pdf``; default: none.
    verify : bool, default: False
        Whether the results are compared with what the scene expects (``expect``).
    force : bool, default: False
        Whether files that exist are written over.
    progress : callable, optional
        Is called a few times a second with the fraction done (0 to 1), the time left in s or None, and a text;
        what it raises ends the program in order and is raised again.
    **options
        ``threads`` (int): threads to use.

    Returns
    -------
    Cycle
        The file, open. Where no cycle was found, its `status` says why, and its `period` is NaN.

    Raises
    ------
    NumericalError
        With `verify`, if a result is not what was expected.

    Examples
    --------
    >>> found = cycle(example("mass_on_belt"))
    >>> found.status, round(found.period, 4)
    ('periodic', 0.6712)
    """
    asked = {"figure": figure, "verify": verify, "force": force, **options}
    return written("cycle", scene, output, set, progress, asked)


def sweep(scene: Scene | Place, *, parameter: str | None = None, from_: Quantity, to: Quantity,
          points: int | None = None, scale: Spacing | None = None, up_down: bool = False, output: Place | None = None,
          set: Settings | None = None, figure: Place | None = None, threads: int | None = None,  # noqa: A002
          force: bool = False, progress: Progress | None = None) -> Sweep:
    """Transients along a key of a scene, or limit cycles where its integrator goes from event to event.

    Parameters
    ----------
    scene : Scene or path
        A scene, or the path of its file.
    parameter : str, optional
        Key of the scene that varies, or "drive.displacement", how far the drive has moved the bodies; default:
        "contact.start", or with several pairs in contact "drive.displacement".
    from_, to : number or str
        Its first and last value, SI or with a unit.
    points : int, optional
        How many values, both ends included; default: 21.
    scale : {"linear", "log"}, optional
        Values at equal distances or at equal ratios; default: linear.
    up_down : bool, default: False
        Whether to go up and then down, each value from the motion at the one before, which shows where two motions
        exist.
    output : path, optional
        HDF5 file to write; default: one in a new folder of its own.
    set : mapping, optional
        Keys of the scene that are set anew for this call: numbers in SI units, or texts with a unit.
    figure : path, optional
        Picture of the amplitude to write: ``.png``, ``.svg`` or ``.pdf``; default: none.
    threads : int, optional
        Threads to use; default: all processors.
    force : bool, default: False
        Whether files that exist are written over.
    progress : callable, optional
        Is called a few times a second with the fraction done (0 to 1), the time left in s or None, and a text;
        what it raises ends the program in order and is raised again.

    Returns
    -------
    Sweep
        The file, open.

    Examples
    --------
    >>> found = sweep(example("mass_on_belt"), parameter="parameters.v", from_=0.05, to=0.15, points=3)
    >>> found.parameter, found.values.tolist()
    ('parameters.v', [0.05, 0.1, 0.15])
    """
    asked = {"parameter": parameter, "from": from_, "to": to, "points": points, "scale": scale, "up_down": up_down,
             "figure": figure, "threads": threads, "force": force}
    return written("sweep", scene, output, set, progress, asked)
