#include "coupling/laws/substrate_contact.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <memory>

namespace stridor {
namespace {

using SignKind = RegularisedSign::Kind;

double derivative(const std::function<double(double)>& f, double x, double h) {
  return (8.0 * (f(x + h) - f(x - h)) - (f(x + 2 * h) - f(x - 2 * h))) / (12.0 * h);
}

SubstrateContact contact_with(RegularisedSign sign, FrictionLoad load) {
  static const auto law = std::make_shared<FittedLaw>(published_coefficients());
  return {law, 5.0, 12.5, 1.0 / 7.5e-4, 0.3, 1.0, load, {}, sign};
}

TEST(RegularisedSign, NoneIsOneFromZeroOn) {
  for (const double v : {0.0, 0.1, 1e9}) {
    const RegularisedSign::Value found = RegularisedSign{SignKind::none, 0.2}.at(v);
    EXPECT_EQ(found.value, 1.0);
    EXPECT_EQ(found.slope, 0.0);
  }
}

TEST(RegularisedSign, FunctionsRiseFromZeroToOne) {
  for (const SignKind kind :
       {SignKind::tanh, SignKind::linear, SignKind::square_root, SignKind::atan}) {
    const RegularisedSign sign{kind, 0.2};
    EXPECT_EQ(sign.at(0.0).value, 0.0);
    EXPECT_NEAR(sign.at(2e9).value, 1.0, 1e-9);
    double last = -1.0;
    for (double v = 0.0; v < 2.0; v += 0.03) {
      EXPECT_GE(sign.at(v).value, last);
      last = sign.at(v).value;
      if (v > 0.0) {
        EXPECT_NEAR(sign.at(v).slope,
                    derivative([&](double at) { return sign.at(at).value; }, v, 1e-4 * v), 1e-9);
      }
    }
  }
  // tanh 1, 1/√2, and half of one where arctan 1 = π/4.
  EXPECT_NEAR((RegularisedSign{SignKind::tanh, 0.2}.at(0.2).value), 0.7615941559557649, 1e-15);
  EXPECT_NEAR((RegularisedSign{SignKind::square_root, 0.2}.at(0.2).value), std::sqrt(0.5), 1e-15);
  EXPECT_NEAR((RegularisedSign{SignKind::atan, 0.2}.at(0.2).value), 0.5, 1e-15);
  EXPECT_NEAR((RegularisedSign{SignKind::linear, 0.2}.at(0.1).value), 0.5, 1e-15);
}

TEST(SubstrateContact, DerivativesAreThoseOfTheForces) {
  for (const SignKind kind :
       {SignKind::none, SignKind::tanh, SignKind::linear, SignKind::square_root, SignKind::atan}) {
    for (const FrictionLoad load : {FrictionLoad::applied, FrictionLoad::contact}) {
      const SubstrateContact contact = contact_with({kind, 0.05}, load);
      for (const double direction : {1.0, -1.0}) {
        const double y = 0.08;
        const double v = 0.04 * direction;
        const SubstrateForces forces = contact.at(y, v, direction);
        const auto normal = [&](double at_y, double at_v) {
          return contact.at(at_y, at_v, direction).normal.value;
        };
        const auto tangential = [&](double at_y, double at_v) {
          return contact.at(at_y, at_v, direction).tangential.value;
        };
        // Against the slip.
        EXPECT_LT(forces.tangential.value * direction, 0.0);
        const double size = std::abs(forces.normal.value) / y;
        const auto by_y = [&](auto&& force) {
          return derivative([&](double at) { return force(at, v); }, y, 1e-3 * y);
        };
        const auto by_v = [&](auto&& force) {
          return derivative([&](double at) { return force(y, at); }, v, 1e-4);
        };
        EXPECT_NEAR(forces.normal.by_indentation, by_y(normal), 1e-9 * size);
        EXPECT_NEAR(forces.normal.by_slip, by_v(normal), 1e-8 * size);
        EXPECT_NEAR(forces.tangential.by_indentation, by_y(tangential), 1e-9 * size);
        EXPECT_NEAR(forces.tangential.by_slip, by_v(tangential), 1e-8 * size);
      }
    }
  }
}

TEST(SubstrateContact, OnlySetValuedFrictionHasStaticStrength) {
  const double y = 0.08;
  const SubstrateContact set_valued = contact_with({}, FrictionLoad::applied);
  // The area without speed is b_1 b_2 ŷ in the published fit.
  EXPECT_NEAR(set_valued.static_strength(y).value, 0.3 * 1.440 * 2.118 * y / 5.0, 1e-15);
  const SubstrateContact smooth = contact_with({SignKind::tanh, 0.05}, FrictionLoad::applied);
  EXPECT_EQ(smooth.static_strength(y).value, 0.0);
  EXPECT_EQ(smooth.at(y, 0.0, 1.0).tangential.value, 0.0);
}

TEST(SubstrateContact, NothingActsOutOfContact) {
  for (const double y : {0.0, -1.0}) {
    for (const SignKind kind : {SignKind::none, SignKind::atan}) {
      const SubstrateForces forces =
          contact_with({kind, 0.05}, FrictionLoad::contact).at(y, 0.0, 1.0);
      EXPECT_EQ(forces.range, LawRange::no_contact);
      EXPECT_EQ(forces.normal.value, 0.0);
      EXPECT_EQ(forces.tangential.value, 0.0);
    }
  }
}

}  // namespace
}  // namespace stridor
