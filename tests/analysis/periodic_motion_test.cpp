#include "analysis/periodic_motion.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/errors.hpp"
#include "tests/support/small_systems.hpp"

namespace stridor {
namespace {

using test::MassOnGround;
using ::testing::HasSubstr;

/// Stick-slip of 1 kg on 100 N/m under 10 N on a belt at 0.1 m/s: sticks from 20 mm to 40 mm and
/// slips back in three quarters of a period of the spring.
MassOnGround mass_on_belt() {
  MassOnGround scene;
  scene.belt_velocity = 0.1;
  scene.friction.static_coefficient = 0.4;
  scene.friction.dynamic_coefficient = 0.3;
  return scene;
}

TimeParameters exact_steps(double step) {
  TimeParameters time = test::time_of(step);
  time.integrator = Integrator::exact;
  return time;
}

TEST(PeriodicMotion, StickSlipOnABeltIsThatOfTheClosedForm) {
  const double stick = 0.2;
  const double slip = 0.75 * 2.0 * std::numbers::pi / 10.0;
  const double width = 0.01 * std::numbers::sqrt2;
  for (const double h : {1e-4, 5e-5}) {
    const PeriodicMotion found =
        find_periodic_motion(mass_on_belt().system(), exact_steps(h), {.settle = 3.0});
    ASSERT_EQ(found.status, CycleStatus::periodic);
    EXPECT_TRUE(found.observed.is_x);
    // Of first order: it breaks loose at the end of a step, a few early or late, as the force still
    // rings from where it stuck, and goes v h farther each. Where exactly is up to rounding: with two
    // compilers the fraction is 4.57 h and 5.01 h from that of the closed form.
    EXPECT_NEAR(found.period, stick + slip, 3.0 * h);
    EXPECT_NEAR(found.seen.stick_fraction.value(), stick / (stick + slip), 8.0 * h);
    EXPECT_EQ(found.seen.free_fraction.value(), 0.0);
    EXPECT_NEAR(found.seen.largest - found.seen.smallest, 2.0 * width, 0.3 * h);
    // What sticks has forgotten how it came there.
    ASSERT_EQ(found.multipliers.size(), 3u);
    EXPECT_LT(std::abs(found.multipliers[0]), 0.02);
    EXPECT_LT(found.residual, 1e-5);
    EXPECT_NEAR(found.step * static_cast<double>(found.num_steps), found.period, 1e-15);
  }
}

TEST(PeriodicMotion, FollowedFromItsTurnItComesBack) {
  const TimeParameters time = exact_steps(1e-4);
  const PeriodicMotion found = find_periodic_motion(mass_on_belt().system(), time, {.settle = 3.0});
  ASSERT_EQ(found.status, CycleStatus::periodic);
  double first = 0.0;
  double last = 0.0;
  double largest = -1.0;
  std::int64_t seen = 0;
  follow_cycle(found, time, [&](const Simulation& simulation) {
    last = observed_displacement(found, simulation);
    if (seen++ == 0) first = last;
    largest = std::max(largest, last);
  });
  EXPECT_EQ(seen, found.num_steps + 1);
  EXPECT_NEAR(last, first, 1e-8);
  // The turn lies where the displacement is largest.
  EXPECT_NEAR(first, largest, 1e-6);
}

TEST(PeriodicMotion, MotionThatDiesDownIsNoCycle) {
  // Steady sliding about 30 mm, without reversals.
  MassOnGround scene = mass_on_belt();
  scene.friction = constant_friction(0.3);
  scene.displacement = 0.031;
  scene.alpha = 20.0;
  EXPECT_EQ(find_periodic_motion(scene.system(), exact_steps(1e-3), {.settle = 10.0}).status,
            CycleStatus::at_rest);
  // By 0.3 % a turn: as good as the same, but Newton's method finds nothing except rest.
  scene.alpha = 0.01;
  const PeriodicMotion slow =
      find_periodic_motion(scene.system(), exact_steps(1e-3), {.settle = 10.0});
  EXPECT_EQ(slow.status, CycleStatus::settling);
  EXPECT_TRUE(slow.multipliers.empty());
}

TEST(PeriodicMotion, BeltAtRestHoldsTheMass) {
  MassOnGround scene = mass_on_belt();
  scene.belt_velocity = 0.0;
  scene.displacement = 0.01;
  EXPECT_EQ(find_periodic_motion(scene.system(), exact_steps(1e-3), {.settle = 5.0}).status,
            CycleStatus::sticking);
}

TEST(PeriodicMotion, FailureOfARunIsSaid) {
  test::MovingForce scene;
  const PeriodicMotion found = find_periodic_motion(
      scene.system(), test::time_of(0.05 / scene.largest_omega()), {.settle = 1e3});
  EXPECT_EQ(found.status, CycleStatus::diverged);
  EXPECT_THAT(found.failure, HasSubstr("beam.top"));
}

TEST(PeriodicMotion, NothingRepeatsItselfOnAMasterThatEnds) {
  EXPECT_EQ(why_not_periodic(mass_on_belt().system()), std::nullopt);
  System system = test::MovingForce{}.system();
  EXPECT_THAT(why_not_periodic(system).value(),
              HasSubstr("contact 'contact' moves along beam.top and comes to its end"));
  system.contacts.clear();
  EXPECT_THAT(why_not_periodic(system).value(), HasSubstr("nothing touches"));
}

}  // namespace
}  // namespace stridor
