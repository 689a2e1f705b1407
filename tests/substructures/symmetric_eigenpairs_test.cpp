#include "substructures/matrices/symmetric_eigenpairs.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <limits>
#include <random>

#include "core/errors.hpp"
#include "tests/support/constants.hpp"
#include "tests/support/message_of.hpp"

namespace stridor {
namespace {

using test::message_of;

using test::eps;

Eigen::MatrixXd random_matrix(Eigen::Index n, unsigned seed) {
  std::mt19937 generator(seed);
  std::normal_distribution<double> normal;
  return Eigen::MatrixXd::NullaryExpr(n, n, [&] { return normal(generator); });
}

/// What an upper triangle that is not looked at may hold.
Eigen::MatrixXd lower_of(const Eigen::MatrixXd& matrix) {
  Eigen::MatrixXd lower = matrix;
  lower.triangularView<Eigen::StrictlyUpper>().setConstant(
      std::numeric_limits<double>::quiet_NaN());
  return lower;
}

// LAPACK's methods are backward stable: residuals are some n eps of the norm.
TEST(SymmetricEigenpairs, SolveTheirEquationAndAscend) {
  for (const Eigen::Index n : {1, 2, 24, 25, 26, 120}) {
    const Eigen::MatrixXd random = random_matrix(n, 7);
    const Eigen::MatrixXd A = random + random.transpose();
    const SymmetricEigenpairs pairs = symmetric_eigenpairs(lower_of(A), "here");
    const Eigen::MatrixXd& X = pairs.vectors;
    const double rounding = 10.0 * static_cast<double>(n) * eps;
    EXPECT_LT((A * X - X * pairs.values.asDiagonal()).norm(), rounding * A.norm());
    EXPECT_LT((X.transpose() * X - Eigen::MatrixXd::Identity(n, n)).norm(), rounding);
    for (Eigen::Index i = 1; i < n; ++i) EXPECT_LE(pairs.values(i - 1), pairs.values(i));
  }
}

// Spectra over eight decades, in pairs that rounding tells apart by little: those of a Krylov space.
TEST(SymmetricEigenpairs, ThoseAtAnEndAreThoseOfAll) {
  for (const Eigen::Index n : {1, 2, 26, 120, 200}) {
    const Eigen::MatrixXd orthogonal =
        Eigen::HouseholderQR<Eigen::MatrixXd>(random_matrix(n, 10)).householderQ();
    Eigen::VectorXd spectrum(n);
    for (Eigen::Index i = 0; i < n; ++i)
      spectrum(i) = std::pow(10.0, -8.0 * static_cast<double>(i / 2) / static_cast<double>(n)) *
                    (1.0 + 1e-9 * static_cast<double>(i % 2));
    const Eigen::MatrixXd A = orthogonal * spectrum.asDiagonal() * orthogonal.transpose();
    const SymmetricEigenpairs all = symmetric_eigenpairs(A, "here");
    for (const Eigen::Index count : {Eigen::Index{0}, Eigen::Index{1}, (n + 2) / 3, n}) {
      for (const bool is_lowest : {true, false}) {
        const SymmetricEigenpairs some = is_lowest ? lowest_eigenpairs(lower_of(A), count, "here")
                                                   : highest_eigenpairs(lower_of(A), count, "here");
        ASSERT_EQ(some.values.size(), count);
        const Eigen::MatrixXd& X = some.vectors;
        const double rounding = 10.0 * static_cast<double>(n) * eps;
        const Eigen::VectorXd expected = is_lowest ? all.values.head(count) : all.values.tail(count);
        EXPECT_LE((some.values - expected).norm(), rounding * A.norm());
        EXPECT_LE((A * X - X * some.values.asDiagonal()).norm(), rounding * A.norm());
        EXPECT_LE((X.transpose() * X - Eigen::MatrixXd::Identity(count, count)).norm(), rounding);
      }
    }
  }
}

TEST(SymmetricEigenpairs, OfTwoMatricesSolveTheirEquationAndAreNormalised) {
  for (const Eigen::Index n : {1, 2, 26, 120}) {
    const Eigen::MatrixXd random = random_matrix(n, 8);
    const Eigen::MatrixXd K = random + random.transpose();
    const Eigen::MatrixXd other = random_matrix(n, 9);
    // At least the identity, at most some 4 n + 1: the condition is below 5 n.
    const Eigen::MatrixXd M = other * other.transpose() + Eigen::MatrixXd::Identity(n, n);
    const SymmetricEigenpairs pairs = generalised_eigenpairs(lower_of(K), lower_of(M), "here");
    const Eigen::MatrixXd& X = pairs.vectors;
    const double rounding = 50.0 * static_cast<double>(n * n) * eps;
    EXPECT_LT((K * X - M * X * pairs.values.asDiagonal()).norm(), rounding * K.norm());
    EXPECT_LT((X.transpose() * M * X - Eigen::MatrixXd::Identity(n, n)).norm(), rounding);
    for (Eigen::Index i = 1; i < n; ++i) EXPECT_LE(pairs.values(i - 1), pairs.values(i));
  }
}

TEST(SymmetricEigenpairs, OfNothingAreNone) {
  EXPECT_EQ(symmetric_eigenpairs(Eigen::MatrixXd(0, 0), "here").values.size(), 0);
  EXPECT_EQ(
      generalised_eigenpairs(Eigen::MatrixXd(0, 0), Eigen::MatrixXd(0, 0), "here").values.size(),
      0);
}

TEST(SymmetricEigenpairs, WhatIsNotFiniteOrNotPositiveDefiniteThrows) {
  const Eigen::MatrixXd unit = Eigen::MatrixXd::Identity(3, 3);
  Eigen::MatrixXd wrong = unit;
  wrong(2, 0) = std::numeric_limits<double>::infinity();
  EXPECT_EQ(message_of<NumericalError>([&] { symmetric_eigenpairs(wrong, "here"); }),
            "here: the eigenproblem of 3 unknowns is not finite");
  EXPECT_EQ(message_of<NumericalError>([&] { lowest_eigenpairs(wrong, 2, "here"); }),
            "here: the eigenproblem of 3 unknowns is not finite");
  EXPECT_EQ(message_of<NumericalError>([&] { generalised_eigenpairs(wrong, unit, "here"); }),
            "here: the eigenproblem of 3 unknowns is not finite");
  EXPECT_EQ(message_of<NumericalError>([&] { generalised_eigenpairs(unit, wrong, "here"); }),
            "here: the mass is not positive definite");
  EXPECT_EQ(message_of<NumericalError>([&] { generalised_eigenpairs(unit, -unit, "here"); }),
            "here: the mass is not positive definite");
}

}  // namespace
}  // namespace stridor
