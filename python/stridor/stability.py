"""Verbs that linearise a scene about its sliding equilibrium: eigenvalues, loci, thresholds, maps, responses."""

from __future__ import annotations

import os
from dataclasses import dataclass
from typing import Any, Mapping, Sequence

import numpy as np

from . import invocation
from .calls import call, opened, output_of, written
from .invocation import Progress, arguments_of
from .responses import FrequencyResponses
from .results import Locus, StabilityMap
from .scene import About, Place, Quantity, Scene, Settings, Spacing, as_scene
from .tables import Thresholds, thresholds_of


@dataclass(frozen=True, repr=False)
class Eigenvalues:
    """The sliding equilibrium and its eigenvalues, what `eig` finds.

    Attributes
    ----------
    values : complex array
        Eigenvalues s, 1/s, ascending frequency: the real part is a growth rate, the imaginary part a circular
        frequency.
    stable : bool
        Whether none grows within `window`.
    window : tuple of float
        Lowest and highest frequency for which that holds, Hz.
    equilibrium : dict
        Contact forces, N, positions and displacements, m.
    raw : dict
        The whole JSON object, with ``explanation`` where it was asked for.
    """

    values: np.ndarray
    stable: bool
    window: tuple[float, float]
    equilibrium: dict[str, Any]
    raw: dict[str, Any]

    @property
    def frequencies(self) -> np.ndarray:
        """Frequency of each eigenvalue, Hz."""
        return self.values.imag / (2.0 * np.pi)

    @property
    def growth(self) -> np.ndarray:
        """Growth rate of each eigenvalue, 1/s; negative where it decays."""
        return self.values.real

    def __repr__(self) -> str:
        if len(self.values) == 0:
            return "<Eigenvalues: none>"
        worst = int(self.growth.argmax())
        return (f"<Eigenvalues: {len(self.values)}, {self.frequencies[0]:.6g} to {self.frequencies[-1]:.6g} Hz, "
                f"{'stable' if self.stable else 'unstable'};\n "
                f"largest growth {self.growth[worst]:.4g} 1/s at {self.frequencies[worst]:.6g} Hz>")


def eig(scene: Scene | Place, *, set: Settings | None = None, about: About | None = None,  # noqa: A002
        count: int | None = None, below: Quantity | None = None, at: Quantity | None = None, explain: bool = False,
        mode: int | None = None, shapes: Place | None = None, output: Place | None = None, force: bool = False,
        progress: Progress | None = None, **options: Any) -> Eigenvalues:
    """The sliding equilibrium at one position, and its eigenvalues.

    Parameters
    ----------
    scene : Scene or path
        A scene, or the path of its file.
    set : mapping, optional
        Keys of the scene that are set anew for this call: numbers in SI units, or texts with a unit.
    about : {"undeformed", "deformed"}, optional
        Geometry about which the system is linearised: the undeformed one, or that of the deformed sliding equilibrium;
        default: undeformed, with contacts on the faces of plates deformed.
    count : int, optional
        How many eigenvalues of positive frequency, the lowest first; default: 20, with `below` all.
    below : number or str, optional
        Highest frequency of eigenvalues, Hz or with a unit; default: none.
    at : number or str, optional
        Position of the contact along the master, m or with a unit; default: ``contact.start`` of the scene.
    explain : bool, default: False
        Whether ``raw["explanation"]`` says why a mode grows: what damping, stiffness and friction do to it, where its
        energy comes from, and of which modes without friction it is made.
    mode : int, optional
        Number of the mode to explain or to draw, from 1; default: the one that grows fastest.
    shapes : path, optional
        Folder for a picture of the mode and its motion for ParaView (VTK); default: none.
    output : path, optional
        HDF5 file to write, which `open` gives as a `Spectrum`; default: none.
    force : bool, default: False
        Whether files that exist are written over.
    progress : callable, optional
        Is called a few times a second with the fraction done (0 to 1), the time left in s or None, and a text;
        what it raises ends the program in order and is raised again.
    **options
        ``method`` ("secular": zeros of the secular function, the default; "dense": all eigenvalues of the assembled
        matrices, as a check); ``uff`` (path): universal file to write, with all modes at all nodes; ``compare`` (path):
        universal file of measured shapes to set beside, ``node`` (mapping of numbers of its nodes to points,
        "body.point") and ``figure`` (path): picture of that comparison; ``threads`` (int): threads to use.

    Returns
    -------
    Eigenvalues
        With values, growth rates, frequencies and the equilibrium.

    Raises
    ------
    NumericalError
        If there is no sliding equilibrium.

    Examples
    --------
    >>> found = eig(example("frozen_growth"), about="deformed", count=10)
    >>> found.values.shape, found.stable
    ((10,), False)
    >>> round(float(found.growth.max()), 1) > 0
    True
    """
    asked = {"about": about, "count": count, "below": below, "at": at, "explain": explain, "mode": mode,
             "shapes": shapes, "output": output, "force": force, **options}
    raw = call("eig", scene, set=set, progress=progress, **asked)
    values = np.array([complex(re, im) for re, im in raw["eigenvalues"]])
    upper = raw["window"][1]
    return Eigenvalues(values, raw["stable"], (raw["window"][0], np.inf if upper is None else upper),
                       raw["equilibrium"], raw)


def locus(scene: Scene | Place, *, parameter: str | None = None, from_: Quantity, to: Quantity,
          points: int | None = None, output: Place | None = None, set: Settings | None = None,  # noqa: A002
          about: About | None = None, count: int | None = None, below: Quantity | None = None,
          figure: Place | None = None, force: bool = False, progress: Progress | None = None,
          **options: Any) -> Locus:
    """Eigenvalues along a key of a scene.

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
        How many values, both ends included; default: 101.
    output : path, optional
        HDF5 file to write; default: one in a new folder of its own.
    set : mapping, optional
        Keys of the scene that are set anew for this call: numbers in SI units, or texts with a unit.
    about : {"undeformed", "deformed"}, optional
        Geometry about which the system is linearised: the undeformed one, or that of the deformed sliding equilibrium;
        default: undeformed, with contacts on the faces of plates deformed.
    count : int, optional
        How many eigenvalues of positive frequency, the lowest first; default: 20, with `below` all.
    below : number or str, optional
        Highest frequency of eigenvalues, Hz or with a unit; default: none.
    figure : path, optional
        Picture to write, of frequency against growth rate: ``.png``, ``.svg`` or ``.pdf``; default: none.
    force : bool, default: False
        Whether files that exist are written over.
    progress : callable, optional
        Is called a few times a second with the fraction done (0 to 1), the time left in s or None, and a text;
        what it raises ends the program in order and is raised again.
    **options
        ``method`` ("secular": zeros of the secular function, the default; "dense": all eigenvalues of the assembled
        matrices, as a check); ``history`` (path): picture of growth rate and frequency against the parameter;
        ``threads`` (int): threads to use.

    Returns
    -------
    Locus
        The file, open.

    Examples
    --------
    >>> found = locus(example("two_springs_on_a_belt"), parameter="parameters.mu", from_=0, to=1.2, points=13)
    >>> [round(float(value), 2) for value in found.values[(found.eigenvalues.real > 1e-6).any(axis=1)]]
    [0.8, 0.9, 1.0, 1.1, 1.2]
    """
    asked = {"parameter": parameter, "from": from_, "to": to, "points": points, "about": about, "count": count,
             "below": below, "figure": figure, "force": force, **options}
    return written("locus", scene, output, set, progress, asked)


def threshold(scene: Scene | Place, *, parameter: str | None = None, from_: Quantity, to: Quantity,
              points: int | None = None, output: Place | None = None, set: Settings | None = None,  # noqa: A002
              about: About | None = None, count: int | None = None, below: Quantity | None = None, force: bool = False,
              progress: Progress | None = None, **options: Any) -> Thresholds:
    """Every value of a key at which the sliding state becomes stable or unstable.

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
        How many values, both ends included; default: 101.
    output : path, optional
        HDF5 file to write, the locus along the key, which `open` gives as a `Locus`; default: none.
    set : mapping, optional
        Keys of the scene that are set anew for this call: numbers in SI units, or texts with a unit.
    about : {"undeformed", "deformed"}, optional
        Geometry about which the system is linearised: the undeformed one, or that of the deformed sliding equilibrium;
        default: undeformed, with contacts on the faces of plates deformed.
    count : int, optional
        How many eigenvalues of positive frequency, the lowest first; default: 20, with `below` all.
    below : number or str, optional
        Highest frequency of eigenvalues, Hz or with a unit; default: none.
    force : bool, default: False
        Whether a file that exists is written over.
    progress : callable, optional
        Is called a few times a second with the fraction done (0 to 1), the time left in s or None, and a text;
        what it raises ends the program in order and is raised again.
    **options
        ``method`` ("secular": zeros of the secular function, the default; "dense": all eigenvalues of the assembled
        matrices, as a check); ``threads`` (int): threads to use.

    Returns
    -------
    Thresholds
        A row for each value, ascending; none where the stability does not change.

    Examples
    --------
    >>> found = threshold(example("two_springs_on_a_belt"), parameter="parameters.mu", from_=0, to=1.2)
    >>> [round(root["value"], 4) for root in found]
    [0.75]
    """
    asked = {"parameter": parameter, "from": from_, "to": to, "points": points, "output": output, "about": about,
             "count": count, "below": below, "force": force, **options}
    return thresholds_of(call("threshold", scene, set=set, progress=progress, **asked))


def map(scene: Scene | Place, *, x: tuple[str, Quantity, Quantity, int],  # noqa: A001
        y: tuple[str, Quantity, Quantity, int], output: Place | None = None, set: Settings | None = None,  # noqa: A002
        scale: Spacing | None = None, about: About | None = None, count: int | None = None,
        below: Quantity | None = None, figure: Place | None = None, threads: int | None = None,
        force: bool = False, progress: Progress | None = None, **options: Any) -> StabilityMap:
    """The largest growth rate over two keys of a scene, and where stability changes.

    Parameters
    ----------
    scene : Scene or path
        A scene, or the path of its file.
    x, y : tuple
        Key, first value, last value (SI or with a unit) and number of values, along each axis.
    output : path, optional
        HDF5 file to write; default: one in a new folder of its own.
    set : mapping, optional
        Keys of the scene that are set anew for this call: numbers in SI units, or texts with a unit.
    scale : {"linear", "log"}, optional
        Values at equal distances or at equal ratios; default: linear.
    about : {"undeformed", "deformed"}, optional
        Geometry about which the system is linearised: the undeformed one, or that of the deformed sliding equilibrium;
        default: undeformed, with contacts on the faces of plates deformed.
    count : int, optional
        How many eigenvalues of positive frequency, the lowest first; default: 20, with `below` all.
    below : number or str, optional
        Highest frequency of eigenvalues, Hz or with a unit; default: none.
    figure : path, optional
        Picture to write: ``.png``, ``.svg`` or ``.pdf``; default: none.
    threads : int, optional
        Threads to use; default: all processors.
    force : bool, default: False
        Whether files that exist are written over.
    progress : callable, optional
        Is called a few times a second with the fraction done (0 to 1), the time left in s or None, and a text;
        what it raises ends the program in order and is raised again.
    **options
        ``x_scale`` and ``y_scale`` ("linear" or "log"): `scale` along one axis alone; ``method`` ("secular": zeros of
        the secular function, the default; "dense": all eigenvalues of the assembled matrices, as a check).

    Returns
    -------
    StabilityMap
        The file, open.

    Examples
    --------
    >>> found = map(example("disc_and_pads"), x=("parameters.mu", 0.2, 0.5, 4),
    ...             y=("substructures.disc.spin", 5, 10, 2))
    >>> found.growth.shape
    (2, 4)
    """
    asked = {"x": x, "y": y, "scale": scale, "about": about, "count": count, "below": below, "figure": figure,
             "threads": threads, "force": force, **options}
    return written("map", scene, output, set, progress, asked)


def frf(scene: Scene | Place, *, input: str | Sequence[str], from_: Quantity, to: Quantity,  # noqa: A002
        points: int | None = None, motions: str | Sequence[str] | None = None,
        output: Place | Sequence[Place] | None = None, set: Settings | None = None,  # noqa: A002
        scale: Spacing | None = None, about: About | None = None, figure: Place | None = None,
        compare: Place | None = None, node: Mapping[int, str] | None = None, force: bool = False,
        progress: Progress | None = None, **options: Any) -> FrequencyResponses:
    """Frequency responses between points, about the sliding equilibrium, friction included.

    Parameters
    ----------
    scene : Scene or path
        A scene, or the path of its file.
    input : str or list of str
        Where and along what a force acts, "body.point.y".
    from_, to : number or str
        Lowest and highest frequency, Hz or with a unit.
    points : int, optional
        Number of frequencies; default: 1001.
    motions : str or list of str, optional
        Motions that are wanted, "body.point.y.displacement", "velocity" or "acceleration": receptance, mobility or
        accelerance (``--output`` of the command line); default: the acceleration at each input.
    output : path or list of path, optional
        Files to write: HDF5 (``.h5``) and universal files (``.uff``, ``.unv``); where none is HDF5, one more in a new
        folder of its own.
    set : mapping, optional
        Keys of the scene that are set anew for this call: numbers in SI units, or texts with a unit.
    scale : {"linear", "log"}, optional
        Frequencies at equal distances or at equal ratios; default: linear.
    about : {"undeformed", "deformed"}, optional
        Geometry about which the system is linearised: the undeformed one, or that of the deformed sliding equilibrium;
        default: undeformed, with contacts on the faces of plates deformed.
    figure : path, optional
        Picture to write, of magnitude, phase and locus: ``.png``, ``.svg`` or ``.pdf``; default: none.
    compare : path, optional
        Universal file of measured responses (dataset 58) to set beside; ``raw`` then tells how well they agree.
    node : mapping, optional
        Which point a node of the measurement is, by its number: ``{12: "pad.tip"}``.
    force : bool, default: False
        Whether files that exist are written over.
    progress : callable, optional
        Is called a few times a second with the fraction done (0 to 1), the time left in s or None, and a text;
        what it raises ends the program in order and is raised again.
    **options
        ``binary`` and ``single`` (bool): universal files with numbers in binary, in single precision; ``threads``
        (int): threads to use.

    Returns
    -------
    FrequencyResponses
        The HDF5 file, open.

    Examples
    --------
    >>> found = frf(example("reed"), input="reed.middle.y", motions="reed.tip.y.displacement", from_="100 Hz",
    ...             to="3 kHz", points=30)
    >>> found.frequency.shape
    (30,)
    """
    files = [os.fspath(output)] if isinstance(output, (str, os.PathLike)) else [os.fspath(one) for one in output or []]
    of_numbers = [file for file in files if not file.endswith((".uff", ".unv"))] or [output_of(None, "frf.h5")]
    words = [word for file in dict.fromkeys([*files, *of_numbers]) for word in ("-o", file)]
    asked = {"output": motions, "input": input, "from": from_, "to": to, "points": points, "scale": scale,
             "about": about, "figure": figure, "compare": compare, "node": node, "force": force, **options}
    words = ["frf", *as_scene(scene, set).words(), *words, *arguments_of(asked)]
    return opened(of_numbers[0], invocation.call(words, progress))
