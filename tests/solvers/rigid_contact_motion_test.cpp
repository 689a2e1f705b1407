#include "solvers/rigid_contact_motion.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "solvers/spring_contact_motion.hpp"
#include "tests/support/face_contacts.hpp"
#include "tests/support/message_of.hpp"

namespace stridor {
namespace {

using Complex = std::complex<double>;
using test::contact_of;
using test::fastest_of;
using test::FastestMode;
using test::message_of;

DiscModelParameters rigid_brake() {
  DiscModelParameters brake = test::squealing_brake();
  brake.contact.formulation = ContactFormulation::lagrange;
  return brake;
}

RigidContactMotion motion_of(const DiscModel& model, double step) {
  return {model.bodies, model.contacts, model.law, model.state, step};
}

LinearSystem free_masses(const Eigen::VectorXd& masses, const Eigen::VectorXd& stiffnesses) {
  const Eigen::Index n = masses.size();
  return {masses.asDiagonal(), Eigen::MatrixXd::Zero(n, n), stiffnesses.asDiagonal(),
          Eigen::MatrixXd(0, n), Eigen::MatrixXd(0, n)};
}

TEST(RigidContactMotion, SmallMotionGrowsAsTheEigenvalueSays) {
  const DiscModel model = make_disc_model(rigid_brake());
  const FastestMode mode = fastest_of(model.system);
  ASSERT_GT(mode.s.real(), 100.0);
  constexpr double amplitude = 1e-12;
  constexpr double end = 0.02;
  const auto error = [&](double step) {
    RigidContactMotion motion = motion_of(model, step);
    motion.start(amplitude * mode.q.real(), amplitude * (mode.s * mode.q).real());
    const int num_steps = static_cast<int>(std::lround(end / step));
    for (int n = 0; n < num_steps; ++n) EXPECT_TRUE(motion.step());
    const Eigen::VectorXcd grown = amplitude * std::exp(mode.s * end) * mode.q;
    const Eigen::VectorXcd phasor =
        motion.displacement() - Complex(0.0, 1.0) *
                                    (motion.velocity() - mode.s.real() * motion.displacement()) /
                                    mode.s.imag();
    const double growth = std::log(phasor.norm() / (amplitude * mode.q.norm())) / end;
    EXPECT_NEAR(growth, mode.s.real(), 1e-3 * mode.s.real()) << step;
    return (motion.displacement() - grown.real()).norm() / grown.norm();
  };
  const double coarse = error(4e-6);
  const double fine = error(2e-6);
  EXPECT_LT(fine, 5e-3);
  EXPECT_NEAR(coarse / fine, 4.0, 0.2);
}

TEST(RigidContactMotion, DampedMotionDecaysUpToTheLongestStep) {
  DiscModelParameters brake = rigid_brake();
  brake.contact.friction.coefficient = 0.2;
  const DiscModel model = make_disc_model(brake);
  ASSERT_LT(fastest_of(model.system).s.real(), 0.0);
  double longest = 1e-6;
  for (double step = longest; step < 1e-3; step *= 1.1) {
    try {
      (void)motion_of(model, step);
      longest = step;
    } catch (const std::invalid_argument& error) {
      EXPECT_NE(std::string(error.what()).find("small motion grows with"), std::string::npos);
      break;
    }
  }
  EXPECT_GT(longest, 2e-5);
  EXPECT_LT(longest, 1e-3);
  EXPECT_THROW((void)motion_of(model, 3.0 * longest), std::invalid_argument);
  for (const double share : {0.1, 0.3, 0.6, 1.0}) {
    const double step = share * longest;
    RigidContactMotion motion = motion_of(model, step);
    Eigen::VectorXd kick = Eigen::VectorXd::Zero(model.bodies.size());
    for (Eigen::Index i = 0; i < kick.size(); ++i)
      kick(i) = 1e-9 * std::sin(1.0 + static_cast<double>(i));
    motion.start(Eigen::VectorXd::Zero(kick.size()), kick);
    const int num_steps = static_cast<int>(0.5 / step);
    double early = 0.0;
    double late = 0.0;
    for (int n = 0; n < num_steps; ++n) {
      ASSERT_TRUE(motion.step()) << share << ' ' << n;
      double& largest = 2 * n < num_steps ? early : late;
      largest = std::max(largest, motion.velocity().norm());
    }
    EXPECT_LT(late, early) << share;
  }
}

TEST(RigidContactMotion, MassThatLandsStays) {
  // Pressed with N0 it flies for v0 from the face and comes back after the time of a pendulum about
  // −N0/k; what is left of the impact is the force of the sliding state.
  constexpr double m = 2.0, k = 50.0, N0 = 8.0, v0 = 0.7;
  const double w = std::sqrt(k / m);
  const double flight = 2.0 / w * std::atan(v0 / (w * N0 / k));
  const std::vector<FaceContact> contacts{contact_of(1, -1, 0)};
  const FaceContactLaw law{0.0, std::nullopt, 1.0, false, false};
  const double step = flight / 997.3;
  RigidContactMotion motion(
      free_masses(Eigen::VectorXd::Constant(1, m), Eigen::VectorXd::Constant(1, k)), contacts, law,
      prescribed_sliding_state(contacts, law, N0), step);
  motion.start(Eigen::VectorXd::Zero(1), Eigen::VectorXd::Constant(1, v0));
  double impulse = 0.0;
  for (int n = 1; n <= 2000; ++n) {
    ASSERT_TRUE(motion.step());
    const double t = n * step;
    const double expected =
        t < flight ? -N0 / k + N0 / k * std::cos(w * t) + v0 / w * std::sin(w * t) : 0.0;
    ASSERT_NEAR(motion.displacement()(0), expected, 1e-3 * v0 / w) << n;
    ASSERT_GE(motion.contact(0).gap, -1e-15);
    impulse += step * motion.contact(0).force;
    if (n < 990) {
      ASSERT_EQ(motion.contact(0).force, 0.0);
    }
  }
  EXPECT_NEAR(motion.contact(0).force, N0, 1e-9 * N0);
  EXPECT_NEAR(motion.displacement()(0), 0.0, 1e-15);
  // It comes back with the velocity it had; the rest of the impulse holds N0 from then on.
  const double after = 2000 * step - flight;
  EXPECT_NEAR(impulse, m * v0 + N0 * after, 2.0 * N0 * step);
}

TEST(RigidContactMotion, MassesThatMeetGoOnTogether) {
  // A pad of mass 1 flies with −0.3 towards a part of the plate of mass 3 that comes with 0.1: they
  // go on with the momentum of both.
  FaceContact contact = contact_of(2, -1, 0);
  contact.plate.w(1) = 1.0;
  const std::vector<FaceContact> contacts{contact};
  const FaceContactLaw law{0.0, std::nullopt, 1.0, false, false};
  RigidContactMotion motion(free_masses(Eigen::Vector2d(1.0, 3.0), Eigen::Vector2d(0.0, 0.0)),
                            contacts, law, prescribed_sliding_state(contacts, law, 0.0), 1e-3);
  motion.start(Eigen::Vector2d(0.0401, 0.0), Eigen::Vector2d(-0.3, 0.1));
  for (int n = 0; n < 300; ++n) {
    ASSERT_TRUE(motion.step());
    ASSERT_GE(motion.contact(0).gap, -1e-15);
  }
  EXPECT_NEAR(motion.velocity()(0), (-0.3 + 3.0 * 0.1) / 4.0, 1e-12);
  EXPECT_NEAR(motion.velocity()(1), (-0.3 + 3.0 * 0.1) / 4.0, 1e-12);
}

TEST(RigidContactMotion, WithoutAClosedContactIsFreeMotion) {
  constexpr double m = 2.0, k = 50.0, gap = 0.5;
  const std::vector<FaceContact> contacts{contact_of(1, -1, 0)};
  const FaceContactLaw law{0.0, std::nullopt, 1.0, false, false};
  FaceSlidingState state = prescribed_sliding_state(contacts, law, 0.0);
  state.contacts[0].is_closed = false;
  state.contacts[0].gap = gap;
  RigidContactMotion motion(
      free_masses(Eigen::VectorXd::Constant(1, m), Eigen::VectorXd::Constant(1, k)), contacts, law,
      state, 1e-2);
  motion.start(Eigen::VectorXd::Constant(1, 0.1), Eigen::VectorXd::Zero(1));
  for (int n = 1; n <= 500; ++n) {
    ASSERT_TRUE(motion.step());
    ASSERT_NEAR(motion.displacement()(0), 0.1 * std::cos(5.0 * 1e-2 * n), 1e-12);
    ASSERT_EQ(motion.contact(0).state, ContactState::open);
    ASSERT_NEAR(motion.contact(0).gap, gap + motion.displacement()(0), 1e-12);
  }
}

TEST(RigidContactMotion, MassOnABeltSticksAndThenSwingsAtItsSpeed) {
  // As SpringContactMotion of this name, whose friction does not depend on what presses.
  constexpr double k = 100.0, N0 = 10.0, mu = 0.3, v = 0.1;
  const LinearSystem system = free_masses(Eigen::Vector2d::Ones(), Eigen::Vector2d(k, 1e4));
  const std::vector<FaceContact> contacts{contact_of(2, 0, 1)};
  const FaceContactLaw law{mu, std::nullopt, v, false, false};
  RigidContactMotion motion(system, contacts, law, prescribed_sliding_state(contacts, law, N0),
                            1e-3);
  motion.start(Eigen::Vector2d(-mu * N0 / k, 0.0), Eigen::Vector2d::Zero());
  bool has_stuck = false;
  double largest = 0.0;
  for (int n = 1; n <= 4000; ++n) {
    const double before = motion.displacement()(0);
    const bool sticks = motion.contact(0).state == ContactState::stick;
    ASSERT_TRUE(motion.step());
    if (sticks) {
      has_stuck = true;
      EXPECT_NEAR(motion.displacement()(0) - before, v * 1e-3, 1e-15);
    }
    if (n > 2000) largest = std::max(largest, motion.displacement()(0));
  }
  EXPECT_TRUE(has_stuck);
  EXPECT_NEAR(largest, v / std::sqrt(k), 2e-4);
}

TEST(RigidContactMotion, SquealEndsInABoundedCycleThatDoesNotDependOnTheStep) {
  const DiscModel model = make_disc_model(rigid_brake());
  const FastestMode mode = fastest_of(model.system);
  const auto largest = [&](double step) {
    RigidContactMotion motion = motion_of(model, step);
    motion.start(1e-7 * mode.q.real(), 1e-7 * (mode.s * mode.q).real());
    const int num_steps = static_cast<int>(std::lround(0.12 / step));
    double late = 0.0;
    int num_open = 0;
    for (int n = 0; n < num_steps; ++n) {
      EXPECT_TRUE(motion.step()) << n;
      if (2 * n < num_steps) continue;
      late = std::max(late, motion.displacement().norm());
      for (int i = 0; i < motion.num_contacts(); ++i)
        num_open += motion.contact(i).state == ContactState::open ? 1 : 0;
    }
    // Without lift-off it would have grown by exp(40).
    EXPECT_GT(num_open, num_steps / 10);
    return late;
  };
  const double coarse = largest(4e-6);
  const double fine = largest(1e-6);
  EXPECT_NEAR(coarse, fine, 0.01 * fine);
}

TEST(RigidContactMotion, ManyContactsThatStickAndLiftOffKeepTheLaws) {
  DiscModelParameters brake = test::with_elastic_pads(rigid_brake());
  brake.contact.friction.coefficient = 0.6;
  const DiscModel model = make_disc_model(brake);
  const FastestMode mode = fastest_of(model.system);
  constexpr double step = 5e-7;
  RigidContactMotion motion = motion_of(model, step);
  motion.start(3e-5 * mode.q.real(), 3e-5 * (mode.s * mode.q).real());
  const auto gap_of = [&](const FaceContact& contact, const Eigen::VectorXd& q) {
    return contact.gap().dot(q) +
           0.5 * (contact.normal_bending() * q).dot(contact.bending_forces().transpose() * q);
  };
  int seen[3] = {0, 0, 0};
  Eigen::VectorXd before = motion.displacement();
  for (int n = 0; n < 6000; ++n) {
    std::vector<FaceContactState> states;
    for (int i = 0; i < motion.num_contacts(); ++i) states.push_back(motion.contact(i));
    const Eigen::VectorXd now = motion.displacement();
    ASSERT_TRUE(motion.step()) << n;
    const Eigen::VectorXd& next = motion.displacement();
    for (std::size_t i = 0; i < states.size(); ++i) {
      const FaceContact& contact = model.contacts[i];
      const FaceContactState& state = states[i];
      const double size = next.norm();
      ++seen[static_cast<int>(state.state)];
      ASSERT_NEAR(state.gap, gap_of(contact, now), 1e-12 * size);
      // The force is there to close the gap until the next step, and only for that.
      const double gap = gap_of(contact, next);
      ASSERT_GE(gap, -1e-12 * size);
      if (state.force > 0.0) {
        ASSERT_NEAR(gap, 0.0, 1e-12 * size) << n;
      }
      const double limit = 0.6 * state.force;
      const Eigen::Vector2d friction(state.friction_force, state.across_force);
      ASSERT_LE(friction.norm(), limit + 1e-6 * (1000.0 + limit));
      const double sliding = model.law.speed * contact.radius;
      const auto velocity = [&](const Eigen::VectorXd& from, const Eigen::VectorXd& to) {
        const Eigen::VectorXd change = (to - from) / step;
        return Eigen::Vector2d(
            sliding - contact.friction().dot(change),
            -contact.across().dot(change) - 0.5 * sliding * contact.turning().dot(from + to));
      };
      const Eigen::Vector2d v = 0.5 * (velocity(before, now) + velocity(now, next));
      const Eigen::Vector2d jump = velocity(now, next) - velocity(before, now);
      if (state.state != ContactState::slip) continue;
      ASSERT_NEAR(friction.norm(), limit, 1e-6 * (1000.0 + limit)) << n;
      // Turning slowly it is against the velocity between that of this step and of the last.
      if (n > 0 && jump.norm() < 0.01 * v.norm()) {
        ASSERT_GT(friction.dot(v), 0.9 * limit * v.norm() - 1e-3) << n;
      }
    }
    before = now;
  }
  for (const int count : seen) EXPECT_GT(count, 0);
}

TEST(RigidContactMotion, IsTheLimitOfStiffSprings) {
  // While contacts stay closed; friction turns far from its direction, and forces bend.
  DiscModelParameters brake = rigid_brake();
  brake.disc.speed = 3.0;
  const FastestMode mode = fastest_of(make_disc_model(brake).system);
  constexpr double step = 5e-7;
  constexpr int num_steps = 4000;
  const Eigen::VectorXd q = 3e-6 * mode.q.real();
  const Eigen::VectorXd v = 3e-6 * (mode.s * mode.q).real();
  const DiscModel rigid = make_disc_model(brake);
  const auto end_of = [&](FaceContactMotion& motion) {
    motion.start(q, v);
    for (int n = 0; n < num_steps; ++n) EXPECT_TRUE(motion.step());
    return motion.displacement();
  };
  RigidContactMotion motion = motion_of(rigid, step);
  const Eigen::VectorXd limit = end_of(motion);
  brake.contact.formulation = ContactFormulation::penalty;
  const auto difference = [&](double penalty) {
    brake.contact.penalty = penalty;
    const DiscModel model = make_disc_model(brake);
    SpringContactMotion springs(model.bodies, model.contacts, model.law, model.state, step);
    return (end_of(springs) - limit).norm() / limit.norm();
  };
  const double soft = difference(1e11);
  const double stiff = difference(1e12);
  EXPECT_LT(stiff, 0.01);
  EXPECT_NEAR(soft / stiff, 10.0, 2.0);
}

TEST(RigidContactMotion, IsOfSecondOrderWhileContactsSlide) {
  DiscModelParameters brake = rigid_brake();
  brake.disc.speed = 3.0;
  const DiscModel model = make_disc_model(brake);
  const FastestMode mode = fastest_of(model.system);
  constexpr double end = 2e-3;
  double speeds[2] = {1e9, 0.0};
  const auto end_of = [&](int num_steps) {
    RigidContactMotion motion = motion_of(model, end / num_steps);
    motion.start(3e-6 * mode.q.real(), 3e-6 * (mode.s * mode.q).real());
    for (int n = 0; n < num_steps; ++n) {
      EXPECT_TRUE(motion.step());
      const FaceContactState contact = motion.contact(0);
      EXPECT_EQ(contact.state, ContactState::slip);
      speeds[0] = std::min(speeds[0], contact.slip_velocity);
      speeds[1] = std::max(speeds[1], contact.slip_velocity);
    }
    return motion.displacement();
  };
  const Eigen::VectorXd exact = end_of(16000);
  const double coarse = (end_of(1000) - exact).norm();
  const double fine = (end_of(2000) - exact).norm();
  EXPECT_GT(speeds[1], 1.2 * speeds[0]);  // else friction hardly turns
  EXPECT_NEAR(coarse / fine, 4.0, 0.3);
}

TEST(RigidContactMotion, GoesOnBitwiseFromItsState) {
  const DiscModel model = make_disc_model(rigid_brake());
  const FastestMode mode = fastest_of(model.system);
  const auto fresh = [&] {
    RigidContactMotion motion = motion_of(model, 4e-6);
    motion.start(1e-5 * mode.q.real(), 1e-5 * (mode.s * mode.q).real());
    return motion;
  };
  RigidContactMotion whole = fresh();
  int num_open = 0;
  for (int n = 0; n < 3000; ++n) {
    ASSERT_TRUE(whole.step());
    num_open += whole.contact(0).state == ContactState::open ? 1 : 0;
  }
  EXPECT_GT(num_open, 0);
  State state;
  whole.save(state, "motion/");
  RigidContactMotion second = fresh();
  second.load(state, "motion/");
  EXPECT_EQ(whole.contact(0).slip_velocity, second.contact(0).slip_velocity);
  for (int n = 0; n < 300; ++n) {
    ASSERT_TRUE(whole.step());
    ASSERT_TRUE(second.step());
  }
  EXPECT_EQ(whole.displacement(), second.displacement());
  EXPECT_EQ(whole.velocity(), second.velocity());
  EXPECT_EQ(whole.contact(0).force, second.contact(0).force);
}

TEST(RigidContactMotion, RefusesWhatItCannotMarch) {
  const std::vector<FaceContact> contacts{contact_of(1, -1, 0)};
  const LinearSystem mass =
      free_masses(Eigen::VectorXd::Constant(1, 2.0), Eigen::VectorXd::Constant(1, 50.0));
  const auto message = [&](const FaceContactLaw& law, double step) {
    return message_of<std::invalid_argument>([&] {
      RigidContactMotion(mass, contacts, law, prescribed_sliding_state(contacts, law, 8.0), step);
    });
  };
  EXPECT_EQ(message({0.0, 800.0, 1.0, false, false}, 1e-3),
            "motion of rigid face contacts: takes no penalty, and a plate that turns");
  EXPECT_EQ(message({0.0, std::nullopt, 0.0, false, false}, 1e-3),
            "motion of rigid face contacts: takes no penalty, and a plate that turns");
  const double longest = std::numbers::pi / 5.0;
  EXPECT_EQ(
      message({0.0, std::nullopt, 1.0, false, false}, 1.01 * longest),
      "motion of rigid face contacts: a step of 0.634602 s is too long for bodies as stiff as "
      "these");
  const FaceContactLaw law{0.0, std::nullopt, 1.0, false, false};
  EXPECT_NO_THROW(RigidContactMotion(mass, contacts, law,
                                     prescribed_sliding_state(contacts, law, 8.0), 0.99 * longest));
}

}  // namespace
}  // namespace stridor
