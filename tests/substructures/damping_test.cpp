#include "substructures/matrices/damping.hpp"
#include "tests/support/constants.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

namespace stridor {
namespace {

using testing::IsEmpty;
using testing::SizeIs;

using test::eps;

/// Beam 1 of the paper: from 40 to 0.2 between 0.2 and 0.25 s.
RayleighDamping oblique_damping() {
  return {0.2, 4e-8, 40.0, 0.2, 0.05};
}

std::vector<Problem> problems_of_damping(const RayleighDamping& damping) {
  std::vector<Problem> problems;
  for (const auto& check : RayleighDamping::schema().checks) check(&damping, problems);
  return problems;
}

TEST(RayleighDamping, DefaultIsNone) {
  const RayleighDamping damping;
  EXPECT_EQ(damping.alpha_at(0.0), 0.0);
  EXPECT_EQ(damping.alpha_max(), 0.0);
  EXPECT_EQ(damping.beta, 0.0);
  EXPECT_EQ(damping.constant_from(), 0.0);
}

TEST(RayleighDamping, WithoutAStartValueAlphaIsConstant) {
  const RayleighDamping damping{40.0, 4e-8, {}, 0.0, 0.0};
  for (const double time : {-1.0, 0.0, 0.2, 100.0}) EXPECT_EQ(damping.alpha_at(time), 40.0);
  EXPECT_EQ(damping.alpha_max(), 40.0);
  EXPECT_EQ(damping.constant_from(), 0.0);
}

TEST(RayleighDamping, StartValueHoldsThenFallsLinearlyThenStays) {
  const RayleighDamping damping = oblique_damping();
  for (const double time : {-1.0, 0.0, 0.1, 0.2}) EXPECT_EQ(damping.alpha_at(time), 40.0) << time;
  // Four rounded operations on numbers up to 40; t − hold is rounded to eps t, a relative error of
  // eps t/fade = 5 eps of the fall.
  for (int i = 1; i < 10; ++i) {
    EXPECT_NEAR(damping.alpha_at(0.2 + 0.005 * i), 40.0 - 3.98 * i, 16.0 * eps * 40.0) << i;
  }
  for (const double time : {0.25 + 1e-15, 0.3, 2.25, 1e9})
    EXPECT_EQ(damping.alpha_at(time), 0.2) << time;
}

TEST(RayleighDamping, ScheduleIsContinuous) {
  const RayleighDamping damping = oblique_damping();
  const double slope = (40.0 - 0.2) / 0.05;
  for (const double time : {0.2, damping.constant_from()}) {
    const double step = 1e-9;
    EXPECT_LE(std::abs(damping.alpha_at(time + step) - damping.alpha_at(time - step)),
              2.0 * slope * step + 16.0 * eps * 40.0);
  }
}

TEST(RayleighDamping, ScheduleIsConstantFromTheEndOfTheFade) {
  EXPECT_EQ(oblique_damping().constant_from(), 0.2 + 0.05);
  EXPECT_EQ(oblique_damping().alpha_at(oblique_damping().constant_from()), 0.2);
}

TEST(RayleighDamping, FadeOfZeroIsAJump) {
  const RayleighDamping damping{1.0, 0.0, 40.0, 0.5, 0.0};
  EXPECT_EQ(damping.alpha_at(std::nextafter(0.5, 0.0)), 40.0);
  EXPECT_EQ(damping.alpha_at(0.5), 1.0);
  EXPECT_EQ(damping.constant_from(), 0.5);
}

TEST(RayleighDamping, AlphaMayRise) {
  const RayleighDamping damping{40.0, 0.0, 0.0, 1.0, 2.0};
  EXPECT_EQ(damping.alpha_at(1.0), 0.0);
  EXPECT_EQ(damping.alpha_at(2.0), 20.0);
  EXPECT_EQ(damping.alpha_at(3.0), 40.0);
}

TEST(RayleighDamping, LargestAlphaIsThatOfEitherEndOfTheSchedule) {
  EXPECT_EQ(oblique_damping().alpha_max(), 40.0);
  EXPECT_EQ((RayleighDamping{40.0, 0.0, 0.2, 1.0, 2.0}.alpha_max()), 40.0);
}

TEST(RayleighDamping, SchemaRefusesAHoldOrFadeOfNothing) {
  const char* const message =
      "alpha_start: missing: `hold` and `fade` say how long it lasts; give it or drop them";
  for (const RayleighDamping& damping :
       {RayleighDamping{1.0, 0.0, {}, 0.2, 0.0}, RayleighDamping{1.0, 0.0, {}, 0.0, 0.05}}) {
    const std::vector<Problem> problems = problems_of_damping(damping);
    ASSERT_THAT(problems, SizeIs(1));
    EXPECT_EQ(problems[0].text(), message);
  }
  EXPECT_THAT(problems_of_damping(oblique_damping()), IsEmpty());
  EXPECT_THAT(problems_of_damping({40.0, 4e-8, {}, 0.0, 0.0}), IsEmpty());
  EXPECT_THAT(problems_of_damping({0.2, 4e-8, 40.0, 0.0, 0.0}), IsEmpty());
}

}  // namespace
}  // namespace stridor
