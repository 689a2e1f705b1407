#include "analysis/precision_study.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "tests/support/message_of.hpp"
#include "tests/support/small_systems.hpp"

namespace stridor {
namespace {

using namespace test;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr double study_interval = 0.01;

/// ω = 10 rad/s, started 1 m out, sliding without friction.
MassOnGround oscillator() {
  MassOnGround mass;
  mass.displacement = 1.0;
  return mass;
}

TimeParameters time_with(Integrator integrator, double step) {
  TimeParameters time;
  time.integrator = integrator;
  time.step = step;
  time.end = 1.0;
  return time;
}

TEST(StepLadder, IsGeometricAsFarAsWholeNumbersGo) {
  EXPECT_THAT(step_ladder(35, 140, 3), ElementsAre(35, 70, 140));
  EXPECT_THAT(step_ladder(1, 16, 7), ElementsAre(1, 2, 3, 4, 6, 10, 16));
  EXPECT_THAT(step_ladder(3, 4, 7), ElementsAre(3, 4));
  EXPECT_THAT(step_ladder(5, 9, 1), ElementsAre(5));
  for (const auto& [coarsest, finest, count] :
       {std::tuple{0, 4, 3}, std::tuple{4, 3, 3}, std::tuple{1, 4, 0}}) {
    EXPECT_THAT(message_of<std::invalid_argument>(
                    [&, c = coarsest, f = finest, n = count] { step_ladder(c, f, n); }),
                HasSubstr("step_ladder: not 1 <= coarsest <= finest"));
  }
}

TEST(StableStepsPerSample, IsTheLeastNumberWithinTheLimit) {
  // The limit is 2/ω = 0.2 s: one step of 0.1 s, six of 1 s (0.1667 s), five being at the limit
  // itself but for the margin of one part in 10⁹.
  const System system = oscillator().system();
  const TimeParameters time = time_with(Integrator::central_difference, 0.01);
  EXPECT_EQ(stable_steps_per_sample(system, time, 0.1), 1);
  EXPECT_EQ(stable_steps_per_sample(system, time, 0.99), 5);
  EXPECT_EQ(stable_steps_per_sample(system, time, 1.0), 6);
  EXPECT_THAT(
      message_of<std::invalid_argument>([&] { stable_steps_per_sample(system, time, 1e6); }),
      HasSubstr("more than 1e5 steps per sample"));
}

TEST(WithAssumption, ChangesEveryContactAndNothingElse) {
  const System system = oscillator().system();
  const System changed = with_assumption(system, ContactAssumption::subs_c);
  EXPECT_EQ(changed.contacts[0].assumption, ContactAssumption::subs_c);
  EXPECT_EQ(system.contacts[0].assumption, ContactAssumption::film);
  EXPECT_EQ(changed.bodies.size(), system.bodies.size());
}

TEST(TimedRun, SamplesTheMotionAtTheInterval) {
  for (const int steps : {1, 4}) {
    TimedRun run(oscillator().system(), time_with(Integrator::exact, study_interval / steps),
                 {0, MassOnGround::x_row}, study_interval, 100);
    EXPECT_EQ(run.run_until(30), MarchEnd::finished);
    EXPECT_EQ(run.run_until(100), MarchEnd::finished);
    EXPECT_EQ(run.failure(), "");
    const SampledRun& samples = run.samples();
    ASSERT_EQ(samples.displacement.size(), 101u);
    ASSERT_EQ(samples.forces.size(), 1u);
    ASSERT_EQ(samples.forces[0].size(), 101u);
    for (std::size_t i = 0; i <= 100; ++i) {
      // The propagation of the mode is exact; only rounding of a hundred steps remains.
      ASSERT_NEAR(samples.displacement[i], std::cos(0.1 * static_cast<double>(i)), 1e-11) << i;
      ASSERT_NEAR(samples.forces[0][i], 10.0, 1e-9) << i;
    }
  }
}

TEST(TimedRun, StretchesChangeNothing) {
  const auto samples_of = [](const std::vector<std::int64_t>& stops) {
    TimedRun run(oscillator().system(), time_with(Integrator::central_difference, 0.005),
                 {0, MassOnGround::x_row}, study_interval, 50);
    for (const std::int64_t stop : stops) run.run_until(stop);
    return run.samples().displacement;
  };
  EXPECT_EQ(samples_of({50}), samples_of({0, 7, 8, 50}));
}

TEST(TimedRun, CountsWhatItTook) {
  TimedRun run(oscillator().system(), time_with(Integrator::exact, 0.0025),
               {0, MassOnGround::x_row}, study_interval, 1000);
  EXPECT_EQ(run.cost().steps, 0);
  for (int turn = 1; turn <= 10; ++turn) run.run_until(100 * turn);
  const RunCost cost = run.cost();
  EXPECT_EQ(cost.steps, 4000);
  EXPECT_GT(cost.setup, 0.0);
  EXPECT_GT(cost.stepping, 0.0);
  EXPECT_GT(cost.sampling, 0.0);
  EXPECT_GT(cost.least_step, 0.0);
  EXPECT_LE(cost.least_step, cost.median_step);
  EXPECT_LE(cost.least_step * 4000.0, cost.stepping * (1.0 + 1e-9));
}

TEST(TimedRun, AStepBeyondTheLimitIsAResult) {
  TimedRun run(oscillator().system(), time_with(Integrator::central_difference, 0.25),
               {0, MassOnGround::x_row}, 0.25, 10);
  EXPECT_THAT(run.failure(), HasSubstr("above the largest stable step"));
  EXPECT_EQ(run.run_until(10), MarchEnd::failed);
  EXPECT_EQ(run.cost().steps, 0);
}

TEST(TimedRun, ALossOfSlidingIsAResult) {
  // Friction with nothing that moves: Subs-b slides in the direction of the first step, comes to
  // rest in the spring and turns round, which it may not from the start on.
  MassOnGround mass = oscillator();
  mass.assumption = ContactAssumption::subs_b;
  mass.belt_velocity = 0.1;
  System system = mass.system();
  system.contacts[0].armed_from = 0.0;
  TimedRun run(system, time_with(Integrator::exact, study_interval), {0, MassOnGround::x_row},
               study_interval, 100);
  EXPECT_EQ(run.run_until(100), MarchEnd::failed);
  EXPECT_THAT(run.failure(), HasSubstr("sliding"));
  EXPECT_LT(run.samples().displacement.size(), 101u);
}

TEST(PrecisionPlan, CoversIntegratorsModesAndAssumptions) {
  // Modes at 10 rad/s and 0: frequencies above 1.6 Hz leave nothing out, those below leave the
  // rigid mode only, so neither is of use where all modes or none are asked for.
  StudyParameters parameters;
  parameters.retained = {1.0, 5.0};
  parameters.assumptions = {ContactAssumption::film, ContactAssumption::subs_a};
  parameters.points = 3;
  const TimeParameters time = time_with(Integrator::central_difference, 0.1);
  const PrecisionPlan plan = make_plan(oscillator().system(), time, 1.0, parameters);
  EXPECT_EQ(plan.stable_steps, 6);
  EXPECT_EQ(plan.reference.integrator, Integrator::exact);
  EXPECT_THAT(plan.reference.steps_per_sample, ElementsAre(24, 48));
  ASSERT_EQ(plan.methods.size(), 5u);
  EXPECT_EQ(plan.methods[0].integrator, Integrator::central_difference);
  EXPECT_THAT(plan.methods[0].steps_per_sample, ElementsAre(5, 6, 12, 24));
  EXPECT_THAT(plan.methods[1].steps_per_sample, ElementsAre(1, 5, 24));
  EXPECT_EQ(plan.methods[2].retained, 1.0);
  EXPECT_EQ(plan.methods[3].retained, 1.0);
  EXPECT_EQ(plan.methods[3].integrator, Integrator::central_difference);
  EXPECT_EQ(plan.methods[4].assumption, ContactAssumption::subs_a);
  EXPECT_EQ(plan.methods[4].retained, 1.0);
}

TEST(PrecisionMethod, KeepsWhatItDoesNotChange) {
  TimeParameters time = time_with(Integrator::central_difference, 0.1);
  time.coordinates = Coordinates::craig_bampton;
  time.contact_sweeps = 77;
  const TimeParameters changed =
      PrecisionMethod{Integrator::exact, 50.0, ContactAssumption::film, {}}.at(4, time, 0.01);
  EXPECT_EQ(changed.integrator, Integrator::exact);
  EXPECT_EQ(changed.coordinates, Coordinates::modal);
  EXPECT_DOUBLE_EQ(changed.step, 0.0025);
  EXPECT_DOUBLE_EQ(changed.retain->frequency.value(), 50.0);
  EXPECT_EQ(changed.contact_sweeps, 77);
  EXPECT_EQ(changed.end, 1.0);
}

}  // namespace
}  // namespace stridor
