#include "solvers/eigenvalues/complex_eigenpairs.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <complex>
#include <random>
#include <vector>

namespace stridor {
namespace {

using Complex = std::complex<double>;

TEST(ComplexEigenpairs, SatisfyTheirEquationAndAreOfUnitLength) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  const Eigen::Index n = 40;
  const Eigen::MatrixXcd A =
      Eigen::MatrixXcd::NullaryExpr(n, n, [&] { return Complex(normal(random), normal(random)); });
  const ComplexEigenpairs pairs = complex_eigenpairs(A);
  const Eigen::MatrixXcd rest = A * pairs.vectors - pairs.vectors * pairs.values.asDiagonal();
  EXPECT_LT(rest.norm(), 1e-13 * static_cast<double>(n) * A.norm());
  for (Eigen::Index i = 0; i < n; ++i) EXPECT_NEAR(pairs.vectors.col(i).norm(), 1.0, 1e-13);
  EXPECT_NEAR(std::abs(pairs.values.sum() - A.trace()), 0.0, 1e-12 * A.norm());
}

TEST(ComplexEigenpairs, ThoseOfATriangleAreItsDiagonal) {
  Eigen::MatrixXcd A(3, 3);
  A << Complex(1, 2), 5.0, Complex(0, 7), 0.0, Complex(-3, 0.5), 1e3, 0.0, 0.0, Complex(0, -1e-6);
  const ComplexEigenpairs pairs = complex_eigenpairs(A);
  for (Eigen::Index k = 0; k < 3; ++k) {
    const Eigen::VectorXd off = (pairs.values.array() - A(k, k)).abs();
    EXPECT_LT(off.minCoeff(), 1e-12);
  }
}

TEST(ComplexEigenpairs, NoneOfNothing) {
  EXPECT_EQ(complex_eigenpairs(Eigen::MatrixXcd(0, 0)).values.size(), 0);
}

}  // namespace
}  // namespace stridor
