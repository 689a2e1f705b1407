"""Opens files of every kind with h5py, xarray, ncdump and Octave, one of a killed run too."""

import os
import pathlib
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import unittest

os.environ["HDF5_USE_FILE_LOCKING"] = "FALSE"  # a file is read while a run writes it
try:
    import h5py
    import numpy as np
except ImportError as error:
    print(f"not run: {error}")
    sys.exit(77)  # skipped
try:
    import h5netcdf  # noqa: F401
    import xarray
except ImportError:
    xarray = None

PROGRAM = os.environ["STRIDOR_PROGRAM"]
SCENES = pathlib.Path(__file__).parents[2] / "scenes"


def scene(name):
    return str(SCENES / f"{name}.yaml")


def verb(*words):
    subprocess.run([PROGRAM, *words], check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


def killed_run(file):
    """A run killed half-way, when some rows are in its file."""
    process = subprocess.Popen([PROGRAM, "run", scene("beam_on_beam"), "-o", file, "--set", "record.interval=1e-6"],
                               stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    for _ in range(2000):
        time.sleep(0.005)
        try:
            with h5py.File(file, "r") as opened:
                if len(opened["time"]) > 0:
                    break
        except OSError:
            continue
    process.send_signal(signal.SIGKILL)
    process.wait()
    return file


def all_datasets(opened):
    """Paths and datasets of a file, those that links of /plot name once."""
    datasets = []
    opened.visititems(lambda place, item: datasets.append((place, item)) if isinstance(item, h5py.Dataset) else None)
    return datasets


def all_groups(path):
    """Groups that hold datasets of their own."""
    with h5py.File(path, "r") as opened:
        return sorted({"/" + place.rpartition("/")[0] for place, _ in all_datasets(opened)})


class Readers(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        at = lambda name: os.path.join(cls.folder.name, name)
        run = at("run.h5")
        verb("run", scene("examples/frozen_growth"), "-o", run, "--set", "time.end=0.1", "--set", "record.energy=true",
             "--set", "measure.from=0.05")
        verb("locus", scene("beam_on_beam"), "--from", "70mm", "--to", "98mm", "--points", "5", "-o", at("locus.h5"))
        verb("run", scene("beam_on_beam"), "-o", at("heard.h5"), "--set", "time.end=2.3", "--predict", at("locus.h5"))
        verb("map", scene("beam_on_beam"), "--about", "deformed", "--x", "drive.load", "-0.1", "0.05", "4", "--y",
             "contact.friction.coefficient", "0.29", "0.3", "2", "--set", "contact.assumption=film", "--set",
             "contact.start=75.2 mm", "-o", at("failed.h5"))
        verb("map", scene("disc_and_pads"), "--x", "parameters.mu", "0.2", "0.5", "3", "--y",
             "substructures.disc.spin", "5", "10", "2", "-o", at("map.h5"))
        verb("sweep", scene("beam_on_beam"), "--parameter", "contact.friction.coefficient", "--from", "0.3", "--to", "6",
             "--points", "2", "--set", "time.end=0.06", "--set", "drive.ramp=1 ms", "--set", "measure.from=0.05",
             "-o", at("sweep.h5"))
        verb("cycle", scene("examples/mass_on_belt"), "-o", at("cycle.h5"))
        verb("sweep", scene("viscoelastic_sphere"), "--set", "parameters.v=0.03", "--parameter", "parameters.tau0",
             "--from", "0.01", "--to", "0.1", "--points", "2", "-o", at("cycles.h5"))
        verb("frf", scene("beam_on_beam"), "--input", "cantilever.free_end.y", "--from", "100", "--to", "3000", "--points",
             "5", "--set", "time.integrator=exact", "--set", "time.step=5e-6", "--set", "time.retain.frequency=12kHz", "-o",
             at("responses.h5"))
        verb("spectrogram", run, "--channel", "cantilever.free_end.y.displacement", "-o", at("a.png"), "--data",
             at("spectrogram.h5"))
        verb("contact", scene("viscoelastic_contact"), "--speed", "0.1,1", "--indentation", "0.01", "--set",
             "contacts.tip.normal.solver.grid=32", "-o", at("contact.h5"))
        verb("contact", scene("viscoelastic_contact"), "--table", at("law.h5"), "--speeds", "0.1", "1", "4", "--indentations",
             "0.01", "0.1", "4", "--set", "contacts.tip.normal.solver.grid=32")
        verb("contact", scene("viscoelastic_contact"), "--master-curve", at("curve.h5"), "--set",
             "contacts.tip.normal.solver.grid=32")
        verb("eig", scene("disc_and_pads"), "--explain", "-o", at("eig.h5"))
        verb("threshold", scene("disc_and_pads"), "--parameter", "parameters.mu", "--from", "0.2", "--to", "0.5", "--points",
             "4", "-o", at("threshold.h5"))
        verb("compare", scene("beam_on_beam"), "--set", "time.end=0.01", "--set", "measure.from=0.005", "-o", at("compared"))
        os.rename(os.path.join(at("compared"), "comparison.h5"), at("comparison.h5"))
        verb("precision", scene("viscoelastic_sphere"), "--points", "2", "-o", at("study"))
        os.rename(os.path.join(at("study"), "precision.h5"), at("precision.h5"))
        killed_run(at("killed.h5"))
        cls.kinds = {"run": "run", "heard": "run", "killed": "run", "locus": "locus", "map": "stability map",
                     "failed": "stability map",
                     "sweep": "sweep of transients", "cycle": "limit cycle", "cycles": "sweep of limit cycles",
                     "responses": "frequency responses", "spectrogram": "spectrogram", "contact": "sliding contacts",
                     "precision": "study of precision", "law": "contact law", "eig": "eigenvalues", "threshold": "locus",
                     "comparison": "comparison of assumptions", "curve": "master curve"}

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def file(self, name):
        return os.path.join(self.folder.name, name + ".h5")

    def files(self):
        return [(name, kind, self.file(name)) for name, kind in self.kinds.items()]

    # ------------------------------------------------------------------ h5py

    def test_every_dataset_says_what_it_is_and_in_what_unit(self):
        known = {}
        for name, _, path in self.files():
            with h5py.File(path, "r") as opened:
                datasets = all_datasets(opened)
                self.assertGreater(len(datasets), 2)
                for place, dataset in datasets:
                    said = {key: value.decode() if isinstance(value, bytes) else str(value)
                            for key, value in dataset.attrs.items() if key in ("long_name", "units")}
                    self.assertIn(" ", said.get("long_name", ""), f"{name}: /{place} has no long_name in words")
                    *groups, last = place.replace("_", " ").split("/")
                    self.assertNotEqual(f"{last}, {' '.join(groups)}", said["long_name"],
                                        f"{name}: /{place} is not among the names of io/hdf5/dataset_names.cpp")
                    self.assertTrue(said.get("units"), f"{name}: /{place} has no units")
                    known.setdefault(said["units"], place)
        if shutil.which("udunits2") is None:
            self.skipTest("no udunits2")
        for units, place in known.items():
            answer = subprocess.run(["udunits2", "-H", f"({units})", "-W", ""], capture_output=True, text=True, check=False)
            self.assertNotIn("don't recognize", answer.stderr.lower().replace("’", "'"), f"{units} of {place}")
            self.assertEqual(answer.returncode, 0, f"{units} of {place}: {answer.stderr}")

    def test_every_extent_has_a_scale_of_its_length(self):
        for name, _, path in self.files():
            with h5py.File(path, "r") as opened:
                for place, dataset in all_datasets(opened):
                    for axis, extent in enumerate(dataset.shape):
                        what = f"{name}: extent {axis} of /{place}"
                        if place.startswith("checkpoint/"):
                            self.assertEqual(dataset.dims[axis].label, "byte", what)
                            continue
                        if h5py.h5ds.is_scale(dataset.id):
                            continue
                        self.assertEqual(len(dataset.dims[axis]), 1, f"{what} has no scale")
                        if name != "killed":
                            self.assertEqual(len(dataset.dims[axis][0]), extent, what)

    def test_every_file_introduces_itself(self):
        for _, kind, path in self.files():
            with h5py.File(path, "r") as opened:
                attributes = {name: value.decode() if isinstance(value, bytes) else value
                              for name, value in opened.attrs.items()}
                self.assertEqual(attributes["kind"], kind)
                self.assertTrue(attributes["title"].startswith(kind), attributes["title"])
                self.assertIn("stridor", attributes["history"])
                self.assertRegex(attributes["source"], r"^stridor \d")

    def test_viewers_of_nexus_find_what_to_draw(self):
        for name, _, path in self.files():
            with h5py.File(path, "r") as opened:
                text = lambda value: value.decode() if isinstance(value, bytes) else str(value)
                plot = opened[text(opened.attrs["default"])]
                self.assertEqual(text(plot.attrs["NX_class"]), "NXdata")
                signal_ = plot[text(plot.attrs["signal"])]
                axes = [text(axis) for axis in plot.attrs["axes"]]
                self.assertEqual(len(axes), signal_.ndim)
                for extent, axis in zip(signal_.shape, axes):
                    if axis != "." and name != "killed":
                        self.assertEqual(plot[axis].shape, (extent,))

    def test_why_points_of_a_map_failed_stands_in_the_file(self):
        with h5py.File(self.file("failed"), "r") as opened:
            failure = opened["failure"][:]
            self.assertTrue(np.array_equal(failure > 0, np.isnan(opened["growth"][:])))
            self.assertGreater(failure.max(), 0)
            for number in failure[failure > 0]:
                self.assertIn(b"equilibrium", opened["failures/reason"][int(number) - 1])

    def test_why_a_point_of_a_sweep_failed_stands_in_the_file(self):
        with h5py.File(self.file("sweep"), "r") as opened:
            self.assertEqual(list(opened["failed"][:]), [0.0, 1.0])
            first, second = opened["reason"][:]
            self.assertEqual(first, b"")
            self.assertGreater(len(second), 10)

    # ------------------------------------------------------------------ xarray

    @unittest.skipIf(xarray is None, "no xarray with h5netcdf")
    def test_xarray_knows_every_dimension_of_every_group(self):
        self.assertIn("/bursts", all_groups(self.file("heard")))
        for name, _, path in self.files():
            for group in all_groups(path):
                if group == "/checkpoint":  # bytes
                    continue
                with xarray.open_dataset(path, engine="h5netcdf", group=group, phony_dims="access") as dataset:
                    for variable in (*dataset.data_vars.values(), *dataset.coords.values()):
                        for dimension in variable.dims:
                            self.assertNotIn("phony", dimension, f"{name}: {group}/{variable.name}")

    @unittest.skipIf(xarray is None, "no xarray with h5netcdf")
    def test_branches_and_boundaries_are_read_at_once(self):
        with xarray.open_dataset(self.file("locus"), engine="h5netcdf", group="/branches") as branches:
            self.assertEqual(branches["growth"].dims, ("number", "point"))
            self.assertGreaterEqual(branches.sizes["number"], 20)
            first = branches["value"].sel(number=1).dropna("point")
            self.assertEqual((float(first[0]), float(first[-1])), (0.07, 0.098))
        with xarray.open_dataset(self.file("map"), engine="h5netcdf", group="/boundary") as boundary:
            self.assertEqual(boundary["x"].dims, ("number", "point"))
            self.assertEqual((boundary["x"].attrs["units"], boundary["y"].attrs["units"]), ("1", "rad/s"))

    @unittest.skipIf(xarray is None, "no xarray with h5netcdf")
    def test_xarray_labels_what_depends_on_coordinates(self):
        coordinates = {"locus": ("/eigenvalues", None), "map": ("/", ("growth", ("y", "x"))),
                       "failed": ("/", ("failure", ("y", "x"))),
                       "sweep": ("/", ("steps", ("value",))), "responses": ("/", None),
                       "spectrogram": ("/", ("amplitude", ("times", "frequencies"))),
                       "contact": ("/contacts/000", ("pressure", ("y", "x"))), "cycle": ("/channels", None),
                       "cycles": ("/up", ("period", ("value",))),
                       "precision": ("/settings", ("error", ("run_time",))), "run": ("/channels", None),
                       "heard": ("/windows", ("gain", ("number",))), "killed": ("/channels", None),
                       "law": ("/", ("friction", ("indentation", "speed"))),
                       "eig": ("/eigenvalues", ("growth", ("number",))), "threshold": ("/unstable", ("from", ("number",))),
                       "comparison": ("/runs", ("ratio", ("number",))), "curve": ("/", ("f", ("beta",)))}
        for name, _, path in self.files():
            if name == "cycles":
                with h5py.File(path, "r") as opened:
                    group = next(place for place in opened if place != "plot")
                coordinates[name] = (f"/{group}", ("period", ("value",)))
            group, expected = coordinates[name]
            with xarray.open_dataset(path, engine="h5netcdf", group=group, phony_dims="access") as dataset:
                if expected:
                    variable, dimensions = expected
                    self.assertEqual(dataset[variable].dims, dimensions)
                    for dimension in dimensions:
                        self.assertIn(dimension, dataset.coords)
                    self.assertTrue(dataset[variable].attrs["long_name"])
                elif name in ("run", "killed", "cycle"):
                    for variable in dataset.values():
                        self.assertEqual(variable.dims, ("time",))

    # ------------------------------------------------------------------ ncdump, Octave

    @unittest.skipIf(shutil.which("ncdump") is None, "no ncdump")
    def test_ncdump_lists_variables_with_their_dimensions(self):
        expected = {"map": "growth(y, x)", "failed": "failure(y, x)",
                    "spectrogram": "amplitude(times, frequencies)", "sweep": "steps(value)",
                    "run": "force(time)", "heard": "growth_max(number)", "killed": "force(time)",
                    "contact": "pressure(y, x)", "cycle": "force(time)",
                    "responses": "real(frequency)", "locus": "growth(values", "cycles": "period(value)",
                    "precision": "error(run_time)", "law": "friction(indentation, speed)",
                    "eig": "damping_ratio(number)", "threshold": "growth(values", "comparison": "ratio(number)", "curve": "f(beta)"}
        for name, _, path in self.files():
            answer = subprocess.run(["ncdump", "-h", path], capture_output=True, text=True, check=False)
            self.assertEqual(answer.returncode, 0, answer.stderr)
            self.assertIn(expected[name], answer.stdout)

    @unittest.skipIf(shutil.which("octave-cli") is None, "no Octave")
    def test_octave_loads_them(self):
        script = "x = load('{path}'); disp(fieldnames(x)); disp(size(x.{field}))"
        fields = {"run": "time", "heard": "windows.gain", "killed": "time", "locus": "eigenvalues.growth",
                  "map": "growth", "failed": "failure", "sweep": "steps",
                  "cycle": "time", "responses": "frequency", "spectrogram": "amplitude", "contact": "rows.force",
                  "cycles": None, "precision": "settings.error", "law": "friction", "eig": "equilibrium.force",
                  "threshold": "values", "comparison": "runs.step_time", "curve": "f"}
        for name, _, path in self.files():
            with h5py.File(path, "r") as opened:
                field = fields[name] or f"{next(place for place in opened if place != 'plot')}.period"
                size = opened[field.replace(".", "/")].size
            answer = subprocess.run(["octave-cli", "--eval", script.format(path=path, field=field)], capture_output=True,
                                    text=True, check=False)
            # Octave 7 complains as it ends, whatever it has done.
            rows, columns = re.findall(r"^\s*(\d+)\s+(\d+)\s*$", answer.stdout, re.MULTILINE)[-1]
            self.assertEqual(int(rows) * int(columns), size, answer.stderr)

    # ------------------------------------------------------------------ the table of docs/files.md

    def rows_of_the_page(self):
        """Array, group, variable, dimensions, what ncdump and Octave call it and class of every row."""
        text = (SCENES.parent / "docs" / "files.md").read_text(encoding="utf-8")
        row = re.compile(r"^\| ([^|]+) \| `([^`]+)` \| `([^`]+)`, `([^`]+)` \(([^)]+)\) \| `([^`]+)` \| `x\.([^`]+)` \| `(\w+)` \|$", re.M)
        names = {"run with `--predict`": "heard", "run, killed half-way": "killed", "threshold": "threshold",
                 "stability map, points failed": "failed"}
        names.update({kind: name for name, kind in reversed(self.kinds.items()) if name not in names.values()})
        rows = {names[found[0]]: found[1:] for found in row.findall(text)}
        self.assertEqual(set(rows), set(self.kinds))
        return rows

    def test_the_table_of_the_page_is_true(self):
        import stridor
        for name, (array, group, variable, dimensions, dumped, loaded, kind) in self.rows_of_the_page().items():
            path = self.file(name)
            with h5py.File(path, "r") as opened:
                size = opened[array].size
            with stridor.open(path) as opened:
                self.assertEqual(type(opened).__name__, kind, name)
            if xarray is not None:
                with xarray.open_dataset(path, engine="h5netcdf", group=group, phony_dims="access") as dataset:
                    self.assertEqual(dataset[variable].dims, tuple(dimensions.split(", ")), name)
                    self.assertEqual(dataset[variable].size, size, name)
            if shutil.which("ncdump") is not None:
                answer = subprocess.run(["ncdump", "-h", path], capture_output=True, text=True, check=True)
                self.assertIn(f" {dumped} ;", answer.stdout, name)
            if shutil.which("octave-cli") is not None:
                script = f"x = load('{path}'); disp(size(x.{loaded}))"
                answer = subprocess.run(["octave-cli", "--eval", script], capture_output=True, text=True, check=False)
                rows, columns = re.findall(r"^\s*(\d+)\s+(\d+)\s*$", answer.stdout, re.MULTILINE)[-1]
                self.assertEqual(int(rows) * int(columns), size, f"{name}: {answer.stderr}")

    def test_rows_of_a_killed_run_are_whole_up_to_the_length_of_time(self):
        with h5py.File(self.file("killed"), "r") as opened:
            rows = len(opened["time"])
            self.assertGreater(rows, 0)
            self.assertTrue(np.all(np.diff(opened["time"][:]) > 0.0))
            for series in opened["channels"].values():
                self.assertGreaterEqual(len(series), rows)
                self.assertTrue(np.all(np.isfinite(series[:rows])))
            self.assertNotIn("results", opened)


if __name__ == "__main__":
    unittest.main()
