"""Labelled arrays of result files, and what files and series say of themselves."""

import os
import subprocess
import sys
import tempfile
import time
import unittest
from unittest import mock

try:
    import h5py
    import numpy as np
    import stridor
    import xarray
except ImportError as error:
    print(f"not run: {error}")
    sys.exit(77)  # skipped


def is_in_memory(array):
    return array.variable._in_memory  # xarray has no public word for it


class Runs(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.run_ = stridor.run(stridor.example("frozen_growth"), set={"time.end": 0.1, "record.energy": True})

    @classmethod
    def tearDownClass(cls):
        cls.run_.close()

    def test_channels_lie_over_time_and_are_read_where_they_are_used(self):
        labelled = self.run_.to_xarray()
        self.assertEqual(set(labelled), set(self.run_.channels))
        for name, series in self.run_.channels.items():
            array = labelled[name]
            self.assertEqual(array.dims, ("time",))
            self.assertEqual(array.attrs, {"units": series.units, "long_name": series.long_name})
            self.assertFalse(is_in_memory(array))
            self.assertFalse(is_in_memory(array[5:-5]))
            for part in (slice(None), slice(-7, None), slice(None, None, -3), slice(None, None, -1),
                         slice(40, 2, -1), slice(9, 9), 4, -1, [3, 1, 1], []):
                self.assertTrue(np.array_equal(array[part].values, series[:][part]), part)
        self.assertEqual(labelled.time.attrs["units"], "s")
        self.assertTrue(np.array_equal(labelled.time, self.run_.time[:]))
        self.assertEqual(labelled.attrs["source"][:8], "stridor ")

    def test_a_part_is_read_and_not_the_whole(self):
        name = next(iter(self.run_.channels))
        read = []
        series = stridor.Series.__getitem__
        with mock.patch.object(stridor.Series, "__getitem__", lambda self, key: read.append(key) or series(self, key)):
            part = self.run_.to_xarray()[name].isel(time=slice(10, 20)).load()
        self.assertEqual(part.sizes["time"], 10)
        self.assertIn((slice(10, 20, 1),), read)
        self.assertEqual(len(read), 2)  # the part, and time

    def test_other_groups_are_named(self):
        contact = next(iter(self.run_.contacts))
        self.assertEqual(self.run_.to_xarray(f"contact/{contact}").force.dims, ("time",))
        self.assertEqual(set(self.run_.to_xarray("energy")), set(self.run_.energy))
        with self.assertRaisesRegex(KeyError, "no group 'chanels'; it has .*channels"):
            self.run_.to_xarray("chanels")
        with self.assertRaises(KeyError):
            self.run_.to_xarray("time")

    def test_writing_into_an_array_leaves_the_file_alone(self):
        name = next(iter(self.run_.channels))
        array = self.run_.channels[name].to_xarray()
        array[0] = 42.0
        self.assertEqual(float(array[0]), 42.0)
        self.assertNotEqual(self.run_.channels[name][0], 42.0)

    def test_what_has_been_loaded_outlives_its_file(self):
        with stridor.open(self.run_.path) as run:
            name = next(iter(run.channels))
            series, kept, lost = run.channels[name], run.channels[name].to_xarray().load(), run.to_xarray()
        self.assertTrue(np.all(np.isfinite(kept.values)))
        with self.assertRaisesRegex(stridor.FileError, "closed"):
            lost[name].values
        with self.assertRaisesRegex(stridor.FileError, "closed"):
            series[:]
        self.assertIn("closed", repr(series))
        self.assertRegex(repr(run), "closed")

    def test_labelled_arrays_are_saved(self):
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "run.nc")
            try:
                self.run_.to_xarray().to_netcdf(path, engine="h5netcdf")
            except (ImportError, ValueError) as error:
                self.skipTest(str(error))
            with xarray.open_dataset(path, engine="h5netcdf") as again:
                self.assertEqual(again.sizes["time"], len(self.run_.time))


class KilledRun(unittest.TestCase):
    def test_arrays_end_with_the_last_whole_row(self):
        with tempfile.TemporaryDirectory() as folder:
            file = os.path.join(folder, "run.h5")
            process = subprocess.Popen([stridor.program(), "run", stridor.example("beam_on_beam"), "-o", file],
                                       stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
            time.sleep(1.5)
            process.kill()
            process.wait()
            with stridor.open(file) as run:
                length = len(run.time)
                self.assertGreater(length, 0)
                labelled = run.to_xarray()
                self.assertEqual(labelled.sizes, {"time": length})
                self.assertEqual(run.to_xarray("contact/contact").sizes, {"time": length})
                for name in run.channels:
                    self.assertEqual(len(run[f"/channels/{name}"]), length)
                    self.assertEqual(labelled[name].values.shape, (length,))
                    self.assertEqual(run.channels[name].to_xarray().shape, (length,))
                self.assertIn("has not ended", repr(run))

    def test_columns_of_unlike_lengths_are_cut(self):
        with tempfile.TemporaryDirectory() as folder:
            file = os.path.join(folder, "ragged.h5")
            with h5py.File(file, "w") as ragged:
                ragged["time"] = np.arange(10.0)
                ragged["scene/resolved"] = b""
                ragged["time"].make_scale("time")
                for name, length in (("a", 12), ("b", 9)):
                    ragged[f"channels/{name}"] = np.arange(float(length))
                    ragged[f"channels/{name}"].dims[0].attach_scale(ragged["time"])
            with stridor.open(file) as run:
                self.assertIsInstance(run, stridor.Run)
                self.assertEqual([len(run.channels[name]) for name in "ab"], [10, 9])
                labelled = run.to_xarray()
                self.assertEqual(labelled.sizes, {"time": 9})
                self.assertEqual(labelled.a.values.tolist(), labelled.b.values.tolist())


class Stability(unittest.TestCase):
    def test_a_locus_lies_over_its_parameter(self):
        with stridor.locus(stridor.example("beam_on_beam"), from_="70 mm", to="90 mm", points=5, about="deformed") as found:
            labelled = found.to_xarray()
            self.assertEqual(labelled.eigenvalues.dims, ("contact.start", "number"))
            self.assertFalse(is_in_memory(labelled.eigenvalues))
            self.assertTrue(np.array_equal(labelled.eigenvalues[::-2, 3:], found.eigenvalues[::-2, 3:]))
            self.assertEqual(labelled["contact.start"].attrs, {"units": "m", "long_name": "contact.start"})
            points = xarray.DataArray([[0, 4], [2, 0]], dims=("a", "b"))
            self.assertTrue(np.array_equal(labelled.growth[points, points].values,
                                           found.eigenvalues.real[points.values, points.values]))
            self.assertTrue(np.array_equal(labelled.growth[[4, 0], ::-6].values, found.eigenvalues.real[[4, 0], ::-6]))
            for number, (values, s) in enumerate(found.branches):
                branch = labelled.isel(branch=number)
                kept = np.isfinite(branch.branch_value.values)
                self.assertTrue(np.array_equal(branch.branch_value.values[kept], values))
                self.assertTrue(np.array_equal(branch.branch_growth.values[kept], s.real))
            self.assertEqual(found.to_xarray("unstable").sizes, {"number": len(found.windows)})
            self.assertAlmostEqual(found.windows["from"][0], 0.0743385, delta=1e-5)
            self.assertIn("unstable: 0.0743", repr(found))

    def test_a_map_lies_over_both_keys_and_says_why_points_failed(self):
        with stridor.map(stridor.example("beam_on_beam"), x=("drive.load", -0.1, 0.05, 4),
                         y=("contact.friction.coefficient", 0.29, 0.3, 2), about="deformed",
                         set={"contact.assumption": "film", "contact.start": "75.2 mm"}) as found:
            labelled = found.to_xarray()
            self.assertEqual(labelled.growth.dims, ("contact.friction.coefficient", "drive.load"))
            self.assertEqual(labelled["drive.load"].attrs["units"], "N")
            self.assertTrue(np.array_equal(labelled.growth, found.growth, equal_nan=True))
            self.assertTrue(np.array_equal(labelled.reason, found.reasons))
            self.assertEqual(found.to_xarray("boundary").x.dims, ("number", "point"))
            self.assertRegex(repr(found), r"2 x 4 points, \d+ unstable, \d+ failed")

    def test_responses_lie_over_input_and_frequency(self):
        inputs = ["cantilever.free_end.y", "cantilever.free_end.x"]
        with stridor.frf(stridor.example("beam_on_beam"), input=inputs, motions="cantilever.free_end.y.velocity",
                         from_=100, to=3000, points=7) as found:
            labelled = found.to_xarray()
            array = labelled["cantilever.free_end.y.velocity"]
            self.assertEqual((array.dims, array.shape), (("input", "frequency"), (2, 7)))
            self.assertEqual(array.attrs["units"], "m/s/N")
            for name in inputs:
                expected = found["cantilever.free_end.y.velocity", name]
                self.assertTrue(np.array_equal(array.sel(input=name), expected))
                self.assertTrue(np.array_equal(array.sel(input=[name])[0, ::-2], expected[::-2]))


class Others(unittest.TestCase):
    def test_a_sweep_up_and_down_lies_over_the_way_too(self):
        with stridor.sweep(stridor.example("viscoelastic_sphere"), parameter="parameters.tau0", from_=0.01, to=0.1, points=3,
                           set={"parameters.v": 0.03}, up_down=True) as found:
            self.assertEqual(found.ways, ["up", "down"])
            labelled = found.to_xarray()
            self.assertEqual(labelled.period.dims, ("way", "parameters.tau0"))
            for way in found.ways:
                for value, rms in zip(found[f"/{way}/value"][:], found[f"/{way}/x_rms"][:]):
                    self.assertEqual(float(labelled.x_rms.sel({"way": way, "parameters.tau0": value})), rms)
            self.assertEqual(found.to_xarray("down").value.values.tolist(), [0.1, 0.055, 0.01])

    def test_texts_are_texts(self):
        with stridor.sweep(stridor.example("beam_on_beam"), parameter="contact.friction.coefficient", from_=0.3, to=6,
                           points=2, set={"time.end": 0.06, "drive.ramp": "1 ms", "measure.from": 0.05}) as found:
            reasons = found.to_xarray().reason.values
            self.assertEqual(reasons[0], "")
            self.assertGreater(len(reasons[1]), 10)
            self.assertIn("1 value failed", repr(found))

    def test_studies_of_precision_lie_over_run_times(self):
        with stridor.precision(stridor.example("viscoelastic_sphere"), points=2) as found:
            labelled = found.to_xarray()
            self.assertEqual(labelled.error.dims, ("run_time",))
            self.assertTrue(all(isinstance(method, str) for method in labelled.method.values))
            self.assertIn("tolerance", repr(found))

    def test_files_without_a_class_give_their_first_group(self):
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "other.h5")
            with h5py.File(path, "w") as file:
                file["measured/values"] = np.arange(3.0)
            with stridor.open(path) as found:
                self.assertEqual(list(found.to_xarray()), ["values"])
                self.assertIn("measured", repr(found))

    def test_every_series_of_a_cycle_has_its_coordinate(self):
        with tempfile.TemporaryDirectory() as folder:
            file = os.path.join(folder, "cycle.h5")
            stridor.cycle(stridor.example("mass_on_belt"), output=file)
            with stridor.open(file) as found:
                self.assertEqual(found.to_xarray("contact/contact").slip_velocity.dims, ("time",))
                self.assertEqual(found["/multipliers/real"].to_xarray().dims, ("number",))


class WithoutXarray(unittest.TestCase):
    def test_the_error_says_what_to_install(self):
        with stridor.run(stridor.example("frozen_growth"), set={"time.end": 0.1}) as run:
            with mock.patch.dict(sys.modules, {"xarray": None}):
                for ask in (run.to_xarray, next(iter(run.channels.values())).to_xarray):
                    with self.assertRaisesRegex(ImportError, "python3-xarray"):
                        ask()
                self.assertEqual(len(run.time[:]), len(run.time))

    def test_the_package_is_imported_without_it(self):
        code = "import sys; sys.modules['xarray'] = None; import stridor; assert 'pandas' not in sys.modules"
        subprocess.run([sys.executable, "-c", code], check=True)


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], "-v"])
