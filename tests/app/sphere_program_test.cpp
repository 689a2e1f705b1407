// The verbs on a sphere on a viscoelastic substrate, as a user would run them. Numbers are of an
// independent program for the same equations.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "io/run_file.hpp"
#include "tests/support/program.hpp"

namespace stridor {
namespace {

using namespace test;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;
using Json = nlohmann::json;
using Settings = std::vector<std::string>;

Json run_verb(const std::string& verb, const Settings& settings, const Settings& more = {}) {
  std::vector<std::string> arguments{verb, scene_path("viscoelastic_sphere.yaml"), "--json"};
  for (const std::string& setting : settings) {
    arguments.push_back("--set");
    arguments.push_back(setting);
  }
  arguments.insert(arguments.end(), more.begin(), more.end());
  const ProgramResult result = Program(arguments).run();
  EXPECT_EQ(result.exit_code, 0) << result.err;
  return Json::parse(result.out);
}

std::vector<double> thresholds(const std::string& parameter, const std::string& from,
                               const std::string& to, const Settings& settings) {
  const Json object =
      run_verb("threshold", settings, {"--parameter", parameter, "--from", from, "--to", to});
  std::vector<double> values;
  for (const Json& root : object["roots"]) values.push_back(root["value"]);
  return values;
}

void expect_relative(const std::vector<double>& found, const std::vector<double>& expected,
                     double tolerance) {
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t i = 0; i < found.size(); ++i)
    EXPECT_NEAR(found[i], expected[i], tolerance * expected[i]);
}

TEST(SphereProgram, FlutterThresholdsOfTheUndampedSystem) {
  const auto shear = [](const char* load) {
    return thresholds(
        "sphere.shear_strength", "1e-5", "0.5",
        {"small_motion=undamped", "sphere.speed=1e-4", std::string("sphere.normal_load=") + load});
  };
  expect_relative(shear("7.5e-6"), {0.0365980094}, 2e-9);
  // PPH, Fig. 7.
  expect_relative(shear("1e-8"), {3.87771e-3}, 2e-6);
  expect_relative(shear("1e-6"), {1.59687e-2}, 2e-6);
  expect_relative(shear("1e-4"), {0.122590}, 4e-6);
  const auto load = [](const char* strength, const char* speed) {
    return thresholds("sphere.normal_load", "1e-9", "1e-2",
                      {"small_motion=undamped", std::string("sphere.speed=") + speed,
                       std::string("sphere.shear_strength=") + strength});
  };
  expect_relative(load("0.01", "1.58e-4"), {7.04748915e-8}, 2e-9);
  // PPH, Fig. 8.
  expect_relative(load("0.01", "1e-4"), {2.49478e-7}, 2e-6);
  expect_relative(load("0.1", "1e-4"), {6.53730e-5}, 2e-6);
}

TEST(SphereProgram, ThresholdsOfTheWholeSystemWithEitherNormalForce) {
  // PPH, Fig. 11.
  const auto with = [](const char* force) {
    return thresholds("sphere.shear_strength", "1e-5", "0.1",
                      {"sphere.speed=4e-4", std::string("friction_normal_force=") + force});
  };
  expect_relative(with("applied"), {3.841820e-4, 2.10002393e-3}, 2e-7);
  expect_relative(with("contact"), {1.98313455e-3}, 3e-9);
}

TEST(SphereProgram, ThresholdIsWhereTheLocusCrosses) {
  const Json locus = run_verb(
      "locus", {"sphere.speed=4e-4"},
      {"--parameter", "sphere.shear_strength", "--from", "1e-4", "--to", "5e-3", "--points", "20"});
  ASSERT_GE(locus["unstable"].size(), 2u);
  EXPECT_NEAR(locus["unstable"][0]["to"].get<double>(), 3.841820e-4, 1e-10);
  EXPECT_NEAR(locus["unstable"][1]["from"].get<double>(), 2.10002393e-3, 1e-11);
}

TEST(SphereProgram, NoFlutterWherePositiveCouplingIsMissing) {
  for (const char* angle : {"sphere.angle=0", "sphere.angle=-45 deg"}) {
    EXPECT_TRUE(thresholds("sphere.shear_strength", "1e-5", "1",
                           {"small_motion=undamped", "sphere.speed=1e-4", angle})
                    .empty());
  }
}

TEST(SphereProgram, EigenvaluesInBothUnitsAndByBothMethods) {
  const Json secular = run_verb("eig", {});
  const Json dense = run_verb("eig", {}, {"--method", "dense"});
  ASSERT_EQ(secular["eigenvalues"].size(), 2u);
  for (int i = 0; i < 2; ++i) {
    for (int part = 0; part < 2; ++part) {
      EXPECT_NEAR(secular["eigenvalues"][i][part].get<double>(),
                  dense["eigenvalues"][i][part].get<double>(), 1e-11);
    }
  }
  EXPECT_EQ(secular["stable"], false);
  const Json& state = secular["equilibrium"];
  EXPECT_NEAR(state["dimensional"]["x"].get<double>(), 0.002 * state["x"].get<double>(), 1e-17);
  // The balance of forces, in units of the load.
  const double x = state["x"];
  const double y = state["y"];
  EXPECT_NEAR(1.5 * x + 0.5 * y, state["friction_force"].get<double>(), 1e-14);
  EXPECT_NEAR(1.5 * y + 0.5 * x, 1.0 - state["normal_force"].get<double>(), 1e-14);
}

TEST(SphereProgram, MapAgreesWithThresholdAndEigenvalues) {
  const Json map = run_verb("map", {"sphere.speed=4e-4"},
                            {"--x", "sphere.normal_load", "1e-4", "1e-3", "4", "--y",
                             "sphere.shear_strength", "1e-4", "1e-2", "30", "--y-scale", "log"});
  ASSERT_EQ(map["growth"].size(), 30u);
  for (const std::size_t row : {0u, 12u, 29u}) {
    const Json eig = run_verb("eig", {"sphere.speed=4e-4", "sphere.normal_load=4e-4",
                                      "sphere.shear_strength=" + map["y"][row].dump()});
    double largest = -1e300;
    for (const Json& s : eig["eigenvalues"]) largest = std::max(largest, s[0].get<double>());
    EXPECT_NEAR(map["growth"][row][1].get<double>(), largest, 1e-11 * (1.0 + std::abs(largest)));
  }
  // The boundary passes through the thresholds at every load of the grid.
  const std::vector<double> at = thresholds("sphere.shear_strength", "1e-4", "1e-2",
                                            {"sphere.speed=4e-4", "sphere.normal_load=4e-4"});
  for (const double value : at) {
    double nearest = 1e300;
    for (const Json& line : map["boundary"]) {
      for (const Json& point : line) {
        if (std::abs(point[0].get<double>() - 4e-4) < 1e-15)
          nearest = std::min(nearest, std::abs(point[1].get<double>() - value));
      }
    }
    EXPECT_LT(nearest, 1e-13);
  }
}

TEST(SphereProgram, CycleHasWhatItPromises) {
  const TemporaryFolder folder;
  const std::string file = folder / "cycle.h5";
  const Json cycle = run_verb("cycle", {"time.settle=200"}, {"-o", file});
  EXPECT_EQ(cycle["status"], "periodic");
  EXPECT_NEAR(cycle["period"].get<double>(), 6.1544510, 1e-7);
  EXPECT_NEAR(cycle["x"]["rms"].get<double>(), 0.0660501053, 1e-9);
  EXPECT_NEAR(cycle["stick_fraction"].get<double>(), 0.40341, 1e-5);
  EXPECT_EQ(cycle["multipliers"].size(), 3u);
  EXPECT_NEAR(cycle["dimensional"]["period"].get<double>(), 6.1544510 / 40.0, 1e-8);
  EXPECT_TRUE(std::filesystem::exists(file));
}

TEST(SphereProgram, RunByStepsComesToTheCycleOfTheEvents) {
  const TemporaryFolder folder;
  const auto run = [&](const char* name, Settings settings) {
    settings.push_back("time.end=400");
    return run_verb("run", settings, {"-o", folder / name});
  };
  const Json events = run("events.h5", {"time.tolerance=1e-10"});
  EXPECT_NEAR(events["period"].get<double>(), 6.1544510, 1e-6);
  EXPECT_NEAR(events["x"]["rms"].get<double>(), 0.0660501053, 1e-7);
  EXPECT_NEAR(events["stick_fraction"].get<double>(), 0.40341, 1e-5);
  const auto error = [&](const char* name, const char* integrator, const char* step) {
    const Json found =
        run(name, {std::string("time.integrator=") + integrator, std::string("time.step=") + step});
    EXPECT_NEAR(found["stick_fraction"].get<double>(), 0.40341, 2e-3);
    EXPECT_NEAR(found["x"]["rms"].get<double>(), 0.0660501053, 1e-5);
    return std::abs(found["period"].get<double>() - 6.1544510);
  };
  const double order = std::log2(error("a.h5", "exact", "4e-3") / error("b.h5", "exact", "2e-3"));
  EXPECT_GT(order, 1.6);
  EXPECT_LT(order, 2.4);
  EXPECT_LT(error("c.h5", "central_difference", "2e-3"), 2e-4);
}

TEST(SphereProgram, SweepUpAndDownFindsBothMotions) {
  const Json sweep = run_verb("sweep", {"sphere.speed=0.0316227766", "time.settle=1200"},
                              {"--parameter", "sphere.shear_strength", "--from", "0.01", "--to",
                               "0.13", "--points", "3", "--up-down"});
  const Json& up = sweep["up"];
  const Json& down = sweep["down"];
  ASSERT_EQ(up.size(), 3u);
  ASSERT_EQ(down.size(), 3u);
  EXPECT_EQ(up[0]["status"], "at_rest");
  EXPECT_EQ(up[0]["equilibrium_stable"], true);
  EXPECT_EQ(up[2]["equilibrium_stable"], false);
  EXPECT_EQ(down[2]["value"], 0.01);
  EXPECT_EQ(down[2]["status"], "periodic");
  EXPECT_NEAR(down[2]["x"]["rms"].get<double>(), 0.2457, 1e-4);
}

TEST(SphereProgram, RunFilesAreInSiUnitsAndCanBeDrawn) {
  const TemporaryFolder folder;
  const std::string file = folder / "run.h5";
  const Json found = run_verb("run", {"time.end=60"}, {"-o", file});
  const RunFileReader reader(file);
  ASSERT_EQ(reader.times().size(), 1201u);
  EXPECT_NEAR(reader.times().back(), 60.0 / 40.0, 1e-12);
  // x_0 = F_n/k_x = 2 mm.
  const std::vector<double> x = reader.series("/channels/sphere.x.displacement");
  const double largest = *std::max_element(x.begin() + 600, x.end());
  EXPECT_NEAR(largest, 0.002 * found["x"]["max"].get<double>(), 0.02 * largest);
  const std::vector<double> force = reader.series("/contact/contact/force");
  // It begins about the applied load, 7.5e-4 E_0* R² = 0.1 N, less what the springs take.
  EXPECT_GT(force.front(), 0.05);
  EXPECT_LT(force.front(), 0.15);
  for (const std::vector<std::string>& verb :
       {std::vector<std::string>{"spectrogram", file, "--channel", "sphere.x.displacement"},
        std::vector<std::string>{"plot", file, "--kind", "history"}}) {
    std::vector<std::string> arguments = verb;
    const std::string figure = folder / (verb[0] + ".png");
    arguments.insert(arguments.end(), {"-o", figure});
    const ProgramResult result = Program(arguments).run();
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_TRUE(std::filesystem::exists(figure));
  }
  const ProgramResult resumed = Program({"run", "--resume", file}).run();
  EXPECT_EQ(resumed.exit_code, 0) << resumed.err;
  EXPECT_THAT(resumed.out, HasSubstr("holds the whole run, there is nothing left to do"));
}

TEST(SphereProgram, StopsWhereTheMotionGrowsBeyondAllBounds) {
  const TemporaryFolder folder;
  const std::string scene = scene_path("viscoelastic_sphere.yaml");
  const std::string file = folder / "run.h5";
  const auto run = [&](Settings settings) {
    std::vector<std::string> arguments{"run", scene, "-o", file, "--force"};
    for (const std::string& setting : settings)
      arguments.insert(arguments.end(), {"--set", setting});
    return Program(arguments).run();
  };
  // ω_nx, and with Ω = η = 1 and 45 deg the larger of the two frequencies is below 1.74; damping
  // does not change 2/ω much.
  ProgramResult result = run({"time.integrator=central_difference", "time.step=3"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.err, HasSubstr("time.step: 3 is beyond 1."));
  EXPECT_FALSE(std::filesystem::exists(file));
  // A step that does not resolve the motion on the substrate, which is the stiffer the deeper.
  result =
      run({"time.integrator=exact", "time.step=0.2", "time.end=200", "time.record_interval=1"});
  EXPECT_EQ(result.exit_code, 3);
  EXPECT_THAT(result.err, HasSubstr("the substrate is too stiff for the step"));
  EXPECT_THAT(result.err, HasSubstr("try a shorter time.step, about 0."));
  EXPECT_THAT(result.err, HasSubstr(file + " holds everything up to then"));
  const RunFileReader reader(file);
  EXPECT_GT(reader.times().size(), 2u);
  EXPECT_EQ(std::get<std::string>(reader.results().at("status")), "failed");
  result = Program({"run", "--resume", file}).run();
  EXPECT_EQ(result.exit_code, 4);
  EXPECT_THAT(result.err, HasSubstr("holds a run that failed"));
}

TEST(SphereProgram, PrecisionSetsErrorAgainstRunTime) {
  const Json found = run_verb("precision", {"time.end=20"}, {"--points", "4", "--tune", "1e-4"});
  ASSERT_EQ(found["rows"].size(), 12u);
  EXPECT_LT(found["reference"]["error"].get<double>(), 1e-9);
  double last = 1e300;
  for (int k = 0; k < 12; ++k) {
    const Json& row = found["rows"][k];
    EXPECT_EQ(row["stable"], true) << k;
    EXPECT_GT(row["wall_s"].get<double>(), 0.0);
    // Steps from sample to sample are precise at any tolerance; of fixed ones the error falls with
    // the step.
    if (k % 4 == 0) last = 1e300;
    EXPECT_LT(row["error"].get<double>(), k < 4 ? 1e-4 : last) << k;
    last = row["error"];
  }
  EXPECT_EQ(found["rows"][0]["integrator"], "event_driven");
  EXPECT_EQ(found["rows"][4]["integrator"], "exact");
  EXPECT_EQ(found["rows"][8]["integrator"], "central_difference");
  EXPECT_LT(found["tuned"]["error"].get<double>(), 1e-4);
}

TEST(SphereProgram, SaysWhereTheLawIsExceeded) {
  const TemporaryFolder folder;
  const std::string scene = scene_path("viscoelastic_sphere.yaml");
  // Under this load the sphere rests deeper than 0.3 of its radius.
  const std::vector<std::string> deep{"--set", "sphere.normal_load=0.3", "--set", "time.end=40",
                                      "--set", "time.settle=20"};
  const auto output_of = [&](std::vector<std::string> arguments) {
    arguments.insert(arguments.end(), deep.begin(), deep.end());
    const ProgramResult result = Program(arguments).run();
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return result.out;
  };
  EXPECT_THAT(output_of({"run", scene, "-o", folder / "deep.h5"}), HasSubstr("(y/R > 0.3)"));
  EXPECT_THAT(output_of({"cycle", scene}), HasSubstr("(y/R > 0.3)"));
  for (const char* verb : {"run", "cycle"}) {
    const std::string name = std::string(verb) + ".h5";
    const Json found = run_verb(verb, {"time.end=40", "time.settle=20"}, {"-o", folder / name});
    EXPECT_EQ(found["law_exceeded"], false);
    EXPECT_GT(found["largest_indentation"].get<double>(), 0.0);
  }
}

TEST(SphereProgram, WhatAMotionFailedOfIsSaid) {
  const TemporaryFolder folder;
  const std::string scene = scene_path("viscoelastic_sphere.yaml");
  const std::string thrown = "time.initial_indentation=1e15";
  const ProgramResult cycle = Program({"cycle", scene, "--set", thrown}).run();
  EXPECT_EQ(cycle.exit_code, 3);
  EXPECT_THAT(cycle.err, HasSubstr("after t = "));
  EXPECT_THAT(cycle.err, HasSubstr("; try "));
  // In a sweep they are rows, of which nothing is drawn.
  const std::string figure = folder / "sweep.png";
  const std::vector<std::string> arguments{
      "sweep", scene,  "--set",    thrown, "--parameter", "sphere.speed", "--from", "1e-3",
      "--to",  "1e-2", "--points", "2",    "--figure",    figure,         "--force"};
  const ProgramResult table = Program(arguments).run();
  EXPECT_EQ(table.exit_code, 3);
  EXPECT_THAT(table.err,
              HasSubstr("none of the 2 motions can be followed; sphere.speed = 0.001: after t = "));
  EXPECT_THAT(table.out,
              AllOf(HasSubstr("diverged"), HasSubstr("sphere.speed = 0.01: after t = ")));
  EXPECT_TRUE(std::filesystem::exists(figure));
  std::vector<std::string> with_json = arguments;
  with_json.emplace_back("--json");
  const Json sweep = Json::parse(Program(with_json).run().out);
  for (const Json& row : sweep["rows"]) {
    EXPECT_EQ(row["status"], "diverged");
    EXPECT_THAT(row["failure"].get<std::string>(), HasSubstr("after t = "));
    EXPECT_EQ(row["x"]["rms"], nullptr);
  }
}

TEST(SphereProgram, PrintsTables) {
  const TemporaryFolder folder;
  const std::string scene = scene_path("viscoelastic_sphere.yaml");
  const auto output_of = [&](std::vector<std::string> arguments) {
    arguments.insert(arguments.begin() + 1, scene);
    const ProgramResult result = Program(arguments).run();
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return result.out;
  };
  const std::string picture = folder / "cycle.png";
  std::string table = output_of({"cycle", "--set", "time.settle=200", "--figure", picture});
  for (const char* text : {"status                          periodic\n", "6.15445", "multiplier",
                           "part of time sticking           0.40341", "cycle.png\n"})
    EXPECT_THAT(table, HasSubstr(text));
  EXPECT_THAT(table, Not(HasSubstr("y/R > 0.3")));
  // It dies down, but not by then.
  table = output_of({"cycle", "--set", "time.settle=50", "--set", "sphere.speed=0.0316", "--set",
                     "sphere.shear_strength=0.09", "--figure", picture, "--force"});
  EXPECT_THAT(table, AllOf(HasSubstr("settling\n"), Not(HasSubstr("period  "))));

  const std::string file = folder / "sweep.h5";
  table = output_of({"sweep", "--set", "time.settle=200", "--parameter", "sphere.shear_strength",
                     "--from", "1e-3", "--to", "1e-2", "--points", "2", "-o", file});
  for (const char* text :
       {"value", "equilibrium\n", "periodic", "6.1544", "unstable\n", "sweep.h5\n"})
    EXPECT_THAT(table, HasSubstr(text));

  table = output_of({"precision", "--set", "time.end=20", "--points", "2", "--tune", "1e-3", "-o",
                     folder / "precision"});
  for (const char* text : {"run time (s)", "event_driven", "1.0e-03", "  cheapest\n",
                           "differs from the same at 1e-12", "precision.png and precision.json"})
    EXPECT_THAT(table, HasSubstr(text));
  const ProgramResult coarse =
      Program({"precision", scene, "--set", "time.end=20", "--points", "2", "--tune", "1e-15"})
          .run();
  EXPECT_EQ(coarse.exit_code, 3);
  EXPECT_THAT(coarse.err, HasSubstr("no setting measured is within 1e-15"));
}

TEST(SphereProgram, RefusesWhatDoesNotFit) {
  const std::string scene = scene_path("viscoelastic_sphere.yaml");
  const auto error = [&](std::vector<std::string> arguments) {
    arguments.insert(arguments.begin() + 1, scene);
    const ProgramResult result = Program(arguments).run();
    EXPECT_EQ(result.exit_code, 2);
    return result.err;
  };
  EXPECT_THAT(error({"eig", "--set", "sphere.normal_force=0.1"}),
              HasSubstr("says the same as `normal_load`"));
  EXPECT_THAT(
      error({"locus", "--parameter", "sphere.normal_force", "--from", "0.1", "--to", "0.2"}),
      HasSubstr("says the same as `normal_load`"));
  EXPECT_THAT(error({"locus", "--parameter", "time.end", "--from", "1", "--to", "2"}),
              HasSubstr("no influence"));
  EXPECT_THAT(error({"locus", "--from", "1", "--to", "2"}), HasSubstr("name a key"));
  EXPECT_THAT(error({"eig", "--explain"}), HasSubstr("is for scenes of bodies"));
  EXPECT_THAT(error({"compare"}), HasSubstr("belongs to an oscillator"));
  EXPECT_THAT(error({"precision", "--retain", "1kHz"}), HasSubstr("is for scenes of bodies"));
  EXPECT_THAT(error({"precision", "--until", "3"}), HasSubstr("here time.end says how far"));
  EXPECT_THAT(error({"precision", "--set", "time.end=0.06"}),
              HasSubstr("time.end: holds less than two samples"));
  EXPECT_THAT(error({"eig", "--set", "regularisation.law=tanh"}),
              HasSubstr("regularisation.speed: missing"));
  EXPECT_THAT(error({"run", "-o", "never.h5", "--set", "time.integrator=exact"}),
              HasSubstr("`step` is missing"));
}

}  // namespace
}  // namespace stridor
