// Extrapolation of sweeps: linear iterations end after as many sweeps as they have unknowns.
#include "solvers/contact/sweep_acceleration.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <random>

namespace stridor {
namespace {

/// g(x) = A x + b with a random A of a given norm.
struct LinearSweep {
  Eigen::MatrixXd matrix;
  Eigen::VectorXd offset;

  LinearSweep(Eigen::Index size, double norm, unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> unit(-1.0, 1.0);
    matrix = Eigen::MatrixXd::NullaryExpr(size, size, [&] { return unit(random); });
    matrix *= norm / matrix.norm();
    offset = Eigen::VectorXd::NullaryExpr(size, [&] { return unit(random); });
  }
  Eigen::VectorXd operator()(const Eigen::VectorXd& x) const { return matrix * x + offset; }
  Eigen::VectorXd solution() const {
    const Eigen::Index size = offset.size();
    return (Eigen::MatrixXd::Identity(size, size) - matrix).partialPivLu().solve(offset);
  }
};

/// Error relative to the solution after a number of sweeps.
double error_after(int num_sweeps, const LinearSweep& sweep, SweepAcceleration& acceleration) {
  Eigen::VectorXd x = Eigen::VectorXd::Zero(sweep.offset.size());
  for (int k = 0; k < num_sweeps; ++k) {
    const Eigen::VectorXd g = sweep(x);
    x = acceleration.add(x, g) ? acceleration.next() : g;
  }
  return (x - sweep.solution()).norm() / sweep.solution().norm();
}

TEST(SweepAcceleration, ALinearIterationEndsAfterItsNumberOfUnknowns) {
  for (Eigen::Index size = 1; size <= SweepAcceleration::depth; ++size) {
    // Twice with the same object: what it knew of the first is forgotten.
    SweepAcceleration acceleration(size);
    for (const unsigned seed : {1u, 2u}) {
      const LinearSweep sweep(size, 0.9, seed);
      acceleration.forget();
      // One sweep for each direction, and one from which they are seen.
      EXPECT_LT(error_after(static_cast<int>(size) + 1, sweep, acceleration), 1e-9) << size;
    }
  }
}

TEST(SweepAcceleration, TakesWhatGrowsByItself) {
  const LinearSweep sweep(4, 5.0, 7);
  ASSERT_GT(sweep.matrix.eigenvalues().cwiseAbs().maxCoeff(), 1.0);
  SweepAcceleration acceleration(4);
  EXPECT_LT(error_after(6, sweep, acceleration), 1e-9);
}

TEST(SweepAcceleration, IsFasterThanSweepsOnMoreUnknownsThanItKeeps) {
  // Nearly singular along one direction, as contacts of a stiff body are.
  constexpr Eigen::Index size = 40;
  LinearSweep sweep(size, 0.5, 11);
  sweep.matrix.row(0).setZero();
  sweep.matrix.col(0).setZero();
  sweep.matrix(0, 0) = 0.99;
  constexpr int num_sweeps = 25;
  Eigen::VectorXd plain = Eigen::VectorXd::Zero(size);
  for (int k = 0; k < num_sweeps; ++k) plain = sweep(plain);
  const double left = (plain - sweep.solution()).norm() / sweep.solution().norm();
  SweepAcceleration acceleration(size);
  EXPECT_GT(left, 0.1);
  EXPECT_LT(error_after(num_sweeps, sweep, acceleration), 1e-8);
}

TEST(SweepAcceleration, OneSweepAndOneThatChangesNothingExtrapolateNothing) {
  SweepAcceleration acceleration(2);
  const Eigen::VectorXd x = Eigen::Vector2d(1.0, 2.0);
  EXPECT_FALSE(acceleration.add(x, x));
  EXPECT_FALSE(acceleration.add(x, x));
  EXPECT_EQ(acceleration.next(), x);
}

}  // namespace
}  // namespace stridor
