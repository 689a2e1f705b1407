// The envelope of a signal and its quiet level, above which bursts stand out.
#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

#include "analysis/bursts.hpp"
#include "tests/support/burst_signals.hpp"
#include "tests/support/constants.hpp"

namespace stridor {
namespace {

using namespace test;

TEST(BurstEnvelope, IsTheEffectiveValueOfASineAndMeetsTheEndsSmoothly) {
  std::vector<double> samples(20000);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    samples[i] = 3.0 * std::sin(two_pi * 6.0e3 * static_cast<double>(i) * dt + 0.4);
  }
  const auto envelope = burst_envelope(samples, dt, wide.band, wide.smoothing);
  ASSERT_EQ(envelope.size(), samples.size());
  // The band-pass itself feels the ends for 2/(upper − lower) = 0.16 ms of the 2.5 ms averaged.
  for (std::size_t i = 0; i < envelope.size(); ++i) {
    const bool is_inside = i > 500 && i + 500 < envelope.size();
    EXPECT_NEAR(envelope[i], 3.0 / std::numbers::sqrt2, is_inside ? 1e-4 : 0.1);
  }
}

TEST(BurstEnvelope, MatchesTheMeanOverEveryWindow) {
  // Two tones 200 Hz apart beat: |z|² = 2 + 2 cos(2π·200 t), its mean over T = 4 ms centred at t
  // multiplies the beat by sinc(200·0.004) = sin(0.8π)/(0.8π), e² is half of it.
  std::vector<double> samples(30000);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const double t = static_cast<double>(i) * dt;
    samples[i] = std::cos(two_pi * 6.0e3 * t) + std::cos(two_pi * 6.2e3 * t);
  }
  const double t_mean = 401.0 * dt;
  const double beat =
      std::sin(std::numbers::pi * 200.0 * t_mean) / (std::numbers::pi * 200.0 * t_mean);
  const auto envelope = burst_envelope(samples, dt, wide.band, 4.0e-3);
  for (std::size_t i = 1000; i < 29000; ++i) {
    const double t = static_cast<double>(i) * dt;
    const double expected = 1.0 + beat * std::cos(two_pi * 200.0 * t);
    EXPECT_NEAR(envelope[i] * envelope[i], expected, 1e-3);
  }
}

TEST(BurstEnvelope, AStrongEndDoesNotLeakIntoAQuietStart) {
  // 10⁶ at the end, nothing in the first half. The filter's own response has decayed to 10⁻¹².
  std::vector<double> samples(20000);
  for (std::size_t i = 10000; i < samples.size(); ++i) {
    samples[i] = 1e6 * std::sin(two_pi * 3.5e3 * static_cast<double>(i) * dt);
  }
  const auto envelope = burst_envelope(samples, dt, wide.band, wide.smoothing);
  for (std::size_t i = 0; i < 5000; ++i) EXPECT_LT(envelope[i], 1e-3);
}

TEST(QuietLevel, OfWhiteNoiseIsWhatTheBandLeaves) {
  // 1 s: 12500 independent values, so the level is good to 1 %, the shape to some 10 %.
  const double expected = band_rms(wide.band);
  BurstParameters given = wide;
  given.quiet = Window{0.2, 0.8};
  for (const BurstParameters& parameters : {wide, given}) {
    const QuietLevel level = find_quiet_level(white(100000, 3), dt, parameters);
    EXPECT_NEAR(level.rms, expected, 0.02 * expected);
    EXPECT_NEAR(level.freedom, 12.5e3 * wide.smoothing, 15.0);
    EXPECT_NEAR(level.threshold, 4.0 * level.rms, 1e-12);
  }
}

TEST(QuietLevel, IsHardlyMovedByABurstOfAThirdOfTheSignal) {
  std::vector<double> samples = white(100000, 4);
  for (std::size_t i = 30000; i < 63000; ++i) {
    samples[i] += 1e3 * std::sin(two_pi * 3.5e3 * static_cast<double>(i) * dt);
  }
  const double expected = band_rms(wide.band);
  // The quartile of all is then the 37 % quantile of the quiet part: a few percent for k = 62.
  EXPECT_NEAR(find_quiet_level(samples, dt, wide).rms, expected, 0.1 * expected);
}

TEST(QuietLevel, ANarrowBandOrAShortSignalNeedsAHigherThreshold) {
  const BurstParameters narrow{.band = {3.4e3, 3.6e3}};
  const auto ratio = [](std::size_t count, const BurstParameters& parameters) {
    const QuietLevel level = find_quiet_level(white(count, 5), dt, parameters);
    return level.threshold / level.rms;
  };
  EXPECT_GT(ratio(100000, narrow), 1.2 * wide.threshold);
  EXPECT_GT(ratio(10000, narrow), 2.0 * ratio(100000, narrow));
  EXPECT_GT(ratio(200, wide), ratio(100000, wide));
}

}  // namespace
}  // namespace stridor
