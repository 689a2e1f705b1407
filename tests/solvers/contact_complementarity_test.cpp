#include "solvers/half_space/contact_complementarity.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <vector>

#include "tests/support/message_of.hpp"

namespace stridor {
namespace {

using test::message_of;
using ::testing::HasSubstr;

/// Lemke's complementary pivoting for w = M z + q, w ≥ 0, z ≥ 0, w z = 0.
std::optional<Eigen::VectorXd> lemke(const Eigen::MatrixXd& m, const Eigen::VectorXd& q) {
  const Eigen::Index n = q.size();
  if (q.minCoeff() >= 0.0) return Eigen::VectorXd::Zero(n);
  // Columns: w (0 … n − 1), z (n … 2n − 1), the artificial variable 2n, the right-hand side.
  Eigen::MatrixXd tableau(n, 2 * n + 2);
  tableau << Eigen::MatrixXd::Identity(n, n), -m, Eigen::VectorXd::Constant(n, -1.0), q;
  std::vector<Eigen::Index> basis(static_cast<std::size_t>(n));
  for (Eigen::Index i = 0; i < n; ++i) basis[static_cast<std::size_t>(i)] = i;
  const auto pivot = [&](Eigen::Index row, Eigen::Index column) {
    tableau.row(row) /= tableau(row, column);
    for (Eigen::Index i = 0; i < n; ++i) {
      if (i == row) continue;
      const double factor = tableau(i, column);
      tableau.row(i) -= factor * tableau.row(row);
    }
    const Eigen::Index left = basis[static_cast<std::size_t>(row)];
    basis[static_cast<std::size_t>(row)] = column;
    return left;
  };
  Eigen::Index row = 0;
  q.minCoeff(&row);
  Eigen::Index left = pivot(row, 2 * n);
  for (int step = 0; step < 20 * static_cast<int>(n); ++step) {
    const Eigen::Index entering = left < n ? left + n : left - n;
    Eigen::Index leaving = -1;
    double smallest = std::numeric_limits<double>::infinity();
    for (Eigen::Index i = 0; i < n; ++i) {
      if (tableau(i, entering) <= 1e-12) continue;
      const double ratio = tableau(i, 2 * n + 1) / tableau(i, entering);
      if (ratio < smallest) {
        smallest = ratio;
        leaving = i;
      }
    }
    if (leaving < 0) return {};
    left = pivot(leaving, entering);
    if (left == 2 * n) {
      Eigen::VectorXd z = Eigen::VectorXd::Zero(n);
      for (Eigen::Index i = 0; i < n; ++i) {
        const Eigen::Index variable = basis[static_cast<std::size_t>(i)];
        if (variable >= n) z[variable - n] = tableau(i, 2 * n + 1);
      }
      return z;
    }
  }
  return {};
}

/// A paraboloid of contact radius 1 and indentation 1 in a window of half-width 1.1.
struct Problem {
  explicit Problem(std::size_t n, std::vector<SlidingCreep> with_creep = {})
      : half_space(n), creep(std::move(with_creep)), side(2.2 / static_cast<double>(n)) {
    half_space.set_creep(creep, side);
    for (std::size_t j = 0; j < n / 2; ++j) {
      for (std::size_t i = 0; i < n; ++i) {
        const double x = (static_cast<double>(i) + 0.5) * side - 1.1;
        const double y = (static_cast<double>(j) + 0.5) * side;
        target.push_back(std::numbers::pi / side * (1.0 - 0.5 * (x * x + y * y)));
      }
    }
  }
  HalfSpaceConvolution half_space;
  std::vector<SlidingCreep> creep;
  double side;
  std::vector<double> target;
};

std::vector<double> flat_start(const Problem& problem) {
  std::vector<double> pressure;
  for (const double h : problem.target) pressure.push_back(std::max(0.0, h) * 0.01);
  return pressure;
}

TEST(ContactComplementarity, AgreesWithLemkeOnADenseMatrix) {
  constexpr int n = 16;
  for (const double length : {0.0, 0.3, 1.0, 30.0}) {
    Problem problem(n, {{0.9, length}});
    const InfluenceTable table = problem.half_space.influence().table(problem.creep, problem.side);
    constexpr int size = n * n / 2;
    Eigen::MatrixXd dense(size, size);
    for (int row = 0; row < size; ++row) {
      for (int column = 0; column < size; ++column) {
        const int di = row % n - column % n;
        dense(row, column) =
            table.at(di, row / n - column / n) + table.at(di, row / n + column / n + 1);
      }
    }
    const Eigen::Map<const Eigen::VectorXd> target(problem.target.data(), size);
    const std::optional<Eigen::VectorXd> expected = lemke(dense, -target);
    ASSERT_TRUE(expected);
    std::vector<double> pressure = flat_start(problem);
    ContactComplementarity solver(problem.half_space);
    const ComplementarityOutcome outcome = solver.solve(problem.target, {1e-12, 100, 60}, pressure);
    ASSERT_TRUE(outcome.converged) << length;
    const Eigen::Map<const Eigen::VectorXd> found(pressure.data(), size);
    EXPECT_LT((found - *expected).cwiseAbs().maxCoeff(), 1e-8 * expected->maxCoeff()) << length;
  }
}

TEST(ContactComplementarity, SolutionIsComplementary) {
  Problem problem(32, {{0.9, 0.5}});
  std::vector<double> pressure = flat_start(problem);
  ContactComplementarity solver(problem.half_space);
  const double tolerance = 1e-9;
  const ComplementarityOutcome outcome =
      solver.solve(problem.target, {tolerance, 100, 60}, pressure);
  ASSERT_TRUE(outcome.converged);
  EXPECT_LE(outcome.residual, tolerance);
  EXPECT_GT(outcome.products, outcome.rounds);
  const double largest = problem.target[0] * 2.0;
  for (std::size_t k = 0; k < pressure.size(); ++k) {
    EXPECT_GE(pressure[k], 0.0);
    if (pressure[k] == 0.0) {
      EXPECT_GE(solver.displacement()[k] - problem.target[k], -tolerance * largest);
    }
  }
}

TEST(ContactComplementarity, DoesNotDependOnTheStart) {
  Problem problem(32, {{0.9, 1.0}});
  ContactComplementarity solver(problem.half_space);
  const ComplementarityLimits limits{1e-11, 100, 60};
  std::vector<double> a = flat_start(problem);
  ASSERT_TRUE(solver.solve(problem.target, limits, a).converged);
  std::vector<double> b(a.size(), 0.0);
  ASSERT_TRUE(solver.solve(problem.target, limits, b).converged);
  // The residual of 1e-11 of the target, times the condition of K on the contact, about N.
  const double largest = *std::max_element(a.begin(), a.end());
  for (std::size_t k = 0; k < a.size(); ++k) EXPECT_NEAR(a[k], b[k], 1e-8 * largest);
}

TEST(ContactComplementarity, NumberOfTransformsHardlyDependsOnSpeedAndGrid) {
  // Purpose of the approximate inverse. With the transform of K itself in its place, β = 1 takes
  // ten times as many.
  for (const std::size_t n : {32, 64}) {
    for (const double length : {0.0, 0.1, 1.0, 10.0, 1000.0}) {
      Problem problem(n, {{0.9, length}});
      std::vector<double> pressure = flat_start(problem);
      ContactComplementarity solver(problem.half_space);
      const ComplementarityOutcome outcome =
          solver.solve(problem.target, {1e-7, 100, 60}, pressure);
      EXPECT_TRUE(outcome.converged);
      EXPECT_LT(outcome.products, 200u) << n << ' ' << length;
    }
  }
}

TEST(ContactComplementarity, NothingInReachMeansNoPressure) {
  Problem problem(16);
  for (double& h : problem.target) h -= 1000.0;
  std::vector<double> pressure = flat_start(problem);
  pressure[4] = 1.0;
  ContactComplementarity solver(problem.half_space);
  EXPECT_TRUE(solver.solve(problem.target, {}, pressure).converged);
  EXPECT_EQ(*std::max_element(pressure.begin(), pressure.end()), 0.0);
}

TEST(ContactComplementarity, SaysWhenItDidNotConverge) {
  Problem problem(32);
  std::vector<double> pressure = flat_start(problem);
  ContactComplementarity solver(problem.half_space);
  const ComplementarityOutcome outcome = solver.solve(problem.target, {1e-9, 2, 60}, pressure);
  EXPECT_FALSE(outcome.converged);
  EXPECT_EQ(outcome.rounds, 2u);
  EXPECT_GT(outcome.residual, 1e-9);
}

TEST(ContactComplementarity, RefusesWrongSizesAndLimits) {
  Problem problem(16);
  ContactComplementarity solver(problem.half_space);
  std::vector<double> pressure = flat_start(problem);
  std::vector<double> few(3);
  EXPECT_THAT(
      message_of<std::invalid_argument>([&] { (void)solver.solve(problem.target, {}, few); }),
      HasSubstr("128 targets and 3 pressures for 128 cells"));
  EXPECT_THAT(message_of<std::invalid_argument>([&] {
                (void)solver.solve(problem.target, {0.0, 1, 1}, pressure);
              }),
              HasSubstr("a limit is not > 0"));
}

}  // namespace
}  // namespace stridor
