#include "analysis/error_norms.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <stdexcept>

#include "tests/support/message_of.hpp"

namespace stridor {
namespace {

using namespace test;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr double pi = std::numbers::pi;
constexpr double interval = 1e-5;
constexpr double frequency = 4000.0;

std::vector<double> sampled_sine(std::size_t count, double amplitude, double phase = 0.0) {
  std::vector<double> values(count);
  for (std::size_t i = 0; i < count; ++i) {
    values[i] =
        amplitude * std::sin(2.0 * pi * frequency * interval * static_cast<double>(i) + phase);
  }
  return values;
}

SampledRun run_of(double amplitude, double phase, double force) {
  constexpr std::size_t count = 10'001;
  return {interval, sampled_sine(count, amplitude, phase), {std::vector<double>(count, force)}};
}

const NormParameters norms{{0.03, 0.07}, {1000.0, 15000.0}};

TEST(SecondDifferences, OfAParabolaAreItsCurvature) {
  std::vector<double> parabola;
  for (int i = 0; i < 6; ++i) parabola.push_back(1.5 * i * i - 2.0 * i + 4.0);
  EXPECT_THAT(second_differences(parabola, 1.0), ElementsAre(3.0, 3.0, 3.0, 3.0));
  EXPECT_THAT(second_differences(parabola, 2.0), ElementsAre(0.75, 0.75, 0.75, 0.75));
  EXPECT_TRUE(second_differences(std::vector<double>{1.0, 2.0}, 1.0).empty());
}

TEST(RunningRms, IsTakenOverWhatThereIs) {
  const std::vector<double> values = running_rms(std::vector<double>{3.0, 4.0, 0.0, 0.0}, 1);
  EXPECT_THAT(values,
              ElementsAre(std::sqrt(12.5), std::sqrt(25.0 / 3.0), std::sqrt(16.0 / 3.0), 0.0));
  EXPECT_THAT(running_rms(std::vector<double>{-2.0, 5.0}, 0), ElementsAre(2.0, 5.0));
  EXPECT_TRUE(running_rms({}, 3).empty());
}

TEST(RunningRms, OfASineOverWholePeriodsIsItsAmplitudeByRootTwo) {
  // 4 kHz at 1e-5 s has 25 samples a period; 2·37 + 1 = 3 periods.
  const std::vector<double> envelope = running_rms(sampled_sine(400, 2.0), 37);
  for (std::size_t i = 37; i + 37 < envelope.size(); ++i)
    ASSERT_NEAR(envelope[i], std::sqrt(2.0), 1e-12) << i;
}

TEST(RelativeError, IsTheNormOfTheDifferenceByThatOfTheReference) {
  EXPECT_DOUBLE_EQ(relative_error(std::vector{3.0, 4.0}, std::vector{0.0, 5.0}),
                   std::sqrt(10.0) / 5.0);
  EXPECT_EQ(relative_error(std::vector{3.0, 4.0}, std::vector{3.0, 4.0}), 0.0);
  EXPECT_TRUE(std::isnan(relative_error(std::vector{1.0}, std::vector{0.0})));
  EXPECT_TRUE(std::isnan(relative_error({}, {})));
  EXPECT_THAT(message_of<std::invalid_argument>([] {
                relative_error(std::vector{1.0}, std::vector{1.0, 2.0});
              }),
              HasSubstr("relative_error: the series differ in length"));
}

TEST(ReferenceRun, ARunDoesNotDifferFromItself) {
  const SampledRun run = run_of(1e-6, 0.3, 0.2);
  const RunErrors errors = ReferenceRun(run, norms).errors_of(run);
  EXPECT_EQ(errors.force, 0.0);
  EXPECT_EQ(errors.acceleration, 0.0);
  EXPECT_EQ(errors.envelope, 0.0);
}

TEST(ReferenceRun, AmplitudeCountsInAccelerationAndEnvelope) {
  const ReferenceRun reference(run_of(1e-6, 0.0, 0.2), norms);
  const RunErrors errors = reference.errors_of(run_of(1.03e-6, 0.0, 0.21));
  // All three are linear in what was changed; rounding of the second differences is 1e-16/(ω h)².
  EXPECT_NEAR(errors.force, 0.05, 1e-12);
  EXPECT_NEAR(errors.acceleration, 0.03, 1e-9);
  EXPECT_NEAR(errors.envelope, 0.03, 1e-9);
}

TEST(ReferenceRun, PhaseCountsInTheAccelerationOnly) {
  const ReferenceRun reference(run_of(1e-6, 0.0, 0.2), norms);
  const RunErrors errors = reference.errors_of(run_of(1e-6, 0.2, 0.2));
  // |exp(i φ) − 1| = 2 sin(φ/2), over 160 whole periods of the window but for its last sample; the
  // envelope over 1,001 samples is ripple of a fortieth period's share, below 1/(2·1001).
  EXPECT_NEAR(errors.acceleration, 2.0 * std::sin(0.1), 1e-3);
  EXPECT_LT(errors.envelope, 1e-3);
}

TEST(ReferenceRun, NothingOutsideTheWindowCounts) {
  const SampledRun run = run_of(1e-6, 0.0, 0.2);
  SampledRun disturbed = run;
  // As far from the window as the band-pass and the envelope remember: 1/(band width) and 5 ms.
  for (std::size_t i = 0; i < 500; ++i) {
    disturbed.displacement[i] *= 1.5;
    disturbed.forces[0][i] = 7.0;
  }
  const RunErrors errors = ReferenceRun(run, norms).errors_of(disturbed);
  EXPECT_EQ(errors.force, 0.0);
  EXPECT_LT(errors.acceleration, 1e-6);
  EXPECT_LT(errors.envelope, 1e-6);
}

TEST(ReferenceRun, ForcesOfSeveralContactsAreOneVector) {
  SampledRun run = run_of(1e-6, 0.0, 3.0);
  run.forces.push_back(std::vector<double>(run.displacement.size(), 4.0));
  SampledRun other = run;
  other.forces[1].assign(run.displacement.size(), 4.5);
  EXPECT_NEAR(ReferenceRun(run, norms).errors_of(other).force, 0.1, 1e-12);
}

TEST(ReferenceRun, ARunThatEndsEarlyOrIsNotFiniteHasNoErrors) {
  const SampledRun run = run_of(1e-6, 0.0, 0.2);
  const ReferenceRun reference(run, norms);
  SampledRun cut = run;
  cut.displacement.pop_back();
  EXPECT_TRUE(std::isnan(reference.errors_of(cut).force));
  SampledRun blown = run;
  blown.displacement[9000] = std::numeric_limits<double>::infinity();
  EXPECT_TRUE(std::isnan(reference.errors_of(blown).envelope));
}

TEST(ReferenceRun, WithoutMotionThereIsNoRelativeError) {
  const SampledRun still = run_of(0.0, 0.0, 0.2);
  const RunErrors errors = ReferenceRun(still, norms).errors_of(still);
  EXPECT_EQ(errors.force, 0.0);
  EXPECT_TRUE(std::isnan(errors.acceleration));
  EXPECT_TRUE(std::isnan(errors.envelope));
}

TEST(ReferenceRun, RejectsWhatIsNotComparable) {
  const SampledRun run = run_of(1e-6, 0.0, 0.2);
  const ReferenceRun reference(run, norms);
  SampledRun other = run;
  other.interval = 2e-5;
  EXPECT_THAT(message_of<std::invalid_argument>([&] { reference.errors_of(other); }),
              HasSubstr("sampled at another interval"));
  other = run;
  other.forces.clear();
  EXPECT_THAT(message_of<std::invalid_argument>([&] { reference.errors_of(other); }),
              HasSubstr("another number of contacts"));
  EXPECT_THAT(message_of<std::invalid_argument>([&] {
                ReferenceRun(run, {{0.0, 1.0}, {1000.0, 60000.0}});
              }),
              HasSubstr("does not satisfy 0 < lower < upper"));
}

TEST(LogLogSlope, OfAPowerIsItsExponent) {
  std::vector<double> x;
  std::vector<double> y;
  for (int i = 1; i <= 7; ++i) {
    x.push_back(std::pow(1.7, i));
    y.push_back(3.0 * std::pow(x.back(), -1.5));
  }
  EXPECT_NEAR(log_log_slope(x, y), -1.5, 1e-12);
  // Least squares, not the line through the ends: (0,0), (1,1), (2,0) in logarithms has slope 0.
  EXPECT_NEAR(log_log_slope(std::vector{1.0, std::exp(1.0), std::exp(2.0)},
                            std::vector{1.0, std::exp(1.0), 1.0}),
              0.0, 1e-12);
}

TEST(LogLogSlope, LeavesOutWhatHasNoLogarithm) {
  constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NEAR(log_log_slope(std::vector{1.0, 2.0, 4.0, 8.0, -1.0},
                            std::vector{1.0, unknown, 16.0, 0.0, 5.0}),
              2.0, 1e-12);
  EXPECT_TRUE(std::isnan(log_log_slope(std::vector{1.0}, std::vector{1.0})));
  EXPECT_TRUE(std::isnan(log_log_slope(std::vector{2.0, 2.0}, std::vector{1.0, 3.0})));
  EXPECT_TRUE(std::isnan(log_log_slope({}, {})));
  EXPECT_THAT(message_of<std::invalid_argument>([] {
                log_log_slope(std::vector{1.0}, std::vector{1.0, 2.0});
              }),
              HasSubstr("log_log_slope: the series differ in length"));
}

TEST(ParetoFront, HoldsWhatNothingBeats) {
  constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(
      pareto_front(std::vector{1.0, 2.0, 3.0, 2.5, 0.5}, std::vector{0.5, 0.2, 0.1, 0.3, unknown}),
      ElementsAre(true, true, true, false, false));
  // Equal in both: neither beats the other. Equal in one: the other decides.
  EXPECT_THAT(pareto_front(std::vector{1.0, 1.0, 1.0}, std::vector{0.5, 0.5, 0.6}),
              ElementsAre(true, true, false));
  EXPECT_TRUE(pareto_front({}, {}).empty());
  EXPECT_THAT(message_of<std::invalid_argument>([] {
                pareto_front(std::vector{1.0}, std::vector{1.0, 2.0});
              }),
              HasSubstr("pareto_front: the series differ in length"));
}

}  // namespace
}  // namespace stridor
