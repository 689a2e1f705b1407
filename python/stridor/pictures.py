"""Verbs that make pictures, sounds and pages, which are given as paths."""

from __future__ import annotations

from pathlib import Path
from typing import Any, Literal, Mapping, Sequence

from . import invocation
from .calls import output_of
from .files import ResultFile, path_of
from .runs import Run
from .scene import Place, Quantity, Scene, Settings, as_scene


def _made_from(verb: str, of: Sequence[Place | ResultFile], output: Place | None, name: str,
               progress: invocation.Progress | None, options: Mapping[str, Any]) -> Path:
    made = output_of(output, name)
    words = [verb, *(path_of(file) for file in of), "--output", made, *invocation.arguments_of(options)]
    invocation.call(words, progress)
    return Path(made)


def spectrogram(run: Run | Place, *, output: Place | None = None, channel: str | None = None,
                predict: Place | ResultFile | None = None, max_frequency: Quantity | None = None,
                range: Quantity | None = None, band: tuple[Quantity, Quantity] | None = None,  # noqa: A002
                from_: Quantity | None = None, to: Quantity | None = None, data: Place | None = None,
                force: bool = False, progress: invocation.Progress | None = None, **options: Any) -> Path:
    """The picture of a channel's level over time and frequency.

    Parameters
    ----------
    run : Run or path
        A run that has ended or goes on, or the path of its file.
    output : path, optional
        Picture to write: ``.png``, ``.svg`` or ``.pdf``; default: a PNG in a new folder of its own.
    channel : str, optional
        Name of the channel; default: the acceleration in which bursts are sought.
    predict : Locus or path, optional
        A locus, or the path of its file, whose unstable windows are marked and set beside the bursts.
    max_frequency : number or str, optional
        End of the frequency axis, Hz or with a unit; default: upper end of ``measure.band`` of the scene, else 0.4 of
        the sampling rate.
    range : number, optional
        Levels shown below the highest one, dB; default: 60.
    band : tuple, optional
        Lower and upper frequency between which bursts are sought anew, Hz or texts with a unit; default: those that the
        run found in ``measure.band``.
    from_, to : number or str, optional
        Start and end of the time shown, s or with a unit; default: the whole run.
    data : path, optional
        File to write the amplitudes to as well (HDF5); default: none.
    force : bool, default: False
        Whether files that exist are written over.
    progress : callable, optional
        Is called a few times a second with the fraction done (0 to 1), the time left in s or None, and a text;
        what it raises ends the program in order and is raised again.
    **options
        ``window`` ("hann", "blackman_harris" or "rectangular"), ``length`` (number or str: duration of a piece that is
        transformed, s) and ``overlap`` (number: part of a piece that it shares with the next), by default those of the
        scene; ``reference`` (number or str: amplitude of 0 dB; default: that of ISO 1683 for the unit of the channel).

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
    asked = {"channel": channel, "predict": None if predict is None else path_of(predict),
             "max_frequency": max_frequency, "range": range, "band": band, "from": from_, "to": to, "data": data,
             "force": force, **options}
    return _made_from("spectrogram", [run], output, "spectrogram.png", progress, asked)


def plot(file: Run | Place, *, kind: Literal["history", "phase", "spectrum", "spectrogram"],
         output: Place | None = None, channel: str | Sequence[str] | None = None,
         max_frequency: Quantity | None = None, range: Quantity | None = None,  # noqa: A002
         from_: Quantity | None = None, to: Quantity | None = None, data: Place | None = None,
         force: bool = False, progress: invocation.Progress | None = None, **options: Any) -> Path:
    """A picture of a run: series over time, one against another, a spectrum or a spectrogram.

    Parameters
    ----------
    file : Run or path
        A run, or the path of its file.
    kind : {"history", "phase", "spectrum", "spectrogram"}
        What to draw; ``phase`` is one channel against another.
    output : path, optional
        Picture to write: ``.png``, ``.svg`` or ``.pdf``; default: a PNG in a new folder of its own.
    channel : str or list of str, optional
        Names of the channels; default: the eight of most use, of a phase plot the first pair of displacement and
        velocity.
    max_frequency : number or str, optional
        Of spectra and spectrograms, end of the frequency axis, Hz or with a unit.
    range : number, optional
        Of spectra and spectrograms, levels shown below the highest one, dB; default: at most 120 and 60.
    from_, to : number or str, optional
        Start and end of the time shown, s or with a unit; default: the whole run.
    data : path, optional
        File to write the numbers to as well: histories and spectra to a universal file (``.uff`` or ``.unv``, dataset
        58), a spectrogram to HDF5; default: none.
    force : bool, default: False
        Whether files that exist are written over.
    progress : callable, optional
        Is called a few times a second with the fraction done (0 to 1), the time left in s or None, and a text;
        what it raises ends the program in order and is raised again.
    **options
        Of spectra and spectrograms ``window`` ("hann", "blackman_harris" or "rectangular"), ``length`` (number or str:
        duration of a piece that is transformed, s), ``overlap`` (number: part of a piece that it shares with the next)
        and ``reference`` (number or str: amplitude of 0 dB); of spectra ``scale`` ("db" or "linear"); of spectrograms
        ``band`` (tuple of two frequencies, Hz, between which bursts are sought anew); of universal files ``binary`` and
        ``single`` (bool: numbers in binary, in single precision).

    Returns
    -------
    Path
        Of the picture.

    Examples
    --------
    >>> plot(run(example("frozen_growth"), set={"time.end": 0.1}), kind="history").name
    'history.png'
    """
    asked = {"kind": kind, "channel": channel, "max_frequency": max_frequency, "range": range, "from": from_, "to": to,
             "data": data, "force": force, **options}
    return _made_from("plot", [file], output, kind + ".png", progress, asked)


def sound(run: Run | Place, *, output: Place | None = None, channel: str | Sequence[str] | None = None,
          from_: Quantity | None = None, to: Quantity | None = None, slow: float | None = None, rate: int | None = None,
          force: bool = False, progress: invocation.Progress | None = None) -> Path:
    """What a channel of a run sounds like.

    Parameters
    ----------
    run : Run or path
        A run, or the path of its file.
    output : path, optional
        Sound to write, ``.wav`` of 24 bits; default: one in a new folder of its own.
    channel : str or list of str, optional
        Name of the channel, of two the left and the right one; default: the acceleration in which bursts are sought.
    from_, to : number or str, optional
        Start and end of the time played, s or with a unit; default: the whole run.
    slow : number, optional
        How many times as slowly it is played, which divides all frequencies; default: 1.
    rate : int, optional
        Sampling rate of the sound, Hz; default: 48000.
    force : bool, default: False
        Whether a file that exists is written over.
    progress : callable, optional
        Is called a few times a second with the fraction done (0 to 1), the time left in s or None, and a text;
        what it raises ends the program in order and is raised again.

    Returns
    -------
    Path
        Of the sound; in a notebook ``IPython.display.Audio(path)`` plays it.

    Examples
    --------
    >>> sound(run(example("frozen_growth"))).suffix
    '.wav'
    """
    asked = {"channel": channel, "from": from_, "to": to, "slow": slow, "rate": rate, "force": force}
    return _made_from("sound", [run], output, "sound.wav", progress, asked)


def report(*results: ResultFile | Place, output: Place | None = None, channel: str | Sequence[str] | None = None,
           budget: str | None = None, full: bool = False, no_shapes: bool = False, force: bool = False,
           progress: invocation.Progress | None = None) -> Path:
    """One page with all that result files hold, which any browser opens.

    Parameters
    ----------
    *results : result or path
        Results of any verbs, or the paths of their files; unstable windows of a locus are set beside the bursts of runs
        of the same scene.
    output : path, optional
        Page to write, ``.html``; default: one in a new folder of its own.
    channel : str or list of str, optional
        Channels of runs to show; default: the twelve of most use.
    budget : str, optional
        Size that the page may have, beyond which histories are thinned to extremes; default: "8MiB".
    full : bool, default: False
        Whether every sample is kept, whatever the size.
    no_shapes : bool, default: False
        Whether the bodies are left out: shapes of modes, and the slide of runs.
    force : bool, default: False
        Whether a page that exists is written over.
    progress : callable, optional
        Is called a few times a second with the fraction done (0 to 1), the time left in s or None, and a text;
        what it raises ends the program in order and is raised again.

    Returns
    -------
    Path
        Of the page.

    Examples
    --------
    >>> grown = run(example("frozen_growth"))
    >>> windows = locus(example("frozen_growth"), from_="70 mm", to="80 mm", points=11, about="deformed")
    >>> page = report(grown, windows)
    >>> page.suffix
    '.html'
    """
    asked = {"channel": channel, "budget": budget, "full": full, "no_shapes": no_shapes, "force": force}
    return _made_from("report", results, output, "report.html", progress, asked)


def draw(scene: Scene | Place, *, output: Place | None = None, set: Settings | None = None,  # noqa: A002
         force: bool = False, progress: invocation.Progress | None = None, **options: Any) -> Path:
    """A picture of a scene before anything is run: bodies, supports, contacts, drives, points.

    Parameters
    ----------
    scene : Scene or path
        A scene, or the path of its file.
    output : path, optional
        Picture to write: ``.png``, ``.svg`` or ``.pdf``; default: a PNG in a new folder of its own.
    set : mapping, optional
        Keys of the scene that are set anew for this call: numbers in SI units, or texts with a unit.
    force : bool, default: False
        Whether a picture that exists is written over.
    progress : callable, optional
        Is called a few times a second with the fraction done (0 to 1), the time left in s or None, and a text;
        what it raises ends the program in order and is raised again.
    **options
        ``threads`` (int): threads to use.

    Returns
    -------
    Path
        Of the picture.

    Examples
    --------
    >>> draw(example("beam_on_beam"), set={"contact.start": "80 mm"}).name
    'scene.png'
    """
    made = output_of(output, "scene.png")
    asked = {"output": made, "force": force, **options}
    invocation.call(["draw", *as_scene(scene, set).words(), *invocation.arguments_of(asked)], progress)
    return Path(made)
