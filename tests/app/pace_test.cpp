#include "app/terminal/pace.hpp"

#include <gtest/gtest.h>

namespace stridor {
namespace {

/// A clock that goes as the test wants.
SteadyTime at(double seconds) {
  return SteadyTime(
      std::chrono::duration_cast<SteadyTime::duration>(std::chrono::duration<double>(seconds)));
}

TEST(Pace, OfAConstantSpeedLeavesTheRestOfTheTime) {
  Pace pace(at(100.0));
  for (int k = 1; k <= 25; ++k) pace.report(0.01 * k, at(100.0 + k));
  EXPECT_NEAR(pace.left(at(125.0)).value(), 75.0, 1e-9);
  EXPECT_EQ(pace_text(pace, at(125.0)), "25 %, 1 min 15 s left");
}

TEST(Pace, FollowsTheRecentSpeed) {
  // Half of it took 10 s, the rest goes ten times slower.
  Pace pace(at(0.0));
  for (int k = 1; k <= 50; ++k) pace.report(0.01 * k, at(0.2 * k));
  for (int k = 1; k <= 20; ++k) pace.report(0.5 + 0.01 * k, at(10.0 + 2.0 * k));
  // 30 % are left at 2 s each.
  EXPECT_NEAR(pace.left(at(50.0)).value(), 60.0, 1.0);
}

TEST(Pace, GrowsWhileNothingIsReported) {
  Pace pace(at(0.0));
  for (int k = 1; k <= 20; ++k) pace.report(0.01 * k, at(k));
  double before = pace.left(at(20.0)).value();
  for (const double now : {40.0, 80.0, 1000.0}) {
    const double left = pace.left(at(now)).value();
    EXPECT_GT(left, 1.5 * before) << now;
    before = left;
  }
}

TEST(Pace, DoesNotGuessFromNothing) {
  Pace pace(at(0.0));
  EXPECT_FALSE(pace.left(at(60.0)).has_value());
  EXPECT_EQ(pace_text(pace, at(61.0)), "1 min 01 s so far");
  pace.report(0.3, at(0.5));
  EXPECT_EQ(pace_text(pace, at(0.5)), "30 %") << "half a second says little";
}

TEST(Pace, IsWholeOnlyWhereAllIsDone) {
  Pace pace(at(0.0));
  pace.report(0.9999, at(10.0));
  EXPECT_EQ(pace_text(pace, at(10.0)), "99 %, 0 s left");
  pace.report(1.0, at(11.0));
  EXPECT_EQ(pace_text(pace, at(11.0)), "100 %, 0 s left");
}

TEST(Pace, DoesNotGoBack) {
  Pace pace(at(0.0));
  pace.report(0.5, at(2.0));
  pace.report(0.2, at(3.0));
  EXPECT_EQ(pace.fraction(), 0.5);
}

TEST(Pace, KeepsFewMarksHoweverOftenItIsTold) {
  Pace pace(at(0.0));
  for (int k = 1; k <= 1'000'000; ++k) pace.report(1e-6 * k, at(1e-3 * k));
  EXPECT_LT(pace.num_marks(), 1000u);
}

TEST(DurationText, HasTwoUnitsWhereOneIsCoarse) {
  EXPECT_EQ(duration_text(0.2), "0 s");
  EXPECT_EQ(duration_text(59.4), "59 s");
  EXPECT_EQ(duration_text(59.6), "1 min 00 s");
  EXPECT_EQ(duration_text(3599.7), "1 h 00 min");
  EXPECT_EQ(duration_text(7830.0), "2 h 11 min");
}

}  // namespace
}  // namespace stridor
