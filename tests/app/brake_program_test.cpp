// A brake of meshes whose squeal another finite element program has found, by the program.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <filesystem>
#include <numbers>
#include <string>
#include <vector>

#include "tests/support/eigenvalue_program.hpp"
#include "tests/support/temporary_folder.hpp"

namespace stridor {
namespace {

namespace fs = std::filesystem;

class BrakeProgram : public testing::Test {
 protected:
  BrakeProgram() {
    // Meshes are kept beside the scene.
    for (const auto& entry : fs::directory_iterator(STRIDOR_SOURCE_DIR "/scenes/examples/brake"))
      if (entry.path().extension() != ".msh")
        fs::copy_file(entry.path(), folder_ / entry.path().filename().string());
  }

  /// Eigenvalues below 9 kHz.
  std::vector<std::complex<double>> eigenvalues(double friction) {
    const test::Json eig =
        test::json_of({"eig", (folder_ / "brake.yaml").string(), "--below", "9kHz", "--set",
                       "parameters.mu=" + std::to_string(friction)});
    std::vector<std::complex<double>> found;
    for (const test::Json& s : eig["eigenvalues"])
      found.emplace_back(s[0].get<double>(), s[1].get<double>());
    return found;
  }

  test::TemporaryFolder folder_;
};

// The other program: 6322.29 Hz, growth 20.40 Hz, by the full unsymmetric problem on a mesh of the
// same size; a near-double mode of the rings at 4149.87 Hz grows by 0.68 Hz. Interfaces that move
// in few modes are stiffer by some tenths of a per cent.
TEST_F(BrakeProgram, OnePairSquealsAsAnotherProgramSays) {
  int num_growing = 0;
  for (const std::complex<double> s : eigenvalues(0.3)) {
    const double frequency = s.imag() / (2.0 * std::numbers::pi);
    const double growth = s.real() / (2.0 * std::numbers::pi);
    if (growth < 2.0) continue;
    ++num_growing;
    EXPECT_NEAR(frequency, 6322.29, 0.003 * 6322.29);
    EXPECT_NEAR(growth, 20.40, 1.5);
  }
  EXPECT_EQ(num_growing, 1);
}

TEST_F(BrakeProgram, NothingGrowsWithoutFriction) {
  const auto found = eigenvalues(0.0);
  EXPECT_GE(found.size(), 30u);
  for (const std::complex<double> s : found) EXPECT_LT(s.real(), 1e-6 * std::abs(s)) << s;
}

// More than 300 modes, whose eigenvalues are followed from value to value.
TEST(HundredsOfModes, ALocusHasTheEigenvaluesOfSingleValues) {
  std::vector<std::string> scene{STRIDOR_SOURCE_DIR "/scenes/examples/meshed_disc.yaml", "--below",
                                 "6kHz"};
  for (const char* modes :
       {"disc.reduction.fixed_interface_modes=150", "upper.reduction.fixed_interface_modes=40",
        "lower.reduction.fixed_interface_modes=40"}) {
    scene.emplace_back("--set");
    scene.push_back(std::string("substructures.") + modes);
  }
  const auto answer = [&](const std::string& verb, const std::vector<std::string>& others) {
    std::vector<std::string> arguments{verb};
    arguments.insert(arguments.end(), scene.begin(), scene.end());
    arguments.insert(arguments.end(), others.begin(), others.end());
    return test::json_of(arguments);
  };
  // A locus in a window leaves out what decays faster than half the highest frequency.
  constexpr double fastest_decay = -0.5 * 2.0 * std::numbers::pi * 6000.0;
  const auto vibrating = [](const test::Json& list) {
    std::vector<std::complex<double>> found;
    for (const test::Json& s : list) {
      if (s[1].get<double>() > 0.0 && s[0].get<double>() > fastest_decay)
        found.emplace_back(s[0].get<double>(), s[1].get<double>());
    }
    return found;
  };
  const test::Json locus = answer("locus", {"--parameter", "parameters.mu", "--from", "0", "--to",
                                            "0.8", "--points", "3", "--count", "100"});
  EXPECT_GE(locus["unverified"].size(), 30u);
  EXPECT_EQ(locus["method"], "followed");
  const std::vector<std::string> values{"0", "0.4", "0.8"};
  for (std::size_t i = 0; i < values.size(); ++i) {
    const auto expected = vibrating(
        answer("eig", {"--set", "parameters.mu=" + values[i], "--method", "dense"})["eigenvalues"]);
    const auto found = vibrating(locus["eigenvalues"][i]);
    ASSERT_EQ(found.size(), expected.size()) << values[i];
    for (std::size_t k = 0; k < found.size(); ++k)
      EXPECT_LT(std::abs(found[k] - expected[k]), 1e-7 * std::abs(expected[k])) << values[i];
  }
  // Where a window begins, the first one grows.
  ASSERT_GE(locus["unstable"].size(), 1u);
  const double begin = locus["unstable"][0]["from"].get<double>();
  EXPECT_GT(begin, 0.1);
  const auto num_growing_at = [&](double mu) {
    const auto found = vibrating(answer("eig", {"--set", "parameters.mu=" + std::to_string(mu),
                                                "--method", "dense"})["eigenvalues"]);
    return std::count_if(found.begin(), found.end(), [](auto s) { return s.real() > 0.0; });
  };
  EXPECT_EQ(num_growing_at(begin - 1e-4), 0);
  EXPECT_EQ(num_growing_at(begin + 1e-4), 1);
}

}  // namespace
}  // namespace stridor
