#include "analysis/bursts.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <vector>

#include "tests/support/burst_signals.hpp"
#include "tests/support/constants.hpp"
#include "tests/support/rejection.hpp"

namespace stridor {
namespace {

using namespace test;
using ::testing::SizeIs;

TEST(Bursts, NoneInGaussianNoiseOfAnyLength) {
  // A false burst in one record has a probability below 10⁻⁴.
  const BurstParameters narrow{.band = {3.4e3, 3.6e3}, .minimum_duration = 0.0};
  BurstParameters given = wide;
  given.minimum_duration = 0.0;
  given.quiet = Window{0.0, 1.0e-3};
  BurstParameters rough = wide;
  rough.smoothing = 0.4e-3;
  rough.minimum_duration = 0.0;
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    for (const std::size_t count : {1U, 2U, 30U, 300U, 2000U, 20000U}) {
      const std::vector<double> samples = white(count, seed);
      for (const BurstParameters& parameters : {wide, narrow, given, rough}) {
        EXPECT_THAT(find_bursts(samples, dt, parameters), SizeIs(0)) << seed << ' ' << count;
      }
    }
    EXPECT_THAT(find_bursts(white(200000, seed), dt, wide), SizeIs(0)) << seed;
  }
}

TEST(Bursts, NoneInSilenceConstantsSteadyTonesAndDecay) {
  EXPECT_THAT(find_bursts({}, dt, wide), SizeIs(0));
  EXPECT_THAT(find_bursts(std::vector<double>(50000, 0.0), dt, wide), SizeIs(0));
  EXPECT_THAT(find_bursts(std::vector<double>(50000, -7.3), dt, wide), SizeIs(0));
  std::vector<double> tone(50000);
  std::vector<double> decay(50000);
  for (std::size_t i = 0; i < tone.size(); ++i) {
    const double t = static_cast<double>(i) * dt;
    tone[i] = std::sin(two_pi * 3.5e3 * t);
    decay[i] = tone[i] * std::exp(-30.0 * t);
  }
  EXPECT_THAT(find_bursts(tone, dt, wide), SizeIs(0));
  EXPECT_THAT(find_bursts(decay, dt, wide), SizeIs(0));
}

TEST(Bursts, GrowthInNoiseIsRecovered) {
  const double level = band_rms(wide.band);
  std::uint64_t seed = 100;
  for (const double growth : {40.0, 85.0}) {
    for (const double gain : {3.5, 6.0}) {
      for (const double frequency : {3.5e3, 7.0e3, 9.7e3}) {
        const Synthetic wanted{0.6, 0.6 + gain / growth, growth, 50.0, frequency};
        std::vector<double> samples = white(120000, ++seed);
        wanted.add_to(samples, level);
        const auto found = find_bursts(samples, dt, wide);
        ASSERT_THAT(found, SizeIs(1)) << growth << ' ' << gain << ' ' << frequency;
        expect_found(found[0], wanted, level);
        // Back at the level after the same number of e-folds.
        EXPECT_NEAR(found[0].end, wanted.peak_time + gain / wanted.decay, 2.0 * wide.smoothing);
      }
    }
  }
}

// A steady vibration of `strength` times the noise in the band, which grows from 0.6 s on.
struct Seeded {
  double strength;
  double growth;
  double gain;
  double frequency;

  static constexpr double onset = 0.6;
  double exponent(double t) const {
    const double apex = onset + gain / growth;
    return t < apex ? std::max(0.0, growth * (t - onset)) : std::max(0.0, gain - 50.0 * (t - apex));
  }
  /// Where the envelope, √(1 + strength² e^(2 exponent)) times the noise, is √2 times that before.
  double crossing() const {
    return onset + std::log(2.0 + 1.0 / (strength * strength)) / (2.0 * growth);
  }
  std::vector<double> in_noise(std::uint64_t seed) const {
    const double amplitude = std::numbers::sqrt2 * strength * band_rms(wide.band);
    std::vector<double> samples = white(120000, seed);
    for (std::size_t i = 0; i < samples.size(); ++i) {
      const double t = static_cast<double>(i) * dt;
      samples[i] += amplitude * std::exp(exponent(t)) * std::sin(two_pi * frequency * t);
    }
    return samples;
  }
};

TEST(Bursts, WhatGrowsFromASeedInNoiseIsRecovered) {
  // Of a seed 12 dB above the noise the gain is right within 5 %: the noise in the burst's own
  // band, a quarter of that in the whole, is 1/16 of it. Of a weaker one the noise makes the slope
  // fall to half before the onset is reached, and the gain comes out too low, never too high.
  std::uint64_t seed = 400;
  for (const double strength : {1.0, 4.0}) {
    for (const double growth : {40.0, 85.0}) {
      for (const double gain : {3.5, 6.0}) {
        for (const double frequency : {3.5e3, 9.7e3}) {
          const Seeded wanted{strength, growth, gain, frequency};
          const auto found = find_bursts(wanted.in_noise(++seed), dt, wide);
          ASSERT_THAT(found, SizeIs(1));
          EXPECT_NEAR(found[0].start, wanted.crossing(), wide.smoothing);
          EXPECT_LT(found[0].gain, 1.05 * gain);
          if (strength >= 4.0) {
            EXPECT_GT(found[0].gain, 0.95 * gain) << growth << ' ' << frequency;
          }
        }
      }
    }
  }
}

TEST(Bursts, TimesCountFromTheFirstSampleAndScaleDoesNotMatter) {
  const double level = band_rms(wide.band);
  const Synthetic wanted{0.3, 0.36, 80.0, 60.0, 3.5e3};
  std::vector<double> samples = white(60000, 7);
  wanted.add_to(samples, level);
  const auto found = find_bursts(samples, dt, wide);
  for (double& x : samples) x *= 1e-6;
  BurstParameters shifted = wide;
  shifted.measured = {10.0, 10.6};
  shifted.quiet = Window{10.05, 10.25};
  const auto later = find_bursts(samples, dt, shifted, 10.0);
  ASSERT_THAT(found, SizeIs(1));
  ASSERT_THAT(later, SizeIs(1));
  EXPECT_NEAR(later[0].start, found[0].start + 10.0, wide.smoothing);
  EXPECT_NEAR(later[0].peak_time, found[0].peak_time + 10.0, 1e-9);
  EXPECT_NEAR(later[0].peak, 1e-6 * found[0].peak, 1e-12);
  EXPECT_NEAR(later[0].gain, found[0].gain, 0.05 * found[0].gain);
  // Seen only where it is sought.
  shifted.measured = {10.0, 10.25};
  EXPECT_THAT(find_bursts(samples, dt, shifted, 10.0), SizeIs(0));
  shifted.measured = {20.0, 21.0};
  EXPECT_THAT(find_bursts(samples, dt, shifted, 10.0), SizeIs(0));
}

TEST(Bursts, OneCutOffByTheEndOfTheRecordEndsThere) {
  const double level = band_rms(wide.band);
  std::vector<double> samples = white(60000, 14);
  const Synthetic wanted{0.55, 1.0, 80.0, 1.0, 3.5e3};  // still growing: e⁴ at 0.6 s
  wanted.add_to(samples, level);
  const auto found = find_bursts(samples, dt, wide);
  ASSERT_THAT(found, SizeIs(1));
  EXPECT_NEAR(found[0].start, 0.55, wide.smoothing);
  EXPECT_NEAR(found[0].end, 0.59999, 1e-9);
  EXPECT_NEAR(found[0].peak_time, 0.6, 1.0e-3);
  expect_gain(found[0].gain, 4.0);
  EXPECT_NEAR(found[0].frequency, 3.5e3, 70.0);
}

// A vibration of 3.5 kHz passes an unstable window in the middle of 0.6 s: its growth is
// g √(1 − x²) with x from −1 to 1 in 70 ms, as between two places where eigenvalues part, and −20
// 1/s outside. The window begins with the amplitude `seed` times √2; before `blow` it is a fifth.
struct WindowPassed {
  static constexpr double growth = 100.0;
  static constexpr double half_width = 0.035;
  double seed;
  double blow;

  static double gain() { return 0.5 * std::numbers::pi * growth * half_width; }  // 5.5
  double amplitude(double t) const {
    const double x = std::clamp((t - 0.3) / half_width, -1.0, 1.0);
    const double inside =
        0.5 * (x * std::sqrt(1.0 - x * x) + std::asin(x)) + 0.25 * std::numbers::pi;
    const double outside = std::abs(t - 0.3 - half_width * x);
    const double exponent = growth * half_width * inside + 20.0 * (t < 0.3 ? outside : -outside);
    return std::numbers::sqrt2 * seed * std::exp(exponent) * (t < blow ? 0.2 : 1.0);
  }
};

// With a tone elsewhere in the band twenty times as strong as the vibration when its growth begins:
// the band as a whole rises by ln(1/20) less.
std::vector<double> window_beside_tone(const WindowPassed& passed) {
  std::vector<double> samples = white(60000, 18);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const double t = static_cast<double>(i) * dt;
    samples[i] = 1e-4 * samples[i] + std::numbers::sqrt2 * std::sin(two_pi * 9.0e3 * t) +
                 passed.amplitude(t) * std::sin(two_pi * 3.5e3 * t);
  }
  return samples;
}

// Up to where half of the growth is reached, x = −√¾, there is 2.9 % of the gain; the apex loses
// (growth + decay) T/16, where the growth within T/2 of it is at most 37 1/s and the decay 20: less
// than 0.02.
constexpr double before_onset = 0.029;

TEST(Bursts, GainIsThatOfTheirOwnFrequency) {
  const WindowPassed passed{0.05, 0.0};
  const auto found = find_bursts(window_beside_tone(passed), dt, wide);
  ASSERT_THAT(found, SizeIs(1));
  const double gain = WindowPassed::gain();
  EXPECT_NEAR(found[0].gain, (1.0 - before_onset) * gain, 0.02 * gain);
}

TEST(Bursts, ABlowThatSeedsThemIsNoPartOfTheGain) {
  // 15 and 5 ms before the window begins; half of the growth is reached 5 ms after that.
  for (const double blow : {0.25, 0.26}) {
    const auto found = find_bursts(window_beside_tone({0.05, blow}), dt, wide);
    ASSERT_THAT(found, SizeIs(1));
    const double gain = WindowPassed::gain();
    EXPECT_NEAR(found[0].gain, (1.0 - before_onset) * gain, 0.02 * gain) << blow;
  }
}

TEST(Bursts, FrequencyIsThatOfTheSteepestRiseNotOfTheWhole) {
  // 3.5 kHz while it grows, drifting by 8 % in the 0.1 s after the apex, where most samples are.
  const double level = band_rms(wide.band);
  std::vector<double> samples = white(100000, 15);
  const Synthetic shape{0.4, 0.45, 90.0, 15.0, 0.0};
  double phase = 0.0;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const double t = static_cast<double>(i) * dt;
    phase += two_pi * dt * (3.5e3 + 280.0 * std::clamp((t - 0.45) / 0.1, 0.0, 1.0));
    samples[i] += shape.amplitude(t, level) * std::sin(phase);
  }
  const auto found = find_bursts(samples, dt, wide);
  ASSERT_THAT(found, SizeIs(1));
  EXPECT_NEAR(found[0].frequency, 3.5e3, 20.0);
}

TEST(Bursts, ShorterThanTheMinimumDurationAreDropped) {
  const double level = band_rms(wide.band);
  std::vector<double> samples = white(60000, 16);
  Synthetic{0.3, 0.33, 100.0, 100.0, 3.5e3}.add_to(samples, level);  // 60 ms in all
  BurstParameters parameters = wide;
  parameters.minimum_duration = 0.05;
  EXPECT_THAT(find_bursts(samples, dt, parameters), SizeIs(1));
  parameters.minimum_duration = 0.075;
  EXPECT_THAT(find_bursts(samples, dt, parameters), SizeIs(0));
}

TEST(Bursts, OutsideTheBandIsNotSeen) {
  std::vector<double> samples = white(60000, 17);
  Synthetic{0.3, 0.35, 80.0, 60.0, 800.0}.add_to(samples, 1.0);
  EXPECT_THAT(find_bursts(samples, dt, wide), SizeIs(0));
  EXPECT_THAT(find_bursts(samples, dt, {.band = {400.0, 1600.0}}), SizeIs(1));
}

TEST(Bursts, RejectsWhatItCannotUse) {
  const std::vector<double> samples = white(1000, 1);
  const double infinity = std::numeric_limits<double>::infinity();
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto call = [&](const BurstParameters& parameters, double interval = dt,
                        double first = 0.0) {
    return [&samples, parameters, interval, first] {
      find_bursts(samples, interval, parameters, first);
    };
  };
  expect_rejection(call(wide, 0.0), "the sampling interval must be positive");
  expect_rejection(call(wide, dt, nan), "the time of the first sample must be finite");
  expect_rejection(call({.band = {5.0e3, 4.0e3}}), "does not satisfy 0 < lower < upper");
  for (const double threshold : {1.9, -4.0, infinity, nan}) {
    expect_rejection(call({.band = wide.band, .threshold = threshold}), "is not 2 or more");
  }
  for (const double smoothing : {0.0, -1.0, 3.9e-4, infinity, nan}) {
    expect_rejection(call({.band = wide.band, .smoothing = smoothing}),
                     "is not one period of the lower edge of the band, 0.0004 s, or more");
  }
  expect_rejection([&] { burst_envelope(samples, dt, wide.band, 0.0); }, "is not one period");
  for (const double duration : {-1.0, infinity, nan}) {
    expect_rejection(call({.band = wide.band, .minimum_duration = duration}), "is not 0 or more");
  }
  expect_rejection(call({.band = wide.band, .measured = {2.0, 1.0}}), "ends before it starts");
  expect_rejection(call({.band = wide.band, .quiet = Window{1.0, 0.0}}), "ends before it starts");
  expect_rejection(call({.band = wide.band, .quiet = Window{3.0, 4.0}}),
                   "no sample lies in the quiet window 3 to 4 s");
  expect_rejection(
      [&] {
        find_quiet_level(samples, dt, {.band = wide.band, .measured = {3.0, 4.0}});
      },
      "no sample lies in the measured window");
  std::vector<double> broken = samples;
  broken[3] = nan;
  expect_rejection([&] { find_bursts(broken, dt, wide); }, "the samples must be finite");
}

}  // namespace
}  // namespace stridor
