#include "analysis/explanation.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "solvers/eigenvalues/dense_eigenvalues.hpp"
#include "solvers/eigenvalues/eigenvector.hpp"

namespace stridor {
namespace {

/// A contact with friction between modes at random, with forces that depend on place and velocity.
Pencil random_pencil(unsigned seed) {
  std::mt19937 generator(seed);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  const auto random = [&](Eigen::Index rows, Eigen::Index columns) {
    return Eigen::MatrixXd(Eigen::MatrixXd::NullaryExpr(
        rows, columns, [&](Eigen::Index, Eigen::Index) { return uniform(generator); }));
  };
  constexpr Eigen::Index n = 8;
  constexpr Eigen::Index m = 4;
  Pencil pencil;
  pencil.omega = Eigen::VectorXd::LinSpaced(n, 1.0, 6.0);
  pencil.damping = 0.02 * pencil.omega.array().square();
  pencil.ports = random(m, n);
  pencil.compatibility = random(1, m);
  pencil.equilibrium = pencil.compatibility + 0.2 * random(1, m);
  pencil.port_stiffness = 0.3 * random(m, m);
  pencil.port_damping = 0.05 * random(m, m);
  return pencil;
}

class ExplanationTest : public ::testing::TestWithParam<unsigned> {};

TEST_P(ExplanationTest, QuotientsSatisfyTheScalarEquation) {
  const Pencil pencil = random_pencil(GetParam());
  int num_looked_at = 0;
  for (const Eigenvalue& one : dense_eigenvalues(pencil)) {
    if (one.s.imag() <= 0.0) continue;
    ++num_looked_at;
    const ModeQuotients seen = mode_quotients(pencil, one.s, eigenvector(pencil, one.s).right);
    // Rounding, enlarged by the condition of B_C S S' B_E', which is of order 1 to 100 here.
    EXPECT_LT(seen.residual, 1e-10);
  }
  EXPECT_GT(num_looked_at, 3);
}

TEST_P(ExplanationTest, PowersAddUpToTheGrowth) {
  const Pencil pencil = random_pencil(GetParam());
  for (const Eigenvalue& one : dense_eigenvalues(pencil)) {
    if (one.s.imag() <= 0.0) continue;
    const ModeEnergy energy = mode_energy(pencil, one.s, eigenvector(pencil, one.s));
    EXPECT_LT(energy.residual, 1e-10);
    EXPECT_LT(energy.by_damping, 0.0);
  }
}

TEST_P(ExplanationTest, ContactWithoutFrictionDoesNoWorkAndNothingIsSkew) {
  Pencil pencil = frictionless(random_pencil(GetParam()));
  pencil.damping = 0.02 * pencil.omega.array().square();
  for (const Eigenvalue& one : dense_eigenvalues(pencil)) {
    if (one.s.imag() <= 0.0) continue;
    const Eigenvector vector = eigenvector(pencil, one.s);
    EXPECT_NEAR(mode_energy(pencil, one.s, vector).from_contact, 0.0, 1e-12 * std::abs(one.s));
    const ModeQuotients seen = mode_quotients(pencil, one.s, vector.right);
    EXPECT_NEAR(seen.circulatory, 0.0, 1e-11 * std::norm(one.s));
    EXPECT_NEAR(seen.gyroscopic, 0.0, 1e-11 * std::abs(one.s));
    EXPECT_GT(seen.margin(), 0.0);
  }
}

TEST_P(ExplanationTest, SharesOfAllModesAddUpToOne) {
  const Pencil pencil = random_pencil(GetParam());
  std::vector<Eigenvalue> modes;
  for (const Eigenvalue& one : dense_eigenvalues(frictionless(pencil)))
    if (one.s.imag() > 0.0) modes.push_back(one);
  ASSERT_EQ(modes.size(), 7u);
  for (const Eigenvalue& one : dense_eigenvalues(pencil)) {
    if (one.s.imag() <= 0.0) continue;
    const auto shares = participations(pencil, modes, eigenvector(pencil, one.s).right);
    double sum = 0.0;
    for (const Participation& share : shares) sum += share.share;
    EXPECT_NEAR(sum, 1.0, 1e-9);
    EXPECT_GE(shares[0].share, shares[1].share);
  }
}

/// A contact that gives way is a spring of the system without friction too: the modes near those of
/// a rigid one for a small compliance, and no work of the spring.
TEST_P(ExplanationTest, ContactThatGivesWayKeepsItsSpringWithoutFriction) {
  Pencil rigid = random_pencil(GetParam());
  rigid.port_stiffness.resize(0, 0);
  rigid.port_damping.resize(0, 0);
  Pencil soft = rigid;
  soft.compliance = Eigen::VectorXd::Constant(1, 1e-9);
  std::vector<double> expected, found;
  for (const Eigenvalue& one : dense_eigenvalues(frictionless(rigid)))
    if (one.s.imag() > 0.0) expected.push_back(one.s.imag());
  const Pencil sprung = with_springs(soft);
  for (const Eigenvalue& one : dense_eigenvalues(frictionless(sprung)))
    if (one.s.imag() > 0.0 && one.s.imag() < 100.0) found.push_back(one.s.imag());
  std::ranges::sort(expected);
  std::ranges::sort(found);
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t i = 0; i < found.size(); ++i) EXPECT_NEAR(found[i], expected[i], 1e-6);

  soft.compliance.setConstant(0.1);
  soft.equilibrium = soft.compatibility;
  const Pencil without_friction = with_springs(soft);
  for (const Eigenvalue& one : dense_eigenvalues(without_friction)) {
    if (one.s.imag() <= 0.0) continue;
    const ModeEnergy energy =
        mode_energy(without_friction, one.s, eigenvector(without_friction, one.s));
    EXPECT_NEAR(energy.from_contact, 0.0, 1e-12 * std::abs(one.s));
    EXPECT_LT(energy.residual, 1e-10);
  }
}

INSTANTIATE_TEST_SUITE_P(Seeds, ExplanationTest, ::testing::Values(1u, 2u, 3u));

}  // namespace
}  // namespace stridor
