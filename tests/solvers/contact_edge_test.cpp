#include "solvers/half_space/contact_edge.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "tests/support/message_of.hpp"

namespace stridor {
namespace {

using test::message_of;
using ::testing::HasSubstr;

constexpr std::size_t n = 64;

struct Fields {
  std::vector<double> pressure = std::vector<double>(n * n / 2);
  std::vector<double> gap = std::vector<double>(n * n / 2);
};

/// Fields from a function that is > 0 inside and < 0 outside of the contact.
template <class Inside>
Fields fields_of(const Inside& inside) {
  Fields fields;
  for (std::size_t j = 0; j < n / 2; ++j) {
    for (std::size_t i = 0; i < n; ++i) {
      const double q = inside(static_cast<double>(i) + 0.5 - 0.5 * n, static_cast<double>(j) + 0.5);
      fields.pressure[j * n + i] = q > 0.0 ? std::sqrt(q) : 0.0;
      fields.gap[j * n + i] = q < 0.0 ? std::pow(-q, 1.5) : 0.0;
    }
  }
  return fields;
}

TEST(ContactEdge, EllipseIsFoundExactly) {
  // p² and gap^⅔ are parabolas along every line, so only the step between points along the edge is
  // left: r² about the middle is a smooth periodic function.
  const double a = 20.3;
  const double b = 13.7;
  const Fields fields = fields_of(
      [&](double x, double y) { return 1.0 - std::pow((x - 3.2) / a, 2) - std::pow(y / b, 2); });
  const ContactEdge edge = find_contact_edge(fields.pressure, fields.gap, n);
  ASSERT_TRUE(edge.is_resolved);
  EXPECT_NEAR(edge.area / (std::numbers::pi * a * b), 1.0, 2e-3);
  for (const auto& [x, y] : edge.points) {
    EXPECT_NEAR(std::pow((x - 3.2) / a, 2) + std::pow(y / b, 2), 1.0, 1e-9);
    EXPECT_GE(y, 0.0);
  }
}

TEST(ContactEdge, CircleHasItsArea) {
  const Fields fields = fields_of([&](double x, double y) { return 29.0 * 29.0 - x * x - y * y; });
  const ContactEdge edge = find_contact_edge(fields.pressure, fields.gap, n);
  ASSERT_TRUE(edge.is_resolved);
  EXPECT_NEAR(edge.area / (std::numbers::pi * 29.0 * 29.0), 1.0, 1e-12);
}

TEST(ContactEdge, PressureLayerAtOneSideLeavesItToTheGap) {
  // Ahead (x > 0) the pressure turns within two cells of the edge, behind it the gap does.
  const double radius = 20.0;
  Fields fields = fields_of([&](double x, double y) {
    const double distance = radius - std::hypot(x, y);
    return distance * (2.0 * radius - distance);
  });
  for (std::size_t j = 0; j < n / 2; ++j) {
    for (std::size_t i = 0; i < n; ++i) {
      const double x = static_cast<double>(i) + 0.5 - 0.5 * n;
      const double distance = std::abs(radius - std::hypot(x, static_cast<double>(j) + 0.5));
      double& p = fields.pressure[j * n + i];
      double& gap = fields.gap[j * n + i];
      if (x > 0.0) p *= std::sqrt(1.0 + 4.0 * std::exp(-0.3 * distance));
      if (x < 0.0) gap *= 1.0 + std::sqrt(distance);
    }
  }
  const ContactEdge edge = find_contact_edge(fields.pressure, fields.gap, n);
  ASSERT_TRUE(edge.is_resolved);
  EXPECT_NEAR(edge.area / (std::numbers::pi * radius * radius), 1.0, 0.01);
}

TEST(ContactEdge, HolesAndCrumbsAreCounted) {
  const Fields ring = fields_of([](double x, double y) {
    const double r = std::hypot(x, y);
    return (r - 10.0) * (25.0 - r);
  });
  const ContactEdge edge = find_contact_edge(ring.pressure, ring.gap, n);
  EXPECT_FALSE(edge.is_resolved);
  EXPECT_TRUE(edge.points.empty());
  EXPECT_NEAR(edge.area / (std::numbers::pi * (625.0 - 100.0)), 1.0, 0.02);

  // Too few cells for a parabola, and nothing beyond to measure a gap on.
  Fields crumb = fields_of([](double x, double y) { return 4.0 - x * x - y * y; });
  for (double& gap : crumb.gap) gap = std::numeric_limits<double>::infinity();
  const ContactEdge small = find_contact_edge(crumb.pressure, crumb.gap, n);
  EXPECT_FALSE(small.is_resolved);
  EXPECT_EQ(small.area, 12.0);

  const ContactEdge nothing = find_contact_edge(Fields().pressure, Fields().gap, n);
  EXPECT_FALSE(nothing.is_resolved);
  EXPECT_EQ(nothing.area, 0.0);
}

TEST(ContactEdge, RefusesFieldsOfAnotherSize) {
  const std::vector<double> few(7);
  EXPECT_THAT(message_of<std::invalid_argument>([&] { (void)find_contact_edge(few, few, 4); }),
              HasSubstr("7 pressures and 7 gaps are not half of 4 x 4"));
}

}  // namespace
}  // namespace stridor
