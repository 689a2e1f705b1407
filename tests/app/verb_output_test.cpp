// Output of verbs without --json: the tables, and a picture of each kind.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/support/program.hpp"

namespace stridor {
namespace {

namespace fs = std::filesystem;
using namespace test;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

const std::string beams = scene_path("beam_on_beam.yaml");
const std::string sphere = scene_path("viscoelastic_sphere.yaml");

std::string output_of(const std::vector<std::string>& arguments) {
  const ProgramResult result = Program(arguments).run();
  EXPECT_EQ(result.exit_code, 0) << result.err;
  return result.out;
}

/// As a viewer knows it, and not empty.
void expect_picture(const fs::path& file) {
  ASSERT_TRUE(fs::exists(file)) << file;
  EXPECT_EQ(contents_of(file).substr(1, 3), "PNG");
  EXPECT_GT(fs::file_size(file), 10000U) << file;
}

TEST(VerbOutput, ARunOfManyPointsNamesTheLargestForce) {
  const TemporaryFolder folder;
  const std::vector<std::string> run{"run",   scene_path("examples/slave_edge.yaml"),
                                     "--set", "substructures.post.mesh.through=10",
                                     "--set", "contact.normal={law: penalty, stiffness: 1e5}",
                                     "--set", "time={integrator: exact, step: 1e-7, end: 1e-4}",
                                     "--set", "measure.from=1e-5",
                                     "--set", "drive.ramp=0",
                                     "-o",    (folder / "edge.h5").string()};
  const std::string out = output_of(run);
  EXPECT_THAT(out, HasSubstr("of 21 points, largest in contact[0]: "));
  EXPECT_THAT(out, Not(HasSubstr("contact[1]")));
}

TEST(VerbOutput, EigDrawsAModeAndItsMotion) {
  const TemporaryFolder folder;
  const fs::path shapes = folder / "shapes";
  const std::vector<std::string> eig{"eig",   beams,    "--count", "2",        "--at",
                                     "60 mm", "--mode", "1",       "--shapes", shapes.string()};
  // The first bending mode of the cantilever by itself has 45 Hz; contact and load change it
  // little.
  EXPECT_THAT(output_of(eig), AllOf(HasSubstr("damping ratio"), HasSubstr("stable between"),
                                    HasSubstr("mode_01.png and 26 files for ParaView")));
  expect_picture(shapes / "mode_01.png");
  for (const char* name : {"mode_01.vtu", "mode_01_frame_000.vtu", "mode_01_frame_023.vtu"})
    EXPECT_THAT(contents_of(shapes / name), HasSubstr("<UnstructuredGrid>")) << name;
  EXPECT_THAT(contents_of(shapes / "mode_01.pvd"), HasSubstr("file=\"mode_01_frame_023.vtu\""));
  // Not over what is there, and not where the position is given twice.
  const ProgramResult again = Program(eig).run();
  EXPECT_EQ(again.exit_code, 4);
  EXPECT_THAT(again.err, HasSubstr("exists; use --force"));
}

TEST(VerbOutput, EigExplainsAMode) {
  // The first of the bursts of the scene: two modes near 3.5 kHz meet.
  const std::string text =
      output_of({"eig", beams, "--set", "contact.start=0.075", "--about", "deformed", "--explain"});
  EXPECT_THAT(text, AllOf(HasSubstr("at 3521.39 Hz, growth 89.8"), HasSubstr("sees damping d = "),
                          HasSubstr("growth: +118."), HasSubstr("1/s from the contact, -28."),
                          HasSubstr("enters at the contact in each cycle"),
                          HasSubstr("90.5 % of it is the mode of 3522.38 Hz without friction")));
  EXPECT_THAT(text, Not(HasSubstr("coupled terms")));
  EXPECT_THAT(output_of({"eig", scene_path("examples/rotating_support.yaml"), "--explain"}),
              HasSubstr("1/s by coupled terms of bodies"));
}

TEST(VerbOutput, EigSaysWhichContactsAreOpen) {
  EXPECT_THAT(output_of({"eig", scene_path("extreme/points_on_one_element.yaml"), "--about",
                         "deformed", "--count", "2"}),
              AllOf(HasSubstr("contact[0]          open, gap 2.78"),
                    HasSubstr("contact[2]          0.0295 m along the master, force 0.1998")));
  const ProgramResult several =
      Program({"eig", scene_path("examples/two_pairs.yaml"), "--at", "60mm"}).run();
  EXPECT_EQ(several.exit_code, 2);
  EXPECT_THAT(several.err, HasSubstr("--at: the scene has several contact pairs; set the `start`"));
}

TEST(VerbOutput, RunTellsOfEveryContactAndOfTheEnergy) {
  const TemporaryFolder folder;
  const std::string text = output_of({"run", scene_path("examples/two_pairs.yaml"), "-o",
                                      (folder / "run.h5").string(), "--set", "record.energy=true",
                                      "--set", "time.end=0.01", "--set", "measure.from=0"});
  for (const char* part :
       {"modes of front          13 moving", "contact force, front    ", "contact force, rear     ",
        "energy balance          largest error", "changes of load and drive from 0.1 s on"})
    EXPECT_THAT(text, HasSubstr(part));
}

TEST(VerbOutput, RunsWhoseContactsOnlyTakeEnergySayNothingOfIt) {
  const TemporaryFolder folder;
  const std::vector<std::string> run{"run",   scene_path("examples/landing.yaml"),
                                     "-o",    (folder / "run.h5").string(),
                                     "--set", "record.energy=true"};
  EXPECT_THAT(output_of(run), Not(HasSubstr("CONTACT WORK")));
}

TEST(VerbOutput, PrecisionNamesTheCheapestAndWhatElseThereIs) {
  const std::string text = output_of(
      {"precision", scene_path("beam_on_beam_leading.yaml"), "--until", "8 ms", "--set",
       "measure.from=4 ms", "--set", "record.interval=1e-5", "--points", "2", "--retain", "50 kHz",
       "--assumptions", "subs_a", "--published-window", "2e-4", "--tune", "1e-2"});
  for (const char* part : {"published form", "cheapest within 0.01", "integrator: exact"})
    EXPECT_THAT(text, HasSubstr(part));
}

TEST(VerbOutput, ExpectationsOfWhatIsNoNumberAreToldOf) {
  const TemporaryFolder folder;
  write_file(folder / "scene.yaml", contents_of(scene_path("examples/stick_slip.yaml")) +
                                        "  - {result: status, value: 1, tolerance: 1}\n"
                                        "  - {result: bursts.0.peak, value: 1, tolerance: 1}\n");
  const ProgramResult result =
      Program({"run", (folder / "scene.yaml").string(), "-o", (folder / "run.h5").string(), "--set",
               "time.end=0.3", "--verify"})
          .run();
  EXPECT_EQ(result.exit_code, 3);
  EXPECT_THAT(result.err, AllOf(HasSubstr("status: expected 1, but the run has no such number"),
                                HasSubstr("bursts.0.peak: expected 1, but the run has no such")));
}

TEST(VerbOutput, MapsSweepsAndLociOfSmallSystemsAreDrawn) {
  const TemporaryFolder folder;
  const auto figure = [&](const char* name) { return (folder / name).string(); };
  EXPECT_THAT(output_of({"map", sphere, "--x", "parameters.v", "1e-3", "1e-1", "5", "--y",
                         "parameters.tau0", "5e-3", "5e-2", "5", "--scale", "log", "--figure",
                         figure("map.png")}),
              HasSubstr("points are unstable"));
  expect_picture(figure("map.png"));
  // The cycle of the paper, see SphereProgram.
  EXPECT_THAT(output_of({"sweep", sphere, "--parameter", "parameters.tau0", "--from", "8e-3",
                         "--to", "1e-2", "--points", "2", "--set", "cycle.settle=1.25", "--figure",
                         figure("sweep.png")}),
              HasSubstr("periodic     0.15386127"));
  expect_picture(figure("sweep.png"));
  output_of({"locus", scene_path("examples/flutter.yaml"), "--parameter",
             "parameters.load", "--from", "0", "--to", "0.4", "--points", "9",
             "--figure", figure("locus.png")});
  expect_picture(figure("locus.png"));
}

TEST(VerbOutput, ThresholdSaysWhereAndWhichWay) {
  const std::vector<std::string> scan{"threshold",   scene_path("disc_and_pads.yaml"),
                                      "--parameter", "parameters.mu",
                                      "--from",      "0.1"};
  const auto to = [&](const char* end, const char* from) {
    std::vector<std::string> arguments = scan;
    arguments.back() = from;
    arguments.insert(arguments.end(), {"--to", end});
    return output_of(arguments);
  };
  EXPECT_THAT(to("0.6", "0.1"), HasSubstr("unstable beyond"));
  EXPECT_THAT(to("0.15", "0.1"), HasSubstr("stable everywhere between"));
  EXPECT_THAT(to("0.6", "0.55"), HasSubstr("unstable everywhere between"));
  EXPECT_THAT(output_of({"threshold", beams, "--parameter", "contact.friction.coefficient",
                         "--from", "0", "--to", "0.01"}),
              HasSubstr("stable everywhere between contact.friction.coefficient = 0 and "));
}

TEST(VerbOutput, ProblemsWithFilesNameTheFileApart) {
  const TemporaryFolder folder;
  const std::string missing = folder / "none.msh";
  const auto error_of = [](const std::vector<std::string>& arguments) {
    const ProgramResult result = Program(arguments).run();
    EXPECT_EQ(result.exit_code, 4) << result.out;
    const auto error = nlohmann::json::parse(result.out)["errors"][0];
    // In words both stand together.
    EXPECT_THAT(result.err, HasSubstr(error["file"].get<std::string>() + ": " +
                                      error["message"].get<std::string>()));
    return error;
  };
  auto error = error_of({"import", missing, "--json"});
  EXPECT_EQ(error["file"], missing);
  EXPECT_EQ(error["message"],
            "cannot be opened; expected a mesh of Gmsh (.msh) or of Abaqus or CalculiX (.inp)");
  EXPECT_EQ(error.size(), 6U);  // no dataset
  error = error_of({"info", beams, "--json"});
  EXPECT_EQ(error["file"], beams);
  EXPECT_EQ(error["message"], "is not an HDF5 file");
  EXPECT_EQ(error["code"], "other-kind-of-file");
}

TEST(VerbOutput, JsonHoldsTheWarningsOfARun) {
  const TemporaryFolder folder;
  const auto run = [&](const std::vector<std::string>& more) {
    std::vector<std::string> arguments{"run",     scene_path("examples/mass_on_belt.yaml"),
                                       "-o",      folder / "run.h5",
                                       "--force", "--json",
                                       "--set",   "time.end=0.01"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const ProgramResult result = Program(arguments).run();
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return nlohmann::json::parse(result.out)["warnings"];
  };
  const auto checked = [&](const std::vector<std::string>& more) {
    std::vector<std::string> arguments{"check", scene_path("examples/mass_on_belt.yaml"), "--json",
                                       "--set", "time.end=0.01"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return nlohmann::json::parse(Program(arguments).run().out)["warnings"];
  };
  EXPECT_EQ(run({"--set", "measure.from=0"}), nlohmann::json::array());
  const nlohmann::json warned = run({"--set", "measure.from=1"});
  ASSERT_GE(warned.size(), 1U);
  EXPECT_EQ(warned, checked({"--set", "measure.from=1"}));
  EXPECT_EQ(warned[0]["key"], "measure.from");
}

TEST(VerbOutput, FitPrintsItsCoefficients) {
  const std::string text =
      output_of({"fit", "--speeds", "1e-2", "1e2", "9", "--indentations", "1e-3", "0.1", "5"});
  EXPECT_THAT(text, AllOf(HasSubstr("r^2 of the published fits"), HasSubstr("r^2 of the refit"),
                          HasSubstr("shift of the speed axis, decades")));
}

}  // namespace
}  // namespace stridor
