#include "analysis/statistics.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <stdexcept>
#include <vector>

namespace stridor {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

TEST(Statistics, RmsOfASineOverWholePeriodsIsItsAmplitudeOverRootTwo) {
  std::vector<double> samples(1000);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    samples[i] = 3.0 * std::sin(2.0 * std::numbers::pi * static_cast<double>(i) / 50.0);
  }
  EXPECT_NEAR(rms(samples), 3.0 / std::numbers::sqrt2, 1e-14);
  EXPECT_EQ(rms(std::vector<double>{-2.0}), 2.0);
}

TEST(Statistics, PeakIsTheLargestMagnitude) {
  EXPECT_EQ(peak(std::vector<double>{1.0, -4.0, 3.0}), 4.0);
  EXPECT_EQ(peak(std::vector<double>{0.0}), 0.0);
  EXPECT_TRUE(std::isnan(peak(std::vector<double>{1.0, std::nan(""), 3.0})));
  EXPECT_TRUE(std::isnan(rms(std::vector<double>{1.0, std::nan(""), 3.0})));
}

TEST(Statistics, NoSamplesAreRejected) {
  EXPECT_THAT([] { rms({}); }, ThrowsMessage<std::invalid_argument>(HasSubstr("rms: no samples")));
  EXPECT_THAT([] { peak({}); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("peak: no samples")));
}

TEST(Window, BothEndsAreIncludedDespiteRounding) {
  // 0.1 and 0.3 are not exact multiples of 0.01 in binary.
  const IndexRange range = samples_in({0.1, 0.3}, 0.0, 0.01, 100);
  EXPECT_EQ(range.begin, 10U);
  EXPECT_EQ(range.end, 31U);
  const IndexRange between = samples_in({0.1001, 0.2999}, 0.0, 0.01, 100);
  EXPECT_EQ(between.begin, 11U);
  EXPECT_EQ(between.end, 30U);
}

TEST(Window, IsCutAtTheEndsOfTheSeries) {
  const IndexRange all = samples_in({}, 5.0, 0.5, 10);
  EXPECT_EQ(all.begin, 0U);
  EXPECT_EQ(all.end, 10U);
  const IndexRange tail = samples_in({8.0, 1e9}, 5.0, 0.5, 10);
  EXPECT_EQ(tail.begin, 6U);
  EXPECT_EQ(tail.size(), 4U);
}

TEST(Window, OutsideTheSeriesIsEmpty) {
  EXPECT_TRUE(samples_in({-2.0, -1.0}, 0.0, 0.1, 10).is_empty());
  EXPECT_TRUE(samples_in({2.0, 3.0}, 0.0, 0.1, 10).is_empty());
  EXPECT_TRUE(samples_in({0.42, 0.48}, 0.0, 0.1, 10).is_empty());
  EXPECT_TRUE(samples_in({0.0, 1.0}, 0.0, 0.1, 0).is_empty());
}

TEST(Window, PicksItsPartOfASeries) {
  const std::vector<double> series{0.0, 1.0, 2.0, 3.0, 4.0};
  const auto part = samples_in({1.0, 3.0}, 0.0, 1.0, series.size()).of(series);
  ASSERT_EQ(part.size(), 3U);
  EXPECT_EQ(part.front(), 1.0);
  EXPECT_EQ(part.back(), 3.0);
}

TEST(Window, BadArgumentsAreRejected) {
  EXPECT_THAT(
      [] {
        samples_in({1.0, 0.0}, 0.0, 0.1, 10);
      },
      ThrowsMessage<std::invalid_argument>(HasSubstr("ends before it starts")));
  EXPECT_THAT(
      [] {
        samples_in({std::nan(""), 0.0}, 0.0, 0.1, 10);
      },
      ThrowsMessage<std::invalid_argument>(HasSubstr("ends before it starts")));
  EXPECT_THAT(
      [] {
        samples_in({0.0, 1.0}, 0.0, 0.0, 10);
      },
      ThrowsMessage<std::invalid_argument>(HasSubstr("interval must be positive")));
}

}  // namespace
}  // namespace stridor
