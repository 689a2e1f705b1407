"""The page of a report as Chromium has drawn it, of a run that ended and of one that was killed: it is ready, and says of its
bursts and of the largest samples what `info` says of the file. Needs no driver of browsers."""

import html
import json
import os
import pathlib
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time

PROGRAM = os.environ["STRIDOR_PROGRAM"]
SCENE = pathlib.Path(__file__).parents[2] / "scenes" / "beam_on_beam.yaml"
CHROMIUM = shutil.which("chromium")
if CHROMIUM is None:
    print("not run: there is no chromium")
    sys.exit(77)  # skipped


def verb(*words):
    done = subprocess.run([PROGRAM, *words], check=True, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
    return done.stdout


def killed(command, file, time_reached):
    """Kills a run when its file has come to a time."""
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    while process.poll() is None:
        time.sleep(0.02)
        told = subprocess.run([PROGRAM, "info", file, "--json"], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
        reached = json.loads(told.stdout)["time"] if told.returncode == 0 else None
        if reached and reached["to"] > time_reached:
            process.send_signal(signal.SIGKILL)
    process.wait()


def check(folder, run):
    page = folder / "report.html"
    verb("report", str(run), "-o", str(page), "--force")
    drawn = subprocess.run([CHROMIUM, "--headless", "--no-sandbox", "--disable-gpu", f"--user-data-dir={folder}/browser",
                            "--virtual-time-budget=60000", "--dump-dom", page.as_uri()], check=True, stdout=subprocess.PIPE,
                           stderr=subprocess.DEVNULL, text=True, timeout=120).stdout
    head = re.search(r"<html[^>]*>", drawn).group()
    assert 'data-ready="yes"' in head, head
    told = json.loads(html.unescape(re.search(r'data-check="([^"]*)"', head).group(1)))
    info = json.loads(verb("info", str(run), "--json"))
    assert told["sections"] == 1, told
    assert told["bursts"] == [burst["frequency"] for burst in info["bursts"]], (told, info["bursts"])
    assert len(told["bursts"]) > 0
    assert len(told["peaks"]) > 0
    return told, info


with tempfile.TemporaryDirectory() as name:
    folder = pathlib.Path(name)
    whole = folder / "whole.h5"
    verb("run", str(SCENE), "-o", str(whole))
    told, info = check(folder, whole)
    peak = info["results"]["free_end_acceleration.peak"]
    assert any(abs(one - peak) < 1e-4 * peak for one in told["peaks"]), (told["peaks"], peak)

    part = folder / "part.h5"
    killed([PROGRAM, "run", str(SCENE), "-o", str(part)], str(part), 1.9)
    told, info = check(folder, part)
    assert "status" not in info["results"], "the run has ended before it was killed"
