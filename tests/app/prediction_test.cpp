#include "app/stability/prediction.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace stridor {
namespace {

TimedWindow window(double from, double to, double frequency) {
  TimedWindow timed;
  timed.window.frequency = frequency;
  timed.from_time = from;
  timed.to_time = to;
  timed.gain = 2.0;
  return timed;
}

NumberedBurst burst(std::size_t number, double start, double end, double frequency) {
  Burst one{};
  one.start = start;
  one.end = end;
  one.frequency = frequency;
  return {number, one};
}

TEST(MatchBursts, TheOneOfLikeFrequencyThatOverlapsMost) {
  const auto predictions = match_bursts(
      {window(1.0, 1.2, 3500.0)},
      {burst(1, 0.9, 1.02, 3500.0), burst(2, 1.05, 1.5, 3540.0), burst(3, 1.0, 1.2, 7000.0)});
  ASSERT_EQ(predictions.size(), 1u);
  ASSERT_TRUE(predictions[0].burst);
  EXPECT_EQ(predictions[0].burst->number, 2u);
}

TEST(MatchBursts, ABurstMayRiseOutOfTheQuietShortlyAfterItsWindow) {
  const std::vector<TimedWindow> windows{window(1.0, 1.1, 3500.0)};
  EXPECT_TRUE(match_bursts(windows, {burst(1, 1.14, 1.3, 3500.0)})[0].burst);
  EXPECT_FALSE(match_bursts(windows, {burst(1, 1.16, 1.3, 3500.0)})[0].burst);
}

TEST(MatchBursts, AnotherFrequencyIsAnotherBurst) {
  const std::vector<TimedWindow> windows{window(1.0, 1.1, 3500.0)};
  EXPECT_TRUE(match_bursts(windows, {burst(1, 1.0, 1.3, 3500.0 * 1.019)})[0].burst);
  EXPECT_FALSE(match_bursts(windows, {burst(1, 1.0, 1.3, 3500.0 * 1.021)})[0].burst);
}

TEST(MatchBursts, ABurstBelongsToOneWindowAloneTheOneThatItOverlapsMost) {
  const auto rows = match_bursts({window(1.0, 1.1, 3500.0), window(1.2, 1.4, 3500.0)},
                                 {burst(1, 1.05, 1.5, 3500.0)});
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_FALSE(rows[0].burst.has_value());
  ASSERT_TRUE(rows[1].burst.has_value());
  EXPECT_TRUE(unexplained(rows, {burst(1, 1.05, 1.5, 3500.0)}).empty());
  EXPECT_EQ(unexplained(rows, {burst(1, 1.05, 1.5, 3500.0), burst(2, 3.0, 3.1, 3500.0)}),
            std::vector<std::size_t>{2});
  NumberedBurst overtone = burst(3, 1.2, 1.4, 7000.0);
  overtone.burst.harmonic = {1, 2};
  EXPECT_TRUE(unexplained(rows, {burst(1, 1.05, 1.5, 3500.0), overtone}).empty());
  const auto windows =
      windows_of(rows, {burst(2, 3.0, 3.1, 3500.0), burst(1, 1.05, 1.5, 3500.0)});
  ASSERT_EQ(windows.size(), 2u);
  EXPECT_FALSE(windows[0].has_value());
  EXPECT_EQ(windows[1], std::size_t{1});
}

TEST(MatchBursts, WindowsThatNoRunPassesAreLeftOut) {
  constexpr double never = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(match_bursts({window(never, never, 3500.0)}, {}).empty());
}

TEST(PredictionJson, HasNullWhereThereIsNoBurst) {
  const Json rows = prediction_json(match_bursts({window(1.0, 1.1, 3500.0)}, {}));
  ASSERT_EQ(rows.size(), 1u);
  EXPECT_TRUE(rows[0]["burst"].is_null());
  EXPECT_TRUE(rows[0]["burst_start"].is_null());
  EXPECT_EQ(rows[0]["gain"], 2.0);
}

}  // namespace
}  // namespace stridor
