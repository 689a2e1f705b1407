// Vibration that lasts, beside bursts.
#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <vector>

#include "analysis/bursts.hpp"
#include "tests/support/burst_signals.hpp"
#include "tests/support/constants.hpp"

namespace stridor {
namespace {

using namespace test;

std::vector<double> sine(std::size_t count, double amplitude, double frequency) {
  std::vector<double> samples(count);
  for (std::size_t i = 0; i < count; ++i)
    samples[i] = amplitude * std::sin(two_pi * frequency * static_cast<double>(i) * dt);
  return samples;
}

Vibration vibration_of(const std::vector<double>& samples,
                       const BurstParameters& parameters = wide) {
  return find_vibration(SampleSpan(samples), dt, parameters);
}

TEST(LastingTone, IsNamedWithFrequencyLevelAndShare) {
  std::vector<double> samples = sine(60000, 2.0, 3530.0);
  const std::vector<double> noise = white(samples.size(), 7);
  for (std::size_t i = 0; i < samples.size(); ++i) samples[i] += noise[i];
  const Vibration found = vibration_of(samples);
  EXPECT_TRUE(found.bursts.empty());
  ASSERT_TRUE(found.lasting);
  EXPECT_NEAR(found.lasting->frequency, 3530.0, 2.0);
  EXPECT_NEAR(found.lasting->rms, std::numbers::sqrt2, 0.03);
  const double square = 2.0 + std::pow(band_rms(wide.band), 2);
  EXPECT_NEAR(found.lasting->share, 2.0 / square, 0.03);
}

TEST(LastingTone, IsNoNoiseHoweverNarrowTheBand) {
  for (const double upper : {15.0e3, 4.0e3, 2.8e3}) {
    BurstParameters parameters = wide;
    parameters.band.upper = upper;
    for (const std::uint64_t seed : {1U, 2U, 3U, 4U, 5U, 6U})
      EXPECT_FALSE(vibration_of(white(100000, seed), parameters).lasting) << upper << ' ' << seed;
  }
}

TEST(LastingTone, IsNoBurstAndNoVibrationThatDiesOut) {
  std::vector<double> burst = white(60000, 3);
  Synthetic{0.2, 0.35, 40.0, 60.0, 3530.0}.add_to(burst, 1.0);
  EXPECT_FALSE(vibration_of(burst).lasting);
  std::vector<double> decaying = sine(60000, 1.0, 3530.0);
  for (std::size_t i = 0; i < decaying.size(); ++i)
    decaying[i] *= std::exp(-10.0 * static_cast<double>(i) * dt);
  EXPECT_FALSE(vibration_of(decaying).lasting);
}

TEST(LastingTone, IsNotSoughtInTooShortASignalOrBelowRounding) {
  EXPECT_TRUE(vibration_of(sine(4100, 1.0, 3530.0)).lasting);
  EXPECT_FALSE(vibration_of(sine(3900, 1.0, 3530.0)).lasting);  // less than 8 T
  std::vector<double> outside = sine(60000, 1.0, 10.0);
  EXPECT_FALSE(vibration_of(outside).lasting);
  EXPECT_FALSE(vibration_of(std::vector<double>(60000, 0.0)).lasting);
}

}  // namespace
}  // namespace stridor
