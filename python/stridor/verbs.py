"""The verbs of the program that compute. Keyword arguments are named as the options of the command line; where a name
is a word of Python, an underscore follows: ``from_``. Every verb takes ``progress``, a function that is
called a few times a second with the fraction done, the time left in s or None, and a text."""

from __future__ import annotations

import os
import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Mapping

import numpy as np

from . import errors, invocation, opening
from .results import FrequencyResponses, Locus, StabilityMap, Sweep
from .rubber import ContactLaw, SlidingContacts
from .runs import Cycle, Run
from .scene import Place, Scene, as_scene

Settings = Mapping[str, Any]


@dataclass(frozen=True, repr=False)
class Eigenvalues:
    """What `eig` finds.

    Attributes
    ----------
    values : complex array
        s, 1/s: the real part is a growth rate, the imaginary part a circular frequency.
    stable : bool
        Whether none grows within `window`.
    window : tuple of float
        Frequencies for which that holds, Hz.
    equilibrium : dict
        Contact forces, positions and displacements.
    raw : dict
        The whole JSON object, with `explanation` where it was asked for.
    """

    values: np.ndarray
    stable: bool
    window: tuple[float, float]
    equilibrium: dict[str, Any]
    raw: dict[str, Any]

    @property
    def frequencies(self) -> np.ndarray:
        """Hz."""
        return self.values.imag / (2.0 * np.pi)

    @property
    def growth(self) -> np.ndarray:
        """1/s."""
        return self.values.real

    def __repr__(self) -> str:
        if len(self.values) == 0:
            return "<Eigenvalues: none>"
        worst = int(self.growth.argmax())
        return (f"<Eigenvalues: {len(self.values)}, {self.frequencies[0]:.6g} to {self.frequencies[-1]:.6g} Hz, "
                f"{'stable' if self.stable else 'unstable'};\n "
                f"largest growth {self.growth[worst]:.4g} 1/s at {self.frequencies[worst]:.6g} Hz>")


def call(verb: str, scene: Scene | Place, *, set: Settings | None = None, **options: Any) -> dict[str, Any]:  # noqa: A002
    """Any verb that takes a scene.

    Returns
    -------
    dict
        The JSON object of the verb.

    Examples
    --------
    >>> found = call("threshold", example("elastic_pads"), parameter="parameters.mu", from_=0.1, to=0.5)
    >>> round(found["roots"][0]["value"], 3)
    0.263
    """
    progress = options.pop("progress", None)
    words = [verb, *as_scene(scene, set).words(), *invocation.arguments_of(options)]
    return invocation.call(words, progress)


def output_of(output: Place | None, name: str) -> str:
    """The file to write; without a name one in a new folder of its own."""
    return os.fspath(output) if output is not None else str(Path(tempfile.mkdtemp(prefix="stridor-")) / name)


def run(scene: Scene | Place | None = None, *, output: Place | None = None, set: Settings | None = None,  # noqa: A002
        resume: Place | None = None, **options: Any) -> Run:
    """A transient.

    Parameters
    ----------
    scene : Scene or path
        None with `resume`.
    output : path, optional
        Run file; default: one in a new folder of its own.
    set : mapping, optional
        Keys of the scene that are set anew.
    resume : path, optional
        A run file that was interrupted, from which the run goes on.
    **options
        ``verify``, ``error``, ``max_wall``, ``force``, ``vtu``, ``predict``: as of ``stridor run``.

    Returns
    -------
    Run

    Raises
    ------
    Stopped
        By Ctrl-C or `max_wall`; its `file` can be resumed.

    Examples
    --------
    >>> with run(example("frozen_growth"), set={"time.end": 0.1}) as found:
    ...     found.status, float(found.time[-1])
    ('done', 0.1)
    """
    file = os.fspath(resume) if resume is not None else output_of(output, "run.h5")
    if resume is not None:
        words = ["run", "--resume", file]
    else:
        if scene is None:
            raise TypeError("run() needs a scene, or `resume`")
        words = ["run", *as_scene(scene, set).words(), "--output", file]
    progress = options.pop("progress", None)
    try:
        answer = invocation.call([*words, *invocation.arguments_of(options)], progress)
    except errors.Stopped as stopped:
        raise errors.Stopped(stopped.problems, file, stopped.answer) from None
    return _opened(file, answer)


def eig(scene: Scene | Place, *, set: Settings | None = None, **options: Any) -> Eigenvalues:  # noqa: A002
    """The sliding equilibrium and its eigenvalues.

    Parameters
    ----------
    **options
        ``about`` ("undeformed" or "deformed"), ``count``, ``below``, ``at``, ``explain``, ``mode``,
        ``shapes``: as of ``stridor eig``.

    Examples
    --------
    >>> found = eig(example("frozen_growth"), about="deformed", count=10)
    >>> found.values.shape, found.stable
    ((10,), False)
    >>> round(float(found.growth.max()), 1) > 0
    True
    """
    raw = call("eig", scene, set=set, **options)
    values = np.array([complex(re, im) for re, im in raw["eigenvalues"]])
    upper = raw["window"][1]
    return Eigenvalues(values, raw["stable"], (raw["window"][0], np.inf if upper is None else upper),
                       raw["equilibrium"], raw)


def locus(scene: Scene | Place, *, output: Place | None = None, set: Settings | None = None,  # noqa: A002
          **options: Any) -> Locus:
    """Eigenvalues along a key.

    Parameters
    ----------
    output : path, optional
        File; default: one in a new folder of its own.
    **options
        ``parameter``, ``from_``, ``to``, ``points``, ``about``, ``count``, ``below``, ``figure``.

    Examples
    --------
    >>> found = locus(example("two_springs_on_a_belt"), parameter="parameters.mu", from_=0, to=1.2, points=13)
    >>> [round(float(value), 2) for value in found.values[(found.eigenvalues.real > 1e-6).any(axis=1)]]
    [0.8, 0.9, 1.0, 1.1, 1.2]
    """
    return _written("locus", scene, output, set, options)


def map(scene: Scene | Place, *, x: tuple[str, Any, Any, int], y: tuple[str, Any, Any, int],  # noqa: A001
        output: Place | None = None, set: Settings | None = None, **options: Any) -> StabilityMap:  # noqa: A002
    """Stability over two keys, each (key, first value, last value, number of values).

    Examples
    --------
    >>> found = map(example("disc_and_pads"), x=("parameters.mu", 0.2, 0.5, 4),
    ...             y=("substructures.disc.spin", 5, 10, 2))
    >>> found.growth.shape
    (2, 4)
    """
    file = output_of(output, "map.h5")
    axes = ["--x", *[str(part) for part in x], "--y", *[str(part) for part in y]]
    progress = options.pop("progress", None)
    words = ["map", *as_scene(scene, set).words(), *axes, "--output", file, *invocation.arguments_of(options)]
    return _opened(file, invocation.call(words, progress))


def frf(scene: Scene | Place, *, output: Place | None = None, set: Settings | None = None,  # noqa: A002
        motions: Any = None, **options: Any) -> FrequencyResponses:
    """Frequency responses.

    Parameters
    ----------
    output : path, optional
        HDF5 file; default: one in a new folder of its own.
    motions : str or list of str, optional
        Motions that are wanted (``--output`` of the command line).
    **options
        ``input``, ``from_``, ``to``, ``points``, ``scale``, ``about``, ``figure``, ``compare``, ``node``.

    Examples
    --------
    >>> found = frf(example("reed"), input="reed.middle.y", motions="reed.tip.y.displacement", from_="100 Hz",
    ...             to="3 kHz", points=30)
    >>> found.frequency.shape
    (30,)
    """
    file = output_of(output, "frf.h5")
    progress = options.pop("progress", None)
    words = ["frf", *as_scene(scene, set).words(), "-o", file, *invocation.arguments_of({"output": motions}),
             *invocation.arguments_of(options)]
    return _opened(file, invocation.call(words, progress))


def _written(verb: str, scene: Scene | Place, output: Place | None, set: Settings | None,  # noqa: A002
             options: Mapping[str, Any]) -> Any:
    file = output_of(output, verb + ".h5")
    return _opened(file, call(verb, scene, set=set, output=file, **options))


def _opened(file: str, answer: dict[str, Any]) -> Any:
    """A file that a verb has written, with what it said."""
    opened = opening.open(file)
    opened.raw = answer
    return opened


def threshold(scene: Scene | Place, *, set: Settings | None = None, **options: Any) -> list[dict[str, Any]]:  # noqa: A002
    """Every value of a key where the stability changes: ``parameter``, ``from_``, ``to``.

    Examples
    --------
    >>> found = threshold(example("two_springs_on_a_belt"), parameter="parameters.mu", from_=0, to=1.2)
    >>> [round(root["value"], 4) for root in found]
    [0.75]
    """
    return call("threshold", scene, set=set, **options)["roots"]


def cycle(scene: Scene | Place, *, output: Place | None = None, set: Settings | None = None,  # noqa: A002
          **options: Any) -> Cycle:
    """A periodic motion, one period of it with its multipliers.

    Parameters
    ----------
    output : path, optional
        HDF5 file; default: one in a new folder of its own.
    **options
        ``figure``, ``verify``, ``force``: as of ``stridor cycle``.

    Returns
    -------
    Cycle
        Where none was found, its `status` says why, and its `period` is NaN.

    Examples
    --------
    >>> found = cycle(example("mass_on_belt"))
    >>> found.status, round(found.period, 4)
    ('periodic', 0.6712)
    """
    return _written("cycle", scene, output, set, options)


def sweep(scene: Scene | Place, *, output: Place | None = None, set: Settings | None = None,  # noqa: A002
          **options: Any) -> Sweep:
    """Transients or cycles along a key: ``parameter``, ``from_``, ``to``, ``points``, ``threads``.

    Examples
    --------
    >>> found = sweep(example("mass_on_belt"), parameter="parameters.v", from_=0.05, to=0.15, points=3)
    >>> found.parameter, found.values.tolist()
    ('parameters.v', [0.05, 0.1, 0.15])
    """
    return _written("sweep", scene, output, set, options)


def compare(scene: Scene | Place, *, set: Settings | None = None, **options: Any) -> list[dict[str, Any]]:  # noqa: A002
    """The four contact assumptions on the same work, a row each, as ``pandas.DataFrame`` takes them.

    Examples
    --------
    >>> rows = compare(example("beam_on_beam"), set={"time.end": 0.02, "measure.from": 0.01})
    >>> [row["assumption"] for row in rows]
    ['subs_a', 'subs_b', 'subs_c', 'film']
    """
    return call("compare", scene, set=set, **options)["rows"]


def precision(scene: Scene | Place, *, set: Settings | None = None, **options: Any) -> dict[str, Any]:  # noqa: A002
    """Error against run time; with ``reduction=True`` that of the reduced bodies alone.

    Examples
    --------
    >>> found = precision(example("tuning_fork"), reduction=True)
    >>> sorted(found)
    ['reduction']
    """
    return call("precision", scene, set=set, **options)


def contact(scene: Scene | Place, *, output: Place | None = None, set: Settings | None = None,  # noqa: A002
            **options: Any) -> SlidingContacts:
    """Viscoelastic normal laws of a scene in steady sliding: force, area, friction, pressures.

    Parameters
    ----------
    output : path, optional
        File; default: one in a new folder of its own.
    **options
        ``speed``, ``indentation`` or ``load``, a number or several (default: those of the scene); ``contact``, where
        the scene has several; ``pressure`` and ``edges``, pictures; ``verify``, ``threads``, ``force``: as of
        ``stridor contact``.

    Returns
    -------
    SlidingContacts
        With ``raw["rows"]``, where remarks on each row stand.

    Raises
    ------
    ConfigError
        If the scene has no such law, or several and `contact` names none.
    NumericalError
        If a contact did not converge; its `answer` has all rows.

    Examples
    --------
    >>> found = contact(example("viscoelastic_contact"), speed=[0.1, 1], indentation=0.01,
    ...                 set={"contacts.tip.normal.solver.grid": 32})
    >>> len(found.rows)
    2
    """
    return _written("contact", scene, output, set, options)


def contact_table(scene: Scene | Place, *, output: Place | None = None, set: Settings | None = None,  # noqa: A002
                  **options: Any) -> ContactLaw:
    """The law of a contact as a table, which the key ``normal.form`` of a contact takes (``stridor contact --table``).

    Parameters
    ----------
    output : path, optional
        File; default: one in a new folder of its own.
    **options
        ``speeds`` and ``indentations``, each (first, last, number of values); ``contact``, ``threads``, ``force``.

    Examples
    --------
    >>> law = contact_table(example("viscoelastic_contact"), speeds=(0.1, 1, 4), indentations=(0.005, 0.01, 4),
    ...                     set={"contacts.tip.normal.solver.grid": 32})
    >>> type(law).__name__
    'ContactLaw'
    """
    file = output_of(output, "law.h5")
    return _opened(file, call("contact", scene, set=set, table=file, **options))


def fit(*, speeds: tuple[float, float, int] | None = None, indentations: tuple[float, float, int] | None = None,
        figures: Place | None = None, **options: Any) -> dict[str, Any]:
    """Refit of the published contact laws to the boundary elements. It takes no scene.

    Parameters
    ----------
    speeds, indentations : tuple, optional
        First and last value and their number, v tau/R and y/R; default: (1e-3, 1e3, 49), (1e-4, 0.3, 15).
    figures : path, optional
        Folder for the pictures modulus, cuts and scatter.

    Returns
    -------
    dict
        Coefficients ``published`` and ``refit``, the ``shift`` of the speed, and what each explains, ``r2``.

    Examples
    --------
    >>> found = fit(speeds=(0.1, 1.0, 4), indentations=(1e-3, 1e-2, 4))
    >>> found["samples"], found["r2"]["refit"]["force"] > 0.9999
    (16, True)
    """
    progress = options.pop("progress", None)
    folder = None if figures is None else os.fspath(figures)
    asked = {"speeds": speeds, "indentations": indentations, "figures": folder, **options}
    return invocation.call(["fit", *invocation.arguments_of(asked)], progress)
