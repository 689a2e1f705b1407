// Bursts in white noise, and how well they can be found there.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>
#include <vector>

#include "analysis/band_pass.hpp"
#include "analysis/bursts.hpp"
#include "tests/support/constants.hpp"

namespace stridor::test {

inline constexpr double dt = 1.0e-5;  ///< s
inline constexpr BurstParameters wide{.band = {2.5e3, 15.0e3}};

/// White noise of variance 1.
inline std::vector<double> white(std::size_t count, std::uint64_t seed) {
  std::mt19937_64 generator(seed);
  std::normal_distribution<double> normal;
  std::vector<double> samples(count);
  for (double& x : samples) x = normal(generator);
  return samples;
}

/// R.m.s. value of white noise of variance 1 after the band-pass filter.
inline double band_rms(Band band) {
  double square = 0.0;
  constexpr int points = 20000;
  for (int i = 0; i < points; ++i) {
    const double gain = band_pass_gain((i + 0.5) / points * 0.5 / dt, dt, band);
    square += gain * gain / points;
  }
  return std::sqrt(square);
}

/// Grows with `growth`, passing the r.m.s. value `level` at `start`, to `peak_time`, then decays.
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

/// In white noise that fills the band a gain is uncertain. What the noise leaves in the band of the
/// burst's own, 4/T = 800 Hz of 12.5 kHz, is ln √(12500/800) = 1.4 below the level, and the growth
/// cannot be followed beyond that. On the way there it disturbs the slope of ln e over T by about
/// √2·(own noise/burst)/T = 70 1/s where the burst is as strong as the level, and by less than half
/// of any growth here, 20 to 42 1/s, from 4 times the level on.
inline void expect_gain(double found, double wanted) {
  EXPECT_GT(found, wanted - std::log(4.0) - 0.14);
  EXPECT_LT(found, wanted + 1.4);
}

/// The gain of the filter at these frequencies is within 1.4 % of 1. The start, where the burst's
/// power passes the noise's, is blurred by T; the scatter of the mean square over T, 1/√(B T) = 13
/// %, moves it by 0.13/(2·growth) = 2 ms for the slowest. The apex loses (growth + decay) T/8, up
/// to 0.14. At four times the level e scatters by 4.5 %, its logarithm's slope over 2 T by 6 1/s.
inline void expect_found(const Burst& found, const Synthetic& wanted, double level) {
  EXPECT_NEAR(found.start, wanted.start, wide.smoothing);
  expect_gain(found.gain, wanted.gain());
  EXPECT_NEAR(found.frequency, wanted.frequency, 0.02 * wanted.frequency);
  EXPECT_NEAR(found.growth, wanted.growth, 12.0);
  EXPECT_NEAR(found.peak_time, wanted.peak_time, 1.0e-3);
  const double peak = wanted.amplitude(wanted.peak_time, level);
  EXPECT_NEAR(found.peak, peak, 0.05 * peak + 4.0 * level);
}

}  // namespace stridor::test
