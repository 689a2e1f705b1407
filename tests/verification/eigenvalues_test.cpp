// Secular against dense eigenvalues of the main scenes, with all modes.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <random>
#include <vector>

#include "solvers/eigenvalues/dense_eigenvalues.hpp"
#include "solvers/eigenvalues/secular_eigenvalues.hpp"
#include "tests/support/paper_model.hpp"

namespace stridor {
namespace {

TEST(SecularAgainstDense, AgreeAtTwoHundredRandomPositionsAndFrictionValues) {
  const Model models[] = {test::make_paper_model(test::paper_model()),
                          test::make_paper_model(test::paper_model(test::leading_angle))};
  std::mt19937 engine(1);
  std::uniform_real_distribution<double> position(0.0005, 0.0995);
  std::uniform_real_distribution<double> friction(0.0, 2.0);
  double largest = 0.0;
  for (int i = 0; i < 200; ++i) {
    const System& system = models[i % 2].system;
    Pencil pencil = make_modal_pencil(system);
    const double mu = i < 4 ? 0.0 : friction(engine);
    place_undeformed(pencil, system, position(engine) - 0.030, mu, 1.0);
    const bool is_undamped = i / 2 % 2 == 1;
    if (is_undamped) pencil.damping.setZero();

    std::vector<Eigenvalue> dense = dense_eigenvalues(pencil, DenseWork::eigenvalues);
    SecularFunction function(pencil);
    const SecularSpectrum secular = secular_spectrum(function, SpectrumWindow::lowest(40));
    ASSERT_TRUE(secular.is_complete);
    int below = 0;
    for (const Eigenvalue& eigenvalue : dense) {
      if (SecularFunction::height_of(eigenvalue.s) < secular.height)
        below += eigenvalue.s.imag() > 0.0 ? 2 : 1;
      // Without friction nothing grows; the dense method rounds to 1e-16 of 6e6 rad/s.
      if (mu == 0.0) {
        EXPECT_LT(eigenvalue.growth(), is_undamped ? 1e-6 : 0.0);
      }
    }
    EXPECT_EQ(below, secular.num_counted);
    for (const Eigenvalue& eigenvalue : secular.eigenvalues) {
      const auto nearest =
          std::min_element(dense.begin(), dense.end(), [&](const auto& a, const auto& b) {
            return std::abs(a.s - eigenvalue.s) < std::abs(b.s - eigenvalue.s);
          });
      const double difference = std::abs(nearest->s - eigenvalue.s) / std::abs(eigenvalue.s);
      EXPECT_LT(difference, 1e-8) << "at sample " << i << ", " << eigenvalue.frequency() << " Hz";
      largest = std::max(largest, difference);
      dense.erase(nearest);
    }
  }
  std::printf("largest relative difference: %.1e\n", largest);
}

}  // namespace
}  // namespace stridor
