#!/usr/bin/env python3
"""Makes docs/figures/beam_on_beam.gif: the sliding beam above its spectrogram as it builds up.

Usage: docs/figures/animate.py [STRIDOR], by default build/release/stridor of this source tree.
Takes Debian's python3-h5py, python3-matplotlib and python3-pil. The bodies stand where the drive
puts them; their deflections, of micrometres, are not drawn.
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

HERE = pathlib.Path(__file__).resolve().parent
SOURCE = HERE.parent.parent
NUM_FRAMES = 48
START, SPEED, RAMP = 30.0, 30.0, 0.1  # mm, mm/s, s: contact.start and drive of the scene


def amplitudes(stridor, folder):
    """Times, frequencies and amplitudes of the spectrogram of the main scene."""
    run, data = folder / "beam.h5", folder / "amplitudes.h5"
    subprocess.run([stridor, "run", SOURCE / "scenes/beam_on_beam.yaml", "-o", run,
                    "--set", "time.integrator=exact", "--set", "time.step=5e-6",
                    "--set", "time.retain.frequency=35kHz"], check=True, stdout=subprocess.DEVNULL)
    subprocess.run([stridor, "spectrogram", run, "--data", data, "-o", folder / "a.png"],
                   check=True, stdout=subprocess.DEVNULL)
    with h5py.File(data) as file:
        return file["times"][:], file["frequencies"][:], file["amplitude"][:]


def frame(times, frequencies, levels, now):
    """The picture at a time: the scene above, what has sounded so far below."""
    figure, (scene, sound) = plt.subplots(
        2, 1, figsize=(6.4, 4.4), dpi=80, height_ratios=[1, 2.2], layout="constrained")
    tip = START + SPEED * max(0.0, now - RAMP / 2)
    scene.plot([0, 100], [0, 0], color="tab:blue", linewidth=5, solid_capstyle="butt")
    scene.plot([0, 0], [-14, 14], color="black", linewidth=3)
    along = np.radians(30.0)
    scene.plot([tip, tip + 75 * np.cos(along)], [1.5, 1.5 + 75 * np.sin(along)], color="tab:red",
               linewidth=3)
    scene.set(xlim=(-5, 170), ylim=(-15, 42), aspect="equal", xlabel="mm", yticks=[])
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
        times, frequencies, amplitude = amplitudes(stridor, pathlib.Path(folder))
    keep = times > 0.3  # the start of the sliding would outshine the rest
    times, amplitude = times[keep], amplitude[keep]
    levels = 20 * np.log10(np.maximum(amplitude / amplitude.max(), 1e-4))
    pictures = [frame(times, frequencies, levels, now)
                for now in np.linspace(times[0], times[-1], NUM_FRAMES)]
    palette = pictures[-1].quantize(64, dither=Image.Dither.NONE)
    pictures = [picture.quantize(palette=palette, dither=Image.Dither.NONE) for picture in pictures]
    durations = [110] * (NUM_FRAMES - 1) + [2500]
    pictures[0].save(HERE / "beam_on_beam.gif", save_all=True, append_images=pictures[1:],
                     duration=durations, loop=0, optimize=False)


if __name__ == "__main__":
    main()
