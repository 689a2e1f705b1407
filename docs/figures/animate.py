#!/usr/bin/env python3
"""Makes docs/figures/beam_on_beam.gif: the sliding beam above its spectrogram as it builds up.

Usage: docs/figures/animate.py [STRIDOR], by default build/release/stridor of this source tree.
Takes Debian's python3-h5py, python3-matplotlib, python3-pil and python3-scipy.

The bodies are drawn as the run has them, by the displacements of points along their upper surfaces:
what load and friction bend slowly, up to 1.9 mm, and the vibration in the band of the bursts, up to
6 nm, are enlarged by the factors that stand in the picture. A period of the vibration takes about a
seventieth of the time from one picture to the next, so that it is shown as under a stroboscope: each
picture has the instant near its time at which the vibration is an eighth of a period further than in
the picture before. The shaded band is its amplitude.
"""
import pathlib
import subprocess
import sys
import tempfile

import h5py
import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from PIL import Image
from scipy import signal

HERE = pathlib.Path(__file__).resolve().parent
SOURCE = HERE.parent.parent
NUM_FRAMES = 96
START, SPEED, RAMP = 30.0, 30.0, 0.1  # mm, mm/s, s: contact.start and drive of the scene
BAND = [2500.0, 15000.0]  # Hz: measure.band of the scene
ANGLE = np.radians(30.0)
ALONG_CANTILEVER = np.arange(4, 101, 4)  # mm, of the points; it is clamped at 0
ALONG_OBLIQUE = np.arange(0, 76, 5)
DEFLECTION, VIBRATION = 5, 1_000_000  # factors of enlargement
NEAR = 30  # samples before and after a time among which its instant is sought


def results(stridor, folder):
    """Run file of the main scene with the motion along both beams, and its spectrogram."""
    run, data = folder / "beam.h5", folder / "amplitudes.h5"
    channels = ["cantilever.free_end.y.acceleration"]
    channels += [f"cantilever.c{at}.y.displacement" for at in ALONG_CANTILEVER]
    channels += [f"oblique.o{at}.{axis}.displacement" for at in ALONG_OBLIQUE for axis in "xy"]
    settings = {"time.integrator": "exact", "time.step": "5e-6", "time.retain.frequency": "35kHz",
                "substructures.cantilever.points": points("c", ALONG_CANTILEVER),
                "substructures.oblique.points": points("o", ALONG_OBLIQUE),
                "record.channels": "[" + ", ".join(channels) + "]"}
    sets = [word for key, value in settings.items() for word in ("--set", f"{key}={value}")]
    subprocess.run([stridor, "run", SOURCE / "scenes/beam_on_beam.yaml", "-o", run, *sets],
                   check=True, stdout=subprocess.DEVNULL)
    subprocess.run([stridor, "spectrogram", run, "--channel", channels[0], "--data", data,
                    "-o", folder / "a.png"], check=True, stdout=subprocess.DEVNULL)
    return run, data


def points(letter, places):
    """Points of a beam along its upper surface, as the scene has them."""
    return "{" + ", ".join(f"{letter}{at}: {{on: top, at: {at} mm}}" for at in places) + "}"


def sampled(channel, rate, indices):
    """Of a channel around each index: the slow part, and the vibration with its amplitude as a
    complex number, all in mm."""
    values = 1e3 * channel[:]
    band = signal.butter(4, BAND, "band", fs=rate, output="sos")
    vibration = signal.sosfiltfilt(band, values)
    around = indices[:, None] + np.arange(-NEAR, NEAR + 1)
    return (values - vibration)[indices], signal.hilbert(vibration)[around]


def motions(run, frame_times):
    """The slow deflections of both beams in each frame, and their vibrations around it."""
    with h5py.File(run) as file:
        times, channels = file["time"][:], file["channels"]
        rate = (len(times) - 1) / (times[-1] - times[0])
        indices = np.clip(np.searchsorted(times, frame_times), NEAR, len(times) - 1 - NEAR)
        names = [[f"cantilever.c{at}.y" for at in ALONG_CANTILEVER],
                 [f"oblique.o{at}.x" for at in ALONG_OBLIQUE],
                 [f"oblique.o{at}.y" for at in ALONG_OBLIQUE]]
        parts = [[sampled(channels[f"{name}.displacement"], rate, indices) for name in row] for row in names]
    slow = [np.array([part[0] for part in row]).T for row in parts]
    fast = [np.array([part[1] for part in row]).transpose(1, 2, 0) for row in parts]
    return slow, fast  # each by frame, instant where it is fast, and point


def beams(slow, fast, k, now):
    """Of both beams in a frame: the line drawn, and the lines between which it vibrates."""
    sag, x, y = (DEFLECTION * part[k] for part in slow)
    vibrations = [VIBRATION * part[k] for part in fast]
    travel = SPEED * max(0.0, now - RAMP / 2)
    x += START + travel + ALONG_OBLIQUE * np.cos(ANGLE) - DEFLECTION * travel
    y += ALONG_OBLIQUE * np.sin(ANGLE)
    across = np.cos(ANGLE) * vibrations[2] - np.sin(ANGLE) * vibrations[1]
    behind = np.angle(across[:, len(ALONG_OBLIQUE) // 3] * np.exp(-2j * np.pi * k / 8))
    sag_now, x_now, y_now = (part[np.argmin(np.abs(behind))].real for part in vibrations)
    widths = np.abs(vibrations[0]).max(axis=0), np.abs(across).max(axis=0)
    cantilever = [(np.insert(ALONG_CANTILEVER, 0, 0), np.insert(sag + part, 0, 0))
                  for part in (sag_now, -widths[0], widths[0])]
    oblique = [(x + x_now, y + y_now)]
    oblique += [(x - sign * np.sin(ANGLE) * widths[1], y + sign * np.cos(ANGLE) * widths[1]) for sign in (-1, 1)]
    return cantilever, oblique


def frame(times, frequencies, levels, now, bodies):
    """The picture at a time: the scene above, what has sounded so far below."""
    figure, (scene, sound) = plt.subplots(
        2, 1, figsize=(6.4, 5.4), dpi=80, height_ratios=[1.25, 1.4], layout="constrained")
    for (line, below, above), color, width in zip(bodies, ("tab:blue", "tab:red"), (4, 3)):
        scene.fill(np.append(below[0], above[0][::-1]), np.append(below[1], above[1][::-1]), color=color,
                   alpha=0.3, linewidth=0)
        scene.plot(*line, color=color, linewidth=width, solid_capstyle="butt")
    scene.plot([0, 0], [-14, 14], color="black", linewidth=3)
    scene.set(xlim=(-5, 170), ylim=(-17, 43), aspect="equal", xlabel="mm", yticks=[])
    scene.set_title(f"deflection × {DEFLECTION}; vibration × {VIBRATION:,}, in slow motion", fontsize=10)
    shown = np.where(times[:, None] <= now, levels, levels.min())
    sound.pcolormesh(times, frequencies / 1e3, shown.T, vmin=-80, vmax=0, cmap="inferno",
                     shading="auto", rasterized=True)
    sound.axvline(now, color="white", linewidth=0.8)
    sound.set(xlabel="time (s)", ylabel="frequency (kHz)", ylim=(0, 15))
    figure.canvas.draw()
    picture = Image.fromarray(np.asarray(figure.canvas.buffer_rgba())[:, :, :3].copy())
    plt.close(figure)
    return picture


def main():
    stridor = sys.argv[1] if len(sys.argv) > 1 else SOURCE / "build/release/stridor"
    with tempfile.TemporaryDirectory() as folder:
        run, data = results(stridor, pathlib.Path(folder))
        with h5py.File(data) as file:
            times, frequencies, amplitude = (file[name][:] for name in ("times", "frequencies", "amplitude"))
        keep = times > 0.3  # the start of the sliding would outshine the rest
        times, amplitude = times[keep], amplitude[keep]
        frame_times = np.linspace(times[0], times[-1], NUM_FRAMES)
        slow, fast = motions(run, frame_times)
    levels = 20 * np.log10(np.maximum(amplitude / amplitude.max(), 1e-4))
    pictures = [frame(times, frequencies, levels, now, beams(slow, fast, k, now))
                for k, now in enumerate(frame_times)]
    palette = pictures[-6].quantize(96, Image.Quantize.MAXCOVERAGE, dither=Image.Dither.NONE)
    pictures = [picture.quantize(palette=palette, dither=Image.Dither.NONE) for picture in pictures]
    durations = [80] * (NUM_FRAMES - 1) + [2500]
    pictures[0].save(HERE / "beam_on_beam.gif", save_all=True, append_images=pictures[1:],
                     duration=durations, loop=0, optimize=False)


if __name__ == "__main__":
    main()
