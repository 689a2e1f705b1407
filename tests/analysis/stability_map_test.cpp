#include "analysis/stability_map.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "analysis/growth_field.hpp"
#include "tests/support/message_of.hpp"

namespace stridor {
namespace {

using namespace test;
using ::testing::HasSubstr;

std::vector<double> grid(double from, double to, int count) {
  std::vector<double> values;
  for (int i = 0; i < count; ++i) values.push_back(from + (to - from) * i / (count - 1));
  return values;
}

/// Where a circle of radius r about the origin cuts lines at the given coordinate.
std::vector<double> circle_cuts(double r, double at) {
  if (std::abs(at) >= r) return {};
  const double half = std::sqrt(r * r - at * at);
  return {-half, half};
}

TEST(SignChanges, APairWithinOneIntervalIsFound) {
  // Of one sign within 1e-4 of 0.317, of the other elsewhere: a narrow window.
  for (const double sign : {1.0, -1.0}) {
    std::vector<double> values;
    for (int i = 0; i <= 10; ++i) values.push_back(0.1 * i);
    const auto margin = [&](double x) {
      return sign * (1e-8 - (x - 0.317) * (x - 0.317)) * (1.0 + x);
    };
    const std::vector<double> changes = sign_changes(margin, values);
    ASSERT_EQ(changes.size(), 2U);
    EXPECT_NEAR(changes[0], 0.3169, 1e-12);
    EXPECT_NEAR(changes[1], 0.3171, 1e-12);
  }
  // One that comes close and stays away.
  EXPECT_TRUE(sign_changes([](double x) { return -1e-3 - x * x; }, {-0.3, 0.1, 0.4}).empty());
}

TEST(BoundaryLines, CircleIsOneClosedLineOfPointsOnIt) {
  GridCrossings crossings{grid(-1, 1, 12), grid(-1, 1, 10), {}, {}};
  for (const double y : crossings.y) crossings.along_x.push_back(circle_cuts(0.7, y));
  for (const double x : crossings.x) crossings.along_y.push_back(circle_cuts(0.7, x));
  std::size_t num_points = 0;
  for (const auto& list : crossings.along_x) num_points += list.size();
  for (const auto& list : crossings.along_y) num_points += list.size();
  const auto lines = boundary_lines(crossings);
  ASSERT_EQ(lines.size(), 1u);
  EXPECT_EQ(lines[0].size(), num_points + 1);
  EXPECT_EQ(lines[0].front(), lines[0].back());
  for (const auto& [x, y] : lines[0]) EXPECT_NEAR(std::hypot(x, y), 0.7, 1e-12);
}

TEST(BoundaryLines, StripNarrowerThanACellIsTwoLinesFromEdgeToEdge) {
  // Unstable between x = 0.51 and 0.52 for every y: no line of the grid along y is cut.
  GridCrossings crossings{{0, 1}, grid(0, 1, 4), {}, {{}, {}}};
  for (int i = 0; i < 4; ++i) crossings.along_x.push_back({0.51, 0.52});
  const auto lines = boundary_lines(crossings);
  ASSERT_EQ(lines.size(), 2u);
  for (const auto& line : lines) {
    ASSERT_EQ(line.size(), 4u);
    for (const auto& point : line) EXPECT_EQ(point[0], line[0][0]);
  }
}

TEST(BoundaryLines, StripThatEndsWithinACellIsClosedThere) {
  GridCrossings crossings{{0, 1}, {0, 1, 2}, {{0.4, 0.6}, {0.45, 0.55}, {}}, {{}, {}}};
  const auto lines = boundary_lines(crossings);
  ASSERT_EQ(lines.size(), 1u);
  EXPECT_EQ(lines[0].size(), 4u);
}

TEST(BoundaryLines, CrossingWithoutACounterpartIsLeftOut) {
  EXPECT_TRUE(boundary_lines({{0, 1}, {0, 1}, {{0.5}, {}}, {{}, {}}}).empty());
  EXPECT_TRUE(boundary_lines({{0, 1}, {0, 1}, {{}, {}}, {{}, {}}}).empty());
}

TEST(BoundaryLines, ListsMustFitTheGrid) {
  EXPECT_THAT(message_of<std::invalid_argument>([] {
                boundary_lines({{0}, {0, 1}, {}, {}});
              }),
              HasSubstr("a grid needs two ascending values or more"));
  EXPECT_THAT(message_of<std::invalid_argument>([] {
                boundary_lines({{0, 1}, {0, 1}, {{}}, {{}, {}}});
              }),
              HasSubstr("the crossings do not fit the grid"));
  EXPECT_THAT(message_of<std::invalid_argument>([] {
                boundary_lines({{0, 1}, {0, 1}, {{0.5, 0.4}, {}}, {{}, {}}});
              }),
              HasSubstr("the crossings do not fit the grid"));
}

}  // namespace
}  // namespace stridor
