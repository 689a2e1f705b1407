#include "analysis/ridges.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "tests/support/constants.hpp"

namespace stridor {
namespace {

using test::two_pi;
using ::testing::SizeIs;

constexpr double dt = 1.0e-5;
constexpr Band band{2.5e3, 15.0e3};
constexpr double smoothing = 5.0e-3;

std::vector<Ridge> ridges_of(const std::vector<double>& samples, double floor, IndexRange measured,
                             std::size_t at_a_time = 100000) {
  RidgeFinder finder(dt, band, smoothing, floor, measured, samples.size());
  const IndexRange needed = finder.needed();
  for (std::size_t i = needed.begin; i < needed.end; i += at_a_time) {
    const std::size_t end = std::min(needed.end, i + at_a_time);
    finder.take(std::span(samples).subspan(i, end - i));
  }
  return std::move(finder).finish();
}

std::vector<double> ridge_sine(double frequency, double amplitude, std::size_t count) {
  std::vector<double> samples(count);
  for (std::size_t i = 0; i < count; ++i)
    samples[i] = amplitude * std::sin(two_pi * frequency * static_cast<double>(i) * dt);
  return samples;
}

// Under this window a sine half-way between two lines of pieces twice as long by zeros reads 0.2 dB
// (2.4 %) too low; at the ends, where a piece is half as long, its own conjugate adds as much.
TEST(Ridges, ASineIsOneWithItsFrequencyAndLevelFromEndToEnd) {
  for (const double frequency : {2.6e3, 3.333e3, 9.876e3, 14.9e3}) {
    const auto samples = ridge_sine(frequency, 3.0, 20000);
    const auto ridges = ridges_of(samples, 0.1, {0, samples.size()});
    ASSERT_THAT(ridges, SizeIs(1)) << frequency;
    EXPECT_EQ(ridges[0].front().at, 0u);
    EXPECT_GT(ridges[0].back().at, samples.size() - 251);
    ASSERT_THAT(ridges[0], SizeIs(80));
    for (const RidgePoint& point : ridges[0]) {
      EXPECT_NEAR(point.frequency, frequency, 10.0) << point.at;
      EXPECT_NEAR(point.level, 3.0 / std::numbers::sqrt2, 0.05 * 3.0) << point.at;
    }
  }
}

TEST(Ridges, TwoSoundsEightyDecibelsApartAreTwo) {
  auto samples = ridge_sine(4.0e3, 1.0, 20000);
  const auto weak = ridge_sine(9.0e3, 2.0e-4, 20000);
  for (std::size_t i = 0; i < samples.size(); ++i) samples[i] += weak[i];
  const auto ridges = ridges_of(samples, 1.0e-5, {0, samples.size()});
  ASSERT_THAT(ridges, SizeIs(2));
  const Ridge& second = ridges[ridges[0].front().frequency > 6.0e3 ? 0 : 1];
  EXPECT_NEAR(second[40].frequency, 9.0e3, 10.0);
  EXPECT_NEAR(second[40].level, 2.0e-4 / std::numbers::sqrt2, 0.03 * 2.0e-4);
}

TEST(Ridges, NoiseBelowTheFloorHasNone) {
  std::mt19937_64 generator(3);
  std::normal_distribution<double> normal;
  std::vector<double> samples(50000);
  for (double& x : samples) x = normal(generator);
  // The noise of the band as a whole, 0.5, is the floor; a line of it holds a sixtieth of its power.
  EXPECT_THAT(ridges_of(samples, 0.5, {0, samples.size()}), SizeIs(0));
}

TEST(Ridges, DoNotDependOnHowTheSamplesCome) {
  std::mt19937_64 generator(4);
  std::normal_distribution<double> normal;
  auto samples = ridge_sine(5.0e3, 2.0, 30000);
  for (double& x : samples) x += normal(generator);
  const auto whole = ridges_of(samples, 0.3, {700, 29000});
  ASSERT_FALSE(whole.empty());
  for (const std::size_t at_a_time : {std::size_t{1}, std::size_t{333}, std::size_t{4096}}) {
    const auto pieces = ridges_of(samples, 0.3, {700, 29000}, at_a_time);
    ASSERT_EQ(pieces.size(), whole.size());
    for (std::size_t r = 0; r < whole.size(); ++r) {
      ASSERT_EQ(pieces[r].size(), whole[r].size());
      for (std::size_t i = 0; i < whole[r].size(); ++i) {
        EXPECT_EQ(pieces[r][i].at, whole[r][i].at);
        EXPECT_EQ(pieces[r][i].frequency, whole[r][i].frequency);
        EXPECT_EQ(pieces[r][i].level, whole[r][i].level);
      }
    }
  }
}

TEST(Ridges, OneThatStopsEndsWhereItStops) {
  auto samples = ridge_sine(5.0e3, 1.0, 40000);
  for (std::size_t i = 20000; i < samples.size(); ++i) samples[i] = 0.0;
  const auto ridges = ridges_of(samples, 0.1, {0, samples.size()});
  ASSERT_THAT(ridges, SizeIs(1));
  // A piece reaches 500 samples to both sides.
  EXPECT_NEAR(static_cast<double>(ridges[0].back().at), 20000.0, 500.0);
}

}  // namespace
}  // namespace stridor
