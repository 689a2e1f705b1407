"""Verbs that set ways of computing beside one another: contact assumptions, integrators and their steps."""

from __future__ import annotations

import os
from collections.abc import Sequence
from typing import Any, Literal

from .calls import call, opened
from .invocation import Progress
from .scene import Place, Quantity, Scene, Settings, as_scene
from .tables import Comparison, PrecisionStudy, comparison_of, precision_of


def compare(scene: Scene | Place, *, output: Place | None = None, set: Settings | None = None,  # noqa: A002
            published_window: float | None = None, force: bool = False, progress: Progress | None = None,
            **options: Any) -> Comparison:
    """The four contact assumptions Subs-a, Subs-b, Subs-c and FiLM on the same work: times, results, bursts.

    Parameters
    ----------
    scene : Scene or path
        A scene, or the path of its file.
    output : path, optional
        Folder to write run files, pictures, ``comparison.json`` and ``comparison.h5`` to; default: none is kept.
    set : mapping, optional
        Keys of the scene that are set anew for this call: numbers in SI units, or texts with a unit.
    published_window : number, optional
        Time of the run, s, over which the published dense form is timed as well; default: not at all.
    force : bool, default: False
        Whether files that exist are written over.
    progress : callable, optional
        Is called a few times a second with the fraction done (0 to 1), the time left in s or None, and a text;
        what it raises ends the program in order and is raised again.
    **options
        ``threads`` (int): threads to use, of which a comparison of times takes one.

    Returns
    -------
    Comparison
        A row for each run; of `output` the file ``comparison.h5``, open.

    Examples
    --------
    >>> found = compare(example("beam_on_beam"), set={"time.end": 0.02, "measure.from": 0.01})
    >>> [row["assumption"] for row in found]
    ['subs_a', 'subs_b', 'subs_c', 'film']
    """
    asked = {"output": output, "published_window": published_window, "force": force, **options}
    answer = call("compare", scene, set=set, progress=progress, **asked)
    return comparison_of(answer) if output is None else opened(os.path.join(output, "comparison.h5"), answer)


def precision(scene: Scene | Place, *, output: Place | None = None, set: Settings | None = None,  # noqa: A002
              points: int | None = None, until: Quantity | None = None,
              norm: Literal["envelope", "acceleration", "force"] | None = None, tune: float | None = None,
              reduction: bool = False, frequencies: Quantity | Sequence[Quantity] | None = None,
              force: bool = False, progress: Progress | None = None, **options: Any) -> PrecisionStudy:
    """Errors against run times over integrators, steps and retained modes, and errors of the reduction of the bodies.

    Parameters
    ----------
    scene : Scene or path
        A scene, or the path of its file.
    output : path, optional
        Folder to write ``precision.json``, ``precision.h5`` and ``precision.png`` to, with `reduction` the first alone;
        default: none is kept.
    set : mapping, optional
        Keys of the scene that are set anew for this call: numbers in SI units, or texts with a unit.
    points : int, optional
        How many steps are measured for each method; default: 7.
    until : number or str, optional
        Time to which the run is taken, s or with a unit; default: the end of the run.
    norm : {"envelope", "acceleration", "force"}, optional
        The error that counts; default: that of the envelope of the acceleration.
    tune : number, optional
        Relative error within which the cheapest setting is sought, `tuned` of the result; default: none is.
    reduction : bool, default: False
        Whether only the reduced bodies are compared with the full ones; nothing is run then.
    frequencies : number, str or list, optional
        Frequencies at which reduced bodies are compared with full ones, Hz or with a unit; default: 1/16 to 1 of that
        up to which a reduction is trusted.
    force : bool, default: False
        Whether files that exist are written over.
    progress : callable, optional
        Is called a few times a second with the fraction done (0 to 1), the time left in s or None, and a text;
        what it raises ends the program in order and is raised again.
    **options
        ``retain`` (list of numbers or str): frequencies up to which modes move, Hz, by default 5/3, 10/3 and 20/3 of
        the upper end of the band; ``assumptions`` (list): contact assumptions beside the scene's own, of "subs_a",
        "subs_b", "subs_c" and "film", by default all; ``published_window`` (number): time of the run, s, over which the
        published dense forms are timed, 0.005 by default, 0 for not at all; ``threads`` (int): threads to use.

    Returns
    -------
    PrecisionStudy
        A row for each setting, and `reduction`; of `output` the file ``precision.h5``, open, unless there is
        `reduction` alone.

    Raises
    ------
    NumericalError
        With `tune`, if no setting is within that error; its `answer` has all rows.

    Examples
    --------
    >>> found = precision(example("tuning_fork"), reduction=True, frequencies=["500 Hz", "1 kHz"])
    >>> found.reduction["frequency"].tolist()
    [500.0, 1000.0]
    >>> bool(found.reduction["error"].max() < 0.01)
    True
    """
    asked = {"output": output, "points": points, "until": until, "norm": norm, "tune": tune, "reduction": reduction,
             "frequencies": frequencies, "force": force, **options}
    answer = call("precision", scene, set=set, progress=progress, **asked)
    if output is None or reduction:
        return precision_of(answer, as_scene(scene).path)
    return opened(os.path.join(output, "precision.h5"), answer)
