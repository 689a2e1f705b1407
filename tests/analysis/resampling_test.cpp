#include "analysis/resampling.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

#include "tests/support/constants.hpp"

namespace stridor {
namespace {

using test::two_pi;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

/// @param frequency over the rate of the samples
std::vector<double> tone(std::size_t count, double frequency) {
  std::vector<double> samples(count);
  for (std::size_t i = 0; i < count; ++i)
    samples[i] = std::sin(two_pi * frequency * static_cast<double>(i));
  return samples;
}

/// Largest difference from the same tone sampled at the new rate, away from the ends by the reach
/// of the filter.
double error_of_tone(double frequency, double ratio) {
  constexpr std::size_t count = 4000;
  const std::vector<double> result = resampled(tone(count, frequency), ratio);
  const double reach = 65.0 * std::max(1.0, ratio);
  double largest = 0.0;
  for (std::size_t j = 0; j < result.size(); ++j) {
    const double at = static_cast<double>(j);
    if (at < reach || at + reach > static_cast<double>(result.size())) continue;
    largest = std::max(largest, std::abs(result[j] - std::sin(two_pi * frequency * at / ratio)));
  }
  return largest;
}

TEST(Resampling, TonesAreTheSameAtEveryRate) {
  for (const double ratio : {0.3, 0.48, 48000.0 / 44100.0, 1.0, 2.0, 5.77}) {
    const double limit = 0.5 * std::min(1.0, ratio);
    for (const double part : {0.01, 0.3, 0.7, 0.95}) {
      EXPECT_LT(error_of_tone(part * limit, ratio), 2e-4)
          << "ratio " << ratio << ", " << part << " of the highest frequency";
    }
  }
}

TEST(Resampling, WhatTheLowerRateCannotHoldIsTakenAway) {
  const std::vector<double> result = resampled(tone(4000, 0.2), 0.3);  // up to 0.15
  const auto inner = [&](std::size_t margin) {
    double largest = 0.0;
    for (std::size_t j = margin; j + margin < result.size(); ++j)
      largest = std::max(largest, std::abs(result[j]));
    return largest;
  };
  EXPECT_LT(inner(70), 1e-4);
}

TEST(Resampling, CountsSamplesByTheirTimesAndKeepsTheFirstInPlace) {
  EXPECT_TRUE(resampled({}, 0.5).empty());
  EXPECT_EQ(resampled(tone(1, 0.1), 3.0).size(), 1u);
  EXPECT_EQ(resampled(tone(101, 0.1), 0.5).size(), 51u);
  EXPECT_EQ(resampled(tone(100, 0.1), 0.5).size(), 50u);
  std::vector<double> impulse(200, 0.0);
  impulse[100] = 1.0;
  const std::vector<double> result = resampled(impulse, 2.0);
  EXPECT_NEAR(result[200], 1.0, 1e-12);
  EXPECT_NEAR(result[202], 0.0, 1e-12);
}

TEST(Resampling, RefusesRatesThatAreNone) {
  for (const double ratio : {0.0, -1.0, HUGE_VAL, std::nan("")}) {
    EXPECT_THAT([&] { resampled(tone(10, 0.1), ratio); },
                ThrowsMessage<std::invalid_argument>(HasSubstr("must be positive")));
  }
}

}  // namespace
}  // namespace stridor
