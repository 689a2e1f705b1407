"""Runs the examples of the Python package, and what they do not show: errors, interrupts, killed runs."""

import doctest
import importlib
import os
import pathlib
import re
import signal
import subprocess
import sys
import tempfile
import threading
import time
import unittest

try:
    import h5py
    import numpy as np
    import stridor
    import xarray  # noqa: F401, of examples
except ImportError as error:
    print(f"not run: {error}")
    sys.exit(77)  # skipped

MODULES = ["stridor", *(f"stridor.{path.stem}" for path in pathlib.Path(stridor.__file__).parent.glob("[a-z]*.py"))]


def load_tests(_loader, tests, _pattern):
    names = {name: getattr(stridor, name) for name in stridor.__all__}
    for name in MODULES:
        module = importlib.import_module(name)
        tests.addTests(doctest.DocTestSuite(module, extraglobs=names))
    page = pathlib.Path(__file__).parents[2] / "docs" / "python.md"
    tests.addTests(doctest.DocFileSuite(str(page), module_relative=False))
    return tests


class Errors(unittest.TestCase):
    def test_each_exit_code_has_its_error(self):
        scene = stridor.example("frozen_growth")
        with self.assertRaises(stridor.ConfigError) as wrong:
            stridor.run(scene, set={"time.step": -1.0})
        problem = wrong.exception.problems[0]
        self.assertEqual(problem.key, "time.step")
        self.assertEqual(problem.code, "wrong-value")
        self.assertEqual(wrong.exception.exit_code, 2)
        with self.assertRaises(stridor.FileError):
            stridor.load("none.yaml")
        with self.assertRaises(stridor.FileError):
            stridor.open("none.h5")
        with self.assertRaises(stridor.NumericalError):
            stridor.run(stridor.example("beam_on_beam"), set={"contact.armed_from": 0.0, "time.end": 0.2})

    def test_a_file_is_not_overwritten_unasked(self):
        with tempfile.TemporaryDirectory() as folder:
            file = os.path.join(folder, "run.h5")
            stridor.run(stridor.example("mass_on_belt"), output=file, set={"time.end": 0.1}).close()
            with self.assertRaises(stridor.FileError):
                stridor.run(stridor.example("mass_on_belt"), output=file, set={"time.end": 0.1})

    def test_a_time_limit_leaves_a_file_to_resume(self):
        with tempfile.TemporaryDirectory() as folder:
            file = os.path.join(folder, "run.h5")
            scene = stridor.Scene(stridor.example("ruler"))
            with self.assertRaises(stridor.Stopped) as stopped:
                stridor.run(scene, output=file, max_wall=0.3)
            self.assertEqual(stopped.exception.file, file)
            with stridor.open(file) as half:
                self.assertEqual(half.status, "stopped")
                so_far = len(half.time)
                self.assertEqual(len(half.channels["ruler.free_end.y.displacement"]), so_far)
            with stridor.run(resume=file) as whole:
                self.assertEqual(whole.status, "done")
                self.assertGreater(len(whole.time), so_far)


class Interrupt(unittest.TestCase):
    def test_ctrl_c_ends_the_run_in_order(self):
        with tempfile.TemporaryDirectory() as folder:
            file = os.path.join(folder, "run.h5")
            threading.Timer(1.0, lambda: os.kill(os.getpid(), signal.SIGINT)).start()
            with self.assertRaises(stridor.Stopped):
                stridor.run(stridor.example("beam_on_beam"), output=file)
            with stridor.open(file) as half:
                time_of_rows = np.asarray(half.time)
                self.assertGreater(len(time_of_rows), 0)
                self.assertTrue(np.all(np.diff(time_of_rows) > 0.0))


class Progress(unittest.TestCase):
    def test_is_told_from_the_beginning_to_the_end(self):
        told = []
        stridor.run(stridor.example("beam_on_beam"), progress=lambda *one: told.append(one)).close()
        fractions = [one[0] for one in told]
        self.assertGreater(len(fractions), 3)
        self.assertEqual(fractions, sorted(fractions))
        self.assertEqual(told[-1], (1.0, 0.0, "done"))
        self.assertTrue(any("t = " in text for _, _, text in told), told)
        self.assertTrue(any(left is not None and left > 0.0 for _, left, _ in told), told)

    def test_what_it_raises_ends_the_run_in_order(self):
        class Enough(Exception):
            pass

        def stop(fraction, _left, _text):
            if fraction > 0.2:
                raise Enough

        with tempfile.TemporaryDirectory() as folder:
            file = os.path.join(folder, "run.h5")
            with self.assertRaises(Enough):
                stridor.run(stridor.example("beam_on_beam"), output=file, progress=stop)
            with stridor.open(file) as half:
                self.assertEqual(half.status, "stopped")
                self.assertGreater(len(half.time), 0)

    def test_errors_are_those_of_a_call_without_it(self):
        with self.assertRaises(stridor.ConfigError) as wrong:
            stridor.run(stridor.example("frozen_growth"), set={"time.step": -1.0}, progress=print)
        self.assertEqual(wrong.exception.problems[0].key, "time.step")


class Files(unittest.TestCase):
    """Every dataset of every kind of file, with its unit, is in docs/files.md."""

    @staticmethod
    def rows_of_page():
        page = pathlib.Path(__file__).parents[2] / "docs" / "files.md"
        rows = []
        for line in page.read_text().splitlines():
            cells = [cell.strip() for cell in line.split("|")]
            if not line.startswith("| `/"):
                continue
            path = re.escape(cells[1].strip("`")).replace("\\<", "<").replace("\\>", ">")
            rows.append((re.compile(re.sub("<[a-z]+>", "[^/]+", path)), cells[3]))
        return rows

    def expect_listed(self, path):
        rows = self.rows_of_page()
        self.assertGreater(len(rows), 60)
        with h5py.File(path, "r") as file:
            datasets = []
            file.visititems(lambda name, item: datasets.append(name) if isinstance(item, h5py.Dataset) else None)
            for name in datasets:
                units = file[name].attrs["units"].decode()
                listed = [unit for row, unit in rows if row.fullmatch("/" + name)]
                self.assertTrue(listed, f"/{name} of {path} is not in docs/files.md")
                fits = any(unit in ("", units) or unit.startswith("of the") for unit in listed)
                self.assertTrue(fits, f"/{name} of {path} is in {units}, docs/files.md says {listed}")

    def test_every_dataset_of_every_kind_is_on_the_page(self):
        with tempfile.TemporaryDirectory() as folder:
            def made(name, *words):
                file = os.path.join(folder, name)
                out = "--data" if words[0] == "spectrogram" else "-o"
                more = ["-o", os.path.join(folder, "a.png")] if words[0] == "spectrogram" else []
                subprocess.run([stridor.program(), *words, out, file, *more], check=True,
                               stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
                return file

            example = stridor.example
            run = made("run.h5", "run", example("frozen_growth"), "--set", "time.end=0.1", "--set",
                       "record.energy=true", "--set", "measure.from=0.05")
            locus = made("path.h5", "locus", example("beam_on_beam"), "--from", "60mm", "--to", "76mm", "--points", "33",
                         "--about", "deformed")
            heard = made("heard.h5", "run", example("beam_on_beam"), "--set", "time.end=1.7", "--predict", locus)
            with stridor.open(heard) as opened:
                # The window of 74.3 mm is heard, that of 62 mm is not.
                self.assertEqual(opened.bursts["window"].tolist(), [1])
                self.assertEqual(opened.windows["burst"].tolist(), [-1, 0])
                self.assertAlmostEqual(opened.windows["gain"][1], opened.bursts["gain"][0], delta=0.5)
            files = [
                run, heard, made("belt.h5", "run", example("mass_on_belt"), "--set", "time.end=1"),
                made("block.h5", "run", example("sliding_block"), "--set", "time.end=2e-3", "--set", "measure.from=1e-3"),
                made("sphere.h5", "run", example("viscoelastic_sphere"), "--set", "time.end=0.2"),
                made("disc.h5", "run", example("disc_squeal"), "--set", "time.end=1e-3"),
                made("locus.h5", "locus", example("beam_on_beam"), "--from", "30mm", "--to", "98mm", "--points", "3"),
                made("map.h5", "map", example("disc_and_pads"), "--x", "parameters.mu", "0.2", "0.5", "3", "--y",
                     "substructures.disc.spin", "5", "10", "2"),
                made("sweep.h5", "sweep", example("mass_on_belt"), "--parameter", "parameters.mu_d", "--from", "0.1",
                     "--to", "0.3", "--points", "2", "--set", "time.end=1", "--set", "measure.from=0.5"),
                made("cycle.h5", "cycle", example("mass_on_belt")),
                made("cycles.h5", "sweep", example("viscoelastic_sphere"), "--set", "parameters.v=0.03", "--parameter",
                     "parameters.tau0", "--from", "0.01", "--to", "0.1", "--points", "2"),
                os.path.join(made("study", "precision", example("viscoelastic_sphere"), "--points", "2"), "precision.h5"),
                made("failed.h5", "map", example("beam_on_beam"), "--about", "deformed", "--x", "drive.load", "-0.1", "0.05",
                     "4", "--y", "contact.friction.coefficient", "0.29", "0.3", "2", "--set", "contact.assumption=film",
                     "--set", "contact.start=75.2 mm"),
                made("frf.h5", "frf", example("reed"), "--input", "reed.middle.y", "--from", "100", "--to", "3000",
                     "--points", "5"),
                made("kept.h5", "frf", example("beam_on_beam"), "--input", "cantilever.free_end.y", "--from", "100", "--to",
                     "3000", "--points", "5", "--set", "time.integrator=exact", "--set", "time.step=5e-6", "--set",
                     "time.retain.frequency=12kHz"),
                made("amplitudes.h5", "spectrogram", run, "--channel", "cantilever.free_end.y.displacement"),
                made("contact.h5", "contact", example("viscoelastic_contact"), "--speed", "0.1", "--indentation", "0.01"),
            ]
            for file in files:
                self.expect_listed(file)


class Results(unittest.TestCase):
    """What the classes of files make of their datasets."""

    def test_branches_end_where_they_were_followed_to(self):
        with stridor.locus(stridor.example("beam_on_beam"), from_="70 mm", to="98 mm", points=5) as found:
            branches = found.branches
            self.assertGreaterEqual(len(branches), 20)
            self.assertEqual(max(len(values) for values, _ in branches), found["/branches/value"].shape[1])
            for values, s in branches:
                self.assertEqual(len(values), len(s))
                self.assertTrue(np.all(np.isfinite(s)) and np.all(np.diff(values) > 0))

    def test_points_of_a_map_say_why_they_failed(self):
        with stridor.map(stridor.example("beam_on_beam"), x=("drive.load", -0.1, 0.05, 4),
                         y=("contact.friction.coefficient", 0.29, 0.3, 2), about="deformed",
                         set={"contact.assumption": "film", "contact.start": "75.2 mm"}) as found:
            failed = np.isnan(found.growth)
            self.assertTrue(failed.any() and not failed.all())
            self.assertTrue(np.array_equal(found.reasons != "", failed))
            self.assertIn("equilibrium", found.reasons[failed][0])
            for line in found.boundary:
                self.assertEqual(line.shape[1], 2)
                self.assertTrue(np.all(np.isfinite(line)))
            self.assertGreater(len(found.boundary), 0)

    def test_responses_say_how_far_a_run_is_off(self):
        def found(**settings):
            with stridor.frf(stridor.example("beam_on_beam"), input="cantilever.free_end.y", from_=100, to=3000, points=5,
                             set={"time.integrator": "exact", "time.step": 5e-6, **settings}) as responses:
                return responses.truncation

        kept = found(**{"time.retain.frequency": "12kHz"})
        self.assertEqual(list(kept), [("cantilever.free_end.y.acceleration", "cantilever.free_end.y")])
        self.assertTrue(0.0 < next(iter(kept.values())) < 0.1)
        self.assertEqual(found(), {})


class KilledRun(unittest.TestCase):
    def test_rows_that_are_whole_are_read(self):
        with tempfile.TemporaryDirectory() as folder:
            file = os.path.join(folder, "run.h5")
            process = subprocess.Popen(
                [stridor.program(), "run", stridor.example("beam_on_beam"), "-o", file],
                stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
            time.sleep(1.5)
            process.kill()
            process.wait()
            with stridor.open(file) as run:
                length = len(run.time)
                self.assertGreater(length, 0)
                for series in run.channels.values():
                    self.assertEqual(len(series), length)
                    self.assertEqual(series[:].shape, (length,))
                    self.assertEqual(series[-1], series[:][-1])
                    with self.assertRaises(IndexError):
                        series[length]


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], "-v"])
