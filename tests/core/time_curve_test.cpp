#include "core/time_curve.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <vector>

#include "tests/support/constants.hpp"
#include "tests/support/message_of.hpp"

namespace stridor {
namespace {

using test::message_of;
using testing::HasSubstr;

using test::eps;
using test::infinity;
using test::not_a_number;

/// Rises, falls below zero, stays, on intervals of different widths, partly before t = 0.
TimeCurve sample_curve() {
  return TimeCurve(TimeTable{{-0.5, 0.25, 1.0, 1.5, 4.0}, {0.5, 2.0, -1.0, -1.0, 3.0}});
}
constexpr double sample_max = 3.0;    // of |value|
constexpr double sample_jump = 4.0;   // largest difference of two neighbours
constexpr double sample_width = 0.5;  // shortest interval

/// ∫ value dt by three-point Gauss on 16 parts of every piece. The curve is a polynomial of degree
/// 5 between support points, for which the rule is exact: only rounding is left.
double quadrature(const TimeCurve& curve, double from, double to) {
  std::vector<double> breaks{from};
  for (const double time : curve.table().times)
    if (time > from && time < to) breaks.push_back(time);
  breaks.push_back(to);
  constexpr std::array<double, 3> weights{5.0 / 18.0, 8.0 / 18.0, 5.0 / 18.0};
  const double offset = std::sqrt(0.15);
  const std::array<double, 3> points{0.5 - offset, 0.5, 0.5 + offset};
  double sum = 0.0;
  for (std::size_t i = 1; i < breaks.size(); ++i) {
    const double width = (breaks[i] - breaks[i - 1]) / 16.0;
    for (int part = 0; part < 16; ++part) {
      for (std::size_t k = 0; k < 3; ++k)
        sum += weights[k] * width * curve.value(breaks[i - 1] + width * (part + points[k]));
    }
  }
  return sum;
}

TEST(TimeCurve, DefaultIsZeroAtAllTimes) {
  const TimeCurve curve;
  for (const double time : {-1e9, -1.0, 0.0, 1.0, 1e9}) {
    EXPECT_EQ(curve.value(time), 0.0);
    EXPECT_EQ(curve.slope(time), 0.0);
    EXPECT_EQ(curve.integral(time), 0.0);
  }
  EXPECT_TRUE(curve.is_constant());
}

TEST(TimeCurve, ConstantHasNoSlopeAndALinearIntegral) {
  const TimeCurve curve(-0.25);
  for (const double time : {-3.0, 0.0, 0.5, 8.0}) {
    EXPECT_EQ(curve.value(time), -0.25);
    EXPECT_EQ(curve.slope(time), 0.0);
    EXPECT_EQ(curve.integral(time), -0.25 * time);
  }
  EXPECT_TRUE(curve.is_constant());
  EXPECT_EQ(curve.constant_from(), 0.0);
}

TEST(TimeCurve, GoesThroughItsSupportPointsExactly) {
  const TimeCurve curve = sample_curve();
  const TimeTable& table = curve.table();
  for (std::size_t i = 0; i < table.times.size(); ++i)
    EXPECT_EQ(curve.value(table.times[i]), table.values[i]) << i;
  EXPECT_FALSE(curve.is_constant());
  EXPECT_EQ(curve.constant_from(), 4.0);
}

TEST(TimeCurve, IsConstantBeforeAndAfterTheTable) {
  const TimeCurve curve = sample_curve();
  for (const double time : {-infinity, -1e6, -0.5001}) EXPECT_EQ(curve.value(time), 0.5);
  for (const double time : {4.0001, 1e6, infinity}) EXPECT_EQ(curve.value(time), 3.0);
  for (const double time : {-1e6, -0.5001, 4.0001, 1e6}) EXPECT_EQ(curve.slope(time), 0.0);
}

TEST(TimeCurve, FollowsTheQuinticSmoothstep) {
  // r(1/4) = 53/512, r(1/2) = 1/2, r(3/4) = 459/512: all exact in binary, and so are the
  // operations.
  const TimeCurve curve(TimeTable{{1.0, 5.0}, {2.0, 514.0}});
  EXPECT_EQ(curve.value(2.0), 2.0 + 53.0);
  EXPECT_EQ(curve.value(3.0), 2.0 + 256.0);
  EXPECT_EQ(curve.value(4.0), 2.0 + 459.0);
}

TEST(TimeCurve, StaysBetweenNeighbouringSupportPointsAndIsMonotoneThere) {
  const TimeCurve curve = sample_curve();
  const TimeTable& table = curve.table();
  for (std::size_t i = 1; i < table.times.size(); ++i) {
    const double sign = table.values[i] >= table.values[i - 1] ? 1.0 : -1.0;
    double previous = table.values[i - 1];
    for (int k = 1; k <= 1000; ++k) {
      const double time = table.times[i - 1] + (table.times[i] - table.times[i - 1]) * k / 1000.0;
      const double value = curve.value(time);
      // Near the ends the smoothstep is flat to third order, so rounding may turn a step around.
      EXPECT_GE(sign * (value - previous), -8.0 * eps * sample_jump) << time;
      previous = value;
    }
  }
}

TEST(TimeCurve, SlopeIsTheDerivativeOfTheValue) {
  // Central difference over +-d: |r'''| <= 60, so the error is at most 60 J/w^3 d^2/6 plus the
  // rounding of two values, 8 eps each (five products and sums), over 2 d. It holds across support
  // points too, where the third derivative jumps but stays within the bound.
  const TimeCurve curve = sample_curve();
  const double d = 1e-5;
  const double tolerance = 10.0 * sample_jump / std::pow(sample_width, 3) * d * d +
                           8.0 * eps * (sample_max + sample_jump) / d;
  for (double time = -1.0; time < 5.0; time += 0.0078125) {
    EXPECT_NEAR(curve.slope(time), (curve.value(time + d) - curve.value(time - d)) / (2.0 * d),
                tolerance)
        << time;
  }
}

TEST(TimeCurve, SteepestSlopeIsFifteenEighthsOfTheMean) {
  const TimeCurve curve = TimeCurve::ramp(8.0, 0.5);
  EXPECT_EQ(curve.slope(0.25), 1.875 * 8.0 / 0.5);
}

TEST(TimeCurve, SlopeAndCurvatureVanishAtEverySupportPoint) {
  // With both zero at t_i, |slope(t_i +- d)| <= max|f'''| d^2/2 = 30 J/w^3 d^2: a curvature left
  // over would show as a term linear in d, a slope as a constant.
  const TimeCurve curve = sample_curve();
  for (const double time : curve.table().times) {
    EXPECT_EQ(curve.slope(time), 0.0) << time;
    for (const double d : {1e-3, 1e-5, 1e-7}) {
      // t_i +- d is rounded to eps |t|, hence the factor.
      const double bound = 30.0 * sample_jump / std::pow(sample_width, 3) * d * d *
                           (1.0 + 4.0 * eps * std::max(1.0, std::abs(time)) / d);
      EXPECT_LE(std::abs(curve.slope(time + d)), bound) << time;
      EXPECT_LE(std::abs(curve.slope(time - d)), bound) << time;
    }
  }
}

TEST(TimeCurve, IntegralAgreesWithQuadrature) {
  // Up to 5 pieces of 48 terms are summed, each at most max|value| times the length of the
  // interval.
  const TimeCurve curve = sample_curve();
  for (const double time : {-3.0, -0.5, -0.1, 0.0, 0.1, 0.25, 0.7, 1.0, 1.2, 1.5, 3.9, 4.0, 7.0}) {
    const double expected =
        time >= 0.0 ? quadrature(curve, 0.0, time) : -quadrature(curve, time, 0.0);
    EXPECT_NEAR(curve.integral(time), expected, 240.0 * eps * sample_max * 10.0) << time;
  }
}

TEST(TimeCurve, IntegralStartsAtZeroWhereverTheTableStarts) {
  EXPECT_EQ(sample_curve().integral(0.0), 0.0);
  const TimeCurve later(TimeTable{{2.0, 3.0}, {4.0, 8.0}});
  EXPECT_EQ(later.integral(0.0), 0.0);
  EXPECT_EQ(later.integral(2.0), 8.0);
  EXPECT_EQ(later.integral(3.0), 14.0);
  EXPECT_EQ(later.integral(-1.0), -4.0);
  const TimeCurve earlier(TimeTable{{-3.0, -2.0}, {4.0, 8.0}});
  EXPECT_EQ(earlier.integral(1.0), 8.0);
  EXPECT_EQ(earlier.integral(-2.0), -16.0);
  EXPECT_EQ(earlier.integral(-3.0), -22.0);
}

TEST(TimeCurve, RampStartsAtZeroAndEndsAtItsValue) {
  const TimeCurve ramp = TimeCurve::ramp(0.03, 0.1);
  EXPECT_EQ(ramp.value(-1.0), 0.0);
  EXPECT_EQ(ramp.value(0.0), 0.0);
  EXPECT_EQ(ramp.value(0.1), 0.03);
  EXPECT_EQ(ramp.value(2.25), 0.03);
  EXPECT_EQ(ramp.slope(0.0), 0.0);
  EXPECT_EQ(ramp.slope(0.1), 0.0);
  EXPECT_EQ(ramp.constant_from(), 0.1);
  EXPECT_FALSE(ramp.is_constant());
}

TEST(TimeCurve, IntegralOfARampOverItsDurationIsHalf) {
  EXPECT_EQ(TimeCurve::ramp(8.0, 0.5).integral(0.5), 2.0);
  // Three rounded operations where the numbers are not exact in binary.
  EXPECT_NEAR(TimeCurve::ramp(0.03, 0.1).integral(0.1), 0.0015, 3.0 * eps * 0.0015);
}

TEST(TimeCurve, SlidingOfTheMainSceneEndsAt66Millimetres) {
  // s = v (t - ramp/2) = 0.030 (2.25 - 0.05): four rounded operations.
  EXPECT_NEAR(TimeCurve::ramp(0.03, 0.1).integral(2.25), 0.066, 4.0 * eps * 0.066);
}

TEST(TimeCurve, RampWithoutDurationIsAConstant) {
  const TimeCurve ramp = TimeCurve::ramp(0.03, 0.0);
  EXPECT_TRUE(ramp.is_constant());
  EXPECT_EQ(ramp.value(-1.0), 0.03);
  EXPECT_EQ(ramp.value(0.0), 0.03);
}

TEST(TimeCurve, TableOfOnePointIsAConstant) {
  const TimeCurve curve(TimeTable{{2.0}, {5.0}});
  EXPECT_TRUE(curve.is_constant());
  EXPECT_EQ(curve.value(0.0), 5.0);
  EXPECT_EQ(curve.integral(3.0), 15.0);
}

TEST(TimeCurve, EmptyTableThrows) {
  EXPECT_EQ(message_of<std::invalid_argument>([] { TimeCurve(TimeTable{}); }),
            "TimeCurve: times and values need the same length, at least 1");
}

TEST(TimeCurve, DifferentLengthsThrow) {
  EXPECT_EQ(message_of<std::invalid_argument>([] {
              TimeCurve(TimeTable{{0.0, 1.0}, {0.0}});
            }),
            "TimeCurve: times and values need the same length, at least 1");
  EXPECT_EQ(message_of<std::invalid_argument>([] {
              TimeCurve(TimeTable{{}, {0.0}});
            }),
            "TimeCurve: times and values need the same length, at least 1");
}

TEST(TimeCurve, NumbersThatAreNotFiniteThrow) {
  for (const double bad : {not_a_number, infinity, -infinity}) {
    EXPECT_EQ(message_of<std::invalid_argument>([&] {
                TimeCurve(TimeTable{{0.0, bad}, {0.0, 1.0}});
              }),
              "TimeCurve: times and values must be finite");
    EXPECT_EQ(message_of<std::invalid_argument>([&] {
                TimeCurve(TimeTable{{0.0, 1.0}, {bad, 1.0}});
              }),
              "TimeCurve: times and values must be finite");
  }
}

TEST(TimeCurve, TimesThatDoNotIncreaseThrow) {
  EXPECT_EQ(message_of<std::invalid_argument>([] {
              TimeCurve(TimeTable{{0.0, 1.0, 1.0}, {0.0, 1.0, 2.0}});
            }),
            "TimeCurve: times must increase strictly");
  EXPECT_EQ(message_of<std::invalid_argument>([] {
              TimeCurve(TimeTable{{1.0, 0.0}, {0.0, 1.0}});
            }),
            "TimeCurve: times must increase strictly");
}

TEST(TimeCurve, RampOfNegativeDurationThrows) {
  EXPECT_THAT(message_of<std::invalid_argument>([] { TimeCurve::ramp(1.0, -0.1); }),
              HasSubstr("times must increase strictly"));
}

}  // namespace
}  // namespace stridor
