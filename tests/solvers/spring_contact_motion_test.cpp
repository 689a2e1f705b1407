#include "solvers/spring_contact_motion.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tests/support/face_contacts.hpp"
#include "tests/support/message_of.hpp"

namespace stridor {
namespace {

using Complex = std::complex<double>;
using test::contact_of;
using test::fastest_of;
using test::FastestMode;
using test::message_of;
using test::squealing_brake;

TEST(SpringContactMotion, SmallMotionGrowsAsTheEigenvalueSays) {
  const DiscModelParameters brake = squealing_brake();
  const DiscModel model = make_disc_model(brake);
  const FastestMode mode = fastest_of(model.system);
  ASSERT_GT(mode.s.real(), 100.0);
  constexpr double step = 5e-6;
  constexpr double amplitude = 1e-12;
  SpringContactMotion motion(model.bodies, model.contacts, model.law, model.state, step);
  motion.start(amplitude * mode.q.real(), amplitude * (mode.s * mode.q).real());
  constexpr int num_steps = 4000;
  for (int n = 0; n < num_steps; ++n) ASSERT_TRUE(motion.step());
  const double t = num_steps * step;
  const Eigen::VectorXcd grown = amplitude * std::exp(mode.s * t) * mode.q;
  EXPECT_LT((motion.displacement() - grown.real()).norm(), 1e-4 * grown.norm());
  // The rate from displacement and velocity over |s|, whatever the phase.
  const auto size = [&](const Eigen::VectorXd& q, const Eigen::VectorXd& v) {
    const Eigen::VectorXcd phasor = q - Complex(0.0, 1.0) * (v - mode.s.real() * q) / mode.s.imag();
    return phasor.norm();
  };
  const double growth =
      std::log(size(motion.displacement(), motion.velocity()) /
               size(amplitude * mode.q.real(), amplitude * (mode.s * mode.q).real())) /
      t;
  EXPECT_NEAR(growth, mode.s.real(), 1e-3 * mode.s.real());
}

TEST(SpringContactMotion, SquealEndsInABoundedCycleWithLiftOff) {
  const DiscModelParameters brake = squealing_brake();
  const DiscModel model = make_disc_model(brake);
  const FaceContactLaw& law = model.law;
  const double preload = model.state.contacts.front().force;
  const FastestMode mode = fastest_of(model.system);
  constexpr double step = 4e-6;
  SpringContactMotion motion(model.bodies, model.contacts, law, model.state, step);
  motion.start(1e-7 * mode.q.real(), 1e-7 * (mode.s * mode.q).real());
  double largest[3] = {0.0, 0.0, 0.0};
  int num_open = 0;
  constexpr int num_steps = 20000;
  for (int n = 0; n < 3 * num_steps; ++n) {
    ASSERT_TRUE(motion.step()) << n;
    largest[n / num_steps] = std::max(largest[n / num_steps], motion.displacement().norm());
    for (int i = 0; i < motion.num_contacts(); ++i) {
      // The laws of contact from the motion, not from what the solver kept.
      const FaceContact& contact = model.contacts[static_cast<std::size_t>(i)];
      const FaceContactState state = motion.contact(i);
      const Eigen::VectorXd& q = motion.displacement();
      const double bent =
          0.5 * (contact.normal_bending() * q).dot(contact.bending_forces().transpose() * q);
      const double gap = contact.gap().dot(q) + bent;
      const double expected = std::max(0.0, preload - *law.penalty * gap);
      ASSERT_NEAR(state.force, expected, 1e-6 * (preload + expected));
      const Eigen::Vector2d friction(state.friction_force, state.across_force);
      ASSERT_LE(friction.norm(), law.friction * state.force * (1.0 + 1e-9));
      num_open += state.state == ContactState::open ? 1 : 0;
      if (state.state != ContactState::slip) continue;
      const double along = law.speed * contact.radius - contact.friction().dot(motion.velocity());
      EXPECT_GE(along * state.friction_force, -1e-6 * preload);
    }
  }
  EXPECT_GT(num_open, num_steps / 10);
  // Without lift-off it would grow by exp(27) from each window to the next.
  EXPECT_LT(largest[2], 1.5 * largest[1]);
  EXPECT_GT(largest[2], largest[1] / 1.5);
}

/// A mass that bounces on a spring that does not pull.
LinearSystem bouncer(double mass, double stiffness) {
  const auto one = [](double value) { return Eigen::MatrixXd::Constant(1, 1, value); };
  return {one(mass), one(0.0), one(stiffness), Eigen::MatrixXd(0, 1), Eigen::MatrixXd(0, 1)};
}

TEST(SpringContactMotion, BouncingMassHasItsClosedFormToSecondOrder) {
  constexpr double m = 2.0, k = 50.0, k_C = 800.0, N0 = 8.0, v0 = 0.7;
  const double w = std::sqrt(k / m);
  const double W = std::sqrt((k + k_C) / m);
  const double opening = N0 / k_C;
  // Aloft m q̈ + k q = −N0; in contact m q̈ + (k + k_C) q = 0; both begin at the opening.
  const double flight = 2.0 / w * std::atan(v0 / (w * (opening + N0 / k)));
  const double contact = 2.0 / W * (std::numbers::pi - std::atan(v0 / (W * opening)));
  const double period = flight + contact;
  const auto error = [&](int steps) {
    const std::vector<FaceContact> contacts{contact_of(1, -1, 0)};
    const FaceContactLaw law{0.0, k_C, 1.0, false, false};
    SpringContactMotion motion(bouncer(m, k), contacts, law,
                               prescribed_sliding_state(contacts, law, N0), period / steps);
    motion.start(Eigen::VectorXd::Constant(1, opening), Eigen::VectorXd::Constant(1, v0));
    for (int n = 0; n < 3 * steps; ++n) EXPECT_TRUE(motion.step());
    return std::hypot(W * (motion.displacement()(0) - opening), motion.velocity()(0) - v0) / v0;
  };
  const double coarse = error(1000);
  const double fine = error(4000);
  EXPECT_LT(coarse, 1e-3);
  EXPECT_LT(fine, coarse / 8.0);
}

TEST(SpringContactMotion, RefusesAStepTooLongForItsContacts) {
  constexpr double m = 2.0, k = 50.0, k_C = 800.0;
  const std::vector<FaceContact> contacts{contact_of(1, -1, 0)};
  const FaceContactLaw law{0.0, k_C, 1.0, false, false};
  const FaceSlidingState state = prescribed_sliding_state(contacts, law, 8.0);
  // Taking the spring out leaves 1 − k_C/(k + k_C) (1 − sin x/x) of it, x = ω h.
  double low = std::numbers::pi, high = 4.0;
  for (int i = 0; i < 60; ++i) {
    const double x = 0.5 * (low + high);
    (std::sin(x) / x > -k / k_C ? low : high) = x;
  }
  const double longest = low / std::sqrt((k + k_C) / m);
  EXPECT_NO_THROW(SpringContactMotion(bouncer(m, k), contacts, law, state, 0.999 * longest));
  EXPECT_NE(message_of<std::invalid_argument>([&] {
              SpringContactMotion(bouncer(m, k), contacts, law, state, 1.001 * longest);
            }).find("is too long for contacts as stiff as these"),
            std::string::npos);
  EXPECT_THROW(SpringContactMotion(bouncer(m, k), contacts, law, state, 2.2 * longest),
               std::invalid_argument);
  const FaceContactLaw rigid{0.0, std::nullopt, 1.0, false, false};
  EXPECT_EQ(message_of<std::invalid_argument>(
                [&] { SpringContactMotion(bouncer(m, k), contacts, rigid, state, 1e-3); }),
            "motion of face contacts: takes contacts with a penalty, and a plate that turns");
}

TEST(SpringContactMotion, ManyContactsThatStickAndLiftOffKeepTheLaws) {
  // Pads of three points each with friction that couples them, kicked so that some stick: sweeps
  // over the contacts alone would go round in circles.
  DiscModelParameters brake = test::with_elastic_pads(squealing_brake());
  brake.contact.penalty = 1e9;
  brake.contact.friction.coefficient = 0.6;
  const DiscModel model = make_disc_model(brake);
  const FastestMode mode = fastest_of(model.system);
  SpringContactMotion motion(model.bodies, model.contacts, model.law, model.state, 5e-7);
  motion.start(3e-5 * mode.q.real(), 3e-5 * (mode.s * mode.q).real());
  int seen[3] = {0, 0, 0};
  for (int n = 0; n < 6000; ++n) {
    ASSERT_TRUE(motion.step()) << n;
    const Eigen::VectorXd& q = motion.displacement();
    for (int i = 0; i < motion.num_contacts(); ++i) {
      const FaceContact& contact = model.contacts[static_cast<std::size_t>(i)];
      const FaceContactState state = motion.contact(i);
      const double bent =
          0.5 * (contact.normal_bending() * q).dot(contact.bending_forces().transpose() * q);
      const double expected =
          std::max(0.0, model.state.contacts[static_cast<std::size_t>(i)].force -
                            1e9 * (contact.gap().dot(q) + bent));
      ASSERT_NEAR(state.force, expected, 1e-6 * (1000.0 + expected)) << n;
      const Eigen::Vector2d friction(state.friction_force, state.across_force);
      const double limit = 0.6 * state.force;
      ASSERT_LE(friction.norm(), limit + 1e-6 * (1000.0 + limit)) << n;
      ++seen[static_cast<int>(state.state)];
      if (state.state != ContactState::slip) continue;
      const double sliding = model.law.speed * contact.radius;
      const Eigen::Vector2d v(
          sliding - contact.friction().dot(motion.velocity()),
          -contact.across().dot(motion.velocity()) - sliding * contact.turning().dot(q));
      ASSERT_LT((friction - limit * v.normalized()).norm(), 1e-5 * (1000.0 + limit)) << n;
    }
  }
  for (const int count : seen) EXPECT_GT(count, 0);
}

TEST(SpringContactMotion, GoesOnBitwiseFromItsState) {
  const DiscModelParameters brake = squealing_brake();
  const DiscModel model = make_disc_model(brake);
  const FastestMode mode = fastest_of(model.system);
  const auto fresh = [&] {
    SpringContactMotion motion(model.bodies, model.contacts, model.law, model.state, 4e-6);
    motion.start(1e-5 * mode.q.real(), 1e-5 * (mode.s * mode.q).real());
    return motion;
  };
  SpringContactMotion whole = fresh();
  for (int n = 0; n < 900; ++n) ASSERT_TRUE(whole.step());
  State state;
  whole.save(state, "motion/");
  SpringContactMotion second = fresh();
  second.load(state, "motion/");
  for (int n = 0; n < 300; ++n) {
    ASSERT_TRUE(whole.step());
    ASSERT_TRUE(second.step());
  }
  EXPECT_EQ(whole.displacement(), second.displacement());
  EXPECT_EQ(whole.contact(0).force, second.contact(0).force);
}

TEST(SpringContactMotion, MassOnABeltSticksAndThenSwingsAtItsSpeed) {
  // From rest, 0.03 m short of the place where friction holds the spring, a mass on a belt swings
  // faster than the belt, sticks, and leaves with v at that place: from then on its amplitude is
  // v/ω.
  constexpr double m = 1.0, k = 100.0, N0 = 10.0, mu = 0.3, v = 0.1;
  LinearSystem system;
  system.mass = m * Eigen::Matrix2d::Identity();
  system.velocity = Eigen::Matrix2d::Zero();
  system.position = Eigen::Vector2d(k, 1e4).asDiagonal();
  system.gaps = system.forces = Eigen::MatrixXd(0, 2);
  const std::vector<FaceContact> contacts{contact_of(2, 0, 1)};
  const FaceContactLaw law{mu, 1e5, v, false, false};
  SpringContactMotion motion(system, contacts, law, prescribed_sliding_state(contacts, law, N0),
                             1e-3);
  motion.start(Eigen::Vector2d(-mu * N0 / k, 0.0), Eigen::Vector2d::Zero());
  bool has_stuck = false;
  double largest = 0.0;
  for (int n = 1; n <= 4000; ++n) {
    ASSERT_TRUE(motion.step());
    if (motion.contact(0).state == ContactState::stick) {
      has_stuck = true;
      EXPECT_NEAR(motion.velocity()(0), v, 1e-9);
    }
    if (n > 2000) largest = std::max(largest, motion.displacement()(0));
  }
  EXPECT_TRUE(has_stuck);
  EXPECT_NEAR(largest, v / std::sqrt(k / m), 2e-4);
}

}  // namespace
}  // namespace stridor
