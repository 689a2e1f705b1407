// A brake of meshes whose squeal another finite element program has found, by the program.
#include <gtest/gtest.h>

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

}  // namespace
}  // namespace stridor
