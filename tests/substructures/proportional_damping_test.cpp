#include "substructures/reduction/proportional_damping.hpp"

#include <gtest/gtest.h>

#include "tests/support/paper_beams.hpp"

namespace stridor {
namespace {

BodyMatrices beam() {
  BeamParameters parameters = test::paper_cantilever();
  parameters.mesh.along = 20;
  return make_beam(parameters);
}

SparseMatrix damping_of(const BodyMatrices& body, double alpha, double beta) {
  return alpha * body.mass + beta * body.stiffness;
}

TEST(ProportionalDamping, IsFoundInTheEntriesOfAMesh) {
  const BodyMatrices body = beam();
  const auto found =
      proportional_damping(damping_of(body, 5.0, 1e-7), body.mass, body.stiffness);
  ASSERT_TRUE(found);
  // Accuracy that rounding of C leaves to α, which is a small part of it.
  EXPECT_NEAR(found->alpha, 5.0, 1e-14 * 1e-7 * body.stiffness.norm() / body.mass.norm());
  EXPECT_NEAR(found->beta, 1e-7, 1e-20);
  EXPECT_FALSE(found->alpha_start);
}

TEST(ProportionalDamping, MayBeOfOneKindOrNone) {
  const BodyMatrices body = beam();
  const auto by_stiffness =
      proportional_damping(damping_of(body, 0.0, 1e-7), body.mass, body.stiffness);
  ASSERT_TRUE(by_stiffness);
  EXPECT_EQ(by_stiffness->alpha, 0.0);
  const auto by_mass =
      proportional_damping(damping_of(body, 3.0, 0.0), body.mass, body.stiffness);
  ASSERT_TRUE(by_mass);
  EXPECT_NEAR(by_mass->alpha, 3.0, 1e-12);
  EXPECT_EQ(by_mass->beta, 0.0);
  const auto none = proportional_damping(damping_of(body, 0.0, 0.0), body.mass, body.stiffness);
  ASSERT_TRUE(none);
  EXPECT_EQ(none->alpha, 0.0);
  EXPECT_EQ(none->beta, 0.0);
}

TEST(ProportionalDamping, IsFoundWhereStiffnessIsAMultipleOfMass) {
  const BodyMatrices body = beam();
  const SparseMatrix stiffness = 100.0 * body.mass;
  const auto found = proportional_damping(2.0 * body.mass, body.mass, stiffness);
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->alpha + 100.0 * found->beta, 2.0, 1e-12);
}

TEST(ProportionalDamping, IsNotADashpotAGyroscopicTermOrAGain) {
  const BodyMatrices body = beam();
  const auto is_proportional = [&](const SparseMatrix& velocity) {
    return proportional_damping(velocity, body.mass, body.stiffness).has_value();
  };
  const SparseMatrix damping = damping_of(body, 5.0, 1e-7);
  SparseMatrix changed = damping;
  changed.coeffRef(3, 3) += 1e-9 * damping.norm();
  EXPECT_FALSE(is_proportional(changed));
  changed = damping;
  changed.coeffRef(3, 4) += 1e-9 * damping.norm();
  changed.coeffRef(4, 3) -= 1e-9 * damping.norm();
  EXPECT_FALSE(is_proportional(changed));
  EXPECT_FALSE(is_proportional(damping_of(body, -5.0, 1e-7)));
  EXPECT_FALSE(is_proportional(damping_of(body, 5.0, -1e-7)));
  EXPECT_TRUE(is_proportional(damping));
}

}  // namespace
}  // namespace stridor
