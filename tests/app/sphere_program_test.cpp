// The verbs on a sphere on a viscoelastic substrate, as a user would run them. Numbers are of an
// independent program for the same equations, in the units of its paper (PPH).
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "io/run_file/run_file.hpp"
#include "tests/support/program.hpp"

namespace stridor {
namespace {

using namespace test;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;
using Json = nlohmann::json;
using Settings = std::vector<std::string>;

constexpr double omega_x = 40.0;  ///< rad/s; its inverse is the paper's unit of time
constexpr double x0 = 2e-3;       ///< F_n/k_x, m, its unit of length

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

const std::string undamped = "terms=[gyroscopic, friction, geometric]";

TEST(SphereProgram, FlutterThresholdsOfTheUndampedSystem) {
  const auto shear = [](const char* load) {
    return thresholds("parameters.tau0", "1e-5", "0.5",
                      {undamped, "parameters.v=1e-4", std::string("parameters.F=") + load});
  };
  expect_relative(shear("7.5e-6"), {0.0365980094}, 2e-9);
  // PPH, Fig. 7.
  expect_relative(shear("1e-8"), {3.87771e-3}, 2e-6);
  expect_relative(shear("1e-6"), {1.59687e-2}, 2e-6);
  expect_relative(shear("1e-4"), {0.122590}, 4e-6);
  const auto load = [](const char* strength, const char* speed) {
    return thresholds("parameters.F", "1e-9", "1e-2",
                      {undamped, std::string("parameters.v=") + speed,
                       std::string("parameters.tau0=") + strength});
  };
  expect_relative(load("0.01", "1.58e-4"), {7.04748915e-8}, 2e-9);
  // PPH, Fig. 8.
  expect_relative(load("0.01", "1e-4"), {2.49478e-7}, 2e-6);
  expect_relative(load("0.1", "1e-4"), {6.53730e-5}, 2e-6);
}

TEST(SphereProgram, EigenvaluesOfTheUndampedSystemComeInPairs) {
  // s² = −½(tr K ± √D): two on the imaginary axis, or one that grows and one that decays.
  const Settings stable{undamped, "parameters.v=1e-4", "parameters.F=7.5e-6",
                        "parameters.tau0=0.03"};
  for (const Json& s : run_verb("eig", stable)["eigenvalues"])
    EXPECT_LT(std::abs(s[0].get<double>()), 1e-8);
  Settings unstable = stable;
  unstable.back() = "parameters.tau0=0.1";
  const Json found = run_verb("eig", unstable)["eigenvalues"];
  ASSERT_EQ(found.size(), 2u);
  EXPECT_GT(std::abs(found[0][0].get<double>()), 0.1);
  EXPECT_NEAR(found[0][0].get<double>(), -found[1][0].get<double>(), 1e-8);
}

TEST(SphereProgram, NoFlutterWherePositiveCouplingIsMissing) {
  for (const char* angle : {"parameters.alpha=0", "parameters.alpha=-45 deg"})
    EXPECT_TRUE(
        thresholds("parameters.tau0", "1e-5", "1", {undamped, "parameters.v=1e-4", angle}).empty());
}

TEST(SphereProgram, ThresholdsOfTheWholeSystemWithEitherNormalForce) {
  // PPH, Fig. 11.
  const auto with = [](const char* force) {
    return thresholds("parameters.tau0", "1e-5", "0.1",
                      {"parameters.v=4e-4", std::string("contact.friction.viscoelastic=") + force});
  };
  expect_relative(with("applied"), {3.841820e-4, 2.10002393e-3}, 2e-7);
  expect_relative(with("contact"), {1.98313455e-3}, 3e-9);
}

TEST(SphereProgram, ThresholdIsWhereTheLocusCrosses) {
  const Json locus = run_verb(
      "locus", {"parameters.v=4e-4"},
      {"--parameter", "parameters.tau0", "--from", "1e-4", "--to", "5e-3", "--points", "20"});
  ASSERT_GE(locus["unstable"].size(), 2u);
  EXPECT_NEAR(locus["unstable"][0]["to"].get<double>(), 3.841820e-4, 1e-10);
  EXPECT_NEAR(locus["unstable"][1]["from"].get<double>(), 2.10002393e-3, 1e-11);
}

TEST(SphereProgram, EigenvaluesByBothMethodsAndBalanceOfForces) {
  const Json secular = run_verb("eig", {});
  const Json dense = run_verb("eig", {}, {"--method", "dense"});
  ASSERT_EQ(secular["eigenvalues"].size(), 2u);
  for (int i = 0; i < 2; ++i) {
    for (int part = 0; part < 2; ++part) {
      EXPECT_NEAR(secular["eigenvalues"][i][part].get<double>(),
                  dense["eigenvalues"][i][part].get<double>(), 1e-11 * omega_x);
    }
  }
  EXPECT_EQ(secular["stable"], false);
  // Springs against contact and load of 0.1 N; y points out of the substrate.
  const Json& state = secular["equilibrium"];
  const double x = state["displacement"][0];
  const double y = state["displacement"][1];
  constexpr double k = 50.0;
  EXPECT_NEAR(k * (1.5 * x - 0.5 * y), -state["friction_force"].get<double>(), 1e-15);
  EXPECT_NEAR(k * (1.5 * y - 0.5 * x), state["force"].get<double>() - 0.1, 1e-15);
}

TEST(SphereProgram, MapAgreesWithThresholdAndEigenvalues) {
  const Json map = run_verb("map", {"parameters.v=4e-4"},
                            {"--x", "parameters.F", "1e-4", "1e-3", "4", "--y", "parameters.tau0",
                             "1e-4", "1e-2", "30", "--y-scale", "log"});
  ASSERT_EQ(map["growth"].size(), 30u);
  for (const std::size_t row : {0u, 12u, 29u}) {
    const Json eig = run_verb("eig", {"parameters.v=4e-4", "parameters.F=4e-4",
                                      "parameters.tau0=" + map["y"][row].dump()});
    double largest = -1e300;
    for (const Json& s : eig["eigenvalues"]) largest = std::max(largest, s[0].get<double>());
    EXPECT_NEAR(map["growth"][row][1].get<double>(), largest, 1e-11 * (1.0 + std::abs(largest)));
  }
  // The boundary passes through the thresholds at every load of the grid.
  const std::vector<double> at =
      thresholds("parameters.tau0", "1e-4", "1e-2", {"parameters.v=4e-4", "parameters.F=4e-4"});
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
  const Json cycle = run_verb("cycle", {"cycle.settle=5"}, {"-o", file});
  EXPECT_EQ(cycle["status"], "periodic");
  EXPECT_NEAR(omega_x * cycle["period"].get<double>(), 6.1544510, 1e-7);
  EXPECT_NEAR(cycle["x"]["rms"].get<double>() / x0, 0.0660501053, 1e-9);
  EXPECT_NEAR(cycle["stick_fraction"].get<double>(), 0.40341, 1e-5);
  EXPECT_EQ(cycle["multipliers"].size(), 3u);
  EXPECT_TRUE(std::filesystem::exists(file));
}

/// Mean period of the second half of a run, from where its x turns back: linear between samples.
double period_of(const RunFileReader& file) {
  const std::vector<double> time = file.times();
  const std::vector<double> velocity = file.series("/channels/sphere.center.x.velocity");
  std::vector<double> turns;
  for (std::size_t i = time.size() / 2; i + 1 < time.size(); ++i) {
    if (!(velocity[i] > 0.0 && velocity[i + 1] <= 0.0)) continue;
    const double share = velocity[i] / (velocity[i] - velocity[i + 1]);
    turns.push_back(time[i] + share * (time[i + 1] - time[i]));
  }
  return (turns.back() - turns.front()) / static_cast<double>(turns.size() - 1);
}

TEST(SphereProgram, RunByStepsComesToTheCycleOfTheEvents) {
  const TemporaryFolder folder;
  const auto run = [&](const char* name, Settings settings) {
    settings.push_back("time.end=10");
    settings.push_back("measure.from=5");
    return run_verb("run", settings, {"-o", folder / name});
  };
  const Json events = run("events.h5", {"time.tolerance=1e-10"});
  EXPECT_NEAR(omega_x * events["period"].get<double>(), 6.1544510, 1e-6);
  EXPECT_NEAR(events["x"]["rms"].get<double>() / x0, 0.0660501053, 1e-7);
  EXPECT_NEAR(events["stick_fraction"].get<double>(), 0.40341, 1e-5);
  const double reference = period_of(RunFileReader(folder / "events.h5"));
  const auto error = [&](const char* name, const char* integrator, const char* step) {
    const Json found =
        run(name, {std::string("time.integrator=") + integrator, std::string("time.step=") + step});
    // Of the window, which holds no whole number of cycles.
    EXPECT_NEAR(found["stick_fraction"].get<double>(), 0.40341, 1.5e-2);
    return std::abs(period_of(RunFileReader(folder / name)) - reference) * omega_x;
  };
  const double order =
      std::log2(error("a.h5", "exact", "1.25e-4") / error("b.h5", "exact", "6.25e-5"));
  EXPECT_GT(order, 1.4);
  EXPECT_LT(order, 2.6);
  EXPECT_LT(error("c.h5", "central_difference", "5e-5"), 2e-4);
}

TEST(SphereProgram, ChannelsOfEventsAreThoseOfSteps) {
  const TemporaryFolder folder;
  const auto run = [&](const char* name, Settings settings) {
    settings.push_back("time.end=0.25");
    settings.push_back("measure.from=0");
    settings.push_back(
        "record.channels=[sphere.center.x.displacement, sphere.center.y.displacement, "
        "sphere.center.x.velocity, sphere.center.y.acceleration, contact.force, "
        "contact.friction_force, contact.gap, contact.slip_velocity, contact.position, "
        "contact.area]");
    run_verb("run", settings, {"-o", folder / name});
    return RunFileReader(folder / name);
  };
  const RunFileReader events = run("events.h5", {});
  const RunFileReader steps =
      run("steps.h5", {"time.integrator=exact", "time.step=1.25e-5", "record.interval=1.25e-3"});
  const std::vector<double> time = events.times();
  ASSERT_EQ(time.size(), steps.times().size());
  for (const std::string& name : events.series_names()) {
    const std::vector<double> a = events.series(name);
    const std::vector<double> b = steps.series(name);
    const double size = std::abs(*std::max_element(
        b.begin(), b.end(), [](double l, double r) { return std::abs(l) < std::abs(r); }));
    // Jumps of the friction and kinks of what is low-passed take a few samples.
    int apart = 0;
    for (std::size_t i = 3; i + 3 < a.size(); ++i) apart += std::abs(a[i] - b[i]) > 0.02 * size;
    EXPECT_LE(apart, 30) << name;
  }
}

TEST(SphereProgram, SweepUpAndDownFindsBothMotions) {
  const Json sweep = run_verb("sweep", {"parameters.v=0.0316227766", "cycle.settle=30"},
                              {"--parameter", "parameters.tau0", "--from", "0.01", "--to", "0.13",
                               "--points", "2", "--up-down"});
  const Json& up = sweep["up"];
  const Json& down = sweep["down"];
  ASSERT_EQ(up.size(), 2u);
  ASSERT_EQ(down.size(), 2u);
  EXPECT_EQ(up[0]["status"], "at_rest");
  EXPECT_EQ(up[0]["equilibrium_stable"], true);
  EXPECT_EQ(up[1]["equilibrium_stable"], false);
  EXPECT_EQ(down[1]["value"], 0.01);
  EXPECT_EQ(down[1]["status"], "periodic");
  EXPECT_NEAR(down[1]["x"]["rms"].get<double>() / x0, 0.2457, 1e-4);
}

TEST(SphereProgram, RunFilesCanBeDrawn) {
  const TemporaryFolder folder;
  const std::string file = folder / "run.h5";
  const Json found = run_verb("run", {"time.end=1.5", "measure.from=0.75"}, {"-o", file});
  const RunFileReader reader(file);
  ASSERT_EQ(reader.times().size(), 1201u);
  EXPECT_NEAR(reader.times().back(), 60.0 / omega_x, 1e-12);
  const std::vector<double> x = reader.series("/channels/sphere.center.x.displacement");
  const double largest = *std::max_element(x.begin() + 600, x.end());
  EXPECT_NEAR(largest, found["x"]["max"].get<double>(), 0.02 * largest);
  const std::vector<double> force = reader.series("/contact/contact/force");
  // It begins about the applied load, 7.5e-4 E_0* R² = 0.1 N, less what the springs take.
  EXPECT_GT(force.front(), 0.05);
  EXPECT_LT(force.front(), 0.15);
  EXPECT_EQ(found["contact_force"]["max"].get<double>(),
            *std::max_element(force.begin() + 600, force.end()));
  for (const std::vector<std::string>& verb :
       {std::vector<std::string>{"spectrogram", file, "--channel", "sphere.center.x.displacement"},
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
  // With Ω = η = 1 and 45 deg the larger of the two frequencies is √2 ω_nx; damping does not change
  // 2/ω much.
  ProgramResult result =
      run({"time.integrator=central_difference", "time.step=0.075", "record.interval=0.075"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.err, HasSubstr("0.075 s is above the largest stable step 0.03"));
  EXPECT_FALSE(std::filesystem::exists(file));
  // A step that does not resolve the motion on the substrate, which is the stiffer the deeper.
  result = run({"time.integrator=exact", "time.step=5e-3", "time.end=5", "record.interval=5e-3"});
  EXPECT_EQ(result.exit_code, 3);
  EXPECT_THAT(result.err, HasSubstr("the substrate is too stiff for the step"));
  EXPECT_THAT(result.err, HasSubstr(file + " holds everything up to then"));
  const RunFileReader reader(file);
  EXPECT_GT(reader.times().size(), 2u);
  EXPECT_EQ(std::get<std::string>(reader.results().at("status")), "failed");
  result = Program({"run", "--resume", file}).run();
  EXPECT_EQ(result.exit_code, 4);
  EXPECT_THAT(result.err, HasSubstr("holds a run that failed"));
}

TEST(SphereProgram, PrecisionSetsErrorAgainstRunTime) {
  const Json found = run_verb("precision", {"time.end=0.5"}, {"--points", "4", "--tune", "1e-4"});
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
  EXPECT_LT(found["tune"]["error"].get<double>(), 1e-4);
}

TEST(SphereProgram, SaysWhereTheLawIsExceeded) {
  const TemporaryFolder folder;
  const std::string scene = scene_path("viscoelastic_sphere.yaml");
  // Under this load the sphere rests deeper than 0.3 of its radius.
  const std::vector<std::string> deep{"--set", "parameters.F=0.3", "--set", "time.end=1",
                                      "--set", "measure.from=0",   "--set", "cycle.settle=0.5"};
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
    const Json found =
        run_verb(verb, {"time.end=1", "measure.from=0", "cycle.settle=0.5"}, {"-o", folder / name});
    EXPECT_EQ(found["law_exceeded"], false);
    EXPECT_GT(found["largest_indentation"].get<double>(), 0.0);
  }
}

TEST(SphereProgram, WhatAMotionFailedOfIsSaid) {
  const TemporaryFolder folder;
  const std::string scene = scene_path("viscoelastic_sphere.yaml");
  const std::string thrown = "initial.indentation=1e15";
  const ProgramResult cycle = Program({"cycle", scene, "--set", thrown}).run();
  EXPECT_EQ(cycle.exit_code, 3);
  EXPECT_THAT(cycle.err, HasSubstr("after t = "));
  EXPECT_THAT(cycle.err, HasSubstr("; try "));
  // In a sweep they are rows, of which nothing is drawn.
  const std::string figure = folder / "sweep.png";
  const std::vector<std::string> arguments{
      "sweep", scene,  "--set",    thrown, "--parameter", "parameters.v", "--from", "1e-3",
      "--to",  "1e-2", "--points", "2",    "--figure",    figure,         "--force"};
  const ProgramResult table = Program(arguments).run();
  EXPECT_EQ(table.exit_code, 3);
  EXPECT_THAT(table.err,
              HasSubstr("none of the 2 motions can be followed; parameters.v = 0.001: after t = "));
  EXPECT_THAT(table.out,
              AllOf(HasSubstr("diverged"), HasSubstr("parameters.v = 0.01: after t = ")));
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
  std::string table = output_of({"cycle", "--set", "cycle.settle=5", "--figure", picture});
  for (const char* text : {"status                          periodic\n", "0.15386", "multiplier",
                           "part of time sticking           0.40341", "cycle.png\n"})
    EXPECT_THAT(table, HasSubstr(text));
  EXPECT_THAT(table, Not(HasSubstr("y/R > 0.3")));
  // It dies down, but not by then.
  table = output_of({"cycle", "--set", "cycle.settle=1.25", "--set", "parameters.v=0.0316", "--set",
                     "parameters.tau0=0.09", "--figure", picture, "--force"});
  EXPECT_THAT(table, AllOf(HasSubstr("settling\n"), Not(HasSubstr("period  "))));

  const std::string file = folder / "sweep.h5";
  table = output_of({"sweep", "--set", "cycle.settle=5", "--parameter", "parameters.tau0", "--from",
                     "1e-3", "--to", "1e-2", "--points", "2", "-o", file});
  for (const char* text :
       {"value", "equilibrium\n", "periodic", "0.15386", "unstable\n", "sweep.h5\n"})
    EXPECT_THAT(table, HasSubstr(text));

  table = output_of({"precision", "--set", "time.end=0.5", "--points", "2", "--tune", "1e-3", "-o",
                     folder / "precision"});
  for (const char* text : {"run time (s)", "event_driven", "1.0e-03", "  cheapest\n",
                           "differs from the same at 1e-12", "precision.png, precision.json and precision.h5 in"})
    EXPECT_THAT(table, HasSubstr(text));
  const ProgramResult coarse =
      Program({"precision", scene, "--set", "time.end=0.5", "--points", "2", "--tune", "1e-15"})
          .run();
  EXPECT_EQ(coarse.exit_code, 3);
  EXPECT_THAT(coarse.err, HasSubstr("no setting measured is within 1e-15"));
}

TEST(SphereProgram, RefusesWhatDoesNotFit) {
  const std::string scene = scene_path("viscoelastic_sphere.yaml");
  const auto error_of = [](const std::vector<std::string>& arguments) {
    const ProgramResult result = Program(arguments).run();
    EXPECT_EQ(result.exit_code, 2) << result.out;
    return result.err;
  };
  const auto error = [&](std::vector<std::string> arguments) {
    arguments.insert(arguments.begin() + 1, scene);
    return error_of(arguments);
  };
  EXPECT_THAT(error({"locus", "--parameter", "time.end", "--from", "1", "--to", "2"}),
              HasSubstr("no influence"));
  EXPECT_THAT(error({"compare"}), HasSubstr("event_driven knows no contact assumptions"));
  EXPECT_THAT(error({"run", "-o", "never.h5", "--error"}), HasSubstr("`precision` says the error"));
  EXPECT_THAT(error({"check", "--stability"}), HasSubstr("event_driven has no steps of a given length"));
  EXPECT_THAT(error({"precision", "--retain", "1kHz"}), HasSubstr("is for scenes with time.step"));
  EXPECT_THAT(error({"precision", "--until", "3"}), HasSubstr("here time.end says how far"));
  EXPECT_THAT(error({"precision", "--set", "time.end=0.0015"}),
              HasSubstr("time.end: holds less than two samples"));
  EXPECT_THAT(error({"run", "-o", "never.h5", "--set", "time.integrator=exact"}),
              HasSubstr("`step` is missing"));
  EXPECT_THAT(error({"run", "-o", "never.h5", "--set", "time.step=1e-4"}),
              HasSubstr("not used by the integrator event_driven"));
  EXPECT_THAT(error({"run", "-o", "never.h5", "--set", "record.energy=true"}),
              HasSubstr("does not know what a half_space stores"));
  EXPECT_THAT(
      error({"run", "-o", "never.h5", "--set", "drive.ramp=0.1", "--set", "initial={state: rest}"}),
      HasSubstr("time.integrator: needs one body of two unknowns, the displacements x and y "
                "of one mass, on a half_space that slides under it at a constant speed: its "
                "drive is not constant from the start"));
  EXPECT_THAT(error({"eig", "--set", "terms=[friction, geometrical]"}),
              HasSubstr("terms.1: there is no term 'geometrical', did you mean 'geometric'?"));
  EXPECT_THAT(error({"eig", "--set", "terms=[friction_damping]"}),
              HasSubstr("terms: `gyroscopic` is missing"));
  EXPECT_THAT(error({"run", "-o", "never.h5", "--set", "initial={indentation: 1.1}"}),
              HasSubstr("needs state: equilibrium"));
  const std::string beam = scene_path("examples/beam_on_substrate.yaml");
  EXPECT_THAT(error_of({"cycle", beam}), HasSubstr("cycle: missing"));
  EXPECT_THAT(error_of({"sweep", beam, "--up-down", "--parameter", "contact.friction.strength",
                        "--from", "1e3", "--to", "1e4"}),
              HasSubstr("is for limit cycles (time.integrator: event_driven)"));
}

TEST(SphereProgram, FormerKeysAreRefusedEachWithTheNewOne) {
  const TemporaryFolder folder;
  const std::string scene = folder / "former.yaml";
  write_file(scene,
             "format: 2\n"
             "sphere:\n  stiffness_x: 50\n  normal_load: 7.5e-4\n  shear_stress: 1e4\n"
             "contact_law: boundary_element\nsmall_motion: undamped\n"
             "time: {end: 500, settle: 20}\n");
  for (const char* verb : {"check", "eig", "cycle"}) {
    const ProgramResult result = Program({verb, scene}).run();
    EXPECT_EQ(result.exit_code, 2);
    for (const char* text :
         {"former.yaml:3:", "sphere.stiffness_x: is now substructures.NAME.springs.horizontal",
          "sphere.normal_load: is now drive.load: =-F*E*R^2",
          "sphere.shear_stress: is now contact.friction.strength",
          "contact_law: is now contact.normal.form", "small_motion: is now terms: [gyroscopic",
          "time.end: is now time.end, in s", "time.settle: is now cycle.settle, in s",
          "docs/format_2.md"})
      EXPECT_THAT(result.err, HasSubstr(text)) << verb;
  }
}

}  // namespace
}  // namespace stridor
