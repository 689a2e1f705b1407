"""Verbs that make pictures, sounds and pages, which are given as paths."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any, Sequence

from . import invocation
from .files import ResultFile
from .runs import Run
from .scene import Place, Scene, as_scene
from .verbs import Settings, output_of


def _path_of(file: Place | ResultFile) -> str:
    return os.fspath(file.path if isinstance(file, ResultFile) else file)


def _made_from(verb: str, of: Sequence[Place | ResultFile], output: Place | None, name: str,
               options: dict[str, Any]) -> Path:
    made = output_of(output, name)
    progress = options.pop("progress", None)
    invocation.call([verb, *(_path_of(file) for file in of), "--output", made, *invocation.arguments_of(options)], progress)
    return Path(made)


def spectrogram(run: Run | Place, *, output: Place | None = None, **options: Any) -> Path:
    """The picture of a channel's level over time and frequency.

    Parameters
    ----------
    run : Run or path
        A run that has ended or goes on.
    output : path, optional
        ``.png``, ``.svg`` or ``.pdf``; default: a PNG in a new folder of its own.
    **options
        ``channel``, ``predict``, ``max_frequency``, ``range``, ``data``, ...: as of ``stridor spectrogram``.

    Returns
    -------
    Path
        Of the picture; in a notebook ``IPython.display.Image(path)`` shows it.

    Examples
    --------
    >>> with run(example("frozen_growth")) as grown:
    ...     picture = spectrogram(grown, max_frequency="8 kHz")
    >>> picture.name
    'spectrogram.png'
    """
    return _made_from("spectrogram", [run], output, "spectrogram.png", options)


def plot(file: ResultFile | Place, *, kind: str, output: Place | None = None, **options: Any) -> Path:
    """A picture of a result: `kind` is ``history``, ``phase``, ``spectrogram`` or ``spectrum``.

    Examples
    --------
    >>> plot(run(example("frozen_growth"), set={"time.end": 0.1}), kind="history").name
    'history.png'
    """
    return _made_from("plot", [file], output, kind + ".png", {"kind": kind, **options})


def sound(run: Run | Place, *, output: Place | None = None, **options: Any) -> Path:
    """A channel as a WAV file: ``channel``, ``from_``, ``to``, ``slow``, ...: as of ``stridor sound``.

    Examples
    --------
    >>> sound(run(example("frozen_growth"))).suffix
    '.wav'
    """
    return _made_from("sound", [run], output, "sound.wav", options)


def report(*results: ResultFile | Place, output: Place | None = None, **options: Any) -> Path:
    """One page with all that result files hold, which any browser opens.

    Examples
    --------
    >>> grown = run(example("frozen_growth"))
    >>> windows = locus(example("frozen_growth"), from_="70 mm", to="80 mm", points=11, about="deformed")
    >>> page = report(grown, windows)
    >>> page.suffix
    '.html'
    """
    return _made_from("report", results, output, "report.html", options)


def draw(scene: Scene | Place, *, output: Place | None = None, set: Settings | None = None,  # noqa: A002
         **options: Any) -> Path:
    """A picture of a scene before anything is run: bodies, supports, contacts, drives, points.

    Parameters
    ----------
    output : path, optional
        ``.png``, ``.svg`` or ``.pdf``; default: a PNG in a new folder of its own.

    Examples
    --------
    >>> draw(example("beam_on_beam"), set={"contact.start": "80 mm"}).name
    'scene.png'
    """
    made = output_of(output, "scene.png")
    progress = options.pop("progress", None)
    invocation.call(["draw", *as_scene(scene, set).words(), "--output", made, *invocation.arguments_of(options)], progress)
    return Path(made)
