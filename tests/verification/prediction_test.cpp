// The locus about the deformed sliding equilibrium says which bursts a transient shows.
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "tests/support/program.hpp"

namespace stridor {
namespace {

using namespace test;
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

class PredictionTest : public ::testing::TestWithParam<Case> {};

TEST_P(PredictionTest, EveryBurstHasItsWindow) {
  const TemporaryFolder folder;
  const std::string scene = scene_path(GetParam().scene);
  const std::string run = (folder / "run.h5").string();
  const std::string locus = (folder / "locus.h5").string();
  const std::string friction = std::string("contact.friction.coefficient=") + GetParam().friction;
  run_json({"run", scene, "-o", run, "--set", friction});
  run_json({"locus", scene, "--from", "30 mm", "--to", "97.5 mm", "--points", "271", "--about",
            "deformed", "-o", locus, "--set", friction});
  const Json picture =
      run_json({"spectrogram", run, "-o", (folder / "figure.png").string(), "--predict", locus});
  ASSERT_EQ(picture["bursts"], 3);
  std::vector<bool> is_predicted(3, false);
  for (const Json& row : picture["prediction"]) {
    if (row["burst"].is_null()) {
      // A window without a burst: too weak to rise out of the quiet by a factor of four, or near
      // 10.6 kHz, where the band holds stronger bursts of 3.5 kHz at the same time.
      EXPECT_TRUE(row["gain"].get<double>() < std::log(4.0) || row["frequency"].get<double>() > 1e4)
          << row;
      continue;
    }
    is_predicted.at(row["burst"].get<std::size_t>() - 1) = true;
    EXPECT_NEAR(row["burst_start"].get<double>(), row["from"].get<double>(), 0.05) << row;
    EXPECT_NEAR(row["burst_frequency"].get<double>(), row["frequency"].get<double>(),
                0.02 * row["frequency"].get<double>());
    EXPECT_NEAR(row["burst_gain"].get<double>(), row["gain"].get<double>(),
                gain_tolerance * row["gain"].get<double>())
        << row;
  }
  EXPECT_EQ(is_predicted, std::vector<bool>(3, true));
}

INSTANTIATE_TEST_SUITE_P(Scenes, PredictionTest,
                         ::testing::Values(Case{"beam_on_beam.yaml", "0.3"},
                                           Case{"beam_on_beam_leading.yaml", "0.3"},
                                           Case{"beam_on_beam.yaml", "0.26"},
                                           Case{"beam_on_beam_leading.yaml", "0.34"}));

TEST(Prediction, TheBurstThatAStrongerOneHidesIsFoundInItsOwnBand) {
  // The window of 10.57 kHz at 93.5 mm opens as the third one of 3.52 kHz does.
  const TemporaryFolder folder;
  const std::string scene = scene_path("beam_on_beam.yaml");
  const std::string run = (folder / "run.h5").string();
  const std::string locus = (folder / "locus.h5").string();
  run_json({"run", scene, "-o", run});
  run_json({"locus", scene, "--from", "90 mm", "--to", "97.5 mm", "--points", "31", "--about",
            "deformed", "-o", locus});
  const Json picture = run_json({"spectrogram", run, "-o", (folder / "figure.png").string(),
                                 "--predict", locus, "--band", "8 kHz,13 kHz"});
  ASSERT_EQ(picture["bursts"], 1);
  int num_found = 0;
  for (const Json& row : picture["prediction"]) {
    if (row["burst"].is_null()) continue;
    ++num_found;
    EXPECT_NEAR(row["burst_frequency"].get<double>(), 10570.0, 0.02 * 10570.0);
    EXPECT_NEAR(row["burst_gain"].get<double>(), row["gain"].get<double>(),
                gain_tolerance * row["gain"].get<double>());
  }
  EXPECT_EQ(num_found, 1);
  const Json bursts = run_json({"info", run, "--band", "8 kHz,13 kHz"})["bursts"];
  // s = 30 mm + 30 mm/s (t - 0.05 s): the window opens near 91 mm.
  EXPECT_NEAR(bursts[0]["start"].get<double>(), 2.086, 0.02);
}

}  // namespace
}  // namespace stridor
