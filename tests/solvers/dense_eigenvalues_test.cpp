#include "solvers/eigenvalues/dense_eigenvalues.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/errors.hpp"
#include "solvers/eigenvalues/eigenvector.hpp"
#include "solvers/eigenvalues/linear_pencil.hpp"
#include "tests/support/full_model.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/pencils.hpp"

namespace stridor {
namespace {

using test::eps;
using test::message_of;
using ::testing::HasSubstr;
using Complex = std::complex<double>;

TEST(DenseEigenvalues, TwoModesInContactAreOneOscillator) {
  // b_C q = 0 leaves one coordinate: (w1 + w2)(s² + c s) + w1 ω2² + w2 ω1² = 0, w = b_C b_E.
  const double c = 0.3;
  const Eigen::RowVector2d compatibility(1.0, 2.0);
  const Eigen::RowVector2d equilibrium(0.5, -0.1);
  const Pencil pencil = test::constrained_modes(
      Eigen::Vector2d(3.0, 7.0), Eigen::Vector2d::Constant(c), compatibility, equilibrium);
  const double w1 = 0.5;
  const double w2 = -0.2;
  const double square = (w1 * 49.0 + w2 * 9.0) / (w1 + w2);
  const Complex expected(-0.5 * c, std::sqrt(square - 0.25 * c * c));
  const auto found = dense_eigenvalues(pencil);
  ASSERT_EQ(found.size(), 1);
  EXPECT_LT(std::abs(found[0].s - expected), 100 * eps * std::abs(expected));
  EXPECT_LT(found[0].residual, 100 * eps);
}

TEST(DenseEigenvalues, CirculatoryAndGyroscopicPairsHaveTheirClosedForms) {
  // q̈1 + q1 + p q2 = 0, q̈2 + 1.4 q2 − p q1 = 0: s² = −1.2 ± √(0.04 − p²).
  Pencil pencil = test::two_masses({1.0, 1.4}, {0.0, 0.0});
  pencil.port_stiffness = test::circulatory(0.3);
  auto found = dense_eigenvalues(pencil);
  ASSERT_EQ(found.size(), 2);
  // Of equal frequency, so rounding orders them.
  if (found[0].growth() > found[1].growth()) std::swap(found[0], found[1]);
  const Complex root = std::sqrt(Complex(-1.2, std::sqrt(0.05)));
  EXPECT_NEAR(found[0].growth(), -std::abs(root.real()), 100 * eps);
  EXPECT_NEAR(found[1].growth(), 0.1016256896, 1e-10);
  EXPECT_NEAR(found[1].s.imag(), std::abs(root.imag()), 100 * eps);

  pencil.port_stiffness = test::circulatory(0.05);
  pencil.port_damping = test::circulatory(0.1);
  found = dense_eigenvalues(pencil);
  ASSERT_EQ(found.size(), 2);
  EXPECT_NEAR(std::abs(found[0].growth()), 0.0111662740, 1e-10);
  EXPECT_NEAR(found[0].growth() + found[1].growth(), 0.0, 100 * eps);
}

TEST(DenseEigenvalues, ADamperOnHardlyAnyMassDoesNotDrownSlowOnes) {
  // 1e-16 s² ± s + 1 = 0 has the roots ∓1 and ∓1e16, to 1e-16; beside it s² + 0.02 s + 4 = 0.
  for (const double damping : {1.0, -1.0}) {
    LinearSystem system;
    system.mass = Eigen::Vector2d(1e-16, 1.0).asDiagonal();
    system.velocity = Eigen::Vector2d(damping, 0.02).asDiagonal();
    system.position = Eigen::Vector2d(1.0, 4.0).asDiagonal();
    system.gaps = system.forces = Eigen::MatrixXd(0, 2);
    const auto found = dense_eigenvalues(make_pencil(system));
    ASSERT_EQ(found.size(), 3);
    std::vector<double> real{found[0].growth(), found[1].growth()};
    std::sort(real.begin(), real.end(),
              [](double a, double b) { return std::abs(a) < std::abs(b); });
    EXPECT_NEAR(real[0], -damping, 1e-12);
    EXPECT_NEAR(real[1], -1e16 * damping, 1e3);
    EXPECT_LT(std::abs(found[2].s - Complex(-0.01, std::sqrt(4.0 - 1e-4))), 1e-12);
    for (const Eigenvalue& one : found) EXPECT_LT(one.residual, 1e-12);
  }
}

TEST(DenseEigenvalues, EveryPairHasASmallResidual) {
  for (unsigned seed = 0; seed < 10; ++seed) {
    const Pencil pencil =
        test::random_pencil(seed, 25, 2, test::ContactTerms::with_stiffness_and_damping);
    const DenseSpectrum spectrum = dense_spectrum(pencil);
    // Conjugates in pairs: what is not real counts twice.
    int count = 0;
    for (std::size_t i = 0; i < spectrum.eigenvalues.size(); ++i) {
      const Eigenvalue& eigenvalue = spectrum.eigenvalues[i];
      count += eigenvalue.s.imag() > 0.0 ? 2 : 1;
      // The iteration is backward stable in the norm of the matrix, 1000 rad/s; the slowest modes
      // have 1 rad/s.
      EXPECT_LT(eigenvalue.residual, 1e-10);
      EXPECT_EQ(eigenvalue.residual,
                relative_residual(pencil, eigenvalue.s,
                                  spectrum.right.col(static_cast<Eigen::Index>(i))));
    }
    EXPECT_EQ(count, pencil.num_eigenvalues());
  }
}

TEST(DenseEigenvalues, WithoutResidualsTheSame) {
  const Pencil pencil = test::random_pencil(5, 25, 1, test::ContactTerms::with_stiffness);
  const auto with = dense_eigenvalues(pencil);
  const DenseSpectrum without = dense_spectrum(pencil, DenseWork::eigenvalues);
  ASSERT_EQ(with.size(), without.eigenvalues.size());
  EXPECT_EQ(without.right.size(), 0);
  for (std::size_t i = 0; i < with.size(); ++i) {
    EXPECT_LT(std::abs(with[i].s - without.eigenvalues[i].s), 1e-9);
    EXPECT_EQ(without.eigenvalues[i].residual, 0.0);
  }
}

TEST(DenseEigenvalues, SlowModesOfAStiffMeshKeepTheirDigits) {
  // 1 and 6e6 rad/s under one constraint: unscaled, entries of 4e13 would leave the slow pair
  // without a correct digit.
  Eigen::Vector4d omega(1.0, 3.0, 2e6, 6e6);
  const Eigen::RowVector4d row(1.0, 1.0, 0.5, 2.0);
  const Pencil pencil = test::constrained_modes(omega, Eigen::Vector4d::Constant(0.01), row, row);
  const auto found = dense_eigenvalues(pencil);
  // To the slow pair the fast modes are rigid but for 1e-12:
  // 1/(x + 1) + 1/(x + 9) = 0 with x = s² + 0.01 s, so x = −5 and |s|² = 5.
  ASSERT_EQ(found.size(), 3);
  // Absolute error of the order of 6e6 eps = 1.3e-9.
  EXPECT_NEAR(std::abs(found[0].s), std::sqrt(5.0), 1e-8);
  EXPECT_NEAR(found[0].growth(), -0.005, 1e-8);
}

TEST(DenseEigenvalues, ConditionsTellEigenvaluesThatAreAboutToMeet) {
  // 1 and 1.4 N/m with ±p between: two eigenvalues meet at p = 0.2.
  const auto conditions = [](double p) {
    Pencil pencil;
    pencil.omega = Eigen::Vector2d(1.0, std::sqrt(1.4));
    pencil.damping = Eigen::Vector2d::Zero();
    pencil.ports = Eigen::Matrix2d::Identity();
    pencil.compatibility = pencil.equilibrium = Eigen::MatrixXd(0, 2);
    pencil.port_stiffness = Eigen::Matrix2d{{0.0, p}, {-p, 0.0}};
    return dense_spectrum(pencil, DenseWork::conditions).conditions;
  };
  for (const double one : conditions(0.0)) EXPECT_NEAR(one, 1.0, 1e-12);
  // With s² = −1.2 ± (0.04 − p²)^½ the motions differ in proportion to the root.
  const double far = conditions(0.2 - 1e-4).front();
  const double near = conditions(0.2 - 1e-6).front();
  EXPECT_GT(far, 10.0);
  EXPECT_NEAR(near / far, 10.0, 0.1);
}

TEST(DenseEigenvalues, ConditionsNearTheAxisAreThoseOfAllVectors) {
  // Modes with damping but for two, and forces that make their motions differ from the left ones.
  Pencil pencil = test::random_pencil(5, 25, 1, test::ContactTerms::with_stiffness);
  pencil.damping.setConstant(20.0);
  pencil.damping(3) = pencil.damping(11) = 0.0;
  pencil.ports.col(3) *= 1e-5;
  pencil.ports.col(11) *= 1e-5;
  const DenseSpectrum some = dense_spectrum(pencil, DenseWork::near_axis);
  const DenseSpectrum all = dense_spectrum(pencil, DenseWork::conditions);
  ASSERT_EQ(some.conditions.size(), all.conditions.size());
  EXPECT_EQ(some.right.size(), 0);
  EXPECT_NEAR(some.norm, all.norm, 1e-12 * all.norm);
  int num_near = 0;
  for (std::size_t i = 0; i < all.conditions.size(); ++i) {
    const std::complex<double> s = all.eigenvalues[i].s;
    EXPECT_LT(std::abs(some.eigenvalues[i].s - s), 1e-9);
    if (!is_near_axis(s)) {
      EXPECT_TRUE(std::isnan(some.conditions[i]));
      continue;
    }
    ++num_near;
    EXPECT_NEAR(some.conditions[i], all.conditions[i], 1e-6 * all.conditions[i]);
  }
  EXPECT_EQ(num_near, 2);
}

TEST(DenseEigenvalues, SaysWhyItFails) {
  Pencil pencil = test::random_pencil(5, 10, 2, test::ContactTerms::rows_only);
  pencil.compatibility.row(1) = 2.0 * pencil.compatibility.row(0);
  EXPECT_EQ(message_of<NumericalError>([&] { dense_eigenvalues(pencil); }),
            "dense eigenvalues: the 2 rows of B_C have rank 1");
  // b_C · b_E = 0: no contact force answers to an acceleration.
  const Pencil jammed =
      test::constrained_modes(Eigen::Vector3d(1, 2, 3), Eigen::Vector3d::Zero(),
                              Eigen::RowVector3d(1, 1, 0), Eigen::RowVector3d(1, -1, 0));
  EXPECT_THAT(message_of<NumericalError>([&] { dense_eigenvalues(jammed); }),
              HasSubstr("the reduced mass matrix is singular"));
  EXPECT_EQ(message_of<std::invalid_argument>([] { dense_eigenvalues(Pencil{}); }),
            "pencil: 0 constraints leave nothing of 0 modes");
}

}  // namespace
}  // namespace stridor
