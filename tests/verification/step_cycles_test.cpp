// Limit cycles by steps beside those from event to event.
#include <gtest/gtest.h>

#include <cmath>
#include <complex>

#include "analysis/limit_cycle.hpp"
#include "analysis/periodic_motion.hpp"
#include "io/run_file/initial_state.hpp"
#include "solvers/transient/sliding_oscillator.hpp"
#include "tests/support/program.hpp"

namespace stridor {
namespace {

TEST(StepCycles, SphereOnRubberIsThatOfTheEvents) {
  const LoadedScene loaded = load_scene(test::scene_path("examples/sphere_on_rubber.yaml"), {});
  Model model = build_model(loaded);
  (void)set_initial_state(model.system, loaded);
  const SlidingOscillator oscillator = as_oscillator(model.system).value();
  CycleOptions options;
  options.settle = 200.0;
  const LimitCycle events =
      find_limit_cycle(oscillator.oscillator, oscillator.initial_displacement(model.system),
                       oscillator.initial_velocity(model.system), options);
  ASSERT_EQ(events.status, CycleStatus::periodic);
  // A restart, and an end of sticking, lies within a step: of first order in h.
  double before = 0.0;
  for (const double step : {1e-4, 5e-5, 2.5e-5}) {
    TimeParameters time = *loaded.scene.time;
    time.integrator = Integrator::exact;
    time.step = step;
    const PeriodicMotion found = find_periodic_motion(model.system, time, {.settle = 10.0});
    ASSERT_EQ(found.status, CycleStatus::periodic);
    const double miss = std::abs(found.period / (oscillator.time * events.period) - 1.0);
    EXPECT_LT(miss, 5.0 * step);  // a relative one, of 5/s times h: measured 3.2
    if (before > 0.0) {
      EXPECT_NEAR(before / miss, 2.0, 0.3);
    }
    EXPECT_NEAR(found.seen.rms.value(), oscillator.length * events.x_rms, 1e-3 * *found.seen.rms);
    EXPECT_NEAR(found.seen.stick_fraction.value(), events.stick_fraction, 10.0 * step);
    // Of four unknowns less the shift along the cycle, and of the return map of three.
    ASSERT_EQ(found.multipliers.size(), 3u);
    for (std::size_t i = 0; i < 3; ++i)
      EXPECT_LT(std::abs(found.multipliers[i] - events.multipliers[i]), 1000.0 * step);
    before = miss;
  }
}

}  // namespace
}  // namespace stridor
