#include "coupling/kinematics/monotone_cubic.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/support/message_of.hpp"

namespace stridor {
namespace {

using test::message_of;
using ::testing::HasSubstr;

TEST(MonotoneCubic, PassesThroughItsPointsWithContinuousSlope) {
  const std::vector<double> x{0.0, 1.0, 1.5, 4.0};
  const std::vector<double> y{2.0, 3.0, 3.1, -1.0};
  const MonotoneCubic curve(x, y);
  for (std::size_t i = 0; i < x.size(); ++i) EXPECT_NEAR(curve.at(x[i]).value, y[i], 1e-14);
  for (const double knot : {1.0, 1.5}) {
    EXPECT_NEAR(curve.at(knot - 1e-9).slope, curve.at(knot + 1e-9).slope, 1e-7);
  }
}

TEST(MonotoneCubic, MakesNoNewExtrema) {
  // Values and slopes of a step that a plain spline overshoots.
  const MonotoneCubic curve({0.0, 1.0, 2.0, 3.0, 4.0}, {0.0, 0.0, 1.0, 1.0, 1.0});
  for (double x = 0.0; x <= 4.0; x += 0.01) {
    EXPECT_GE(curve.at(x).value, 0.0);
    EXPECT_LE(curve.at(x).value, 1.0);
    EXPECT_GE(curve.at(x).slope, -1e-14);
  }
}

TEST(MonotoneCubic, DerivativesAreThoseOfTheValue) {
  const MonotoneCubic curve({0.0, 0.7, 2.0, 3.0}, {0.0, 1.0, 1.5, 4.0});
  const double h = 1e-4;
  for (const double x : {0.3, 1.1, 2.6}) {
    const double slope = (curve.at(x + h).value - curve.at(x - h).value) / (2.0 * h);
    const double curvature = (curve.at(x + h).slope - curve.at(x - h).slope) / (2.0 * h);
    EXPECT_NEAR(curve.at(x).slope, slope, 1e-7);
    EXPECT_NEAR(curve.at(x).curvature, curvature, 1e-6);
  }
}

TEST(MonotoneCubic, TwoPointsAreAStraightLine) {
  const MonotoneCubic line({1.0, 3.0}, {2.0, 8.0});
  EXPECT_DOUBLE_EQ(line.at(1.5).value, 3.5);
  EXPECT_DOUBLE_EQ(line.at(2.5).slope, 3.0);
}

TEST(MonotoneCubic, RefusesWrongPoints) {
  const auto says = [](std::vector<double> x, std::vector<double> y) {
    return message_of<std::invalid_argument>([&] { MonotoneCubic curve(x, y); });
  };
  EXPECT_THAT(says({0.0}, {0.0}), HasSubstr("two points or more"));
  EXPECT_THAT(says({0.0, 1.0}, {0.0}), HasSubstr("as many x as y"));
  EXPECT_THAT(says({0.0, 0.0}, {0.0, 1.0}), HasSubstr("does not ascend"));
  EXPECT_THAT(says({0.0, std::numeric_limits<double>::infinity()}, {0.0, 1.0}),
              HasSubstr("not finite"));
}

}  // namespace
}  // namespace stridor
