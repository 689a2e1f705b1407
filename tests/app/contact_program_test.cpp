// The verbs contact and fit, as a user would run them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/support/dataset.hpp"
#include "tests/support/program.hpp"

namespace stridor {
namespace {

using namespace test;
using ::testing::HasSubstr;
using Json = nlohmann::json;

const std::string contact_scene = scene_path("viscoelastic_contact.yaml");
const std::vector<std::string> small{"contact", contact_scene, "--set",
                                     "contacts.tip.normal.solver.grid=32"};

ProgramResult run_with(std::vector<std::string> more) {
  std::vector<std::string> arguments = small;
  arguments.insert(arguments.end(), more.begin(), more.end());
  return Program(arguments).run();
}

TEST(ContactProgram, ReportsEveryPairOfSpeedAndIndentation) {
  const ProgramResult result =
      run_with({"--speed", "0.1,1", "--indentation", "0.01,0.04", "--json"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const Json rows = Json::parse(result.out)["rows"];
  ASSERT_EQ(rows.size(), 4u);
  EXPECT_EQ(rows[0]["speed"], 0.1);
  EXPECT_EQ(rows[1]["speed"], 1.0);
  EXPECT_EQ(rows[2]["indentation"], 0.04);
  for (const Json& row : rows) EXPECT_EQ(row["converged"], true);
  // β = 1; 32 cells are good to 1e-3.
  EXPECT_NEAR(rows[0]["force"].get<double>(), 1.62614e-3, 2e-6);
  EXPECT_NEAR(rows[0]["area"].get<double>(), 2.0174e-2, 1e-3);
  EXPECT_NEAR(rows[0]["friction"].get<double>(), 4.1775e-2, 1e-4);
}

TEST(ContactProgram, LoadControlGivesTheSameContact) {
  const ProgramResult result = run_with({"--speed", "0.1", "--load", "1.626e-3", "--json"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const Json row = Json::parse(result.out)["rows"][0];
  EXPECT_NEAR(row["force"].get<double>(), 1.626e-3, 1e-8);
  EXPECT_NEAR(row["indentation"].get<double>(), 0.01, 1e-4);
}

TEST(ContactProgram, WritesFieldsAndPictures) {
  const TemporaryFolder folder;
  const std::string file = folder / "contact.h5";
  const std::string pressure = folder / "pressure.png";
  const std::string edges = folder / "edges.svg";
  const ProgramResult result =
      run_with({"--speed", "0.01,0.3", "-o", file, "--pressure", pressure, "--edges", edges});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("friction"));
  EXPECT_GT(std::filesystem::file_size(pressure), 1000u);
  EXPECT_GT(std::filesystem::file_size(edges), 1000u);
  // The force is the sum of the pressures: F = F̃ E_0* R², both halves.
  const std::vector<double> p = dataset(file, "/contacts/001/pressure");
  const std::vector<double> x = dataset(file, "/contacts/001/x");
  ASSERT_EQ(p.size(), 32u * 16u);
  double force = 0.0;
  for (const double value : p) force += 2.0 * value * std::pow(x[1] - x[0], 2);
  const double expected = dataset(file, "/rows/force")[1] * 1e6 / 0.75 * 1e-4;
  EXPECT_NEAR(force / expected, 1.0, 1e-12);
  EXPECT_EQ(dataset(file, "/contacts/000/gap").size(), p.size());

  const ProgramResult again = run_with({"-o", file});
  EXPECT_EQ(again.exit_code, 4);
  EXPECT_THAT(again.err, HasSubstr("use --force"));
}

TEST(ContactProgram, SaysWhatDidNotConverge) {
  const ProgramResult result =
      run_with({"--set", "contacts.tip.normal.material.glassy_modulus=1 GPa", "--speed", "0.1",
                "--indentation", "0.01", "--json"});
  EXPECT_EQ(result.exit_code, 3);
  const Json row = Json::parse(result.out)["rows"][0];
  EXPECT_EQ(row["converged"], false);
  EXPECT_TRUE(row["force"].is_null());
  EXPECT_THAT(result.err, HasSubstr("1 of 1 contacts did not converge"));
}

TEST(ContactProgram, RefusesWrongInput) {
  ProgramResult result = run_with({"--indentation", "-1"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.err, HasSubstr("--indentation: -1 must be > 0"));
  result = run_with({"--set", "sliding={}"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.err, HasSubstr("--speed: is needed"));
  result = run_with({"--set", "sliding.indentations=[]"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.err, HasSubstr("--indentation: or --load is needed"));
  result = run_with({"--set",
                     "contacts.tip.normal.profile={shape: table, radius: 1, radii: [0, 1, 2], "
                     "heights: [0, 1, 4]}",
                     "--indentation", "100"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.err, HasSubstr("in contact up to its end at an indentation of 100 R"));
  result = run_with({"--set", "contacts.tip.normal.solver.gird=64"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.err, HasSubstr("did you mean 'grid'?"));
  result = Program({"contact", scene_path("beam_on_beam.yaml")}).run();
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.err, HasSubstr("contact: the scene has no contact with the normal law "
                                    "viscoelastic"));
  result = Program({"eig", contact_scene}).run();
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.err, HasSubstr("which the verb `contact` evaluates"));
  result = run_with({"--contact", "tipp"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.err, HasSubstr("did you mean 'tip'?"));
}

TEST(ContactProgram, LawsOfOrdinaryScenesAreEvaluatedLikewise) {
  // The rest of an oscillator: the force of its contact is that of the law at its indentation.
  const std::string sphere = scene_path("viscoelastic_sphere.yaml");
  const auto law = [&](const std::string& form, std::vector<std::string> more) {
    std::vector<std::string> arguments{
        "contact", sphere, "--json", "--set", "contact.normal.form=" + form, "--speed", "0.1"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const ProgramResult result = Program(arguments).run();
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return Json::parse(result.out)["rows"][0];
  };
  const Json row = law("boundary_element", {"--indentation", "0.01"});
  EXPECT_EQ(row.size(), 13u);
  EXPECT_NEAR(row["force"].get<double>(), 1.62614e-3, 1e-7);
  EXPECT_NEAR(row["area"].get<double>(), 2.0174e-2, 2e-5);
  EXPECT_NEAR(row["friction"].get<double>(), 4.1775e-2, 5e-6);
  EXPECT_EQ(row["converged"], true);
  EXPECT_TRUE(row["memory_in_cells"].is_null());
  EXPECT_TRUE(row["remarks"].empty());
  // PPH (34) at lg v̂ = −1, lg ŷ = −2.
  const double fitted = 11.890 * 1e-3 * 0.5 * (1.199 + std::erf(-0.873 + 0.449 * 2.0 + 0.412));
  EXPECT_NEAR(law("published_fit", {"--indentation", "0.01"})["force"].get<double>(), fitted,
              1e-12);
  // Under a load instead.
  const double force = row["force"].get<double>();
  const Json loaded = law("boundary_element", {"--load", std::to_string(force)});
  EXPECT_NEAR(loaded["indentation"].get<double>(), 0.01, 1e-5);
  EXPECT_NEAR(loaded["force"].get<double>(), std::stod(std::to_string(force)), 1e-15);
  EXPECT_EQ(law("published_fit", {"--indentation", "0.5"})["remarks"].size(), 1u);
  // Pressures are those of boundary elements.
  const ProgramResult picture = Program({"contact", sphere, "--speed", "1", "--indentation", "0.01",
                                         "--pressure", "never.png"})
                                    .run();
  EXPECT_EQ(picture.exit_code, 2);
  EXPECT_THAT(picture.err, HasSubstr("contact.normal.form: must be solve for --pressure"));
}

const std::string solved_on_two =
    "format: 2\n"
    "substructures:\n"
    "  ball: {type: lumped, masses: {center: {mass: 1 g}}, springs: {s: {at: center, stiffness: "
    "1}}}\n"
    "contacts:\n"
    "  soft: &law\n"
    "    slave: ball.center\n"
    "    master: half_space\n"
    "    normal:\n"
    "      law: viscoelastic\n"
    "      form: solve\n"
    "      radius: 10 mm\n"
    "      material: {rubbery_modulus: 1 MPa, glassy_modulus: 10 MPa, poissons_ratio: 0.5,\n"
    "                 creep_times: [10 ms]}\n"
    "      solver: {grid: 32}\n"
    "  hard: *law\n"
    "sliding: {speeds: [0.1], indentations: [0.01]}\n";

TEST(ContactProgram, SeveralContactsAreEvaluatedByName) {
  const TemporaryFolder folder;
  const std::string scene = folder / "two.yaml";
  write_file(scene, solved_on_two);
  EXPECT_EQ(Program({"check", scene}).run().exit_code, 0);
  const ProgramResult both = Program({"contact", scene, "--json"}).run();
  ASSERT_EQ(both.exit_code, 0) << both.err;
  const Json contacts = Json::parse(both.out)["contacts"];
  ASSERT_EQ(contacts.size(), 2u);
  const ProgramResult one = Program({"contact", scene, "--json", "--contact", "hard"}).run();
  ASSERT_EQ(one.exit_code, 0) << one.err;
  EXPECT_EQ(Json::parse(one.out)["rows"], contacts["hard"]["rows"]);
  // A paraboloid by its radius is that of the shipped scene.
  const ProgramResult shipped = run_with({"--speed", "0.1", "--indentation", "0.01", "--json"});
  EXPECT_EQ(Json::parse(shipped.out)["rows"], contacts["soft"]["rows"]);
  const ProgramResult table = Program({"contact", scene, "--table", folder / "law.h5"}).run();
  EXPECT_EQ(table.exit_code, 2);
  EXPECT_THAT(table.err,
              HasSubstr("--contact: is needed: --table is of one contact, and the scene has 2: "
                        "hard, soft"));
}

TEST(ContactProgram, BodiesInMotionNeedATableOfWhatIsSolved) {
  const TemporaryFolder folder;
  const std::string scene = folder / "two.yaml";
  write_file(scene, solved_on_two);
  const ProgramResult refused = Program({"eig", scene}).run();
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_THAT(refused.err, HasSubstr("contacts.hard.normal.form: solve computes every contact by "
                                     "boundary elements"));
  EXPECT_THAT(refused.err,
              HasSubstr("`stridor contact " + scene + " --contact hard --table law.h5`"));
  ASSERT_EQ(Program({"contact", scene, "--contact", "hard", "--table", folder / "law.h5",
                     "--speeds", "0.01", "1", "4", "--indentations", "1e-3", "0.1", "4"})
                .run()
                .exit_code,
            0);
  // The table, once it is there, is what the contact evaluates to.
  const std::string law = folder / "law.h5";
  const ProgramResult result =
      Program(
          {"contact", scene, "--contact", "hard", "--json", "--set",
           "contacts.hard.normal={law: viscoelastic, radius: 10 mm, modulus: 1 MPa, creep_time: "
           "10 ms, form: '" +
               law + "'}",
           "--speed", "0.01", "--indentation", "1e-3"})
          .run();
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const ProgramResult solved = Program({"contact", scene, "--contact", "hard", "--json", "--speed",
                                        "0.01", "--indentation", "1e-3"})
                                   .run();
  const Json expected = Json::parse(solved.out)["rows"][0];
  for (const char* name : {"force", "area", "friction"}) {
    EXPECT_NEAR(
        Json::parse(result.out)["rows"][0][name].get<double>() / expected[name].get<double>(), 1.0,
        1e-3)
        << name;
  }
}

TEST(ContactProgram, FormerKeysAreRefusedEachWithTheNewOne) {
  const TemporaryFolder folder;
  const std::string scene = folder / "former.yaml";
  write_file(scene,
             "format: 2\nmaterial: {rubbery_modulus: 1 MPa, glassy_modulus: 10 MPa}\n"
             "profile: {shape: sphere, radius: 1}\ncontact_solver: {grid: 64}\n");
  for (const char* verb : {"contact", "check", "eig"}) {
    const ProgramResult result = Program({verb, scene}).run();
    EXPECT_EQ(result.exit_code, 2);
    for (const char* text :
         {"former.yaml:2:",
          "material.rubbery_modulus: is now contacts.NAME.normal.material.rubbery",
          "profile.shape: is now contacts.NAME.normal.profile.shape",
          "contact_solver.grid: is now contacts.NAME.normal.solver.grid", "docs/format_2.md"})
      EXPECT_THAT(result.err, HasSubstr(text)) << verb;
  }
}

TEST(ContactProgram, CheckReadsScenesWithoutBodies) {
  EXPECT_EQ(Program({"check", contact_scene}).run().exit_code, 0);
  const ProgramResult result = Program({"check", contact_scene, "--json", "--set",
                                        "contacts.tip.normal.material.creep_times=[]"})
                                   .run();
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_EQ(Json::parse(result.out)["errors"][0]["key"],
            "contacts.tip.normal.material.creep_times");
}

TEST(ContactProgram, MasterCurveNeedsAParaboloidAndOneTime) {
  const TemporaryFolder folder;
  const std::string file = folder / "curve.inc";
  ProgramResult result =
      run_with({"--set", "contacts.tip.normal.profile.shape=sphere", "--master-curve", file});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.err, HasSubstr("profile.shape: must be paraboloid"));
  result =
      run_with({"--set", "contacts.tip.normal.material.creep_times=[1, 2]", "--set",
                "contacts.tip.normal.material.creep_shares=[0.5, 0.5]", "--master-curve", file});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.err, HasSubstr("material.creep_times: must be one"));
  result = run_with({"--master-curve", file, "--json"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(Json::parse(result.out)["points"].size(), 57u);
  EXPECT_THAT(contents_of(file), HasSubstr("{1, 1.62"));
}

TEST(ContactProgram, TableOfAParaboloidIsTheLawOfTheMasterCurve) {
  // Made for the material of the shipped curve, read by an oscillator: the same equilibrium and
  // growth but for the grid (128 cells) and the interpolation.
  const TemporaryFolder folder;
  const std::string file = folder / "law.h5";
  const ProgramResult made =
      Program({"contact", contact_scene, "--set", "contacts.tip.normal.solver.grid=128", "--table",
               file, "--speeds", "1e-3", "1", "25", "--indentations", "1e-3", "0.1", "9", "--json"})
          .run();
  ASSERT_EQ(made.exit_code, 0) << made.err;
  const Json table = Json::parse(made.out);
  EXPECT_EQ(table["force"].size(), 225u);
  EXPECT_GT(table["num_unresolved"], 0);
  EXPECT_EQ(table["num_touching_window"], 0);
  const auto eig = [](const std::string& law) {
    const ProgramResult result =
        Program({"eig", scene_path("viscoelastic_sphere.yaml"), "--json", "--set",
                 "parameters.v=0.05", "--set", "parameters.F=2e-2", "--set",
                 "contact.normal.form=" + law})
            .run();
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return Json::parse(result.out);
  };
  const Json expected = eig("boundary_element");
  const Json found = eig(file);
  EXPECT_EQ(found["equilibrium"]["law_range"], "inside");
  for (const char* name : {"force", "friction_force", "area"}) {
    EXPECT_NEAR(
        found["equilibrium"][name].get<double>() / expected["equilibrium"][name].get<double>(), 1.0,
        3e-3)
        << name;
  }
  // The growth takes derivatives of the law, in which the interpolation is one order less.
  EXPECT_NEAR(found["equilibrium"]["damping"].get<double>() /
                  expected["equilibrium"]["damping"].get<double>(),
              1.0, 0.05);

  // The table stays with a scene of which a key varies.
  const ProgramResult varied =
      Program({"locus", scene_path("viscoelastic_sphere.yaml"), "--json", "--parameter",
               "parameters.tau0", "--from", "1e-2", "--to", "2e-2", "--points", "2", "--set",
               "parameters.v=0.05", "--set", "parameters.F=2e-2", "--set",
               "contact.normal.form=" + file})
          .run();
  ASSERT_EQ(varied.exit_code, 0) << varied.err;
  const Json locus = Json::parse(varied.out);
  ASSERT_EQ(locus["eigenvalues"][0].size(), found["eigenvalues"].size());
  for (std::size_t i = 0; i < found["eigenvalues"].size(); ++i) {
    for (std::size_t part = 0; part < 2; ++part) {
      EXPECT_NEAR(locus["eigenvalues"][0][i][part].get<double>(),
                  found["eigenvalues"][i][part].get<double>(), 1e-8);
    }
  }
}

TEST(ContactProgram, TableOfASphereWithTwoCreepTimesDrivesTheOscillator) {
  const TemporaryFolder folder;
  const std::string file = folder / "law.h5";
  const ProgramResult made =
      run_with({"--set", "contacts.tip.normal.profile.shape=sphere", "--set",
                "contacts.tip.normal.material.creep_times=[10 ms, 100 ms]", "--set",
                "contacts.tip.normal.material.creep_shares=[0.5, 0.5]", "--table", file, "--speeds",
                "1e-2", "10", "7", "--indentations", "1e-3", "0.1", "5"});
  ASSERT_EQ(made.exit_code, 0) << made.err;
  EXPECT_THAT(made.out, HasSubstr("7 speeds, 5 indentations"));
  // A file named in a scene is beside it.
  std::filesystem::copy_file(scene_path("viscoelastic_sphere.yaml"), folder / "sphere.yaml");
  std::string text = contents_of(folder / "sphere.yaml");
  text.replace(text.find("form: published_fit"), 19, "form: law.h5");
  write_file(folder / "sphere.yaml", text);
  const ProgramResult run = Program({"cycle", folder / "sphere.yaml", "--json", "--set",
                                     "parameters.v=0.05", "--set", "cycle.settle=2.5"})
                                .run();
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_GT(Json::parse(run.out)["x"]["rms"].get<double>(), 0.0);

  const ProgramResult again = run_with({"--table", file});
  EXPECT_EQ(again.exit_code, 4);
  EXPECT_THAT(again.err, HasSubstr("use --force"));
}

TEST(ContactProgram, TablesThatCannotBeAreRefused) {
  const TemporaryFolder folder;
  const std::string file = folder / "law.h5";
  ProgramResult result = run_with({"--table", file, "--speeds", "1", "0.1", "5"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.err, HasSubstr("--speeds: needs two positive numbers"));
  result = run_with({"--table", file, "--set",
                     "contacts.tip.normal.profile={shape: table, radius: 1, radii: [0, 0.1, 0.2], "
                     "heights: [0, 1, 4]}"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  result = run_with({"--table", file, "--force", "--set",
                     "contacts.tip.normal.profile={shape: table, radius: 1, radii: [0, 0.1, 0.2], "
                     "heights: [0, 1, 4]}",
                     "--indentations", "0.1", "100", "4"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.err, HasSubstr("in contact up to its end at an indentation of 10 R"));
  result = run_with({"--table", file, "--force", "--set",
                     "contacts.tip.normal.material.glassy_modulus=1 GPa", "--speeds", "0.05", "0.2",
                     "4", "--indentations", "0.01", "0.02", "4"});
  EXPECT_EQ(result.exit_code, 3);
  EXPECT_THAT(result.err, HasSubstr("of the table did not converge; nothing has been written"));
  const auto eig = [](const std::string& law) {
    return Program({"eig", scene_path("viscoelastic_sphere.yaml"), "--set",
                    "contact.normal.form=" + law})
        .run();
  };
  result = eig("nothing.h5");
  EXPECT_EQ(result.exit_code, 4);
  EXPECT_THAT(result.err, HasSubstr("nothing.h5: cannot be opened"));
  result = eig("boundary_elements");
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.err, HasSubstr("'boundary_elements' is neither published_fit nor"));
}

TEST(FitProgram, FindsTheShiftOfTheSpeedAxis) {
  const TemporaryFolder folder;
  const ProgramResult result =
      Program({"fit", "--json", "--figures", (folder / "figures").string()}).run();
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const Json found = Json::parse(result.out);
  EXPECT_EQ(found["samples"], 735);
  for (const char* quantity : {"force", "area", "friction"}) {
    EXPECT_NEAR(found["shift"][quantity].get<double>(), 2.0, 0.1) << quantity;
    EXPECT_GT(found["r2"]["refit"][quantity].get<double>(), 0.99) << quantity;
    EXPECT_GE(found["r2"]["refit"][quantity].get<double>(),
              found["r2"]["published_at_v_over_100"][quantity].get<double>());
  }
  for (const char* name : {"modulus.png", "cuts.png", "scatter.png"})
    EXPECT_TRUE(std::filesystem::exists(folder / "figures" / name)) << name;
  const ProgramResult again = Program({"fit", "--figures", (folder / "figures").string()}).run();
  EXPECT_EQ(again.exit_code, 4);
  EXPECT_THAT(Program({"fit", "--speeds", "1", "0.1", "9"}).run().err,
              HasSubstr("--speeds: needs two positive numbers"));
  EXPECT_THAT(Program({"fit", "--indentations", "1e-3", "0.1", "2.5"}).run().err,
              HasSubstr("--indentations: 2.5 points are not a whole number"));
}

}  // namespace
}  // namespace stridor
