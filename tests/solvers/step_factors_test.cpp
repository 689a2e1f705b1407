// Factors of a frozen step from its characteristic function, against those of its matrix.
#include "solvers/integrators/step_factors.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <random>

#include "solvers/eigenvalues/dense_eigenvalues.hpp"
#include "solvers/integrators/two_step_scheme.hpp"

namespace stridor {
namespace {

using Complex = std::complex<double>;

/// n modes from 1 to 300 rad/s with some overdamped, k contacts with friction; a body that has
/// truncated modes where forces have direct feedthrough.
FrozenModes random_modes(unsigned seed, bool is_exact) {
  std::mt19937 engine(seed);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform;
  const Eigen::Index n = 8 + engine() % 40;
  const Eigen::Index k = 1 + engine() % 3;
  const auto matrix = [&](Eigen::Index rows, Eigen::Index columns) {
    return Eigen::MatrixXd(
        Eigen::MatrixXd::NullaryExpr(rows, columns, [&] { return normal(engine); }));
  };
  const double step = is_exact ? 0.02 : 0.004;
  FrozenModes modes;
  modes.keep.resize(n);
  modes.pull.resize(n);
  modes.gain.resize(n);
  modes.feedthrough.resize(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const double omega = std::pow(300.0, uniform(engine));
    const double damping = (engine() % 8 == 0 ? 2.5 : 0.05 * uniform(engine)) * omega;
    const StepCoefficients c = is_exact ? exact_propagation(omega, damping, step, 0.2)
                                        : central_difference(omega, 0.1 * damping, step);
    modes.keep(i) = c.keep;
    modes.pull(i) = c.pull;
    modes.gain(i) = c.gain;
    modes.feedthrough(i) = c.feedthrough;
  }
  modes.gaps = matrix(k, n);
  modes.forces = modes.gaps + 0.2 * matrix(k, n);
  modes.is_instantaneous = is_exact;
  if (is_exact) {
    const Eigen::MatrixXd rows = matrix(k, k);
    modes.left_out.push_back({1e-5 * rows * rows.transpose(), 0.7});
  }
  return modes;
}

/// The step as a matrix of (r, d) and the forces that lag (docs/theory.md, 3.7).
Eigen::MatrixXd matrix_of(const FrozenModes& modes) {
  const Eigen::Index n = modes.keep.size();
  const Eigen::Index k = modes.gaps.rows();
  const Eigen::Index size = 2 * n + k * static_cast<Eigen::Index>(modes.left_out.size());
  Eigen::MatrixXd free = Eigen::MatrixXd::Zero(size, size);
  const Eigen::VectorXd both = 1.0 - modes.pull.array();
  free.topLeftCorner(n, n) = both.asDiagonal();
  free.block(0, n, n, n) = modes.keep.asDiagonal();
  free.block(n, 0, n, n) = (-modes.pull).asDiagonal();
  free.block(n, n, n, n) = modes.keep.asDiagonal();
  Eigen::MatrixXd closed = modes.gaps *
                           (modes.is_instantaneous ? modes.feedthrough : modes.gain).asDiagonal() *
                           modes.forces.transpose();
  Eigen::MatrixXd force = Eigen::MatrixXd::Zero(k, size);
  if (modes.is_instantaneous) {
    force.leftCols(n) = modes.gaps;
  } else {
    force = modes.gaps * free.topRows(n);
  }
  for (std::size_t b = 0; b < modes.left_out.size(); ++b) {
    closed += modes.left_out[b].share * modes.left_out[b].closed;
    force.middleCols(2 * n + k * static_cast<Eigen::Index>(b), k) =
        (modes.left_out[b].share - 1.0) * modes.left_out[b].closed;
  }
  force = closed.partialPivLu().solve(force).eval();
  Eigen::MatrixXd map = free;
  const Eigen::MatrixXd pushed = modes.gain.asDiagonal() * modes.forces.transpose() * force;
  map.topRows(n) -= pushed;
  map.middleRows(n, n) -= pushed;
  for (std::size_t b = 0; b < modes.left_out.size(); ++b) {
    const Eigen::Index first = 2 * n + k * static_cast<Eigen::Index>(b);
    map.middleRows(first, k) = modes.left_out[b].share * force;
    map.block(first, first, k, k).diagonal().array() += 1.0 - modes.left_out[b].share;
  }
  return map;
}

TEST(StepFactors, AreTheEigenvaluesOfTheStep) {
  int found = 0;
  for (unsigned seed = 0; seed < 60; ++seed) {
    const FrozenModes modes = random_modes(seed, seed % 2 == 0);
    const Eigen::MatrixXd map = matrix_of(modes);
    const auto factors = step_factors(modes);
    std::vector<Complex> expected = matrix_eigenvalues(map);
    if (!factors) continue;
    ++found;
    ASSERT_EQ(factors->size(), expected.size()) << seed;
    for (const Complex z : *factors) {
      const auto nearest = std::min_element(
          expected.begin(), expected.end(),
          [&](Complex a, Complex b) { return std::abs(a - z) < std::abs(b - z); });
      // Dense gaps' factors form Jordan blocks at 0, which rounding scatters.
      if (std::abs(z) > 1e-4) {
        EXPECT_LT(std::abs(*nearest - z), 1e-7) << seed << ' ' << z;
      }
      expected.erase(nearest);
    }
  }
  EXPECT_GE(found, 54);
}

}  // namespace
}  // namespace stridor
