#include "coupling/laws/viscoelastic_law.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <memory>
#include <numbers>
#include <vector>

#include "tests/support/message_of.hpp"

namespace stridor {
namespace {

using test::message_of;
using ::testing::HasSubstr;

/// The derivative of f at x by central differences of sixth order.
double law_derivative(const std::function<double(double)>& f, double x, double h) {
  return (45.0 * (f(x + h) - f(x - h)) - 9.0 * (f(x + 2 * h) - f(x - 2 * h)) +
          (f(x + 3 * h) - f(x - 3 * h))) /
         (60.0 * h);
}

void expect_derivatives(const ViscoelasticContactLaw& law, double y, double v, double tolerance) {
  using Member = LawValue ViscoelasticContact::*;
  const ViscoelasticContact contact = law.at(y, v);
  for (const Member member :
       {&ViscoelasticContact::force, &ViscoelasticContact::area, &ViscoelasticContact::friction}) {
    const LawValue& found = contact.*member;
    const double by_y =
        law_derivative([&](double at) { return (law.at(at, v).*member).value; }, y, 1e-3 * y);
    const double by_v =
        law_derivative([&](double at) { return (law.at(y, at).*member).value; }, v, 1e-3 * v);
    // Relative to the size of the quantity over the variable.
    EXPECT_NEAR(found.by_indentation, by_y, tolerance * found.value / y) << y << ' ' << v;
    EXPECT_NEAR(found.by_speed, by_v, tolerance * found.value / v) << y << ' ' << v;
  }
}

void expect_nothing(const ViscoelasticContact& contact) {
  EXPECT_EQ(contact.range, LawRange::no_contact);
  for (const LawValue& quantity : {contact.force, contact.area, contact.friction}) {
    EXPECT_EQ(quantity.value, 0.0);
    EXPECT_EQ(quantity.by_indentation, 0.0);
    EXPECT_EQ(quantity.by_speed, 0.0);
  }
}

ContactTable power_table() {
  // F̃ = 2 ŷ^1.5 v̂^0.1, Ã = 3 ŷ v̂^-0.05, μ = ŷ^½ v̂^0.3: straight in the logarithms.
  ContactTable table;
  table.speeds = {0.01, 0.1, 0.5, 3.0};
  table.indentations = {1e-3, 1e-2, 0.2};
  for (const double y : table.indentations) {
    for (const double v : table.speeds) {
      table.force.push_back(2.0 * std::pow(y, 1.5) * std::pow(v, 0.1));
      table.area.push_back(3.0 * y * std::pow(v, -0.05));
      table.friction.push_back(std::sqrt(y) * std::pow(v, 0.3));
    }
  }
  return table;
}

TEST(FittedLaw, DerivativesAreThoseOfTheValue) {
  const FittedLaw law(published_coefficients());
  for (const double y : {1e-4, 3e-3, 0.1})
    for (const double v : {1e-4, 4e-3, 0.3, 20.0}) expect_derivatives(law, y, v, 1e-10);
}

TEST(FittedLaw, ValuesOfThePublishedFormulas) {
  // PPH (34), (36), (38) at ŷ = 0.01, v̂ = 0.01, evaluated by hand.
  const ViscoelasticContact contact = FittedLaw(published_coefficients()).at(0.01, 0.01);
  const double z = 0.873 * -2.0 + -0.449 * -2.0 + 0.412;
  EXPECT_NEAR(contact.force.value, 11.890 * 1e-3 * 0.5 * (1.199 + std::erf(z)), 1e-15);
  const double s = (-2.0 - (0.493 * -2.0 - 1.328)) / 0.826;
  EXPECT_NEAR(contact.area.value, 1.440 * 0.01 * (2.118 - std::exp(-0.5 * s * s)), 1e-15);
  const double t = (-2.0 - (0.489 * -2.0 - 1.682)) / 0.766;
  EXPECT_NEAR(contact.friction.value, 0.450 * 0.1 * std::exp(-0.5 * t * t), 1e-15);
  EXPECT_EQ(contact.range, LawRange::inside);
}

TEST(FittedLaw, RestHasTheLimitsAndNoNaN) {
  const FittedLaw law(published_coefficients());
  const ViscoelasticContact rest = law.at(0.01, 0.0);
  const ViscoelasticContact slow = law.at(0.01, 1e-300);
  EXPECT_DOUBLE_EQ(rest.force.value, slow.force.value);
  EXPECT_DOUBLE_EQ(rest.force.by_indentation, slow.force.by_indentation);
  EXPECT_DOUBLE_EQ(rest.area.value, slow.area.value);
  EXPECT_DOUBLE_EQ(rest.area.by_indentation, slow.area.by_indentation);
  EXPECT_EQ(rest.friction.value, 0.0);
  EXPECT_EQ(slow.friction.value, 0.0);
  EXPECT_EQ(slow.force.by_speed, 0.0);
}

TEST(FittedLaw, DeepIndentationIsFlaggedAndNotClamped) {
  const FittedLaw law(published_coefficients());
  EXPECT_EQ(law.at(0.3, 0.1).range, LawRange::inside);
  EXPECT_EQ(law.at(0.31, 0.1).range, LawRange::too_deep);
  EXPECT_GT(law.at(0.5, 0.1).force.value, law.at(0.31, 0.1).force.value);
}

TEST(ContactLaws, VanishOutOfContact) {
  const std::vector<std::unique_ptr<ViscoelasticContactLaw>> laws = [] {
    std::vector<std::unique_ptr<ViscoelasticContactLaw>> list;
    list.push_back(std::make_unique<FittedLaw>(published_coefficients()));
    list.push_back(std::make_unique<BoundaryElementLaw>(shipped_master_curve()));
    list.push_back(std::make_unique<TabulatedLaw>(power_table()));
    return list;
  }();
  for (const auto& law : laws) {
    for (const double y : {0.0, -0.1, std::nan("")})
      for (const double v : {0.0, 0.1}) expect_nothing(law->at(y, v));
  }
}

TEST(ContactLaws, OnlyTheMagnitudeOfTheSpeedMatters) {
  const FittedLaw fit(published_coefficients());
  const BoundaryElementLaw spline(shipped_master_curve());
  for (const ViscoelasticContactLaw* law : {static_cast<const ViscoelasticContactLaw*>(&fit),
                                            static_cast<const ViscoelasticContactLaw*>(&spline)}) {
    EXPECT_EQ(law->at(0.01, 0.1).friction.value, law->at(0.01, -0.1).friction.value);
    EXPECT_EQ(law->at(0.01, 0.1).force.by_speed, law->at(0.01, -0.1).force.by_speed);
  }
}

TEST(LimitedSpline, GoesThroughItsPointsAndToItsLimits) {
  // q = 1 + β²/(1 + β³): β² below, 1/β above.
  const auto q = [](double beta) { return 1.0 + beta * beta / (1.0 + beta * beta * beta); };
  std::vector<double> beta;
  std::vector<double> values;
  for (int k = -16; k <= 16; ++k) {
    beta.push_back(std::pow(10.0, k / 8.0));
    values.push_back(q(beta.back()));
  }
  const LimitedSpline spline(beta, values, 1.0, 2, 1.0);
  for (std::size_t k = 0; k < beta.size(); ++k)
    EXPECT_NEAR(spline.at(beta[k]).value, values[k], 1e-14);
  // Step 0.29 in ln β; the error of a cubic spline is 5/384 h⁴ times the fourth derivative,
  // about 5.
  for (double x = -10.0; x < 10.0; x += 0.37) {
    const double at = std::exp(x);
    EXPECT_NEAR(spline.at(at).value, q(at), 5e-4);
    const double slope =
        law_derivative([&](double b) { return spline.at(b).value; }, at, 1e-4 * at);
    EXPECT_NEAR(spline.at(at).slope * at, slope * at, 1e-7);
  }
  EXPECT_EQ(spline.at(0.0).value, 1.0);
  EXPECT_EQ(spline.at(0.0).slope, 0.0);
  // Once differentiable at the joints.
  for (const double joint : {beta.front(), beta.back()}) {
    EXPECT_NEAR(spline.at(joint * (1.0 - 1e-9)).slope, spline.at(joint * (1.0 + 1e-9)).slope,
                1e-6 * std::abs(spline.at(joint).slope));
  }
}

TEST(LimitedSpline, RefusesWrongPoints) {
  const auto says = [](std::vector<double> beta, std::vector<double> q, int power) {
    return message_of<std::invalid_argument>(
        [&] { LimitedSpline spline(beta, q, 0.0, power, 0.0); });
  };
  EXPECT_THAT(says({1.0, 2.0}, {1.0, 2.0}, 1), HasSubstr("three positive beta"));
  EXPECT_THAT(says({1.0, 2.0, 3.0}, {1.0, 2.0}, 1), HasSubstr("as many values"));
  EXPECT_THAT(says({1.0, 2.0, 3.0}, {1.0, 2.0, 3.0}, 3), HasSubstr("power 3 is not 1 or 2"));
  EXPECT_THAT(says({1.0, 3.0, 2.0}, {1.0, 2.0, 3.0}, 1), HasSubstr("does not ascend"));
}

TEST(BoundaryElementLaw, DerivativesAreThoseOfTheValue) {
  const BoundaryElementLaw law(shipped_master_curve());
  // β from below the data over all of it to beyond; never near a point of the spline, where the
  // third derivative jumps.
  for (const double y : {1e-4, 1e-2, 0.2})
    for (const double beta : {1.1e-3, 0.033, 0.4, 1.1, 7.0, 130.0, 4e4})
      expect_derivatives(law, y, beta * std::sqrt(y), 1e-7);
}

TEST(BoundaryElementLaw, HasTheReferenceValues) {
  // β = 0.1, 1, 10, 100 at ŷ = 0.01 on 256 cells; the shipped 512 cells differ by 1e-5 in force,
  // areas are good to 3 digits.
  const BoundaryElementLaw law(shipped_master_curve());
  const double force[] = {1.33802e-3, 1.62614e-3, 4.65343e-3, 1.01448e-2};
  const double area[] = {2.972e-2, 2.0174e-2, 1.8653e-2, 2.6858e-2};
  const double friction[] = {8.373e-3, 4.1775e-2, 2.7354e-2, 5.745e-3};
  for (int k = 0; k < 4; ++k) {
    const ViscoelasticContact contact = law.at(0.01, 0.1 * std::pow(10.0, k - 1));
    EXPECT_NEAR(contact.force.value / force[k], 1.0, 2e-5);
    EXPECT_NEAR(contact.area.value / area[k], 1.0, 1e-3);
    EXPECT_NEAR(contact.friction.value / friction[k], 1.0, 2e-4);
    EXPECT_EQ(contact.range, LawRange::inside);
  }
}

TEST(BoundaryElementLaw, HasTheExactLimits) {
  const BoundaryElementLaw law(shipped_master_curve());
  const double y = 0.04;
  const ViscoelasticContact rest = law.at(y, 0.0);
  EXPECT_NEAR(rest.force.value, 4.0 / 3.0 * 0.008, 1e-15);
  EXPECT_NEAR(rest.area.value, std::numbers::pi * y, 1e-15);
  EXPECT_EQ(rest.friction.value, 0.0);
  EXPECT_NEAR(rest.friction.by_speed, 0.9, 1e-14);  // μ = √ŷ (1 − e0) β
  EXPECT_EQ(rest.force.by_speed, 0.0);
  EXPECT_EQ(rest.range, LawRange::beyond_data);
  const double beta = 1e9;
  const ViscoelasticContact fast = law.at(y, beta * 0.2);
  EXPECT_NEAR(fast.force.value, 40.0 / 3.0 * 0.008, 1e-6);
  EXPECT_NEAR(fast.area.value, std::numbers::pi * y, 1e-6);
  EXPECT_NEAR(fast.friction.value * beta / (0.2 * 7.2), 1.0, 1e-4);
  EXPECT_EQ(law.at(0.4, 0.5).range, LawRange::too_deep);
}

TEST(BoundaryElementLaw, InterpolatesBetterThanTheGridResolves) {
  // Left-out points of the curve are met by the spline through the others, at twice the step.
  MasterCurve half = shipped_master_curve();
  for (std::size_t k = half.points.size() - 2; k < half.points.size(); k -= 2)
    half.points.erase(half.points.begin() + static_cast<std::ptrdiff_t>(k));
  const BoundaryElementLaw coarse(half);
  for (const MasterPoint& point : shipped_master_curve().points) {
    if (point.memory_in_cells < 8.0) continue;
    const ViscoelasticContact contact = coarse.at(1.0, point.beta);
    EXPECT_NEAR(contact.force.value / point.force, 1.0, 2e-4) << point.beta;
    EXPECT_NEAR(contact.area.value / point.area, 1.0, 1e-3) << point.beta;
    EXPECT_NEAR(contact.friction.value / point.friction, 1.0, 1e-3) << point.beta;
  }
}

TEST(BoundaryElementLaw, RefusesWrongCurves) {
  const auto says = [](const MasterCurve& curve) {
    return message_of<std::invalid_argument>([&] { BoundaryElementLaw law(curve); });
  };
  EXPECT_THAT(says({1.0, {}}), HasSubstr("modulus ratio 1 is not in (0, 1)"));
  EXPECT_THAT(says({0.1, {{1.0, 1.0, 1.0, 1.0, 1.9}}}), HasSubstr("fewer than three points"));
}

TEST(TabulatedLaw, PowerLawsAreMetExactlyInsideAndOutside) {
  const TabulatedLaw law(power_table());
  for (const double y : {2e-4, 1e-3, 5e-3, 0.7}) {
    for (const double v : {0.01, 0.2, 50.0}) {
      const ViscoelasticContact contact = law.at(y, v);
      const double force = 2.0 * std::pow(y, 1.5) * std::pow(v, 0.1);
      EXPECT_NEAR(contact.force.value / force, 1.0, 1e-12);
      EXPECT_NEAR(contact.force.by_indentation, 1.5 * force / y, 1e-11 * force / y);
      EXPECT_NEAR(contact.force.by_speed, 0.1 * force / v, 1e-11 * force / v);
      EXPECT_NEAR(contact.friction.value, std::sqrt(y) * std::pow(v, 0.3), 1e-12);
      const bool is_inside = y >= 1e-3 && y <= 0.2 && v >= 0.01 && v <= 3.0;
      EXPECT_EQ(contact.range, is_inside ? LawRange::inside : LawRange::beyond_data);
    }
  }
}

TEST(TabulatedLaw, SlowSlidingGoesOnToRest) {
  // ln F̃ = ln F̃_1 + p (v̂/v̂_1 − 1) with p = 0.1, and friction in proportion to the speed at last.
  const TabulatedLaw law(power_table());
  const double slowest = 0.01;
  for (const double y : {5e-3, 0.7}) {
    const ViscoelasticContact first = law.at(y, slowest);
    const ViscoelasticContact rest = law.at(y, 0.0);
    EXPECT_EQ(rest.range, LawRange::beyond_data);
    EXPECT_EQ(rest.friction.value, 0.0);
    EXPECT_NEAR(rest.force.value / first.force.value, std::exp(-0.1), 1e-12);
    EXPECT_NEAR(rest.force.by_speed, 0.1 * rest.force.value / slowest, 1e-9 * rest.force.value);
    EXPECT_NEAR(rest.area.value / first.area.value, std::exp(0.05), 1e-12);
    const double onset = first.friction.value * std::exp(1.0 - 0.3) / slowest;
    EXPECT_NEAR(rest.friction.by_speed / onset, 1.0, 1e-12);
    EXPECT_NEAR(law.at(y, 1e-9).friction.value / (1e-9 * onset), 1.0, 1e-6);
    for (const double v : {1e-5, 2e-3, 8e-3}) expect_derivatives(law, y, v, 1e-8);
    // Continuous in value and slope where the table begins.
    const ViscoelasticContact before = law.at(y, slowest * (1.0 - 1e-9));
    EXPECT_NEAR(before.friction.value / first.friction.value, 1.0, 1e-8);
    EXPECT_NEAR(before.friction.by_speed / first.friction.by_speed, 1.0, 1e-7);
    EXPECT_NEAR(before.force.by_speed / first.force.by_speed, 1.0, 1e-7);
  }
}

TEST(TabulatedLaw, DerivativesAreThoseOfTheValueAndNothingOvershoots) {
  ContactTable table = power_table();
  for (std::size_t k = 0; k < table.friction.size(); ++k)
    table.friction[k] = k % 4 < 2 ? 0.1 : 0.3;  // a step along the speed
  const TabulatedLaw law(table);
  for (const double y : {3e-3, 0.05})
    for (const double v : {0.03, 0.2, 1.0}) expect_derivatives(law, y, v, 1e-8);
  for (double v = 0.01; v < 3.0; v *= 1.05) {
    EXPECT_GE(law.at(0.003, v).friction.value, 0.1 - 1e-12);
    EXPECT_LE(law.at(0.003, v).friction.value, 0.3 + 1e-12);
  }
}

TEST(TabulatedLaw, RefusesWrongTables) {
  const auto says = [](auto&& change) {
    ContactTable table = power_table();
    change(table);
    return message_of<std::invalid_argument>([&] { TabulatedLaw law(table); });
  };
  EXPECT_THAT(says([](auto& t) {
                t.speeds = {1.0, 0.5};
              }),
              HasSubstr("speeds are not positive and ascending"));
  EXPECT_THAT(says([](auto& t) { t.indentations = {1.0}; }),
              HasSubstr("fewer than two indentations"));
  EXPECT_THAT(says([](auto& t) { t.area.pop_back(); }), HasSubstr("11 areas for 3 x 4 points"));
  EXPECT_THAT(says([](auto& t) { t.force[0] = 0.0; }), HasSubstr("forces are not all positive"));
}

}  // namespace
}  // namespace stridor
