"""Every verb of the program from Python: what the examples of the package do not show, and what is refused."""

import inspect
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest
import warnings

try:
    import h5py
    import numpy as np
    import stridor
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

    def test_all_that_is_public_is_documented(self):
        for name in stridor.__all__:
            self.assertTrue(inspect.getdoc(getattr(stridor, name)), name)

    def test_an_unknown_option_is_refused(self):
        for function in (stridor.check, stridor.contact, stridor.draw, stridor.locus):
            with self.assertRaises(stridor.ConfigError) as wrong:
                function(stridor.example("viscoelastic_contact"), sped=1.0)
            self.assertEqual(wrong.exception.problems[0].code, "unknown-option", function)


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
