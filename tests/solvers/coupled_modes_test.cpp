// Bodies with gyroscopic, circulatory and non-proportional damping terms by their complex modes.
#include "solvers/eigenvalues/coupled_modes.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <random>

#include "solvers/eigenvalues/dense_eigenvalues.hpp"
#include "solvers/eigenvalues/secular_eigenvalues.hpp"
#include "tests/support/pencils.hpp"

namespace stridor {
namespace {

using Complex = std::complex<double>;
using test::ContactTerms;

/// random_pencil() of which two sets of modes, as of two bodies, have gyroscopic terms, damping that
/// is not proportional and circulatory terms.
Pencil coupled_pencil(unsigned seed, Eigen::Index n, Eigen::Index k, ContactTerms terms) {
  const Pencil plain = test::random_pencil(seed, n, k, terms);
  std::mt19937 engine(seed);
  std::normal_distribution<double> normal;
  const Eigen::Index m = plain.num_ports();
  const Eigen::Index q = n / 2;
  Pencil pencil = plain;
  pencil.num_body_ports = q;
  pencil.ports.setZero(m + q, n);
  pencil.ports.topRows(m) = plain.ports;
  pencil.ports.bottomLeftCorner(q, q).setIdentity();
  for (Eigen::MatrixXd* rows : {&pencil.compatibility, &pencil.equilibrium}) {
    rows->conservativeResize(k, m + q);
    rows->rightCols(q).setZero();
  }
  pencil.port_stiffness.setZero(m + q, m + q);
  pencil.port_damping.setZero(m + q, m + q);
  if (plain.port_stiffness.size() > 0)
    pencil.port_stiffness.topLeftCorner(m, m) = plain.port_stiffness;
  if (plain.port_damping.size() > 0) pencil.port_damping.topLeftCorner(m, m) = plain.port_damping;
  const Eigen::Index half = q / 2;
  for (const auto& [first, size] : {std::pair(Eigen::Index{0}, half), std::pair(half, q - half)}) {
    const auto matrix = [&, size = size] {
      return Eigen::MatrixXd(
          Eigen::MatrixXd::NullaryExpr(size, size, [&] { return normal(engine); }));
    };
    const Eigen::MatrixXd gyroscopic = matrix();
    const Eigen::MatrixXd damping = matrix();
    const Eigen::MatrixXd circulatory = matrix();
    pencil.port_damping.block(m + first, m + first, size, size) =
        3.0 * (gyroscopic - gyroscopic.transpose()) + 0.3 * damping * damping.transpose();
    pencil.port_stiffness.block(m + first, m + first, size, size) =
        0.01 * (circulatory - circulatory.transpose());
  }
  return pencil;
}

TEST(CoupledModes, AnswerForcesAsTheirBodiesDo) {
  const Pencil pencil = coupled_pencil(3, 16, 1, ContactTerms::rows_only);
  const auto modes = coupled_modes(pencil);
  ASSERT_TRUE(modes);
  ASSERT_EQ(modes->modes.size(), 8U);
  ASSERT_EQ(modes->poles.size(), 16);
  Pencil bodies = pencil;
  bodies.port_stiffness.topLeftCorner(6, 6).setZero();
  for (const Complex s : {Complex(-0.5, 30.0), Complex(10.0, 0.1), Complex(0.0, 2000.0)}) {
    const Eigen::MatrixXcd whole = test::dynamic_stiffness(bodies, s).inverse();
    const Eigen::MatrixXcd expected = whole(modes->modes, modes->modes);
    const Eigen::VectorXcd poles = (s - modes->poles.array()).inverse();
    const Eigen::MatrixXcd found =
        modes->shapes * poles.asDiagonal() * modes->adjoint.transpose();
    EXPECT_LT((found - expected).norm(), 1e-10 * expected.norm()) << s;
  }
}

TEST(CoupledModes, AreNoneWhereNothingIsCoupledAndNotGivenWhereVectorsAreMissing) {
  const auto none = coupled_modes(test::random_pencil(1, 6, 1, ContactTerms::rows_only));
  ASSERT_TRUE(none);
  EXPECT_EQ(none->num_pairs(), 0);
  // A mode at its critical damping has one vector for two poles.
  Pencil pencil = coupled_pencil(3, 16, 1, ContactTerms::rows_only);
  pencil.omega(0) = 5.0;
  pencil.damping(0) = 0.0;
  pencil.port_stiffness.setZero();
  pencil.port_damping.setZero();
  pencil.port_damping(6, 6) = 10.0;
  EXPECT_FALSE(coupled_modes(pencil));
}

TEST(CoupledModes, GiveTheSecularFunctionTheEigenvaluesOfTheDenseMethod) {
  for (unsigned seed = 0; seed < 18; ++seed) {
    const auto terms = static_cast<ContactTerms>(seed % 3);
    const Pencil pencil = coupled_pencil(seed, 12 + 2 * (seed % 7), 1 + seed % 2, terms);
    SecularFunction function(pencil);
    const SecularSpectrum found = secular_spectrum(function, SpectrumWindow::all());
    EXPECT_TRUE(found.is_complete) << seed;
    std::vector<Eigenvalue> expected = dense_eigenvalues(pencil);
    ASSERT_EQ(found.eigenvalues.size(), expected.size()) << seed;
    for (const Eigenvalue& one : found.eigenvalues) {
      const auto nearest =
          std::min_element(expected.begin(), expected.end(), [&](const auto& a, const auto& b) {
            return std::abs(a.s - one.s) < std::abs(b.s - one.s);
          });
      EXPECT_LT(std::abs(nearest->s - one.s), 1e-8 * std::abs(one.s)) << seed;
      expected.erase(nearest);
    }
  }
}

TEST(CoupledModes, LeaveEigenvectorsAndCountsAsTheyAre) {
  const Pencil pencil = coupled_pencil(5, 60, 1, ContactTerms::with_stiffness);
  for (const Eigenvalue& one : secular_eigenvalues(pencil, SpectrumWindow::lowest(12)))
    EXPECT_LT(one.residual, 1e-9) << one.s;
  SecularFunction function(pencil);
  const std::vector<Eigenvalue> all = dense_eigenvalues(pencil);
  for (const double height : {5.0, 40.0, 300.0, 1500.0}) {
    int expected = 0;
    for (const Eigenvalue& one : all)
      if (SecularFunction::height_of(one.s) < height) expected += one.s.imag() > 0.0 ? 2 : 1;
    const auto counted = function.count_zeros_below(height);
    ASSERT_TRUE(counted);
    EXPECT_EQ(*counted, expected) << height;
  }
}

TEST(CoupledModes, AreFoundAnewWhereTheirTermsChange) {
  Pencil pencil = coupled_pencil(7, 14, 1, ContactTerms::rows_only);
  SecularFunction function(pencil);
  pencil.port_damping *= 1.5;
  function.assign(pencil);
  const auto expected = dense_eigenvalues(pencil);
  const SecularSpectrum found = secular_spectrum(function, SpectrumWindow::all());
  ASSERT_EQ(found.eigenvalues.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) {
    EXPECT_LT(std::abs(found.eigenvalues[i].s - expected[i].s), 1e-8 * std::abs(expected[i].s));
  }
}

}  // namespace
}  // namespace stridor
