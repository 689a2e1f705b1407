// The locus about the deformed sliding equilibrium says which bursts a transient shows.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "tests/support/dataset.hpp"
#include "tests/support/program.hpp"

namespace stridor {
namespace {

using namespace test;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;
using Json = nlohmann::json;

Json run_json(std::vector<std::string> arguments) {
  arguments.emplace_back("--json");
  const ProgramResult result = Program(std::move(arguments)).run();
  EXPECT_EQ(result.exit_code, 0) << result.err;
  return result.exit_code == 0 ? Json::parse(result.out) : Json();
}

struct Case {
  const char* scene;
  const char* friction;
};

void PrintTo(const Case& one, std::ostream* stream) {
  *stream << one.scene << ", friction " << one.friction;
}

/// Of the gain: the mode changes its shape as it grows (docs/theory.md, 7.6).
constexpr double gain_tolerance = 0.2;

/// That the datasets of a run file hold what its results say, and point at each other.
void expect_stored(const std::string& run, const Json& results) {
  const Json& rows = results["prediction"];
  const std::vector<double> window_of = dataset(run, "/bursts/window");
  const std::vector<double> burst_of = dataset(run, "/windows/burst");
  ASSERT_EQ(window_of.size(), results["bursts"].size());
  ASSERT_EQ(burst_of.size(), rows.size());
  for (const auto& [name, key] :
       {std::pair{"/windows/from", "from"}, std::pair{"/windows/to", "to"},
        std::pair{"/windows/frequency", "frequency"}, std::pair{"/windows/gain", "gain"},
        std::pair{"/windows/growth_max", "growth_max"}}) {
    const std::vector<double> values = dataset(run, name);
    ASSERT_EQ(values.size(), rows.size()) << name;
    for (std::size_t i = 0; i < rows.size(); ++i) EXPECT_EQ(values[i], rows[i][key]) << name;
  }
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const Json& burst = rows[i]["burst"];
    EXPECT_EQ(burst_of[i], burst.is_null() ? -1.0 : burst.get<double>() - 1.0);
    if (burst_of[i] < 0.0) continue;
    EXPECT_EQ(window_of.at(static_cast<std::size_t>(burst_of[i])), static_cast<double>(i));
  }
  for (std::size_t k = 0; k < window_of.size(); ++k) {
    const Json& window = results["bursts"][k]["window"];
    EXPECT_EQ(window_of[k], window.is_null() ? -1.0 : window.get<double>() - 1.0);
  }
}

/// That the courses in a run file are those of its bursts, which follow the frequencies of a locus:
/// a mode of the sliding bodies changes its frequency as they slide.
void expect_courses(const std::string& run, const Json& results) {
  const std::vector<double> of = dataset(run, "/bursts/course/burst");
  const std::vector<double> times = dataset(run, "/bursts/course/time");
  const std::vector<double> frequencies = dataset(run, "/bursts/course/frequency");
  ASSERT_EQ(times.size(), of.size());
  ASSERT_EQ(frequencies.size(), of.size());
  std::vector<std::size_t> points(results["bursts"].size());
  for (std::size_t i = 0; i < of.size(); ++i) {
    const auto k = static_cast<std::size_t>(of[i]);
    ASSERT_LT(k, points.size());
    const Json& burst = results["bursts"][k];
    ++points[k];
    EXPECT_GE(times[i], burst["start"].get<double>());
    EXPECT_LE(times[i], burst["end"].get<double>());
    EXPECT_NEAR(frequencies[i], burst["frequency"].get<double>(),
                0.1 * burst["frequency"].get<double>());
  }
  EXPECT_THAT(points, ::testing::Each(::testing::Gt(20u)));
  // Of three times the frequency of the third, by chance, but not as that changes.
  EXPECT_EQ(dataset(run, "/bursts/harmonic_of"), std::vector<double>(points.size(), -1.0));
}

class PredictionTest : public ::testing::TestWithParam<Case> {};

TEST_P(PredictionTest, EveryBurstHasItsWindow) {
  const TemporaryFolder folder;
  const std::string scene = scene_path(GetParam().scene);
  const std::string run = (folder / "run.h5").string();
  const std::string locus = (folder / "locus.h5").string();
  const std::string friction = std::string("contact.friction.coefficient=") + GetParam().friction;
  run_json({"locus", scene, "--from", "30 mm", "--to", "97.5 mm", "--points", "271", "--about",
            "deformed", "-o", locus, "--set", friction});
  const Json results = run_json({"run", scene, "-o", run, "--set", friction, "--predict", locus});
  const Json picture =
      run_json({"spectrogram", run, "-o", (folder / "figure.png").string(), "--predict", locus});
  // Three of 3.5 kHz, and during the third one of 10.6 kHz.
  ASSERT_EQ(picture["bursts"], 4);
  int num_near_10_kHz = 0;
  for (const Json& row : picture["prediction"]) {
    if (row["burst"].is_null()) {
      // A window without a burst is too weak to rise out of the quiet.
      EXPECT_LT(row["gain"].get<double>(), 2.0) << row;
      continue;
    }
    if (row["frequency"].get<double>() > 1e4) ++num_near_10_kHz;
    EXPECT_NEAR(row["burst_start"].get<double>(), row["from"].get<double>(), 0.05) << row;
    EXPECT_NEAR(row["burst_frequency"].get<double>(), row["frequency"].get<double>(),
                0.02 * row["frequency"].get<double>());
    EXPECT_NEAR(row["burst_gain"].get<double>(), row["gain"].get<double>(),
                gain_tolerance * row["gain"].get<double>())
        << row;
  }
  EXPECT_EQ(num_near_10_kHz, 1);
  EXPECT_EQ(picture["unexplained"], Json::array());
  // The run itself says the same.
  EXPECT_EQ(results["prediction"], picture["prediction"]);
  EXPECT_EQ(results["unexplained"], picture["unexplained"]);
  expect_stored(run, results);
  expect_courses(run, results);
}

INSTANTIATE_TEST_SUITE_P(Scenes, PredictionTest,
                         ::testing::Values(Case{"beam_on_beam.yaml", "0.3"},
                                           Case{"beam_on_beam_leading.yaml", "0.3"},
                                           Case{"beam_on_beam.yaml", "0.26"},
                                           Case{"beam_on_beam_leading.yaml", "0.34"}));

TEST(Prediction, ARunSaysWhichWindowsWereHeardAndWhichBurstsNoneExplains) {
  const TemporaryFolder folder;
  const std::string scene = scene_path("beam_on_beam.yaml");
  const std::string locus = (folder / "locus.h5").string();
  const std::string run = (folder / "run.h5").string();
  // To 1.75 s there is one burst, at 1.54 s and 74 mm, which this locus does not reach.
  run_json({"locus", scene, "--from", "60 mm", "--to", "65 mm", "--points", "21", "--about",
            "deformed", "-o", locus});
  const ProgramResult said = Program({"run", scene, "-o", run, "--predict", locus, "--set",
                                      "time.end=1.7"})
                                 .run();
  ASSERT_EQ(said.exit_code, 0) << said.err;
  EXPECT_THAT(said.out, HasSubstr("window predicted        1.119 to 1.15"));
  EXPECT_THAT(said.out, HasSubstr("gain 1.08: not heard\n"));
  EXPECT_THAT(said.out, HasSubstr("unexplained             burst 1 belongs to no window\n"));
  EXPECT_EQ(dataset(run, "/bursts/window"), std::vector<double>{-1.0});
  EXPECT_EQ(dataset(run, "/windows/burst"), std::vector<double>{-1.0});

  const ProgramResult done = Program({"run", "--resume", run, "--predict", locus}).run();
  EXPECT_EQ(done.exit_code, 2);
  EXPECT_THAT(done.err, HasSubstr("holds a whole run"));
}

TEST(Prediction, WarnsOfALocusOfAnotherSceneAndOfOneThatLookedLessHigh) {
  const TemporaryFolder folder;
  const std::string scene = scene_path("beam_on_beam.yaml");
  const auto said_with = [&](const std::string& name, std::vector<std::string> options) {
    const std::string locus = (folder / (name + ".h5")).string();
    std::vector<std::string> command{"locus",    scene, "--from",  "60 mm",    "--to", "61 mm",
                                     "--points", "2",   "--about", "deformed", "-o",   locus};
    command.insert(command.end(), options.begin(), options.end());
    EXPECT_EQ(Program(command).run().exit_code, 0);
    const ProgramResult run =
        Program({"run", scene, "-o", (folder / ("run_" + name + ".h5")).string(), "--predict",
                 locus, "--set", "time.end=0.02", "--set", "measure.from=0.01"})
            .run();
    EXPECT_EQ(run.exit_code, 0) << run.err;
    return run.err;
  };
  EXPECT_THAT(said_with("same", {}), Not(HasSubstr("warning")));
  EXPECT_THAT(said_with("low", {"--count", "4"}),
              AllOf(HasSubstr("looked up to "), HasSubstr("bursts are sought up to 15000 Hz")));
  EXPECT_THAT(said_with("other", {"--set", "substructures.oblique.thickness=1.4 mm"}),
              HasSubstr("is of another scene"));
}

TEST(Prediction, ARunThatWentOnSaysTheSameOfTheWholeAsOneWithoutAStop) {
  const TemporaryFolder folder;
  const std::string scene = scene_path("beam_on_beam.yaml");
  const std::string locus = (folder / "locus.h5").string();
  const std::string whole = (folder / "whole.h5").string();
  const std::string stopped = (folder / "stopped.h5").string();
  run_json({"locus", scene, "--from", "60 mm", "--to", "76 mm", "--points", "65", "--about",
            "deformed", "-o", locus});
  run_json({"run", scene, "-o", whole, "--predict", locus, "--set", "time.end=1.7"});
  // Early, so that what it says of the part before the stop is other than what there is in all.
  ASSERT_EQ(Program({"run", scene, "-o", stopped, "--predict", locus, "--set", "time.end=1.7",
                     "--max-wall", "0.1"})
                .run()
                .exit_code,
            5);
  run_json({"run", "--resume", stopped, "--predict", locus});
  EXPECT_EQ(dataset(whole, "/windows/burst"), (std::vector<double>{-1.0, 0.0}));
  for (const char* name : {"/windows/from", "/windows/to", "/windows/frequency", "/windows/gain",
                           "/windows/burst", "/bursts/window", "/bursts/start", "/bursts/gain"})
    EXPECT_EQ(dataset(stopped, name), dataset(whole, name)) << name;
}

TEST(Prediction, WhatCannotBeComparedIsRefusedBeforeTheRun) {
  const TemporaryFolder folder;
  const std::string scene = scene_path("beam_on_beam.yaml");
  const std::string locus = (folder / "locus.h5").string();
  const std::string run = (folder / "run.h5").string();
  const auto refusal = [&](const std::string& file, const std::string& set) {
    const ProgramResult result =
        Program({"run", scene, "-o", run, "--predict", file, "--set", set}).run();
    EXPECT_FALSE(std::filesystem::exists(run));
    return std::pair(result.exit_code, result.err);
  };
  run_json({"locus", scene, "--parameter", "contact.friction.coefficient", "--from", "0", "--to",
            "0.3", "--points", "3", "-o", locus});
  const auto [other_key, about_key] = refusal(locus, "time.end=0.1");
  EXPECT_EQ(other_key, 2);
  EXPECT_THAT(about_key, HasSubstr("is a locus over contact.friction.coefficient"));
  const auto [no_band, about_band] = refusal(locus, "measure.band=[]");
  EXPECT_EQ(no_band, 2);
  EXPECT_THAT(about_band, HasSubstr("measure.band"));
  const auto [no_file, about_file] = refusal((folder / "none.h5").string(), "time.end=0.1");
  EXPECT_EQ(no_file, 4);
  EXPECT_THAT(about_file, HasSubstr("none.h5"));
}

}  // namespace
}  // namespace stridor
