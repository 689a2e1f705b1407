#include "coupling/kinematics/roughness.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>
#include <vector>

#include "tests/support/message_of.hpp"

namespace stridor {
namespace {

using test::message_of;
using ::testing::HasSubstr;

constexpr double rms = 3e-9;
constexpr double correlation_length = 2e-5;
constexpr double length = 0.1;  ///< 5000 correlation lengths

Roughness profile(std::int64_t seed) {
  return Roughness({rms, correlation_length, seed}, length);
}

TEST(Roughness, IsNothingByDefault) {
  const Roughness none;
  EXPECT_TRUE(none.is_smooth());
  EXPECT_EQ(none.at(0.3).value, 0.0);
  EXPECT_EQ(none.at(0.3).slope, 0.0);
  EXPECT_FALSE(profile(1).is_smooth());
}

TEST(Roughness, HasTheStatisticsAskedFor) {
  // Means over L = 5000 ℓ: the variance of a Gaussian process scatters by sqrt(2 √(π/2) ℓ/L) = 2.2
  // %, products at a distance and of slopes by no more than 3 %; the mean by sqrt(√π ℓ/L) rms = 1.9
  // %. Four times that, for 5 seeds of which none may fail.
  for (const std::int64_t seed : {0, 1, 2, 3, 1'000'000'007}) {
    const Roughness rough = profile(seed);
    const int num_samples = 200'000;
    const double step = length / num_samples;
    double mean = 0.0;
    double square = 0.0;
    double half = 0.0;
    double one = 0.0;
    double two = 0.0;
    double slopes = 0.0;
    double fourth = 0.0;
    const int usable = num_samples * 9 / 10;
    for (int i = 0; i < usable; ++i) {
      const double s = i * step;
      const auto [z, slope] = rough.at(s);
      mean += z / usable;
      square += z * z / usable;
      fourth += z * z * z * z / usable;
      half += z * rough.at(s + 0.5 * correlation_length).value / usable;
      one += z * rough.at(s + correlation_length).value / usable;
      two += z * rough.at(s + 2.0 * correlation_length).value / usable;
      slopes += slope * slope / usable;
    }
    const double variance = rms * rms;
    EXPECT_NEAR(mean, 0.0, 0.08 * rms);
    EXPECT_NEAR(square, variance, 0.10 * variance);
    EXPECT_NEAR(half, std::exp(-0.25) * variance, 0.12 * variance);
    EXPECT_NEAR(one, std::exp(-1.0) * variance, 0.12 * variance);
    EXPECT_NEAR(two, std::exp(-4.0) * variance, 0.12 * variance);
    EXPECT_NEAR(slopes, 2.0 * variance / (correlation_length * correlation_length),
                0.12 * 2.0 * variance / (correlation_length * correlation_length));
    EXPECT_NEAR(fourth / (square * square), 3.0, 0.3) << "not Gaussian";
  }
}

TEST(Roughness, IsTwiceContinuouslyDifferentiable) {
  // Across every knot value and slope agree to rounding, and the second derivative, by differences
  // of the slope over 1e-4 of a knot distance, up to the third times that.
  const Roughness rough = profile(5);
  const double knot_distance = correlation_length / 8.0;
  const double slope_scale = rms / correlation_length;
  const double curvature_scale = slope_scale / correlation_length;
  for (int k = 1; k < 2000; ++k) {
    const double knot = k * knot_distance;
    const double step = 1e-4 * knot_distance;
    const auto before = rough.at(knot * (1.0 - 1e-15));
    const auto here = rough.at(knot);
    EXPECT_NEAR(before.value, here.value, 1e-11 * rms);
    EXPECT_NEAR(before.slope, here.slope, 1e-10 * slope_scale);
    const double left = (here.slope - rough.at(knot - step).slope) / step;
    const double right = (rough.at(knot + step).slope - here.slope) / step;
    EXPECT_NEAR(left, right, 1e-3 * curvature_scale);
    EXPECT_NEAR((rough.at(knot + step).value - rough.at(knot - step).value) / (2.0 * step),
                here.slope, 1e-6 * slope_scale);
  }
}

TEST(Roughness, IsAFunctionOfSeedAndPlaceAlone) {
  const Roughness rough = profile(7);
  const Roughness again = profile(7);
  const Roughness longer = Roughness({rms, correlation_length, 7}, 2.0 * length);
  const Roughness higher = Roughness({2.0 * rms, correlation_length, 7}, length);
  const Roughness other = profile(8);
  double difference = 0.0;
  for (int i = 999; i >= 0; --i) {
    const double s = 0.99 * length * i / 999.0;
    EXPECT_EQ(rough.at(s).value, again.at(s).value);
    EXPECT_EQ(rough.at(s).value, longer.at(s).value);
    EXPECT_DOUBLE_EQ(2.0 * rough.at(s).value, higher.at(s).value);
    difference += std::abs(rough.at(s).value - other.at(s).value);
  }
  EXPECT_GT(difference / 1000.0, 0.5 * rms);
}

TEST(Roughness, GivesTheSameNumbersEverywhere) {
  // A change of generator or kernel changes every result with a rough surface: to be noticed.
  const Roughness rough = profile(42);
  EXPECT_NEAR(rough.at(0.0).value, 1.8582445425342921e-09, 1e-12 * rms);
  EXPECT_NEAR(rough.at(0.0123456).value, -2.2871859539023199e-09, 1e-12 * rms);
}

TEST(Roughness, GoesOnBeyondTheEndsAndKeepsWhatIsNoNumber) {
  const Roughness rough = profile(9);
  EXPECT_TRUE(std::isfinite(rough.at(-1e-6).value));
  EXPECT_TRUE(std::isfinite(rough.at(length + 1e-6).value));
  EXPECT_NEAR(rough.at(-1e-12).value, rough.at(0.0).value, 1e-5 * rms);
  EXPECT_TRUE(std::isnan(rough.at(std::numeric_limits<double>::quiet_NaN()).value));
}

TEST(Roughness, RefusesCorrelationLengthsThatItCannotHold) {
  EXPECT_THAT(message_of<std::invalid_argument>([] {
                Roughness({rms, 0.0, 1}, length);
              }),
              HasSubstr("not positive"));
  EXPECT_THAT(message_of<std::invalid_argument>([] {
                Roughness({rms, 0.9e-7, 1}, length);
              }),
              HasSubstr("too small"));
}

}  // namespace
}  // namespace stridor
