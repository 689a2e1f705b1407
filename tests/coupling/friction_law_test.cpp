#include "coupling/laws/friction_law.hpp"
#include "coupling/laws/static_dynamic_friction.hpp"
#include "coupling/laws/stribeck_friction.hpp"
#include "tests/support/constants.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace stridor {
namespace {

using test::eps;

constexpr double decay = 0.01;
const FrictionLaw falling = stribeck_friction(0.5, 0.2, decay);
const FrictionLaw rising = stribeck_friction(0.2, 0.5, decay);

TEST(FrictionLaw, ConstantHoldsAsMuchAtRestAsInSliding) {
  const FrictionLaw law = constant_friction(0.3);
  EXPECT_EQ(law.static_coefficient, 0.3);
  for (const double velocity : {-10.0, -1e-9, 0.0, 1e-9, 10.0}) {
    EXPECT_EQ(sliding_friction(law, velocity), 0.3);
    EXPECT_EQ(sliding_friction_slope(law, velocity), 0.0);
  }
}

TEST(FrictionLaw, StaticDynamicSlidesWithTheDynamicCoefficientAtAnySpeed) {
  const FrictionLaw law = static_dynamic_friction(0.4, 0.3);
  for (const double velocity : {-10.0, -1e-9, 0.0, 1e-9, 10.0}) {
    EXPECT_EQ(sliding_friction(law, velocity), 0.3);
    EXPECT_EQ(sliding_friction_slope(law, velocity), 0.0);
  }
}

TEST(FrictionLaw, StribeckFallsFromStaticToDynamicOverItsDecayVelocity) {
  EXPECT_EQ(sliding_friction(falling, 0.0), 0.5);
  EXPECT_EQ(sliding_friction(falling, 1.0), 0.2);  // e^-100 is nothing beside 0.2
  EXPECT_NEAR(sliding_friction(falling, 0.01), 0.2 + 0.3 * std::exp(-1.0), eps);
  EXPECT_NEAR(sliding_friction(falling, 0.01 * std::log(2.0)), 0.35, 2.0 * eps);
  double last = 1.0;
  for (double velocity = 0.0; velocity < 0.1; velocity += 1e-3) {
    EXPECT_LT(sliding_friction(falling, velocity), last);
    last = sliding_friction(falling, velocity);
  }
}

TEST(FrictionLaw, DependsOnTheSpeedNotOnItsSign) {
  for (const FrictionLaw& law : {falling, rising}) {
    for (const double velocity : {1e-4, 0.01, 0.3}) {
      EXPECT_EQ(sliding_friction(law, -velocity), sliding_friction(law, velocity));
      EXPECT_EQ(sliding_friction_slope(law, -velocity), sliding_friction_slope(law, velocity));
    }
  }
}

TEST(FrictionLaw, SlopeIsTheDerivativeByTheSpeed) {
  // Central difference: truncation v_d² μ'''/6 (1e-4)² is below 1e-8 of the slope, rounding
  // eps μ/(1e-4 v_d) is 1e-10.
  for (const FrictionLaw& law : {falling, rising}) {
    for (const double speed : {0.001, 0.01, 0.03}) {
      const double dv = 1e-4 * decay;
      const double difference =
          (sliding_friction(law, speed + dv) - sliding_friction(law, speed - dv)) / (2.0 * dv);
      const double slope = sliding_friction_slope(law, speed);
      EXPECT_NEAR(slope, difference, 1e-8 * std::abs(slope) + 2e-10) << speed;
    }
  }
  EXPECT_NEAR(sliding_friction_slope(falling, 0.0), -30.0, 30.0 * eps);
  EXPECT_NEAR(sliding_friction_slope(rising, 0.0), 30.0, 30.0 * eps);
  EXPECT_EQ(sliding_friction_slope(falling, 10.0), -0.0);
}

TEST(FrictionLaw, TakesVelocitiesInAUnit) {
  FrictionLaw scaled = falling;
  scaled.velocity_unit = 0.25;
  for (const RegularisedSign& sign : {RegularisedSign{}, {RegularisedSign::Kind::tanh, 0.08}}) {
    FrictionLaw plain = falling;
    plain.sign = {sign.kind, 0.25 * sign.speed};
    scaled.sign = sign;
    for (const double velocity : {-0.08, 0.0, 0.02}) {
      EXPECT_DOUBLE_EQ(sliding_friction(scaled, velocity),
                       sliding_friction(plain, 0.25 * velocity));
      EXPECT_DOUBLE_EQ(sliding_friction_slope(scaled, velocity),
                       0.25 * sliding_friction_slope(plain, 0.25 * velocity));
    }
  }
}

TEST(FrictionLaw, EqualCoefficientsMakeStribeckConstant) {
  const FrictionLaw law = stribeck_friction(0.3, 0.3, decay);
  for (const double velocity : {0.0, 0.01, 1.0}) {
    EXPECT_EQ(sliding_friction(law, velocity), 0.3);
    EXPECT_EQ(sliding_friction_slope(law, velocity), 0.0);
  }
}

}  // namespace
}  // namespace stridor
