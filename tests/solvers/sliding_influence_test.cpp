#include "solvers/half_space/sliding_influence.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "tests/support/message_of.hpp"

namespace stridor {
namespace {

using test::message_of;
using ::testing::HasSubstr;

/// ∫ f over [a, b] by halving until two five-point Gauss sums agree.
template <class Function>
double integral(const Function& f, double a, double b, double tolerance, int depth = 0) {
  const auto gauss = [&](double from, double to) {
    constexpr double nodes[] = {0.0, 0.5384693101056831, 0.9061798459386640};
    constexpr double weights[] = {0.5688888888888889, 0.4786286704993665, 0.2369268850561891};
    const double middle = 0.5 * (from + to);
    const double half = 0.5 * (to - from);
    double sum = weights[0] * f(middle);
    for (int k = 1; k < 3; ++k)
      sum += weights[k] * (f(middle - half * nodes[k]) + f(middle + half * nodes[k]));
    return half * sum;
  };
  const double middle = 0.5 * (a + b);
  const double whole = gauss(a, b);
  const double parts = gauss(a, middle) + gauss(middle, b);
  if (depth > 50 || std::abs(whole - parts) < tolerance) return parts;
  return integral(f, a, middle, tolerance, depth + 1) +
         integral(f, middle, b, tolerance, depth + 1);
}

TEST(LoveSquare, CentreAndCornerHaveTheirClosedForms) {
  const double centre = 4.0 * std::log(1.0 + std::sqrt(2.0));
  EXPECT_NEAR(love_square(0.0, 0.0), centre, 1e-14);
  // The corner of a square sees it as the centre of a square of twice the side sees a quarter.
  EXPECT_NEAR(love_square(0.5, 0.5), 0.5 * centre, 1e-14);
}

TEST(LoveSquare, GaussPointsContinueTheClosedForm) {
  // Just inside and outside of the change at r = 24; the third derivative of 1/r is far below
  // 1e-12.
  for (const double angle : {0.0, 0.3, 0.7}) {
    const auto along = [&](double r) {
      return love_square(r * std::cos(angle), r * std::sin(angle));
    };
    const double h = 1e-6;
    EXPECT_NEAR(along(24.0 - h) / along(24.0 + h), 1.0 + 2.0 * h / 24.0, 2e-11);
  }
}

TEST(SlidingInfluence, AgreesWithAdaptiveIntegrationOfTheMemory) {
  // I(x) = ∫₀^∞ exp(−z) L(x + l z) dz, cut where exp(−z) is below rounding; three speeds at which
  // the memory fades within a cell, over some cells and beyond the table.
  const SlidingInfluence influence(16);
  for (const double length : {0.1, 3.0, 200.0}) {
    const SlidingCreep creep{0.9, length};
    const InfluenceTable table = influence.table({&creep, 1}, 1.0);
    for (const auto& [i, j] :
         {std::pair{0, 0}, {-1, 0}, {1, 0}, {2, 1}, {-3, 2}, {-16, 0}, {15, 16}}) {
      const auto fading = [&, x = i, y = j](double t) {
        return std::exp(-t / length) / length * love_square(x + t, y);
      };
      // Split where the edge of the loaded square makes the integrand sharp.
      std::vector<double> ends{0.0, 38.0 * length};
      for (const double edge : {-0.5 - i, 0.5 - i})
        if (edge > 0.0 && edge < ends.back()) ends.insert(ends.end() - 1, edge);
      std::sort(ends.begin(), ends.end());
      double memory = 0.0;
      for (std::size_t k = 0; k + 1 < ends.size(); ++k)
        memory += integral(fading, ends[k], ends[k + 1], 1e-13);
      const double expected = 0.1 * love_square(i, j) + 0.9 * memory;
      EXPECT_NEAR(table.at(i, j) / expected, 1.0, 1e-9) << length << ' ' << i << ' ' << j;
    }
  }
}

TEST(SlidingInfluence, StandingStillIsRubberyAndFastSlidingGlassy) {
  const SlidingInfluence influence(8);
  const auto table = [&](double length) {
    const SlidingCreep creep{0.75, length};
    return influence.table({&creep, 1}, 2.0);
  };
  const InfluenceTable rest = table(0.0);
  const InfluenceTable fast = table(1e9);
  for (const int i : {-8, -3, 0, 5}) {
    EXPECT_EQ(rest.at(i, 2), love_square(i, 2));
    // The remaining memory is that of the tail, (1/l) ∫ exp(−t/l)/t dt ~ ln(l)/l.
    EXPECT_NEAR(fast.at(i, 2), 0.25 * love_square(i, 2), 1e-7);
  }
}

TEST(SlidingInfluence, ShortMemoryExpandsInTheSpeed) {
  // I = L + l L' + l² L'' + …; at 5 cells from the square L' and L'' by differences of L.
  const double length = 1e-3;
  const SlidingCreep creep{0.5, length};
  const InfluenceTable table = SlidingInfluence(8).table({&creep, 1}, 1.0);
  const double h = 1e-3;
  const double slope = (love_square(5 + h, 1) - love_square(5 - h, 1)) / (2 * h);
  EXPECT_NEAR(table.at(5, 1) - love_square(5, 1), 0.5 * length * slope,
              2.0 * length * length * 0.02);
}

TEST(SlidingInfluence, CreepTimesAdd) {
  const SlidingInfluence influence(8);
  const SlidingCreep a{0.2, 0.7};
  const SlidingCreep b{0.5, 11.0};
  const InfluenceTable both = influence.table(std::vector{a, b}, 1.3);
  const InfluenceTable first = influence.table({&a, 1}, 1.3);
  const InfluenceTable second = influence.table({&b, 1}, 1.3);
  for (const int i : {-8, -1, 0, 7}) {
    EXPECT_NEAR(both.at(i, 3), first.at(i, 3) + second.at(i, 3) - love_square(i, 3), 1e-14);
  }
}

TEST(SlidingInfluence, OppositeSlidingIsTheMirrorImage) {
  const SlidingInfluence influence(8);
  const SlidingCreep forward{0.5, 2.0};
  const SlidingCreep backward{0.5, -2.0};
  const InfluenceTable there = influence.table({&forward, 1}, 1.0);
  const InfluenceTable back = influence.table({&backward, 1}, 1.0);
  for (int i = -7; i <= 7; ++i) EXPECT_EQ(there.at(i, 2), back.at(-i, 2));
  EXPECT_GT(there.at(-3, 0), there.at(3, 0)) << "the wake is behind";
}

TEST(SlidingInfluence, RefusesWhatItCannotUse) {
  const auto says = [](auto&& call) { return message_of<std::invalid_argument>(call); };
  EXPECT_THAT(says([] { SlidingInfluence(1); }), HasSubstr("1 cells a side are not 2 to 4096"));
  const SlidingInfluence influence(2);
  const auto table = [&](std::vector<SlidingCreep> creep, double side) {
    return says([&] { (void)influence.table(creep, side); });
  };
  EXPECT_THAT(table({}, 0.0), HasSubstr("side 0 of a cell is not > 0"));
  EXPECT_THAT(table({{0.0, 1.0}}, 1.0), HasSubstr("share is not > 0"));
  EXPECT_THAT(table({{0.5, std::numeric_limits<double>::infinity()}}, 1.0),
              HasSubstr("length not finite"));
  EXPECT_THAT(table({{0.5, 1.0}, {0.2, -1.0}}, 1.0), HasSubstr("different signs"));
  EXPECT_THAT(table({{0.5, 1.0}, {0.5, 2.0}}, 1.0), HasSubstr("sum to less than 1"));
}

}  // namespace
}  // namespace stridor
