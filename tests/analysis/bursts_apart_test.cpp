// Bursts told apart, in time and in frequency.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <numbers>
#include <vector>

#include "analysis/bursts.hpp"
#include "tests/support/burst_signals.hpp"
#include "tests/support/constants.hpp"

namespace stridor {
namespace {

using namespace test;
using ::testing::SizeIs;

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

}  // namespace
}  // namespace stridor
