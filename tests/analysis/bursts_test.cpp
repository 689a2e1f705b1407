#include "analysis/bursts.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <random>
#include <vector>

#include "tests/support/constants.hpp"
#include "tests/support/rejection.hpp"

namespace stridor {
namespace {

using test::expect_rejection;
using ::testing::SizeIs;

using test::two_pi;
constexpr double dt = 1.0e-5;
constexpr BurstParameters wide{.band = {2.5e3, 15.0e3}};

std::vector<double> white(std::size_t count, std::uint64_t seed) {
  std::mt19937_64 generator(seed);
  std::normal_distribution<double> normal;
  std::vector<double> samples(count);
  for (double& x : samples) x = normal(generator);
  return samples;
}

// What the band leaves of white noise of variance 1.
double band_rms(Band band) {
  double square = 0.0;
  constexpr int points = 20000;
  for (int i = 0; i < points; ++i) {
    const double gain = band_pass_gain((i + 0.5) / points * 0.5 / dt, dt, band);
    square += gain * gain / points;
  }
  return std::sqrt(square);
}

// Grows with `growth`, passing the r.m.s. value `level` at `start`, to `peak_time`, then decays.
struct Synthetic {
  double start;
  double peak_time;
  double growth;
  double decay;
  double frequency;

  double gain() const { return growth * (peak_time - start); }
  double amplitude(double t, double level) const {
    const double exponent = t < peak_time ? growth * (t - start) : gain() - decay * (t - peak_time);
    return std::numbers::sqrt2 * level * std::exp(exponent);
  }
  void add_to(std::vector<double>& samples, double level) const {
    for (std::size_t i = 0; i < samples.size(); ++i) {
      const double t = static_cast<double>(i) * dt;
      samples[i] += amplitude(t, level) * std::sin(two_pi * frequency * t);
    }
  }
};

// In white noise that fills the band a gain is uncertain. What the noise leaves in the band of the
// burst's own, 4/T = 800 Hz of 12.5 kHz, is ln √(12500/800) = 1.4 below the level, and the growth
// cannot be followed beyond that. On the way there it disturbs the slope of ln e over T by about
// √2·(own noise/burst)/T = 70 1/s where the burst is as strong as the level, and by less than half
// of any growth here, 20 to 42 1/s, from 4 times the level on.
void expect_gain(double found, double wanted) {
  EXPECT_GT(found, wanted - std::log(4.0) - 0.14);
  EXPECT_LT(found, wanted + 1.4);
}

// The gain of the filter at these frequencies is within 1.4 % of 1. The start, where the burst's
// power passes the noise's, is blurred by T; the scatter of the mean square over T, 1/√(B T) = 13
// %, moves it by 0.13/(2·growth) = 2 ms for the slowest. The apex loses (growth + decay) T/8, up to
// 0.14. At four times the level e scatters by 4.5 %, its logarithm's slope over 2 T by 6 1/s.
void expect_found(const Burst& found, const Synthetic& wanted, double level) {
  EXPECT_NEAR(found.start, wanted.start, wide.smoothing);
  expect_gain(found.gain, wanted.gain());
  EXPECT_NEAR(found.frequency, wanted.frequency, 0.02 * wanted.frequency);
  EXPECT_NEAR(found.growth, wanted.growth, 12.0);
  EXPECT_NEAR(found.peak_time, wanted.peak_time, 1.0e-3);
  const double peak = wanted.amplitude(wanted.peak_time, level);
  EXPECT_NEAR(found.peak, peak, 0.05 * peak + 4.0 * level);
}

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

TEST(Bursts, SeveralAreToldApart) {
  const double level = band_rms(wide.band);
  const Synthetic wanted[] = {{0.3, 0.35, 80.0, 120.0, 3.5e3},
                              {0.8, 0.85, 90.0, 130.0, 10.0e3},
                              {1.2, 1.3, 50.0, 120.0, 6.9e3}};
  std::vector<double> samples = white(160000, 11);
  for (const Synthetic& burst : wanted) burst.add_to(samples, level);
  const auto found = find_bursts(samples, dt, wide);
  ASSERT_THAT(found, SizeIs(3));
  for (std::size_t i = 0; i < 3; ++i) expect_found(found[i], wanted[i], level);
}

TEST(Bursts, AnyNumberAtTheSameTimeIsFound) {
  const double level = band_rms(wide.band);
  const std::vector<Synthetic> wanted{{0.60, 0.66, 85.0, 50.0, 3.5e3},
                                      {0.62, 0.70, 60.0, 50.0, 6.1e3},
                                      {0.64, 0.70, 85.0, 50.0, 10.6e3}};
  std::vector<double> samples = white(120000, 41);
  for (const Synthetic& one : wanted) one.add_to(samples, level);
  const auto found = find_bursts(samples, dt, wide);
  ASSERT_THAT(found, SizeIs(3));
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    expect_found(found[i], wanted[i], level);
    EXPECT_NEAR(found[i].start_frequency, wanted[i].frequency, 50.0);
    EXPECT_NEAR(found[i].end_frequency, wanted[i].frequency, 50.0);
  }
}

// 60 dB beside the louder one, and still 20 dB above the noise.
TEST(Bursts, OneBesideAnotherAThousandTimesLouderIsFound) {
  const double level = band_rms(wide.band);
  const Synthetic loud{0.60, 0.60 + 9.2 / 60.0, 60.0, 50.0, 3.5e3};
  const Synthetic quiet{0.65, 0.65 + 2.3 / 60.0, 60.0, 50.0, 10.6e3};
  std::vector<double> samples = white(120000, 42);
  loud.add_to(samples, level);
  quiet.add_to(samples, level);
  const auto found = find_bursts(samples, dt, wide);
  ASSERT_THAT(found, SizeIs(2));
  EXPECT_NEAR(found[0].frequency, loud.frequency, 50.0);
  EXPECT_NEAR(std::log(found[0].peak / level), 9.2 + 0.35, 0.15);
  EXPECT_NEAR(found[1].frequency, quiet.frequency, 50.0);
  expect_gain(found[1].gain, quiet.gain());
  EXPECT_NEAR(found[1].start, quiet.start, wide.smoothing);
}

TEST(Bursts, OneThatChangesItsFrequencyIsOneAndSaysFromWhereToWhere) {
  // 3.5 kHz at 0.6 s and 5 kHz at 0.75 s: ten times its own band's width in all.
  const Synthetic envelope{0.6, 0.68, 60.0, 50.0, 0.0};
  const double level = band_rms(wide.band);
  std::vector<double> samples = white(120000, 43);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const double t = static_cast<double>(i) * dt;
    const double phase = two_pi * (3.5e3 * (t - 0.6) + 0.5 * 1.0e4 * (t - 0.6) * (t - 0.6));
    if (t > 0.5 && t < 0.9) samples[i] += envelope.amplitude(t, level) * std::sin(phase);
  }
  const auto found = find_bursts(samples, dt, wide);
  ASSERT_THAT(found, SizeIs(1));
  const auto frequency_at = [](double t) { return 3.5e3 + 1.0e4 * (t - 0.6); };
  EXPECT_NEAR(found[0].start_frequency, frequency_at(found[0].start), 100.0);
  EXPECT_NEAR(found[0].end_frequency, frequency_at(found[0].end), 150.0);
  EXPECT_NEAR(found[0].peak_time, envelope.peak_time, 1.0e-3);
  EXPECT_GT(found[0].frequency, found[0].start_frequency);
  EXPECT_LT(found[0].frequency, frequency_at(envelope.peak_time) + 50.0);
  // Its course, with the r.m.s. value where it is steady enough for pieces of 2 T.
  ASSERT_GT(found[0].course.size(), 40U);
  for (const BurstPoint& point : found[0].course) {
    EXPECT_GE(point.time, found[0].start);
    EXPECT_LE(point.time, found[0].end);
    const bool is_loud = envelope.amplitude(point.time, level) > 20.0 * level;
    if (!is_loud) continue;
    EXPECT_NEAR(point.frequency, frequency_at(point.time), 15.0) << point.time;
    EXPECT_NEAR(point.level * std::numbers::sqrt2 / envelope.amplitude(point.time, level), 1.0,
                0.15)
        << point.time;
  }
}

TEST(Bursts, OvertonesAreNamedAndOthersAreNot) {
  const double level = band_rms(wide.band);
  std::vector<double> samples = white(120000, 44);
  // A sound that is no sine, its frequency rising, and one of its own beside its second harmonic.
  const Synthetic envelope{0.6, 0.68, 70.0, 50.0, 0.0};
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const double t = static_cast<double>(i) * dt;
    const double phase = two_pi * (2.5e3 * (t - 0.6) + 0.5 * 2.0e3 * (t - 0.6) * (t - 0.6));
    if (t < 0.5 || t > 0.9) continue;
    const double amplitude = envelope.amplitude(t, level);
    samples[i] +=
        amplitude * (std::sin(phase) + 0.3 * std::sin(2.0 * phase) + 0.15 * std::sin(3.0 * phase));
  }
  Synthetic{0.6, 0.66, 70.0, 50.0, 9.1e3}.add_to(samples, level);
  const auto found = find_bursts(samples, dt, wide);
  ASSERT_THAT(found, SizeIs(4));
  std::map<int, double> frequencies;  // by order
  std::size_t loudest = 0;
  for (std::size_t i = 0; i < found.size(); ++i)
    if (found[i].peak > found[loudest].peak) loudest = i;
  EXPECT_FALSE(found[loudest].harmonic);
  EXPECT_NEAR(found[loudest].frequency, 2.6e3, 100.0);
  int num_own = 0;
  for (const Burst& burst : found) {
    if (!burst.harmonic) {
      ++num_own;
      continue;
    }
    EXPECT_EQ(burst.harmonic->of, loudest);
    EXPECT_NEAR(burst.frequency / found[loudest].frequency, burst.harmonic->order, 0.1);
    EXPECT_TRUE(frequencies.emplace(burst.harmonic->order, burst.frequency).second);
  }
  EXPECT_EQ(num_own, 2);
  EXPECT_EQ(frequencies.count(2), 1U);
  EXPECT_EQ(frequencies.count(3), 1U);
}

TEST(Bursts, ADipOfLessThanSixDecibelsDoesNotDivideAndAReturnToQuietDoes) {
  const double level = band_rms(wide.band);
  for (const double depth : {0.55, 1.0}) {
    // A hundred times the level, with a cosine-shaped dip of 60 ms in the middle.
    std::vector<double> samples = white(100000, 12);
    for (std::size_t i = 0; i < samples.size(); ++i) {
      const double t = static_cast<double>(i) * dt;
      const double rise =
          1.0 / (1.0 + std::exp(-80.0 * (t - 0.4))) / (1.0 + std::exp(80.0 * (t - 0.6)));
      const double x = std::abs(t - 0.5) / 0.03;
      const double dip =
          x > 1.0 ? 1.0 : 1.0 - depth * 0.9 * (0.5 + 0.5 * std::cos(std::numbers::pi * x));
      samples[i] += (depth < 1.0 ? dip : std::max(0.0, 1.0 - (1.0 - dip) / 0.9)) * rise * 100.0 *
                    level * std::sin(two_pi * 3.5e3 * t);
    }
    const auto found = find_bursts(samples, dt, wide);
    ASSERT_THAT(found, SizeIs(depth < 1.0 ? 1 : 2));
    for (const Burst& burst : found) EXPECT_NEAR(burst.frequency, 3.5e3, 70.0);
    if (found.size() == 2) {
      EXPECT_LE(found[0].end, found[1].start);
    }
  }
}

TEST(Bursts, WhatIsLeftOfTheOneBeforeIsTheLevelOfTheNext) {
  const double level = band_rms(wide.band);
  std::vector<double> samples = white(120000, 13);
  const auto log_envelope = [](double t) {  // up to 6 at 0.5 s, down to 3 at 0.6, up to 7 at 0.7
    if (t < 0.5) return 60.0 * (t - 0.4);
    if (t < 0.6) return 6.0 - 30.0 * (t - 0.5);
    if (t < 0.7) return 3.0 + 40.0 * (t - 0.6);
    return 7.0 - 60.0 * (t - 0.7);
  };
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const double t = static_cast<double>(i) * dt;
    samples[i] +=
        std::numbers::sqrt2 * level * std::exp(log_envelope(t)) * std::sin(two_pi * 3.5e3 * t);
  }
  const auto found = find_bursts(samples, dt, wide);
  ASSERT_THAT(found, SizeIs(2));
  expect_gain(found[0].gain, 6.0);
  EXPECT_NEAR(found[1].gain, 4.0, 0.2);
  // √2 above the minimum: after ln √2/40 s.
  EXPECT_NEAR(found[1].start, 0.6 + 0.5 * std::numbers::ln2 / 40.0, wide.smoothing);
  EXPECT_LE(found[0].end, found[1].start);
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
