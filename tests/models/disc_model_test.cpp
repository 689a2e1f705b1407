#include "tests/support/disc_model.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "solvers/eigenvalues/dense_eigenvalues.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/reference_brake.hpp"

namespace stridor {
namespace {

using test::message_of;
using test::pencil_of;
using test::reference_brake;

int num_growing(const std::vector<Eigenvalue>& eigenvalues) {
  return static_cast<int>(std::count_if(eigenvalues.begin(), eigenvalues.end(),
                                        [](const Eigenvalue& one) { return one.growth() > 1e-6; }));
}

double largest_growth(const std::vector<Eigenvalue>& eigenvalues) {
  return std::max_element(eigenvalues.begin(), eigenvalues.end(),
                          [](const auto& a, const auto& b) { return a.growth() < b.growth(); })
      ->growth();
}

TEST(DiscModel, EliminationLeavesNoZeroRoots) {
  const Pencil pencil = pencil_of(reference_brake({"friction"}));
  EXPECT_EQ(pencil.num_eigenvalues(), 34);
  const std::vector<Eigenvalue> found = dense_eigenvalues(pencil);
  ASSERT_EQ(found.size(), 17U);
  EXPECT_GT(found.front().frequency(), 1000.0);
  for (const Eigenvalue& one : found) EXPECT_LT(one.residual, 1e-11);
}

TEST(DiscModel, GyroscopicAndCirculatoryWithoutDampingIsUnstable) {
  const auto found = dense_eigenvalues(pencil_of(reference_brake({"gyroscopic", "friction"})));
  EXPECT_EQ(num_growing(found), 8);
  EXPECT_NEAR(largest_growth(found), 4.649547, 1e-6);
}

TEST(DiscModel, FrictionDampingAndPreloadLeaveFourGrowing) {
  const auto found = dense_eigenvalues(
      pencil_of(reference_brake({"gyroscopic", "friction", "friction_damping", "geometric"})));
  EXPECT_EQ(num_growing(found), 4);
  EXPECT_NEAR(largest_growth(found), 2.165453, 1e-6);
}

TEST(DiscModel, MaterialDampingStabilises) {
  DiscModelParameters brake = reference_brake(
      {"gyroscopic", "friction", "friction_damping", "geometric", "structural_damping"});
  brake.disc.damping.beta = brake.pads.damping.beta = 1e-7;
  EXPECT_NEAR(largest_growth(dense_eigenvalues(pencil_of(brake))), -4.590691, 1e-6);
  brake.disc.damping.beta = brake.pads.damping.beta = 1e-6;
  EXPECT_NEAR(largest_growth(dense_eigenvalues(pencil_of(brake))), -46.177, 5e-4);
}

TEST(DiscModel, WithoutGyroscopicTermsAndFrictionEverythingIsOnTheAxis) {
  for (const Eigenvalue& one : dense_eigenvalues(pencil_of(reference_brake({}))))
    EXPECT_LT(std::abs(one.growth()), 1e-7);
}

TEST(DiscModel, TheAngleOfThePadsDoesNotMatter) {
  DiscModelParameters brake = reference_brake(
      {"gyroscopic", "friction", "friction_damping", "geometric", "structural_damping"});
  brake.disc.damping.beta = brake.pads.damping.beta = 1e-7;
  const auto there = dense_eigenvalues(pencil_of(brake));
  for (const double angle : {0.4, 1.7, 5.0}) {
    brake.pads.angle = angle;
    const auto found = dense_eigenvalues(pencil_of(brake));
    ASSERT_EQ(found.size(), there.size());
    for (std::size_t i = 0; i < found.size(); ++i)
      EXPECT_LT(std::abs(found[i].s - there[i].s), 1e-12 * std::abs(there[i].s)) << angle;
  }
}

TEST(DiscModel, SeveralContactPointsShareThePreload) {
  DiscModelParameters brake = reference_brake({"gyroscopic", "friction", "geometric"});
  brake.contact.offsets = {-0.01, 0.01};
  const DiscModel model = make_disc_model(brake);
  EXPECT_EQ(model.contacts.size(), 4U);
  for (const FaceContactPoint& point : model.state.contacts) EXPECT_EQ(point.force, 1500.0);
  EXPECT_EQ(make_pencil(model.system).num_eigenvalues(), 30);
  // Points that come together are one.
  const auto one = dense_eigenvalues(pencil_of([&] {
    DiscModelParameters at_centre = brake;
    at_centre.contact.offsets.clear();
    at_centre.contact.formulation = ContactFormulation::penalty;
    at_centre.contact.penalty = 1e9;
    return at_centre;
  }()));
  brake.contact.formulation = ContactFormulation::penalty;
  brake.contact.penalty = 0.5e9;
  brake.contact.offsets = {-1e-7, 1e-7};
  const auto two = dense_eigenvalues(pencil_of(brake));
  ASSERT_EQ(one.size(), two.size());
  for (std::size_t i = 0; i < one.size(); ++i)
    EXPECT_LT(std::abs(one[i].s - two[i].s), 1e-7 * std::abs(one[i].s));
}

TEST(DiscModel, RejectsWhatCannotBe) {
  DiscModelParameters brake = reference_brake({"friction_damping"});
  brake.disc.speed = 0.0;
  EXPECT_EQ(message_of<std::invalid_argument>([&] { make_disc_model(brake); }),
            "disc: friction damping is infinite at no speed");
  brake = reference_brake({"gyration"});
  EXPECT_EQ(message_of<std::invalid_argument>([&] { make_disc_model(brake); }),
            "disc: there is no term 'gyration'");
  brake = reference_brake({});
  brake.contact.formulation = ContactFormulation::penalty;
  EXPECT_EQ(message_of<std::invalid_argument>([&] { make_disc_model(brake); }),
            "disc: the penalty formulation needs a penalty");
  brake = reference_brake({});
  brake.pads.radius = 0.2;
  EXPECT_EQ(message_of<std::invalid_argument>([&] { make_disc_model(brake); }),
            "disc: pads at a radius of 0.2 m are off the disc");
}

}  // namespace
}  // namespace stridor
