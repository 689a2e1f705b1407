"""Runs the examples of the Python package, and what they do not show: errors, interrupts, killed runs."""

import doctest
import importlib
import os
import pathlib
import signal
import subprocess
import sys
import tempfile
import threading
import time
import unittest

try:
    import numpy as np
    import stridor
except ImportError as error:
    print(f"not run: {error}")
    sys.exit(77)  # skipped

MODULES = ["stridor", "stridor.errors", "stridor.files", "stridor.invocation", "stridor.scene", "stridor.verbs"]


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
