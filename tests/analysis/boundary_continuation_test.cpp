#include "analysis/boundary_continuation.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "tests/support/message_of.hpp"

namespace stridor {
namespace {

using test::message_of;
using ::testing::HasSubstr;

std::vector<double> cell_edges(double from, double to, int cells) {
  std::vector<double> values;
  for (int i = 0; i <= cells; ++i) values.push_back(from + (to - from) * i / cells);
  return values;
}

/// ∮ x dy: positive if the inside is on the left.
double area(const BoundaryLine& line) {
  double sum = 0.0;
  for (std::size_t i = 0; i + 1 < line.size(); ++i)
    sum += 0.5 * (line[i][0] * line[i + 1][1] - line[i + 1][0] * line[i][1]);
  return sum;
}

TEST(BoundaryContinuation, CircleClosesWithTheUnstableSideOnItsLeft) {
  const auto margin = [](double x, double y) { return 0.49 - x * x - y * y; };
  const auto lines = trace_boundary(margin, {cell_edges(-1, 1, 10), cell_edges(-1, 1, 10), {}},
                                    {{{0.7, 0.0}, {0.0, 0.7}}});
  ASSERT_EQ(lines.size(), 1u);
  const BoundaryLine& line = lines[0];
  EXPECT_EQ(line.front(), line.back());
  for (const auto& [x, y] : line) EXPECT_NEAR(std::hypot(x, y), 0.7, 1e-13);
  // Chords turn by 15° at most: the polygon has 0.6 % less than the disc at most.
  EXPECT_NEAR(area(line), 0.49 * M_PI, 0.012 * 0.49 * M_PI);
  EXPECT_LT(area(line), 0.49 * M_PI);
}

TEST(BoundaryContinuation, LineThatTurnsBackGoesFromEdgeToEdge) {
  // x = 0.5 + 0.4 sin over y is one value of y for every x only in parts: it folds in x.
  const auto margin = [](double x, double y) {
    return x - 0.5 - 0.4 * std::sin(2.0 * M_PI * y) - 0.02 * y;
  };
  const double seed_y = 0.31;
  const double seed_x = 0.5 + 0.4 * std::sin(2.0 * M_PI * seed_y) + 0.02 * seed_y;
  const auto lines =
      trace_boundary(margin, {cell_edges(0, 1, 8), cell_edges(0, 1, 8), {}}, {{{seed_x, seed_y}}});
  ASSERT_EQ(lines.size(), 1u);
  const auto [low, high] = std::minmax(lines[0].front()[1], lines[0].back()[1]);
  EXPECT_EQ(low, 0.0);
  EXPECT_EQ(high, 1.0);
  for (const auto& [x, y] : lines[0]) EXPECT_NEAR(margin(x, y), 0.0, 1e-13);
}

TEST(BoundaryContinuation, CornersArePassed) {
  // A square on its point: the margin has a kink at every corner.
  const auto margin = [](double x, double y) { return 0.6 - std::abs(x) - std::abs(y); };
  const auto lines =
      trace_boundary(margin, {cell_edges(-1, 1, 10), cell_edges(-1, 1, 10), {}}, {{{0.4, 0.2}}});
  ASSERT_EQ(lines.size(), 1u);
  EXPECT_EQ(lines[0].front(), lines[0].back());
  EXPECT_NEAR(area(lines[0]), 0.72, 1e-3);
  for (const auto& [x, y] : lines[0]) EXPECT_NEAR(margin(x, y), 0.0, 1e-13);
}

TEST(BoundaryContinuation, LogarithmicAxesAreFollowedInTheLogarithm) {
  // y = x² from 1e-3 to 1: over six decades of y.
  std::vector<double> x;
  std::vector<double> y;
  for (int i = 0; i <= 30; ++i) x.push_back(std::pow(10.0, -3.0 + 0.1 * i));
  for (int i = 0; i <= 30; ++i) y.push_back(std::pow(10.0, -6.0 + 0.2 * i));
  const auto margin = [](double at_x, double at_y) { return at_y - at_x * at_x; };
  const auto lines = trace_boundary(
      margin, {x, y, {GridSpacing::logarithmic, GridSpacing::logarithmic}}, {{{0.1, 0.01}}});
  ASSERT_EQ(lines.size(), 1u);
  for (const auto& point : lines[0]) EXPECT_NEAR(point[1] / (point[0] * point[0]), 1.0, 1e-12);
  const auto [low, high] = std::minmax(lines[0].front()[0], lines[0].back()[0]);
  EXPECT_NEAR(low, 1e-3, 1e-15);
  EXPECT_NEAR(high, 1.0, 1e-12);
  EXPECT_GT(lines[0].size(), 30u);
}

TEST(BoundaryContinuation, SeveralLinesAreEachFoundOnce) {
  // Three strips.
  const auto margin = [](double x, double) { return std::sin(3.0 * M_PI * x + 0.1); };
  std::vector<BoundaryLine> seeds;
  for (const double y : {0.1, 0.5, 0.9})
    for (const double k : {1.0, 2.0, 3.0}) seeds.push_back({{(k * M_PI - 0.1) / (3.0 * M_PI), y}});
  const auto lines = trace_boundary(margin, {cell_edges(0, 1, 9), cell_edges(0, 1, 9), {}}, seeds);
  EXPECT_EQ(lines.size(), 3u);
}

TEST(BoundaryContinuation, EndsWhereNothingIsKnown) {
  const auto margin = [](double x, double y) {
    return x > 0.6 ? std::numeric_limits<double>::quiet_NaN() : y - 0.5;
  };
  const auto lines =
      trace_boundary(margin, {cell_edges(0, 1, 10), cell_edges(0, 1, 10), {}}, {{{0.3, 0.5}}});
  ASSERT_EQ(lines.size(), 1u);
  for (const auto& point : lines[0]) EXPECT_LE(point[0], 0.6);
  const auto [low, high] = std::minmax(lines[0].front()[0], lines[0].back()[0]);
  EXPECT_EQ(low, 0.0);
  EXPECT_GT(high, 0.55);
}

TEST(BoundaryContinuation, GridMustAscend) {
  const auto margin = [](double, double) { return 1.0; };
  EXPECT_THAT(message_of<std::invalid_argument>([&] {
                trace_boundary(margin, {{0}, {0, 1}, {}}, {});
              }),
              HasSubstr("a grid needs two ascending values or more"));
}

}  // namespace
}  // namespace stridor
