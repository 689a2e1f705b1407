#include "tests/support/sliding_state.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "core/errors.hpp"
#include "solvers/eigenvalues/dense_eigenvalues.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/reference_brake.hpp"

namespace stridor {
namespace {

using test::message_of;
using test::reference_brake;

constexpr double k_phi = 4e7, k_z = 1e8, k_c = 2e7, mu = 0.3;

DiscModelParameters pressed_brake(std::vector<std::string> terms, PistonParameters piston) {
  DiscModelParameters brake = reference_brake(std::move(terms));
  brake.contact.preload.reset();
  brake.pads.piston = piston;
  return brake;
}

const std::vector<std::string> all_terms{"gyroscopic", "friction", "friction_damping", "geometric",
                                         "structural_damping"};

TEST(SlidingState, LeaningSpringsAddToThePistonsForce) {
  // k_φ u = μ λ and k_c u = λ − P, as the disc stays where it is between two pads alike.
  const DiscModel model = make_disc_model(pressed_brake({"friction"}, {3000.0, {}}));
  const double force = 3000.0 / (1.0 - mu * k_c / k_phi);
  ASSERT_EQ(model.state.contacts.size(), 2U);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_NEAR(model.state.contacts[i].force, force, 1e-10 * force);
    EXPECT_NEAR(model.contacts[i].pad_phi.dot(model.state.displacement), mu * force / k_phi,
                1e-10 * force / k_phi);
    EXPECT_NEAR(model.state.contacts[i].gap, 0.0, 1e-18);
  }
}

TEST(SlidingState, SpringsThatComeCloserPress) {
  // k_φ u + k_c δ = μ λ and k_c u + k_z δ = λ.
  const double delta = 4e-5;
  const DiscModel model = make_disc_model(pressed_brake({"friction"}, {{}, delta}));
  const double force = (k_z - k_c * k_c / k_phi) * delta / (1.0 - mu * k_c / k_phi);
  for (const FaceContactPoint& point : model.state.contacts)
    EXPECT_NEAR(point.force, force, 1e-10 * force);
}

TEST(SlidingState, PenaltyGivesWay) {
  // The same with the pad's way x into the disc: k_φ u − k_c x = μ λ, k_c u − k_z x = λ − P, λ =
  // k_C x.
  DiscModelParameters brake = pressed_brake({"friction"}, {3000.0, {}});
  brake.contact.formulation = ContactFormulation::penalty;
  brake.contact.penalty = 1e9;
  const DiscModel model = make_disc_model(brake);
  const double way = 3000.0 / (1e9 + k_z - (mu * 1e9 + k_c) * k_c / k_phi);
  for (const FaceContactPoint& point : model.state.contacts) {
    EXPECT_NEAR(point.force, 1e9 * way, 1e-10 * 1e9 * way);
    EXPECT_NEAR(point.gap, -way, 1e-10 * way);
  }
  // With rigid contacts in the limit, at first order.
  const double rigid = 3000.0 / (1.0 - mu * k_c / k_phi);
  const auto error = [&](double penalty) {
    brake.contact.penalty = penalty;
    return std::abs(make_disc_model(brake).state.contacts[0].force - rigid);
  };
  EXPECT_NEAR(error(1e11) / error(1e12), 10.0, 0.1);
}

TEST(SlidingState, PadsThatAreDrawnInWithoutBoundHaveNone) {
  DiscModelParameters brake = pressed_brake({"friction"}, {3000.0, {}});
  brake.contact.friction.coefficient = 0.999 * k_phi / k_c;
  EXPECT_GT(make_disc_model(brake).state.contacts[0].force, 1000.0 * 3000.0 * 0.999);
  brake.contact.friction.coefficient = 1.001 * k_phi / k_c;
  EXPECT_NE(message_of<NumericalError>([&] {
              make_disc_model(brake);
            }).find("found no state in which it slides steadily"),
            std::string::npos);
}

/// Pads that are as good as rigid, with contact points at ±25 mm.
DiscModelParameters tilting_brake(double friction, double thickness) {
  DiscModelParameters brake = pressed_brake({"friction"}, {3000.0, {}});
  brake.contact.friction.coefficient = friction;
  brake.pads.mass.reset();
  brake.pads.elastic.emplace();
  brake.pads.elastic->length = 0.06;
  brake.pads.elastic->thickness = thickness;
  brake.pads.elastic->width = 0.04;
  brake.pads.elastic->material = {1e16, 0.3, 2500.0};
  brake.pads.elastic->mesh = {12, 2};
  brake.pads.radius = 0.13;
  brake.contact.offsets = {-0.025, 0.025};
  return brake;
}

TEST(SlidingState, FrictionPressesTheLeadingEdge) {
  // Forces as above; the moment of friction at the face and of the springs at the back, μ Λ H, is
  // carried by the points: x (λ₁ − λ₂) = μ Λ H.
  constexpr double H = 0.015, x = 0.025;
  const DiscModel model = make_disc_model(tilting_brake(mu, H));
  // The points' directions turn by x/r against the pad's; the friction along the pad goes with the
  // cosine of it, and what lies across loads the radial springs only.
  const double along = mu * std::cos(x / 0.13);
  const double sum = 3000.0 / (1.0 - along * k_c / k_phi);
  for (const std::size_t first : {0, 2}) {
    const double leading = model.state.contacts[first].force;
    const double trailing = model.state.contacts[first + 1].force;
    EXPECT_NEAR(leading + trailing, sum, 1e-6 * sum);
    EXPECT_NEAR(leading - trailing, along * sum * H / x, 1e-5 * sum);
  }
}

TEST(SlidingState, TheTrailingEdgeOpensWhereFrictionTiltsThePad) {
  // μ H > x: the trailing point would have to pull. On one point, with v = θ x_1 there,
  //   k_φ (u − θ H/2) + k_c v = μ λ,  k_c (u − θ H/2) + k_z v = λ − P,
  //   −(H/2) [k_φ (u − θ H/2) + k_c v] + k_z L²/12 θ = x_1 λ + μ λ H/2,  v + θ x_1 = 0,  x_1 = −x
  constexpr double H = 0.05, x = 0.025, L = 0.06, friction = 0.6;
  const double along = friction * std::cos(x / 0.13);
  const DiscModel model = make_disc_model(tilting_brake(friction, H));
  Eigen::Matrix4d equations;                        // u, v, θ, λ
  equations << k_phi, k_c, -k_phi * H / 2, -along,  //
      k_c, k_z, -k_c * H / 2, -1.0,                 //
      -H / 2 * k_phi, -H / 2 * k_c, H * H / 4 * k_phi + k_z * L * L / 12, x - along * H / 2,  //
      0.0, 1.0, -x, 0.0;
  const Eigen::Vector4d solution =
      equations.partialPivLu().solve(Eigen::Vector4d(0.0, -3000.0, 0.0, 0.0));
  const double opening = solution(1) + x * solution(2);
  ASSERT_GT(opening, 0.0);
  for (const std::size_t first : {0, 2}) {
    EXPECT_TRUE(model.state.contacts[first].is_closed);
    EXPECT_FALSE(model.state.contacts[first + 1].is_closed);
    EXPECT_NEAR(model.state.contacts[first].force, solution(3), 1e-5 * solution(3));
    EXPECT_EQ(model.state.contacts[first + 1].force, 0.0);
    EXPECT_NEAR(model.state.contacts[first + 1].gap, opening, 1e-5 * opening);
  }
  EXPECT_EQ(model.system.gaps.rows(), 2);
}

/// A soft pad on one face only, so that the disc bends, with five points: asymmetric and nonlinear.
struct OneSidedBrake {
  LinearSystem bodies;
  std::vector<FaceContact> contacts;
  FaceContactLaw law;
  Eigen::VectorXd loads;
};

OneSidedBrake one_sided_brake() {
  DiscModelParameters brake = tilting_brake(0.8, 0.03);
  brake.terms = all_terms;
  brake.disc.speed = 60.0;
  brake.disc.damping.alpha = brake.pads.damping.alpha = 1e4;
  brake.disc.damping.beta = brake.pads.damping.beta = 1e-5;
  brake.pads.elastic->material.youngs_modulus = 1e10;
  brake.pads.elastic->reduction.fixed_interface_modes = 6;
  brake.contact.offsets = {-0.03, -0.015, 0.0, 0.015, 0.03};
  brake.contact.formulation = ContactFormulation::penalty;
  brake.contact.penalty = 1e9;
  brake.pads.piston->force = 2000.0;
  const DiscModel model = make_disc_model(brake);
  OneSidedBrake one{model.bodies, {}, model.law, {}};
  one.contacts.assign(model.contacts.begin(), model.contacts.begin() + 5);
  const PadBody pad =
      make_elastic_pad(*brake.pads.elastic, brake.pads.stiffness, brake.contact.offsets);
  one.loads = Eigen::VectorXd::Zero(model.bodies.size());
  one.loads.segment(model.bodies.size() - 2 * pad.size(), pad.size()) = 2000.0 * pad.pushed;
  return one;
}

TEST(SlidingState, IsTheEquilibriumOfTheSecondOrderForces) {
  const OneSidedBrake brake = one_sided_brake();
  const SlidingStateSolution found =
      solve_sliding_state(brake.bodies, brake.contacts, brake.law, brake.loads);
  ASSERT_TRUE(found.has_converged);
  const Eigen::VectorXd& q = found.state.displacement;
  Eigen::VectorXd forces = brake.loads;
  int num_open = 0;
  for (std::size_t i = 0; i < brake.contacts.size(); ++i) {
    const FaceContactPoint& point = found.state.contacts[i];
    num_open += point.is_closed ? 0 : 1;
    EXPECT_GE(point.force, 0.0);
    EXPECT_NEAR(point.force, std::max(0.0, -1e9 * point.gap), 1e-9 * 2000.0);
    forces += point.force * unit_force(brake.contacts[i], brake.law, point);
  }
  EXPECT_GT(num_open, 0);
  EXPECT_LT((brake.bodies.position * q - forces).norm(), 1e-9 * forces.norm());
  // The way the state turns is felt: without it the forces are others.
  FaceContactLaw straight = brake.law;
  straight.forces_bend = false;
  const auto plain = solve_sliding_state(brake.bodies, brake.contacts, straight, brake.loads);
  ASSERT_TRUE(plain.has_converged);
  EXPECT_GT((plain.state.displacement - q).norm(), 1e-4 * q.norm());
}

TEST(SlidingState, TheDeformedStateFeedsTheSmallMotion) {
  // Eigenvalues with the forces that the piston makes are those of the same forces prescribed, but
  // for the bodies' displacement. Both pads are carried along by the same way, and nothing depends
  // on where they stand around the disc: what is left is of second order.
  const auto eigenvalues = [](const DiscModelParameters& brake) {
    return dense_eigenvalues(test::pencil_of(brake));
  };
  const auto difference = [&](double force) {
    const DiscModelParameters pressed = pressed_brake(all_terms, {force, {}});
    DiscModelParameters prescribed = reference_brake(all_terms);
    prescribed.contact.preload = make_disc_model(pressed).state.contacts[0].force;
    const auto a = eigenvalues(pressed);
    const auto b = eigenvalues(prescribed);
    double largest = 0.0;
    for (std::size_t i = 0; i < a.size(); ++i)
      largest = std::max(largest, std::abs(a[i].s - b[i].s));
    return largest;
  };
  const double at_full = difference(3000.0);
  EXPECT_GT(at_full, 1e-3);
  EXPECT_NEAR(difference(1500.0) / at_full, 0.25, 0.03);
}

TEST(SlidingState, IsTheSameAtAnyAngle) {
  DiscModelParameters brake = tilting_brake(mu, 0.015);
  brake.terms = all_terms;
  brake.pads.elastic->material.youngs_modulus = 1e10;
  const DiscModel there = make_disc_model(brake);
  brake.pads.angle = 2.1;
  const DiscModel turned = make_disc_model(brake);
  for (std::size_t i = 0; i < there.contacts.size(); ++i) {
    EXPECT_NEAR(turned.state.contacts[i].force, there.state.contacts[i].force,
                1e-12 * there.state.contacts[i].force);
  }
}

TEST(SlidingState, NeedsOneOfPreloadAndPiston) {
  DiscModelParameters brake = pressed_brake({"friction"}, {3000.0, {}});
  brake.contact.preload = 3000.0;
  EXPECT_EQ(message_of<std::invalid_argument>([&] { make_disc_model(brake); }),
            "disc: contacts have either a preload or pads with a piston");
}

}  // namespace
}  // namespace stridor
