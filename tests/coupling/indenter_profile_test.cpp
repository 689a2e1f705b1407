#include "coupling/laws/indenter_profile.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "tests/support/message_of.hpp"

namespace stridor {
namespace {

using test::message_of;
using ::testing::HasSubstr;

ProfileParameters parameters_of(ProfileShape shape, double radius) {
  ProfileParameters parameters;
  parameters.shape = shape;
  parameters.radius = radius;
  return parameters;
}

/// A table of f at equal steps.
template <class Function>
IndenterProfile table_of(const Function& f, double reach, int num_steps) {
  ProfileParameters parameters = parameters_of(ProfileShape::table, 1.0);
  for (int i = 0; i <= num_steps; ++i) {
    parameters.radii.push_back(reach * i / num_steps);
    parameters.heights.push_back(f(parameters.radii.back()));
  }
  return IndenterProfile(parameters);
}

TEST(IndenterProfile, SlopeIsTheDerivativeOfTheHeight) {
  const double h = 1e-5;
  for (const IndenterProfile& profile :
       {IndenterProfile(parameters_of(ProfileShape::paraboloid, 2.0)),
        IndenterProfile(parameters_of(ProfileShape::sphere, 2.0)),
        table_of([](double r) { return r * r * r; }, 2.0, 7)}) {
    EXPECT_EQ(profile.height(0.0), 0.0);
    for (const double r : {0.1, 0.7, 1.3}) {
      const double slope = (profile.height(r + h) - profile.height(r - h)) / (2.0 * h);
      EXPECT_NEAR(profile.slope(r), slope, 1e-8);
    }
  }
}

TEST(IndenterProfile, SphereIsAParaboloidNearItsTipAndEndsAtItsRadius) {
  const IndenterProfile sphere(parameters_of(ProfileShape::sphere, 2.0));
  EXPECT_NEAR(sphere.height(1e-3) / (1e-6 / 4.0), 1.0, 1e-6);
  EXPECT_EQ(sphere.height(2.0), 2.0);
  EXPECT_EQ(sphere.height(2.0001), std::numeric_limits<double>::infinity());
  EXPECT_EQ(sphere.reach(), 2.0);
}

TEST(IndenterProfile, ElasticContactHasTheClosedFormsOfSneddon) {
  // Power laws f = c r^n: δ = c a^n √π Γ(n/2 + 1)/Γ((n + 1)/2), F/E* = 2 n/(n + 1) a δ.
  for (const double power : {1.0, 2.0, 3.0}) {
    const auto f = [&](double r) { return 0.3 * std::pow(r, power); };
    const IndenterProfile profile = table_of(f, 3.0, 3000);
    const double a = 1.2;
    const double delta =
        f(a) * std::sqrt(M_PI) * std::tgamma(0.5 * power + 1.0) / std::tgamma(0.5 * (power + 1.0));
    // The cubic between the points is of third order in the step of 1e-3.
    EXPECT_NEAR(profile.elastic_indentation(a) / delta, 1.0, 1e-5) << power;
    EXPECT_NEAR(*profile.elastic_contact_radius(delta) / a, 1.0, 1e-5) << power;
    EXPECT_NEAR(profile.elastic_force(a) / (2.0 * power / (power + 1.0) * a * delta), 1.0, 2e-5);
  }
  const IndenterProfile paraboloid(parameters_of(ProfileShape::paraboloid, 0.5));
  EXPECT_DOUBLE_EQ(*paraboloid.elastic_contact_radius(0.02), 0.1);
  EXPECT_NEAR(paraboloid.elastic_force(0.1), 4.0 / 3.0 * std::sqrt(0.5) * std::pow(0.02, 1.5),
              1e-15);
  const IndenterProfile sphere(parameters_of(ProfileShape::sphere, 0.5));
  EXPECT_NEAR(*sphere.elastic_contact_radius(sphere.elastic_indentation(0.3)), 0.3, 1e-14);
}

TEST(IndenterProfile, ContactUpToTheEndHasNoRadius) {
  EXPECT_FALSE(table_of([](double r) { return r * r; }, 1.0, 10).elastic_contact_radius(10.0));
}

TEST(IndenterProfile, RefusesWrongShapes) {
  const auto says = [](auto&& call) { return message_of<std::invalid_argument>(call); };
  EXPECT_THAT(says([] { IndenterProfile p(parameters_of(ProfileShape::sphere, 0.0)); }),
              HasSubstr("radius 0 m is not > 0"));
  ProfileParameters table = parameters_of(ProfileShape::table, 1.0);
  table.radii = {0.1, 0.2};
  table.heights = {0.0, 0.1};
  EXPECT_THAT(says([&] { IndenterProfile p(table); }), HasSubstr("does not start at (0, 0)"));
  table.radii = {0.0, 0.1, 0.2};
  table.heights = {0.0, 0.1, 0.05};
  EXPECT_THAT(says([&] { IndenterProfile p(table); }), HasSubstr("heights descend"));
  EXPECT_THAT(says([] {
                (void)IndenterProfile(parameters_of(ProfileShape::paraboloid, 1.0))
                    .elastic_contact_radius(-1.0);
              }),
              HasSubstr("indentation -1 m is not > 0"));
}

std::vector<Problem> problems_of(const ProfileParameters& profile) {
  std::vector<Problem> problems;
  for (const auto& check : ProfileParameters::schema().checks) check(&profile, problems);
  return problems;
}

TEST(IndenterProfile, SchemaChecksTables) {
  ProfileParameters profile = parameters_of(ProfileShape::table, 1.0);
  EXPECT_EQ(problems_of(profile).size(), 2u);
  profile.radii = {0.0, 0.1, 0.2};
  profile.heights = {0.0, 0.01, 0.04};
  EXPECT_TRUE(problems_of(profile).empty());
  profile.heights.push_back(1.0);
  ASSERT_EQ(problems_of(profile).size(), 1u);
  EXPECT_EQ(problems_of(profile)[0].message, "has 4 entries, `radii` 3");
  profile.shape = ProfileShape::sphere;
  ASSERT_EQ(problems_of(profile).size(), 1u);
  EXPECT_EQ(problems_of(profile)[0].message, "needs `shape: table`");
}

}  // namespace
}  // namespace stridor
