"""Every verb of the program from Python: what the examples of the package do not show, and what is refused."""

import dataclasses
import inspect
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest
import warnings
from unittest import mock

try:
    import h5py
    import numpy as np
    import stridor
    from stridor.tables import comparison_of, precision_of
except ImportError as error:
    print(f"not run: {error}")
    sys.exit(77)  # skipped

SOURCE = pathlib.Path(__file__).parents[2]


class Verbs(unittest.TestCase):
    @staticmethod
    def of_the_program():
        told = subprocess.run([stridor.program(), "--help"], capture_output=True, text=True, check=True).stdout
        return re.findall(r"^  ([a-z]+)  ", told.partition("Subcommands:")[2], re.MULTILINE)

    def test_each_has_a_function_and_is_on_the_page(self):
        page = (SOURCE / "docs" / "python.md").read_text()
        verbs = self.of_the_program()
        self.assertIn("import", verbs)
        self.assertGreater(len(verbs), 15)
        for verb in verbs:
            name = verb + ("_" if verb == "import" else "")
            self.assertIn(name, stridor.__all__)
            self.assertTrue(callable(getattr(stridor, name)))
            self.assertRegex(page, rf"(stridor\.|`){name}\b", f"docs/python.md does not name {name}")

    def test_an_unknown_option_is_refused(self):
        for function, needed in ((stridor.check, {}), (stridor.contact, {}), (stridor.draw, {}),
                                 (stridor.locus, {"from_": 0, "to": 1})):
            with self.assertRaises(stridor.ConfigError) as wrong:
                function(stridor.example("viscoelastic_contact"), sped=1.0, **needed)
            self.assertEqual(wrong.exception.problems[0].code, "unknown-option", function)


def sections(text):
    """The sections of a docstring by their titles, "" the beginning."""
    parts = re.split(r"^(\w+)\n-{3,}\n", text, flags=re.MULTILINE)
    return {"": parts[0], **dict(zip(parts[1::2], parts[2::2]))}


def described(section):
    """What a section of parameters or attributes describes: text by name, without stars."""
    parts = re.split(r"^(\S.*)\n", section, flags=re.MULTILINE)
    return {name.strip().lstrip("*"): text for heads, text in zip(parts[1::2], parts[2::2])
            for name in heads.partition(" : ")[0].split(",")}


def parameters_of(function):
    return {name: one for name, one in inspect.signature(function).parameters.items() if name != "self"}


class Documentation(unittest.TestCase):
    """Every argument and result of what is public has its place in a docstring of the form of numpydoc."""

    PUBLIC = {name: getattr(stridor, name) for name in stridor.__all__}
    CLASSES = {name: one for name, one in PUBLIC.items() if inspect.isclass(one)}

    @classmethod
    def callables(cls):
        yield from ((name, one) for name, one in cls.PUBLIC.items() if name not in cls.CLASSES)
        for name, one in cls.CLASSES.items():
            for method, function in inspect.getmembers(one, inspect.isfunction):
                if not method.startswith("_") and function.__module__.startswith("stridor"):
                    yield f"{name}.{method}", function

    def test_every_argument_and_result_of_a_function_is_described(self):
        seen = 0
        for name, function in self.callables():
            with self.subTest(name):
                said = sections(inspect.getdoc(function) or "")
                self.assertTrue(said[""].strip())
                self.assertEqual(list(described(said.get("Parameters", ""))), self.in_order(function, said))
                if inspect.signature(function).return_annotation != "None":
                    self.assertIn("Returns", said)
                seen += 1
        self.assertGreater(seen, 40)

    def in_order(self, function, said):
        """Names of the arguments, in the order of the docstring where it has them all."""
        order = list(described(said.get("Parameters", "")))
        return sorted(parameters_of(function), key=lambda name: order.index(name) if name in order else len(order))

    def test_every_property_and_attribute_of_a_class_is_described(self):
        for name, one in self.CLASSES.items():
            said = sections(inspect.getdoc(one) or "")
            self.assertTrue(said[""].strip(), name)
            for attribute, value in inspect.getmembers(one, lambda value: isinstance(value, property)):
                self.assertTrue(inspect.getdoc(value), f"{name}.{attribute}")
            if dataclasses.is_dataclass(one):
                fields = [field.name for field in dataclasses.fields(one)]
                self.assertEqual(list(described(said.get("Attributes", ""))), fields, name)
        scene = sections(inspect.getdoc(stridor.Scene))["Parameters"]
        self.assertEqual(list(described(scene)), list(parameters_of(stridor.Scene)))

    #: Options that another function takes.
    ELSEWHERE = {"contact": {"table", "speeds", "indentations", "master_curve"}}
    #: Arguments that the command line names otherwise.
    OWN_NAMES = {"frf": {"motions"}}

    def test_options_are_those_of_the_verb(self):
        for verb in Verbs.of_the_program():
            told = subprocess.run([stridor.program(), verb, "--help"], capture_output=True, text=True,
                                  check=True).stdout
            options = set(re.findall(r"^  (?:-\w,)?--([a-z-]+)", told, re.MULTILINE)) - {"help", "json"}
            options = {name.replace("-", "_") for name in options}
            name = verb + ("_" if verb == "import" else "")
            function = getattr(stridor, name)
            parameters = parameters_of(function)
            keywords = {key.rstrip("_") for key, one in parameters.items() if one.kind == one.KEYWORD_ONLY}
            said = described(sections(inspect.getdoc(function))["Parameters"])
            further = set(re.findall(r"``(\w+)``", said.get("options", "")))
            with self.subTest(verb):
                self.assertEqual(further - options, set())
                self.assertEqual(keywords - options - self.OWN_NAMES.get(verb, set()), set())
                self.assertEqual(further & keywords, set())
                left_out = options - keywords - further - self.ELSEWHERE.get(verb, set())
                self.assertEqual(left_out - ({"progress"} if verb == "schema" else set()), set())
                self.assertEqual("options" in parameters, bool(further), "**options where there are further ones")


class Tables(unittest.TestCase):
    """What a verb gives back without a file reads as its file does."""

    def expect_alike(self, found, again):
        with found, again:
            self.assertEqual(sorted(name for name in found.datasets() if not name.startswith("plot")),
                             sorted(name for name in again.datasets() if not name.startswith("plot")))
            for name in again.datasets():
                self.assertEqual(found[name].units, again[name].units, name)
                self.assertEqual(found[name].dims, again[name].dims, name)
                np.testing.assert_array_equal(found[name][:], again[name][:], name)
            self.assertEqual(found.rows.dtype, again.rows.dtype)
            self.assertEqual(str(list(found)), str(list(again)))
            for name in ("kind", "title", "scene", "norm", "channel", "reference_error", "wanted_error"):
                np.testing.assert_equal(found.attributes.get(name), again.attributes.get(name), name)
            self.assertEqual(repr(found).partition(":")[2].strip(), repr(again).partition(":")[2].strip())

    def test_a_comparison_reads_as_its_file(self):
        with tempfile.TemporaryDirectory() as folder:
            found = stridor.compare(stridor.example("beam_on_beam"), set={"time.end": 0.02, "measure.from": 0.01},
                                    published_window=0.001, output=folder)
            self.assertIsInstance(found, stridor.Comparison)
            self.assertEqual(found.path, os.path.join(folder, "comparison.h5"))
            self.assertEqual(len(found), 8)
            self.assertEqual([row["coordinates"] for row in found[:5]], ["modal"] * 4 + ["craig_bampton"])
            self.expect_alike(found, comparison_of(found.raw))
            with stridor.open(found.path) as opened:
                self.assertIsInstance(opened, stridor.Comparison)
                self.assertEqual(opened[-1]["assumption"], "film")

    def test_a_study_of_precision_reads_as_its_file(self):
        for scene, settings in (("viscoelastic_sphere", {}), ("tuning_fork", {"time.end": 2e-3, "measure.from": 1e-3})):
            with tempfile.TemporaryDirectory() as folder, self.subTest(scene):
                found = stridor.precision(stridor.example(scene), points=2, tune=0.5, output=folder, set=settings)
                tuned, told = found.tuned, found["tune"]
                self.assertEqual((tuned["method"], tuned["error"]), (told["method"], told["error"]))
                self.assertEqual(len(found.reduction) > 0, scene == "tuning_fork")
                self.expect_alike(found, precision_of(found.raw, found.attributes["scene"]))
                with stridor.open(os.path.join(folder, "precision.h5")) as opened:
                    self.assertIsInstance(opened, stridor.PrecisionStudy)
                    self.assertEqual(str(opened.tuned), str(tuned))

    def test_reductions_alone_have_no_settings(self):
        found = stridor.precision(stridor.example("tuning_fork"), reduction=True, frequencies=["500 Hz"])
        self.assertEqual((len(found), found.tuned, found.norm), (0, None, ""))
        self.assertEqual(found["reduction"][0]["errors"], found.reduction["error"].tolist())
        self.assertIn("1 reduced body", repr(found))

    def test_a_result_in_memory_is_in_no_page(self):
        found = stridor.precision(stridor.example("tuning_fork"), reduction=True, frequencies=["500 Hz"])
        with self.assertRaisesRegex(ValueError, "PrecisionStudy stands in no file"):
            stridor.report(found)

    def test_thresholds_are_rows_and_columns(self):
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder) / "along.h5"
            found = stridor.threshold(stridor.example("two_springs_on_a_belt"), parameter="parameters.mu", from_=0,
                                      to=1.2, output=file)
            self.assertEqual(list(found), found.raw["roots"])
            self.assertEqual(found.values.tolist(), [root["value"] for root in found])
            with stridor.open(file) as locus:
                self.assertIsInstance(locus, stridor.Locus)
        none = stridor.threshold(stridor.example("two_springs_on_a_belt"), parameter="parameters.mu", from_=0, to=0.1)
        self.assertFalse(none)
        self.assertEqual(repr(none), "<Thresholds of parameters.mu: none>")

    def test_a_table_of_pandas_has_the_same_columns(self):
        try:
            import pandas  # noqa: F401, is it there?
        except ImportError:
            self.skipTest("pandas is not installed")
        found = stridor.threshold(stridor.example("two_springs_on_a_belt"), parameter="parameters.mu", from_=0, to=1.2)
        self.assertEqual(found.to_pandas().to_dict("records"), list(found))
        with mock.patch.dict(sys.modules, {"pandas": None}), self.assertRaisesRegex(ImportError, "python3-pandas"):
            found.to_pandas()


class Check(unittest.TestCase):
    def test_faults_of_a_scene_are_given_and_those_of_arguments_raised(self):
        scene = stridor.load(stridor.example("beam_on_beam"))
        found = stridor.check(scene, set={"time.step": "5e-7 s"})
        self.assertFalse(found.ok)
        self.assertEqual([problem.code for problem in found.problems], ["step-too-large"])
        self.assertIn("step-too-large", [problem.code for problem in scene.with_settings({"time.step": 5e-7}).check()])
        with self.assertRaises(stridor.ConfigError):
            stridor.check(scene, stability=True, places=0)
        with self.assertRaises(stridor.ConfigError) as wrong:
            stridor.check(stridor.example("viscoelastic_contact"), stability=True)
        self.assertEqual(wrong.exception.problems[0].key, "--stability")
        with self.assertRaises(stridor.FileError):
            stridor.check("none.yaml")

    def test_what_is_hardly_meant_is_a_warning(self):
        found = stridor.check(stridor.example("mass_on_belt"), set={"time.end": 0.5})
        self.assertTrue(found.ok)
        self.assertEqual([warning.key for warning in found.warnings], ["measure.from"])
        self.assertRegex(repr(found), r"(?s)^<Findings: 0 problems, 1 warning\n .*measure.from.*>$")

    def test_steps_that_grow_are_a_result(self):
        found = stridor.check(stridor.example("beam_on_beam"), stability=True, places=3)
        self.assertEqual(len(found.stability["places"]), 3)
        grown = stridor.Findings([], [], {}, {"steps_grow": True}, {})
        self.assertFalse(grown.ok)
        self.assertIn("steps grow", repr(grown))


class Warnings(unittest.TestCase):
    def test_what_a_run_warns_of_is_a_warning_of_python(self):
        with self.assertWarnsRegex(stridor.SceneWarning, "measure.from") as warned:
            stridor.run(stridor.example("mass_on_belt"), set={"time.end": 0.1}).close()
        self.assertEqual(warned.filename, __file__)

    def test_where_nothing_is_odd_there_is_none(self):
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            stridor.run(stridor.example("frozen_growth"), set={"time.end": 0.1}, progress=lambda *_: None).close()


class Import(unittest.TestCase):
    def test_refuses_what_does_not_belong_together(self):
        folder = pathlib.Path(stridor.example("from_abaqus")).parent
        with self.assertRaises(stridor.FileError):
            stridor.import_("none.msh")
        with self.assertRaises(stridor.ConfigError):
            stridor.import_()
        with self.assertRaises(stridor.ConfigError):
            stridor.import_(folder / "reed.uff", folder / "rail.inp")
        with self.assertRaisesRegex(stridor.ConfigError, "unknown key 'mas', did you mean 'mass'"):
            stridor.import_({"mas": folder / "rail.inp"})
        with self.assertRaises(TypeError):
            stridor.import_(None)

    def test_draws_a_mesh_and_does_not_write_over_a_file_unasked(self):
        mesh = pathlib.Path(stridor.example("bracket")).with_suffix(".msh")
        with tempfile.TemporaryDirectory() as folder:
            picture = pathlib.Path(folder) / "bracket.svg"
            self.assertEqual(stridor.import_(mesh, output=picture)["mesh"]["nodes"], 277)
            self.assertGreater(picture.stat().st_size, 1000)
            with self.assertRaises(stridor.FileError):
                stridor.import_(mesh, output=picture)
            stridor.import_(mesh, output=picture, force=True)


class Contact(unittest.TestCase):
    COARSE = {"contacts.tip.normal.solver.grid": 32}

    def test_rows_are_those_that_the_program_prints(self):
        with stridor.contact(stridor.example("viscoelastic_contact"), speed=np.array([0.1, 1.0]), indentation=0.01,
                             set=self.COARSE) as found:
            told = found.raw["rows"]
            self.assertEqual(found.rows["force"].tolist(), [row["force"] for row in told])
            self.assertIn("counted in cells", told[0]["remarks"][0])
            self.assertEqual(found.rows.dtype.names[:2], ("speed", "indentation"))
            self.assertNotIn("edge_x", found.fields[0])
            self.assertIn("edge_x", found.fields[1])

    def test_a_scene_without_such_a_law_is_refused(self):
        with self.assertRaises(stridor.ConfigError) as wrong:
            stridor.contact(stridor.example("beam_on_beam"), speed=0.1, indentation=0.01)
        self.assertEqual(wrong.exception.problems[0].key, "contact")
        with self.assertRaises(stridor.ConfigError):
            stridor.contact(stridor.example("viscoelastic_contact"), speed=0.1, indentation=0.01, load=0.1)

    def test_a_table_is_taken_by_the_scene(self):
        scene = stridor.example("viscoelastic_contact")
        with stridor.contact_table(scene, speeds=(0.1, 1.0, 4), indentations=(1e-3, 1e-2, 4), set=self.COARSE) as law:
            self.assertEqual(law["/force"].shape, (4, 4))
            self.assertEqual(law.kind, "contact law")
        with self.assertRaises(stridor.ConfigError):
            stridor.contact_table(scene, speeds=(0.1, 1.0, 2))

    def test_results_that_miss_what_is_expected_are_kept_by_the_error(self):
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", stridor.SceneWarning)
            with self.assertRaises(stridor.NumericalError) as missed:
                stridor.run(stridor.example("beam_on_beam"), verify=True, set={"time.end": 0.01})
        self.assertEqual(missed.exception.answer["status"], "done")

    def test_fit_refuses_grids_too_coarse(self):
        with self.assertRaises(stridor.ConfigError) as wrong:
            stridor.fit(speeds=(0.1, 1.0, 3))
        self.assertEqual(wrong.exception.problems[0].key, "--speeds")


class Files(unittest.TestCase):
    def test_info_tells_of_every_kind_of_file(self):
        with tempfile.TemporaryDirectory() as folder:
            cycle = os.path.join(folder, "cycle.h5")
            with stridor.cycle(stridor.example("mass_on_belt"), output=cycle) as found:
                self.assertEqual(os.fspath(found.path), cycle)
                self.assertEqual(found.raw["period"], found.period)
            self.assertEqual(stridor.info(cycle)["kind"], "limit cycle")
            with self.assertRaises(stridor.FileError):
                stridor.info(os.path.join(folder, "missing.h5"))
            with stridor.open(cycle) as found:
                self.assertIsInstance(found, stridor.Cycle)
                self.assertEqual(found.status, "periodic")
        with stridor.run(stridor.example("frozen_growth"), set={"time.end": 0.1}) as run:
            self.assertEqual(stridor.info(run)["samples"], len(run.time))
            with self.assertRaises(stridor.ConfigError):
                stridor.info(run, band=(5000, 1000))

    def test_results_have_what_their_verb_said(self):
        with stridor.frf(stridor.example("reed"), input="reed.middle.y", from_=100, to=3000, points=5) as found:
            self.assertTrue(found.raw)
            again = stridor.open(found.path)
            self.assertEqual(again.raw, {})
            again.close()

    def test_responses_are_written_to_universal_files_as_well(self):
        with tempfile.TemporaryDirectory() as folder:
            universal = pathlib.Path(folder) / "reed.uff"
            with stridor.frf(stridor.example("reed"), input="reed.middle.y", from_=100, to=3000, points=5,
                             output=universal, binary=True) as found:
                self.assertEqual(len(found.frequency), 5)
            self.assertIn(b"    58b", universal.read_bytes())
            numbers = pathlib.Path(folder) / "reed.h5"
            with stridor.frf(stridor.example("reed"), input="reed.middle.y", from_=100, to=3000, points=5,
                             output=[universal, numbers], force=True) as found:
                self.assertEqual(found.path, str(numbers))

    def test_pictures_of_scenes_need_a_name_of_a_picture(self):
        with self.assertRaises(stridor.ConfigError):
            stridor.draw(stridor.example("beam_on_beam"), output="scene.txt")

    def test_files_of_unknown_kinds_are_read_all_the_same(self):
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "other.h5")
            with h5py.File(path, "w") as file:
                file["x/y"] = np.arange(3.0)
            with stridor.open(path) as found:
                self.assertEqual(repr(found), f"<ResultFile {path}: \n groups: x>")
                self.assertEqual(found["x/y"].dims, ("y_0",))


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], "-v"])
