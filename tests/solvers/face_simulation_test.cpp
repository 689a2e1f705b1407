// Runs of systems with contacts on faces of spinning bodies: against eigenvalues and closed forms.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <optional>
#include <vector>

#include "core/errors.hpp"
#include "coupling/laws/static_dynamic_friction.hpp"
#include "coupling/laws/stribeck_friction.hpp"
#include "solvers/eigenvalues/dense_eigenvalues.hpp"
#include "solvers/equilibrium/linearise.hpp"
#include "solvers/transient/simulation.hpp"
#include "tests/support/face_contacts.hpp"
#include "tests/support/face_system.hpp"
#include "tests/support/message_of.hpp"

namespace stridor {
namespace {

using Complex = std::complex<double>;

TimeParameters face_time(double step, Integrator integrator = Integrator::exact) {
  TimeParameters time;
  time.step = step;
  time.end = 1.0;
  time.integrator = integrator;
  return time;
}

/// Displacements and velocities of all modes.
struct WholeMotion {
  Eigen::VectorXd displacement, velocity;
};

WholeMotion whole_motion(const Simulation& simulation, int num_bodies) {
  WholeMotion whole;
  for (int b = 0; b < num_bodies; ++b) {
    const Propagator::Motion motion = simulation.motion(b);
    const Eigen::Index n = whole.displacement.size();
    whole.displacement.conservativeResize(n + motion.displacement.size());
    whole.velocity.conservativeResize(n + motion.displacement.size());
    whole.displacement.tail(motion.displacement.size()) = motion.displacement;
    whole.velocity.tail(motion.displacement.size()) = motion.velocity;
  }
  return whole;
}

struct FastMotion {
  Complex s;
  Eigen::VectorXcd q;  ///< of length 1
};

FastMotion fastest_growing(const System& system, const Equilibrium& equilibrium) {
  const DenseSpectrum spectrum = dense_spectrum(linearise(system, equilibrium));
  const auto fastest =
      std::max_element(spectrum.eigenvalues.begin(), spectrum.eigenvalues.end(),
                       [](const auto& a, const auto& b) { return a.growth() < b.growth(); });
  const Eigen::VectorXcd q = spectrum.right.col(fastest - spectrum.eigenvalues.begin());
  // A factor is free, and so is its sign: the largest velocity is real and positive at the start.
  Eigen::Index largest = 0;
  q.cwiseAbs().maxCoeff(&largest);
  const std::complex<double> velocity = fastest->s * q(largest);
  return {fastest->s, q / q.norm() * (std::abs(velocity) / velocity)};
}

/// The system in its equilibrium with a little of a motion.
System perturbed(System system, const Equilibrium& equilibrium, const FastMotion& motion,
                 double amplitude) {
  apply_initial_motion(system, equilibrium);
  Eigen::Index first = 0;
  for (SystemBody& body : system.bodies) {
    const Eigen::VectorXcd part = amplitude * motion.q.segment(first, body.modal.size());
    body.initial_displacement += body.modal.shapes * part.real();
    body.initial_velocity += body.modal.shapes * (motion.s * part).real();
    first += body.modal.size();
  }
  return system;
}

/// Growth over a stretch of time, and the error of the motion at its end.
struct GrowthFound {
  double growth, error;
};

GrowthFound grow(const System& system, const Equilibrium& equilibrium, const FastMotion& mode,
                 double step, double end) {
  constexpr double amplitude = 1e-12;
  Simulation simulation(perturbed(system, equilibrium, mode, amplitude), face_time(step));
  const auto num_steps = static_cast<std::int64_t>(std::lround(end / step));
  EXPECT_EQ(simulation.step_until(num_steps), StepOutcome::done) << simulation.failure();
  WholeMotion motion = whole_motion(simulation, 3);
  Eigen::VectorXd rest(motion.displacement.size());
  Eigen::Index first = 0;
  for (const Eigen::VectorXd& part : equilibrium.displacement) {
    rest.segment(first, part.size()) = part;
    first += part.size();
  }
  motion.displacement -= rest;
  const Eigen::VectorXcd grown = amplitude * std::exp(mode.s * end) * mode.q;
  const Eigen::VectorXcd phasor =
      motion.displacement - Complex(0.0, 1.0) *
                                (motion.velocity - mode.s.real() * motion.displacement) /
                                mode.s.imag();
  return {std::log(phasor.norm() / amplitude) / end,
          (motion.displacement - grown.real()).norm() / grown.norm()};
}

TEST(FaceSimulation, SmallMotionGrowsAsTheEigenvalueSays) {
  for (const bool is_rigid : {false, true}) {
    for (const auto assumption : {ContactAssumption::film, ContactAssumption::subs_b}) {
      DiscModelParameters brake = test::squealing_brake();
      if (is_rigid) brake.contact.formulation = ContactFormulation::lagrange;
      const System system = test::disc_system(brake, assumption);
      const Equilibrium equilibrium = test::face_equilibrium(system);
      const FastMotion mode = fastest_growing(system, equilibrium);
      ASSERT_GT(mode.s.real(), 100.0);
      constexpr double end = 0.02;
      const GrowthFound coarse = grow(system, equilibrium, mode, 4e-6, end);
      const GrowthFound fine = grow(system, equilibrium, mode, 2e-6, end);
      EXPECT_NEAR(coarse.growth, mode.s.real(), 2e-3 * mode.s.real());
      EXPECT_NEAR(fine.growth, mode.s.real(), 1e-3 * mode.s.real());
      EXPECT_LT(fine.error, 5e-3);
      EXPECT_NEAR(coarse.error / fine.error, 4.0, 0.3) << coarse.error;
    }
  }
}

TEST(FaceSimulation, StaysInEquilibriumWithElasticPads) {
  DiscModelParameters brake = test::with_elastic_pads(test::squealing_brake());
  brake.contact.friction.coefficient = 0.1;
  brake.contact.preload.reset();
  brake.pads.piston.emplace().force = 3000.0;
  for (const bool is_rigid : {false, true}) {
    if (is_rigid) brake.contact.formulation = ContactFormulation::lagrange;
    System system = test::disc_system(brake);
    const Equilibrium equilibrium = test::face_equilibrium(system);
    ASSERT_EQ(equilibrium.status, EquilibriumStatus::converged);
    apply_initial_motion(system, equilibrium);
    Simulation simulation(system, face_time(1e-6));
    ASSERT_EQ(simulation.step_until(2000), StepOutcome::done) << simulation.failure();
    for (int i = 0; i < simulation.num_contacts(); ++i) {
      const ContactEquilibrium& expected = equilibrium.contacts[static_cast<std::size_t>(i)];
      // Directions of the first force are those without contact forces, h² λ/m away.
      EXPECT_NEAR(simulation.contact_force(i), expected.force, 1e-5 * expected.force);
      EXPECT_NEAR(simulation.friction_force(i), expected.friction_force, 1e-5 * expected.force);
      EXPECT_NEAR(simulation.friction_across(i), expected.friction_across, 1e-5 * expected.force);
      EXPECT_EQ(simulation.contact_state(i), ContactState::slip);
    }
  }
}

/// A mass on a belt, the face of a body that does not move: pressed on with N, held along the belt,
/// free across it or on a spring.
struct MassOnFace {
  double mass = 2.0;
  double load = 10.0;
  double belt = 0.5;        ///< Ω r, m/s
  double across = 0.3;      ///< initial velocity along the radius, m/s
  double along = 0.0;       ///< along the belt
  bool is_held_along = true;
  double stiffness = 0.0;   ///< of springs along and across
  FrictionLaw friction = constant_friction(0.4);

  System system() const {
    System made;
    ReducedBody block;
    block.mass = mass * Eigen::Matrix3d::Identity();
    block.stiffness = Eigen::Vector3d(stiffness, 0.0, stiffness).asDiagonal();
    block.rows = Eigen::Matrix3d::Identity();
    if (is_held_along) block.rows(0, 0) = 0.0;
    ReducedBody ground;
    ground.mass = ground.stiffness = Eigen::MatrixXd::Identity(1, 1);
    ground.rows = Eigen::MatrixXd::Zero(num_face_rows, 1);
    made.bodies = {test::face_body("ground", ground), test::face_body("block", block)};
    made.bodies[1].held_load = Eigen::Vector3d(0.0, -load, 0.0);
    made.bodies[1].initial_displacement = Eigen::Vector3d::Zero();
    made.bodies[1].initial_velocity = Eigen::Vector3d(along, 0.0, across);
    ContactPoint contact;
    contact.name = "block on belt";
    contact.slave_body = 1;
    contact.slave_rows = {0, 1, 2};
    contact.slave_position.setZero();
    contact.assumption = ContactAssumption::film;
    contact.friction = friction;
    FacePlace& face = contact.face.emplace();
    face.rows = {0, 1, 2, 3, 4};
    face.radius = 1.0;
    face.spin = belt;
    made.contacts.push_back(contact);
    return made;
  }
};

TEST(FaceSimulation, SlidingAcrossABeltIsBrakedByItsShareOfFriction) {
  // m u' = −μ N u/√(V² + u²): t = m/(μ N) [F(u0) − F(u)], F = √(V² + u²) − V arsinh(V/u), and
  // z = m/(μ N) [G(u0) − G(u)], G = ½ (u √(V² + u²) + V² arsinh(u/V)).
  const MassOnFace scene;
  const auto G = [&](double u) {
    return 0.5 * (u * std::hypot(scene.belt, u) +
                  scene.belt * scene.belt * std::asinh(u / scene.belt));
  };
  const auto F = [&](double u) {
    return std::hypot(scene.belt, u) - scene.belt * std::asinh(scene.belt / u);
  };
  const auto time_to = [&](double u) {
    return scene.mass / (0.4 * scene.load) * (F(scene.across) - F(u));
  };
  const auto error = [&](double step, Integrator integrator) {
    Simulation simulation(scene.system(), face_time(step, integrator));
    constexpr double end = 0.4;
    EXPECT_EQ(simulation.step_until(std::lround(end / step)), StepOutcome::done);
    double low = 1e-3 * scene.across, high = scene.across;
    for (int i = 0; i < 80; ++i) {
      const double middle = 0.5 * (low + high);
      (time_to(middle) > end ? low : high) = middle;
    }
    EXPECT_NEAR(simulation.contact_force(0), scene.load, 1e-9 * scene.load);
    EXPECT_NEAR(std::hypot(simulation.friction_force(0), simulation.friction_across(0)),
                0.4 * scene.load, 1e-9);
    const double moved = scene.mass / (0.4 * scene.load) * (G(scene.across) - G(low));
    return std::abs(simulation.displacement(1, 2) - moved);
  };
  for (const auto integrator : {Integrator::exact, Integrator::central_difference}) {
    const double coarse = error(2e-3, integrator);
    const double fine = error(1e-3, integrator);
    // The central difference starts with a force that acts for a whole step.
    const double order = std::log2(coarse / fine);
    if (integrator == Integrator::exact) {
      EXPECT_LT(fine, 2e-6);
      EXPECT_GT(order, 1.8);
    } else {
      EXPECT_LT(fine, 2e-4);
      EXPECT_GT(order, 0.9);
    }
  }
}

TEST(FaceSimulation, SlowMotionAcrossAFastBeltIsDampedAsByADashpot) {
  // Where the belt is much faster, friction across is −(μ N/V) u: exp(−μ N t/(m V)).
  MassOnFace scene;
  scene.belt = 2.0;
  scene.across = 1e-4;
  constexpr double step = 1e-3, end = 0.5;
  Simulation simulation(scene.system(), face_time(step));
  ASSERT_EQ(simulation.step_until(std::lround(end / step)), StepOutcome::done);
  const double rate = 0.4 * scene.load / (scene.mass * scene.belt);
  const double expected = scene.across / rate * (1.0 - std::exp(-rate * end));
  // (u/V)² of friction is along the belt, and an error of order (rate h)².
  EXPECT_NEAR(simulation.displacement(1, 2), expected, 2e-6 * expected);
}

TEST(FaceSimulation, FrictionStopsAMassOnAStraightPathAndHoldsIt) {
  // On a face at rest: deceleration μ N/m against the velocity, wherever it points.
  MassOnFace scene;
  scene.belt = 0.0;
  scene.is_held_along = false;
  scene.along = 0.4;
  scene.across = 0.3;
  constexpr double speed = 0.5;
  const double rate = 0.4 * scene.load / scene.mass;
  for (const auto integrator : {Integrator::exact, Integrator::central_difference}) {
    constexpr double step = 1e-4;
    Simulation simulation(scene.system(), face_time(step, integrator));
    const auto num_steps = std::lround(1.3 * speed / rate / step);
    ASSERT_EQ(simulation.step_until(num_steps), StepOutcome::done) << simulation.failure();
    const double way = 0.5 * speed * speed / rate;
    // The central difference starts with a force that acts for a whole step.
    const double allowed = integrator == Integrator::exact ? 1e-6 : 0.6 * step * speed / way;
    EXPECT_NEAR(simulation.displacement(1, 0), 0.8 * way, allowed * way);
    EXPECT_NEAR(simulation.displacement(1, 2), 0.6 * way, allowed * way);
    EXPECT_EQ(simulation.contact_state(0), ContactState::stick);
    const double rest = simulation.displacement(1, 0);
    ASSERT_EQ(simulation.step_until(2 * num_steps), StepOutcome::done);
    EXPECT_NEAR(simulation.displacement(1, 0), rest, 1e-12);
  }
}

TEST(FaceSimulation, ABeltCarriesAMassUntilItsSpringBreaksItLoose) {
  // It sticks to the belt until k V t = μ_s N, along a straight line, and slips then with μ_d.
  MassOnFace scene;
  scene.is_held_along = false;
  scene.belt = 0.1;
  scene.along = 0.1;  // with the belt
  scene.across = 0.0;
  scene.stiffness = 200.0;
  scene.friction = static_dynamic_friction(0.5, 0.3);
  const double loose = 0.5 * scene.load / (scene.stiffness * scene.belt);
  for (const auto integrator : {Integrator::exact, Integrator::central_difference}) {
    constexpr double step = 1e-4;
    Simulation simulation(scene.system(), face_time(step, integrator));
    double last_stick = 0.0;
    while (simulation.time() < 1.2 * loose) {
      ASSERT_EQ(simulation.step(), StepOutcome::done) << simulation.failure();
      if (simulation.contact_state(0) == ContactState::stick && simulation.time() < 1.1 * loose) {
        last_stick = simulation.time();
        EXPECT_NEAR(simulation.displacement(1, 0), scene.belt * simulation.time(),
                    2.0 * scene.belt * step);
      }
    }
    EXPECT_NEAR(last_stick, loose, 5.0 * step);
    EXPECT_EQ(simulation.contact_state(0), ContactState::slip);
    EXPECT_NEAR(std::hypot(simulation.friction_force(0), simulation.friction_across(0)),
                0.3 * scene.load, 1e-9);
  }
}

TEST(FaceSimulation, EveryFrictionLawBrakesByItsCoefficient) {
  MassOnFace scene;
  scene.belt = 0.5;
  scene.across = 0.0;
  FrictionLaw stribeck = stribeck_friction(0.6, 0.2, 0.4);
  FrictionLaw regularised = constant_friction(0.4);
  regularised.sign = {RegularisedSign::Kind::tanh, 0.8};
  for (const FrictionLaw& law : {stribeck, regularised}) {
    scene.friction = law;
    Simulation simulation(scene.system(), face_time(1e-3));
    ASSERT_EQ(simulation.step_until(50), StepOutcome::done);
    EXPECT_NEAR(simulation.friction_force(0), sliding_friction(law, 0.5) * scene.load,
                1e-9 * scene.load);
    EXPECT_EQ(simulation.contact_state(0), ContactState::slip);
  }
}

/// The brake with three springs on each of two elastic pads, whose ends lift off and stick.
System brake_on_springs() {
  DiscModelParameters brake = test::with_elastic_pads(test::squealing_brake());
  brake.contact.friction.coefficient = 0.4;
  brake.contact.penalty = 5e8;
  brake.contact.preload.reset();
  brake.pads.piston.emplace().force = 3000.0;
  return test::disc_system(brake);
}

/// Displacements of all modes at instants, and how much of the time contacts were open or stuck.
struct MotionOfSprings {
  std::vector<Eigen::VectorXd> motion;
  double open = 0.0;
  double sticking = 0.0;

  MotionOfSprings(const System& system, double step) {
    constexpr double end = 4e-4, interval = 2e-5;
    Simulation simulation(system, face_time(step));
    const auto num_steps = static_cast<std::int64_t>(std::lround(interval / step));
    for (std::int64_t n = 1; n <= std::llround(end / interval); ++n) {
      EXPECT_EQ(simulation.step_until(n * num_steps), StepOutcome::done) << simulation.failure();
      motion.push_back(whole_motion(simulation, 3).displacement);
    }
    ContactStatistics all;
    for (int i = 0; i < simulation.num_contacts(); ++i) all.add(simulation.statistics(i));
    open = static_cast<double>(all.open) / static_cast<double>(all.steps);
    sticking = static_cast<double>(all.sticking) / static_cast<double>(all.steps);
  }

  double error(const MotionOfSprings& reference) const {
    double sum = 0.0, size = 0.0;
    for (std::size_t k = 0; k < motion.size(); ++k) {
      sum += (motion[k] - reference.motion[k]).squaredNorm();
      size += (reference.motion[k] - reference.motion.front()).squaredNorm();
    }
    return std::sqrt(sum / size);
  }
};

TEST(FaceSimulation, OrderIsTwoWhereSpringsLiftOffAndStick) {
  const System system = brake_on_springs();
  const Equilibrium equilibrium = test::face_equilibrium(system);
  ASSERT_EQ(equilibrium.status, EquilibriumStatus::converged);
  const FastMotion mode = fastest_growing(system, equilibrium);
  // A motion that lifts off now and then, 5.5e-5 at 0.5 µs, and one that is open most of the time and
  // sticks, 1.2e-3. With the δ of rigid contacts it is 7.5e-4 and 5.5e-3.
  struct Case {
    double amplitude, open, sticking, error, least_order, largest_order;
  };
  for (const Case& one : {Case{2e-6, 0.02, 0.0, 1e-4, 1.6, 2.4}, Case{5e-5, 0.5, 0.03, 2e-3, 1.3, 2.4}}) {
    const System moving = perturbed(system, equilibrium, mode, one.amplitude);
    const MotionOfSprings reference(moving, 3.125e-8);
    EXPECT_GT(reference.open, one.open);
    EXPECT_GE(reference.sticking, one.sticking);
    const double coarse = MotionOfSprings(moving, 5e-7).error(reference);
    const double fine = MotionOfSprings(moving, 1.25e-7).error(reference);
    EXPECT_LT(coarse, one.error);
    EXPECT_GT(0.5 * std::log2(coarse / fine), one.least_order) << coarse << " " << fine;
    EXPECT_LT(0.5 * std::log2(coarse / fine), one.largest_order) << coarse << " " << fine;
  }
}

/// A limit cycle over stretches of 60 ms.
struct LimitCycle {
  double open = 0.0;   ///< part of the time without contact
  double moved = 0.0;  ///< largest |y| of a pad, mean of the stretches, m
};

/// The squealing brake after 60 ms.
LimitCycle squeal(bool is_rigid, double step, int num_stretches) {
  DiscModelParameters brake = test::squealing_brake();
  if (is_rigid) brake.contact.formulation = ContactFormulation::lagrange;
  const System system = test::disc_system(brake);
  const Equilibrium equilibrium = test::face_equilibrium(system);
  const FastMotion mode = fastest_growing(system, equilibrium);
  Simulation simulation(perturbed(system, equilibrium, mode, 1e-6), face_time(step));
  const auto num_steps = std::lround(0.06 / step);
  EXPECT_EQ(simulation.step_until(num_steps), StepOutcome::done) << simulation.failure();
  LimitCycle found;
  for (int stretch = 0; stretch < num_stretches; ++stretch) {
    long num_open = 0;
    double largest = 0.0;
    for (long n = 0; n < num_steps; ++n) {
      if (simulation.step() != StepOutcome::done) ADD_FAILURE() << simulation.failure();
      if (simulation.contact_force(0) == 0.0) ++num_open;
      largest = std::max(largest, std::abs(simulation.displacement(1, 1)));
    }
    found.open += static_cast<double>(num_open) / static_cast<double>(num_steps * num_stretches);
    found.moved += largest / num_stretches;
  }
  return found;
}

TEST(FaceSimulation, SquealEndsInABoundedCycle) {
  // A program for discs alone, since removed, had 0.1334 mm at 2 and 0.25 µs.
  for (const double step : {2e-6, 1e-6}) {
    const LimitCycle rigid = squeal(true, step, 1);
    EXPECT_NEAR(rigid.moved, 1.334e-4, 0.01e-4);
    EXPECT_NEAR(rigid.open, 0.45, 0.1);
  }
  // And between 0.33 and 0.42 mm from cycle to cycle, lifted off 81 % of the time: contacts that
  // bounce, and a motion that depends on every impact before. The largest of a stretch scatters by
  // 0.045 mm with the least difference at the start, so that the mean of eight is asked.
  const LimitCycle bouncing = squeal(false, 2e-6, 8);
  EXPECT_NEAR(bouncing.moved, 3.9e-4, 0.6e-4);
  EXPECT_NEAR(bouncing.open, 0.85, 0.07);
}

TEST(FaceSimulation, ContactsOfBothKindsRunInOneSystem) {
  // A block between a belt, whose face presses it by the overlap of its spring, and a rigid rail above it.
  MassOnFace scene;
  scene.is_held_along = false;
  scene.stiffness = 500.0;
  System system = scene.system();
  system.contacts[0].penalty = 2e5;
  ReducedBody rail;
  rail.mass = rail.stiffness = Eigen::MatrixXd::Identity(1, 1);
  rail.rows = Eigen::MatrixXd::Zero(4, 1);
  system.bodies.push_back(test::face_body("rail", rail));
  MasterSurface surface;
  surface.name = "rail.bottom";
  surface.body = 2;
  surface.rows = {{0, 1}, {2, 3}};
  // The body lies on the right-hand side: above it, seen from its other end.
  surface.positions = {{10.0, 0.0}, {-10.0, 0.0}};
  surface.arc_length = {0.0, 20.0};
  system.surfaces.push_back(surface);
  ContactPoint above;
  above.name = "block under rail";
  above.slave_body = 1;
  above.slave_rows = {0, 1, 2};
  above.slave_position.setZero();
  above.assumption = ContactAssumption::film;
  above.friction = constant_friction(0.2);
  system.contacts.push_back(above);
  system.bodies[1].held_load(1) = -scene.load;
  system.contacts[0].overlap = 30.0 / 2e5;  // 30 N from below: 20 N against the rail
  Simulation simulation(system, face_time(1e-4));
  ASSERT_EQ(simulation.step_until(2000), StepOutcome::done) << simulation.failure();
  EXPECT_NEAR(simulation.contact_force(0), 30.0, 1e-6);
  EXPECT_NEAR(simulation.contact_force(1), 20.0, 1e-6);
  EXPECT_NEAR(std::hypot(simulation.friction_force(0), simulation.friction_across(0)), 0.4 * 30.0,
              1e-6);
  const Equilibrium equilibrium = find_equilibrium(system, sliding_state(system, 0.0));
  ASSERT_EQ(equilibrium.status, EquilibriumStatus::converged) << equilibrium.failure;
  EXPECT_NEAR(equilibrium.contacts[0].force, 30.0, 1e-9);
  EXPECT_NEAR(equilibrium.contacts[1].force, 20.0, 1e-9);
}

TEST(FaceSimulation, EnergyBalancesToRoundingWhileItSquealsAndLiftsOff) {
  DiscModelParameters brake = test::squealing_brake();
  brake.terms = {"friction", "friction_damping", "geometric", "structural_damping"};
  for (const bool is_rigid : {false, true}) {
    if (is_rigid) brake.contact.formulation = ContactFormulation::lagrange;
    System system = test::disc_system(brake);
    const Equilibrium equilibrium = test::face_equilibrium(system);
    FastMotion mode = fastest_growing(system, equilibrium);
    ASSERT_GT(mode.s.real(), 10.0);
    Simulation simulation(perturbed(system, equilibrium, mode, 5e-5),
                          face_time(5e-7, Integrator::central_difference), Accounts::energy);
    ASSERT_EQ(simulation.step_until(20000), StepOutcome::done) << simulation.failure();
    const EnergyLedger& ledger = *simulation.energy();
    EXPECT_LT(ledger.relative_error(), 1e-11);
    const EnergyBalance& balance = ledger.balance();
    EXPECT_GT(balance.friction_loss, 0.0);
    EXPECT_GT(balance.drive_work, 0.0);
    // Friction is against the velocity at its instant, the mean one of the step may point elsewhere where
    // sliding turns round.
    EXPECT_LE(ledger.friction_gain().steps, 5);
    EXPECT_LT(ledger.friction_gain().largest_power, 1e-4 * balance.friction_loss / 0.01);
    if (!is_rigid) {
      EXPECT_GT(simulation.statistics(0).open, 0);
    }
    // A penalty gives back no more than it has stored.
    EXPECT_FALSE(ledger.contacts_feed());
  }
}

TEST(FaceSimulation, ResumesBitIdentically) {
  const DiscModelParameters brake = test::squealing_brake();
  const System system = test::disc_system(brake);
  const Equilibrium equilibrium = test::face_equilibrium(system);
  const FastMotion mode = fastest_growing(system, equilibrium);
  const System moving = perturbed(system, equilibrium, mode, 5e-5);
  Simulation whole(moving, face_time(2e-6));
  ASSERT_EQ(whole.step_until(1500), StepOutcome::done);
  const State state = whole.save();
  ASSERT_EQ(whole.step_until(4000), StepOutcome::done);
  Simulation resumed(moving, face_time(2e-6));
  resumed.load(state);
  ASSERT_EQ(resumed.step_until(4000), StepOutcome::done);
  for (int b = 0; b < 3; ++b)
    EXPECT_EQ(resumed.motion(b).displacement, whole.motion(b).displacement);
  for (int i = 0; i < 2; ++i) {
    EXPECT_EQ(resumed.contact_force(i), whole.contact_force(i));
    EXPECT_EQ(resumed.friction_across(i), whole.friction_across(i));
    EXPECT_EQ(resumed.statistics(i).numbers(), whole.statistics(i).numbers());
  }
}

TEST(FaceSimulation, RefusesASlaveThatTheDriveMoves) {
  System system = MassOnFace().system();
  system.bodies[1].drive = 0;
  EXPECT_NE(test::message_of<ConfigError>([&] {
              (void)Simulation(system, face_time(1e-3));
            }).find("the drive cannot move it"),
            std::string::npos);
}

TEST(FaceSimulation, PersistentSlidingEndsWhereAContactPulls) {
  MassOnFace scene;
  System system = scene.system();
  system.contacts[0].assumption = ContactAssumption::subs_b;
  system.bodies[1].held_load(1) = 3.0;  // away from the face
  const std::string message =
      test::message_of<NumericalError>([&] { (void)Simulation(system, face_time(1e-3)); });
  EXPECT_NE(message.find("radius 1 m, angle 0 rad: the contact force is -3 N"), std::string::npos)
      << message;
}

}  // namespace
}  // namespace stridor
