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
}

INSTANTIATE_TEST_SUITE_P(Scenes, PredictionTest,
                         ::testing::Values(Case{"beam_on_beam.yaml", "0.3"},
                                           Case{"beam_on_beam_leading.yaml", "0.3"},
                                           Case{"beam_on_beam.yaml", "0.26"},
                                           Case{"beam_on_beam_leading.yaml", "0.34"}));

}  // namespace
}  // namespace stridor
