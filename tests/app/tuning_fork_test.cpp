// A part in space that gmsh meshes from a script, from its mesh to its sound.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <numbers>
#include <string>
#include <vector>

#include "tests/support/constants.hpp"
#include "tests/support/program.hpp"

namespace stridor {
namespace {

namespace fs = std::filesystem;
using namespace test;
using Json = nlohmann::json;

/// The scene in a folder of its own, where the mesh of gmsh comes to stand beside the script.
class TuningFork : public ::testing::Test {
 protected:
  TuningFork() {
    const fs::path from = fs::path(scene_path("examples"));
    fs::copy(from / "tuning_fork.yaml", folder_ / "tuning_fork.yaml");
    fs::create_directory(folder_ / "tuning_fork");
    fs::copy(from / "tuning_fork" / "fork.geo", folder_ / "tuning_fork" / "fork.geo");
  }

  /// Frequencies, Hz, and growth rates, 1/s, of the modes that oscillate.
  std::vector<std::pair<double, double>> modes(const std::vector<std::string>& sets) const {
    std::vector<std::string> arguments{"eig", (folder_ / "tuning_fork.yaml").string(), "--json",
                                       "--count", "4"};
    for (const std::string& set : sets) arguments.insert(arguments.end(), {"--set", set});
    const ProgramResult result = Program(arguments).run();
    EXPECT_EQ(result.exit_code, 0) << result.err;
    const Json object = Json::parse(result.out);
    std::vector<std::pair<double, double>> found;
    for (const Json& pair : object["eigenvalues"])
      if (pair[1].get<double>() > 0.0)
        found.emplace_back(pair[1].get<double>() / two_pi, pair[0].get<double>());
    return found;
  }

  TemporaryFolder folder_;
};

TEST_F(TuningFork, SoundsBelowAClampedTineAndConvergesWithItsMesh) {
  const std::vector<std::string> no_friction{"parameters.mu_s=0", "parameters.mu_d=0"};
  std::vector<std::string> fine = no_friction;
  fine.emplace_back("substructures.fork.mesh_size=1.5e-3");
  const auto coarse_modes = modes(no_friction), fine_modes = modes(fine);
  // A slender beam, clamped and free: 1.8751²/(2π L²) √(E I/(ρ A)).
  const double clamped = std::pow(1.87510407, 2) / (two_pi * 0.09 * 0.09) * 4e-3 / std::sqrt(12.0) *
                         std::sqrt(206e9 / 7850.0);
  // Across, with each other, against each other: in this last one the yoke keeps nearly still.
  ASSERT_GE(coarse_modes.size(), 3u);
  EXPECT_LT(fine_modes[2].first, clamped);
  EXPECT_GT(fine_modes[2].first, 0.93 * clamped);
  EXPECT_LT(fine_modes[1].first, 0.93 * clamped);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_NEAR(coarse_modes[i].first, fine_modes[i].first, 6e-3 * fine_modes[i].first);
    EXPECT_LT(coarse_modes[i].second, 0.0);
  }
}

TEST_F(TuningFork, TheBowFeedsBothModesOfTheTines) {
  const auto bowed = modes({});
  ASSERT_GE(bowed.size(), 3u);
  EXPECT_LT(bowed[0].second, 0.0);
  EXPECT_GT(bowed[1].second, 50.0);
  EXPECT_GT(bowed[2].second, 20.0);
  // On a slower bow friction falls more steeply: -(mu_s - mu_d)/v_d exp(-v/v_d).
  const auto slower = modes({"parameters.v=0.05"});
  EXPECT_NEAR((slower[1].second + slower[2].second + 14.0) / (bowed[1].second + bowed[2].second + 14.0),
              std::exp(0.05 / 0.2), 0.02);
}

}  // namespace
}  // namespace stridor
