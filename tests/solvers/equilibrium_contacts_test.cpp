// Equilibria of several contacts, and those that put a contact at a place.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "solvers/equilibrium/equilibrium.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/paper_equilibrium.hpp"
#include "tests/support/paper_model.hpp"

namespace stridor {
namespace {

using namespace test;

using ::testing::HasSubstr;

TEST(Equilibrium, SeveralSlavePointsOfOneBodyShareTheLoad) {
  const System system = make_paper_model(block_on_cantilever(ContactAssumption::subs_b)).system;
  ASSERT_EQ(system.contacts.size(), 5u);
  const Equilibrium equilibrium = find_equilibrium(system, sliding_state(system, 0.0));
  ASSERT_EQ(equilibrium.status, EquilibriumStatus::converged) << equilibrium.failure;
  double vertical = 0.0;
  double largest = 0.0;
  for (const ContactEquilibrium& contact : equilibrium.contacts) {
    EXPECT_TRUE(contact.is_closed);
    EXPECT_NEAR(contact.gap, 0.0, 1e-14);
    const double push =
        contact.projection.normal.y() - paper_friction * contact.projection.tangent.y();
    vertical += contact.force * push;
    largest = std::max(largest, std::abs(contact.force));
  }
  EXPECT_NEAR(vertical, paper_load, rigid_mode_error * largest);
}

TEST(Equilibrium, UnilateralContactsDoNotPullAndDoNotPenetrate) {
  const System bilateral = make_paper_model(block_on_cantilever(ContactAssumption::subs_b)).system;
  const System unilateral = make_paper_model(block_on_cantilever(ContactAssumption::film)).system;
  const EquilibriumState state = sliding_state(bilateral, 0.0);
  int pulling = 0;
  for (const ContactEquilibrium& contact : find_equilibrium(bilateral, state).contacts)
    pulling += contact.force < 0.0 ? 1 : 0;
  EXPECT_GT(pulling, 0) << "the case shows nothing";

  const Equilibrium equilibrium = find_equilibrium(unilateral, state);
  ASSERT_EQ(equilibrium.status, EquilibriumStatus::converged) << equilibrium.failure;
  double vertical = 0.0;
  int closed = 0;
  for (const ContactEquilibrium& contact : equilibrium.contacts) {
    if (contact.is_closed) {
      ++closed;
      EXPECT_GT(contact.force, 0.0);
      EXPECT_NEAR(contact.gap, 0.0, 1e-14);
    } else {
      EXPECT_EQ(contact.force, 0.0);
      EXPECT_EQ(contact.friction_force, 0.0);
      EXPECT_GT(contact.gap, 0.0);
    }
    vertical += contact.force *
                (contact.projection.normal.y() - paper_friction * contact.projection.tangent.y());
  }
  EXPECT_GE(closed, 1);
  EXPECT_LT(closed, 5);
  EXPECT_NEAR(vertical, paper_load, rigid_mode_error * paper_load);

  // Subs-b that lifts off on violation comes to the same.
  System on_violation = bilateral;
  for (ContactPoint& point : on_violation.contacts) point.on_violation = OnViolation::unilateral;
  const Equilibrium other = find_equilibrium(on_violation, state);
  for (std::size_t i = 0; i < 5; ++i)
    EXPECT_EQ(other.contacts[i].force, equilibrium.contacts[i].force);
}

TEST(Equilibrium, CanBeFoundForThePlaceOfAContact) {
  for (const auto assumption : {ContactAssumption::subs_a, ContactAssumption::subs_b,
                                ContactAssumption::subs_c, ContactAssumption::film}) {
    const System system = paper_system_at(leading_angle, assumption);
    for (const double position : {0.0412, 0.075, 0.0999, 0.1}) {
      const Equilibrium placed =
          find_equilibrium_at(system, 0, position, sliding_state(system, 0.0));
      ASSERT_EQ(placed.status, EquilibriumStatus::converged) << placed.failure;
      EXPECT_NEAR(placed.contacts.at(0).position, position, 1e-14);
      EXPECT_LE(placed.contacts[0].segment, 99);
      const Equilibrium driven = find_equilibrium(system, placed.state);
      // At the end itself rounding may put the slave beyond it.
      if (position == 0.1) continue;
      ASSERT_EQ(driven.status, EquilibriumStatus::converged) << driven.failure;
      if (position == 0.075) continue;  // a node: the other segment is as good
      EXPECT_NEAR(driven.contacts[0].position, position, 1e-14);
      EXPECT_NEAR(driven.contacts[0].force, placed.contacts[0].force, 1e-12);
    }
  }
  // At a node it is the segment before it.
  const System system = paper_system_at(leading_angle);
  EXPECT_EQ(find_equilibrium_at(system, 0, 0.075, sliding_state(system, 0.0)).contacts[0].segment,
            74);
}

TEST(Equilibrium, SeveralContactsCanBePlacedByOneOfThem) {
  const System system = make_paper_model(block_on_cantilever(ContactAssumption::film)).system;
  const Equilibrium placed = find_equilibrium_at(system, 2, 0.0643, sliding_state(system, 0.0));
  ASSERT_EQ(placed.status, EquilibriumStatus::converged) << placed.failure;
  EXPECT_NEAR(placed.contacts[2].position, 0.0643, 1e-14);
  const Equilibrium driven = find_equilibrium(system, placed.state);
  for (std::size_t i = 0; i < 5; ++i) {
    EXPECT_NEAR(driven.contacts[i].force, placed.contacts[i].force, 1e-9);
    EXPECT_EQ(driven.contacts[i].segment, placed.contacts[i].segment);
  }
}

TEST(Equilibrium, AContactThatFollowsTheDriveIsTakenAlongByAnotherOnesPlace) {
  System system = make_paper_model(block_on_cantilever(ContactAssumption::subs_b)).system;
  system.contacts[0].assumption = ContactAssumption::subs_a;
  const Equilibrium placed = find_equilibrium_at(system, 4, 0.0693, sliding_state(system, 0.0));
  ASSERT_EQ(placed.status, EquilibriumStatus::converged) << placed.failure;
  EXPECT_NEAR(placed.contacts[4].position, 0.0693, 1e-14);
  EXPECT_NEAR(placed.contacts[0].position, 0.0505 + placed.state.drive_displacement, 1e-14);
  const Equilibrium driven = find_equilibrium(system, placed.state);
  for (std::size_t i = 0; i < 5; ++i)
    EXPECT_NEAR(driven.contacts[i].force, placed.contacts[i].force, 1e-9);
}

TEST(Equilibrium, DriveIsDisplacedToWhereTheUndeformedSlaveIsWanted) {
  const System system = paper_system_at(trailing_angle);
  EXPECT_NEAR(drive_displacement_at(system, 0, 0.0747), 0.0447, 1e-15);
  EXPECT_NEAR(drive_displacement_at(system, 0, 0.0), -0.030, 1e-15);
  EXPECT_THAT(message_of<std::invalid_argument>([&] { drive_displacement_at(system, 0, 0.1001); }),
              HasSubstr("0.1001 m is off the master cantilever.top, 0 to 0.1 m"));
  EXPECT_THAT(message_of<std::invalid_argument>([&] { drive_displacement_at(system, 0, -0.001); }),
              HasSubstr("off the master"));
  System still = system;
  still.bodies[1].drive = -1;
  EXPECT_THAT(message_of<std::invalid_argument>([&] { drive_displacement_at(still, 0, 0.05); }),
              HasSubstr("the drive does not move contact along its master"));
}

}  // namespace
}  // namespace stridor
