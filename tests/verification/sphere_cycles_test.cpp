// Limit cycles of the sphere on a viscoelastic substrate against an independent program.
#include <gtest/gtest.h>

#include <cmath>

#include "analysis/limit_cycle.hpp"
#include "tests/support/paper_sphere.hpp"

namespace stridor {
namespace {

LimitCycle cycle_of(const test::PaperSphere& model) {
  const SubstrateOscillator oscillator = make_sphere(model);
  const SubstrateEquilibrium rest = find_equilibrium(oscillator);
  return find_limit_cycle(oscillator, {rest.displacement.x(), 1.01 * rest.displacement.y()},
                          {0.0, 0.0});
}

TEST(SphereCycles, FourMotionsWithSlipStickAndLiftOff) {
  struct Row {
    double speed, shear, period, x_rms, stick, free;
  };
  for (const Row& row : {Row{5e-3, 1e-2, 6.1544510, 0.0660501053, 0.40341, 0.0},
                         Row{5e-3, 3e-2, 7.06459996, 0.0855223332, 0.53895, 0.0},
                         Row{5e-3, 1e-3, 5.2660246, 0.0420055009, 0.08213, 0.06955},
                         Row{4e-4, 2.5e-3, 6.0709185, 0.003802136, 0.07121, 0.0}}) {
    const LimitCycle cycle = cycle_of(test::paper_sphere(row.speed, row.shear));
    ASSERT_EQ(cycle.status, CycleStatus::periodic) << row.shear;
    EXPECT_NEAR(cycle.period, row.period, 1e-7) << row.shear;
    EXPECT_NEAR(cycle.x_rms, row.x_rms, 1e-9) << row.shear;
    EXPECT_NEAR(cycle.stick_fraction, row.stick, 6e-6) << row.shear;
    EXPECT_NEAR(cycle.free_fraction, row.free, 6e-6) << row.shear;
    EXPECT_LT(std::abs(cycle.multipliers.front()), 1.0);
  }
}

TEST(SphereCycles, ExtremesOfTheLargestCycle) {
  const LimitCycle cycle = cycle_of(test::paper_sphere(5e-3, 3e-2));
  EXPECT_NEAR(cycle.x_min, -0.01183604, 1e-8);
  EXPECT_NEAR(cycle.x_max, 0.24999874, 1e-8);
}

TEST(SphereCycles, RegularisedFrictionMovesThresholdAndAmplitude) {
  // (2/π) arctan(v/(0.1 v_d)) has the threshold at 3.05e-3 instead of 2.10e-3.
  test::PaperSphere model = test::paper_sphere(4e-4);
  model.regularisation = {RegularisedSign::Kind::atan, 0.1};
  const auto margin = [&](double shear) {
    model.shear_strength = shear;
    const SubstrateOscillator oscillator = make_sphere(model);
    return stability_margin(small_motion(oscillator, find_equilibrium(oscillator)));
  };
  EXPECT_LT(margin(3.045e-3), 0.0);
  EXPECT_GT(margin(3.055e-3), 0.0);
  // The amplitude is too low, in proportion to v_ε, and nothing sticks.
  const auto shortfall = [](double speed) {
    test::PaperSphere smooth = test::paper_sphere();
    smooth.regularisation = {RegularisedSign::Kind::tanh, speed};
    const LimitCycle cycle = cycle_of(smooth);
    EXPECT_EQ(cycle.status, CycleStatus::periodic);
    EXPECT_EQ(cycle.stick_fraction, 0.0);
    return 0.0660501053 - cycle.x_rms;
  };
  const double coarse = shortfall(3e-3);
  const double fine = shortfall(1e-3);
  EXPECT_GT(fine, 0.0);
  EXPECT_NEAR(std::log(coarse / fine) / std::log(3.0), 1.0, 0.15);
}

TEST(SphereCycles, StickSlipBesideAStableEquilibrium) {
  // F̃_n = 7.5e-4, v̂ = 10^-1.5: the equilibrium is stable up to τ̃_0 = 9.16e-2.
  const LimitCycle upper = cycle_of(test::paper_sphere(std::pow(10.0, -1.5), 0.12));
  ASSERT_NE(upper.status, CycleStatus::at_rest);
  const SubstrateOscillator low = make_sphere(test::paper_sphere(std::pow(10.0, -1.5), 0.01));
  const LimitCycle kept = find_limit_cycle(low, upper.last_displacement, upper.last_velocity);
  EXPECT_EQ(kept.status, CycleStatus::periodic);
  EXPECT_NEAR(kept.x_rms, 0.2457, 5e-5);
  EXPECT_EQ(cycle_of(test::paper_sphere(std::pow(10.0, -1.5), 0.01)).status, CycleStatus::at_rest);
}

}  // namespace
}  // namespace stridor
