#include "analysis/limit_cycle.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <complex>

#include "tests/support/paper_sphere.hpp"

namespace stridor {
namespace {

using test::paper_sphere;
using ::testing::HasSubstr;

TEST(LimitCycle, StickSlipOfThePaperBySolvingForIt) {
  // Newton's method makes the cycle independent of how long the motion has settled.
  const SubstrateOscillator oscillator = make_sphere(paper_sphere());
  const SubstrateEquilibrium rest = find_equilibrium(oscillator);
  CycleOptions options;
  options.settle = 200.0;
  options.tolerance = 1e-11;
  const LimitCycle cycle = find_limit_cycle(
      oscillator, {rest.displacement.x(), 1.01 * rest.displacement.y()}, {0.0, 0.0}, options);
  ASSERT_EQ(cycle.status, CycleStatus::periodic);
  EXPECT_NEAR(cycle.period, 6.1544510, 1e-7);
  EXPECT_NEAR(cycle.x_rms, 0.0660501053, 1e-9);
  EXPECT_NEAR(cycle.stick_fraction, 0.40341, 1e-5);
  EXPECT_EQ(cycle.free_fraction, 0.0);
  ASSERT_EQ(cycle.multipliers.size(), 3u);
  // Sticking takes one dimension away.
  EXPECT_LT(std::abs(cycle.multipliers[2]), 1e-5);
  EXPECT_LT(std::abs(cycle.multipliers[0]), 1.0);
}

TEST(LimitCycle, StableEquilibriumComesToRest) {
  const SubstrateOscillator oscillator = make_sphere(paper_sphere(4e-4, 1.5e-3));
  const SubstrateEquilibrium rest = find_equilibrium(oscillator);
  CycleOptions options;
  options.settle = 2000.0;
  options.tolerance = 1e-10;
  EXPECT_EQ(find_limit_cycle(oscillator, {rest.displacement.x(), 1.01 * rest.displacement.y()},
                             {0.0, 0.0}, options)
                .status,
            CycleStatus::at_rest);
}

TEST(LimitCycle, AMotionThatIsNotSettledIsNotIrregular) {
  const auto status = [](double speed, double shear, double start, double settle) {
    const SubstrateOscillator oscillator = make_sphere(paper_sphere(speed, shear));
    const SubstrateEquilibrium rest = find_equilibrium(oscillator);
    CycleOptions options;
    options.settle = settle;
    options.tolerance = 1e-10;
    return find_limit_cycle(oscillator, {rest.displacement.x(), start * rest.displacement.y()},
                            {0.0, 0.0}, options)
        .status;
  };
  // On either side of the threshold at 9.16e-2 it dies down or grows slowly.
  const double fast = std::pow(10.0, -1.5);
  EXPECT_EQ(status(fast, 0.09, 1.001, 50.0), CycleStatus::settling);
  EXPECT_EQ(status(fast, 0.095, 1.0001, 50.0), CycleStatus::settling);
  // PPH, Fig. 12.
  EXPECT_EQ(status(4e-4, 5e-2, 1.01, 300.0), CycleStatus::irregular);
}

TEST(LimitCycle, SaysWhatWentWrong) {
  const SubstrateOscillator oscillator = make_sphere(paper_sphere());
  const LimitCycle cycle = find_limit_cycle(oscillator, {0.0, 1e15}, {0.0, 0.0});
  EXPECT_EQ(cycle.status, CycleStatus::diverged);
  EXPECT_GE(cycle.failure_time, 0.0);
  EXPECT_THAT(cycle.failure, HasSubstr("; try "));
}

}  // namespace
}  // namespace stridor
