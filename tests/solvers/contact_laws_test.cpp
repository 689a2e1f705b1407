// Penalty springs and regularised friction in the place of multipliers and set-valued friction.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <random>
#include <vector>

#include "coupling/laws/stribeck_friction.hpp"
#include "solvers/contact/contact_solver.hpp"
#include "solvers/eigenvalues/dense_eigenvalues.hpp"
#include "solvers/eigenvalues/secular_eigenvalues.hpp"
#include "solvers/equilibrium/equilibrium.hpp"
#include "solvers/equilibrium/linearise.hpp"
#include "solvers/transient/frozen_step.hpp"
#include "solvers/transient/simulation.hpp"
#include "tests/support/paper_model.hpp"
#include "tests/support/small_systems.hpp"

namespace stridor {
namespace {

using namespace test;

constexpr double stiffness = 4e4;  // N/m: 200 rad/s with 1 kg
constexpr double omega = 200.0;

System mass_on_spring(double height, ContactAssumption assumption = ContactAssumption::film) {
  MassOnGround scene;
  scene.assumption = assumption;
  System system = scene.system();
  system.contacts[0].penalty = stiffness;
  system.bodies[0].initial_displacement.y() = height;
  return system;
}

TimeParameters exact_time(double step) {
  TimeParameters time = time_of(step);
  time.integrator = Integrator::exact;
  return time;
}

double height_of(const Simulation& simulation) {
  return simulation.displacement(0, MassOnGround::y_row);
}

TEST(Penalty, CarriesTheLoadAtItsCompression) {
  for (const TimeParameters& time : {time_of(1e-4), exact_time(1e-4)}) {
    Simulation simulation(mass_on_spring(-10.0 / stiffness), time);
    for (int n = 0; n < 1000; ++n) {
      ASSERT_NEAR(simulation.contact_force(0), 10.0, 1e-9) << n;
      ASSERT_NEAR(simulation.contact_place(0).gap, -10.0 / stiffness, 1e-13) << n;
      ASSERT_EQ(simulation.step(), StepOutcome::done) << simulation.failure();
    }
  }
}

TEST(Penalty, SwingsAsASpringDoesWithSecondOrderWhereTheForceIsInstantaneous) {
  // From y = 0 under a load of 10 N: y = −(F/k) (1 − cos ωt), the force up to 2 F and down to 0.
  double last = 0.0;
  for (const double step : {4e-4, 2e-4, 1e-4}) {
    Simulation simulation(mass_on_spring(0.0, ContactAssumption::subs_b), exact_time(step));
    double error = 0.0;
    while (simulation.time() < 0.1) {
      const double expected = -10.0 / stiffness * (1.0 - std::cos(omega * simulation.time()));
      error = std::max(error, std::abs(height_of(simulation) - expected));
      ASSERT_EQ(simulation.step(), StepOutcome::done) << simulation.failure();
    }
    if (last > 0.0) {
      EXPECT_NEAR(last / error, 4.0, 0.6) << step;
    }
    last = error;
  }
  EXPECT_LT(last, 1e-2 * 10.0 / stiffness);
}

TEST(Penalty, LetsTheBodyFlyOffAndCatchesIt) {
  // Pressed in by 5 F/k it leaves the ground at y = 0 with the velocity of the energy left,
  // v² = ω² (a² − (F/k)²) with the amplitude a = 4 F/k, and flies for 2 v/g with g = F/m.
  const double sag = 10.0 / stiffness;
  const double velocity = omega * sag * std::sqrt(15.0);
  const double half_contact = (std::numbers::pi - std::acos(0.25)) / omega;
  const double flight = 2.0 * velocity / 10.0;
  const double step = 1e-5;
  Simulation simulation(mass_on_spring(-5.0 * sag), exact_time(step));
  std::vector<double> changes;
  ContactState last = simulation.contact_state(0);
  double highest = 0.0;
  while (simulation.time() < 0.3) {
    ASSERT_EQ(simulation.step(), StepOutcome::done) << simulation.failure();
    highest = std::max(highest, height_of(simulation));
    const bool opens = simulation.contact_state(0) == ContactState::open;
    if (opens != (last == ContactState::open)) changes.push_back(simulation.time());
    last = simulation.contact_state(0);
  }
  ASSERT_GE(changes.size(), 3U);
  EXPECT_NEAR(changes[0], half_contact, 2.0 * step);
  EXPECT_NEAR(changes[1], half_contact + flight, 1e-3 * flight);
  EXPECT_NEAR(changes[2], 3.0 * half_contact + flight, 1e-3 * flight);
  EXPECT_NEAR(highest, velocity * velocity / 20.0, 2e-3 * highest);
}

TEST(Penalty, GivesBackNoMoreEnergyThanItHasStored) {
  for (const Coordinates form : {Coordinates::modal, Coordinates::craig_bampton}) {
    Simulation simulation(mass_on_spring(-5.0 * 10.0 / stiffness), time_of(2e-5, form),
                          Accounts::energy);
    ASSERT_EQ(simulation.step_until(20000), StepOutcome::done) << simulation.failure();
    const EnergyLedger& ledger = *simulation.energy();
    EXPECT_LT(ledger.relative_error(), 1e-11);
    // Of what the spring holds at the start, the part of one step is not known.
    EXPECT_LT(ledger.contact_gain().energy, 1e-4 * ledger.turned_over());
    EXPECT_FALSE(ledger.contacts_feed());
  }
}

TEST(Penalty, ResumesBitwise) {
  Simulation whole(mass_on_spring(-5.0 * 10.0 / stiffness), time_of(2e-5), Accounts::energy);
  Simulation resumed(mass_on_spring(-5.0 * 10.0 / stiffness), time_of(2e-5), Accounts::energy);
  ASSERT_EQ(whole.step_until(777), StepOutcome::done);
  resumed.load(whole.save());
  ASSERT_EQ(whole.step_until(3000), StepOutcome::done);
  ASSERT_EQ(resumed.step_until(3000), StepOutcome::done);
  EXPECT_EQ(height_of(whole), height_of(resumed));
  EXPECT_EQ(whole.energy()->balance().contact_work, resumed.energy()->balance().contact_work);
  EXPECT_EQ(whole.energy()->contact_gain().energy, resumed.energy()->contact_gain().energy);
}

/// The main scene in small, its contact on a spring.
Model sprung_model(std::optional<double> penalty) {
  ModelParameters parameters = paper_model();
  parameters.drive->ramp = 0.0;
  if (penalty) {
    parameters.contact->normal.law = &normal_law_type("penalty");
    parameters.contact->normal.numbers["stiffness"] = *penalty;
  }
  return make_paper_model(parameters);
}

TEST(Penalty, EquilibriumAndSpectrumApproachThoseOfTheMultiplierAsOneOverItsStiffness) {
  const auto state_of = [](const Model& model) {
    Equilibrium found = find_equilibrium(model.system, sliding_state(model.system, 0.01));
    EXPECT_EQ(found.status, EquilibriumStatus::converged) << found.failure;
    return found;
  };
  const auto frequencies_of = [](const Model& model, const Equilibrium& state) {
    std::vector<std::complex<double>> values;
    for (const Eigenvalue& one :
         secular_eigenvalues(linearise(model.system, state), SpectrumWindow::lowest(4)))
      if (one.s.imag() > 0.0) values.push_back(one.s);
    return values;
  };
  const Model rigid = sprung_model({});
  const Equilibrium rest = state_of(rigid);
  const auto wanted = frequencies_of(rigid, rest);
  ASSERT_GE(wanted.size(), 4U);
  double last_force = 0.0;
  double last_frequency = 0.0;
  for (const double penalty : {1e8, 1e9}) {
    const Model sprung = sprung_model(penalty);
    const Equilibrium found = state_of(sprung);
    EXPECT_NEAR(found.contacts[0].gap, -found.contacts[0].force / penalty,
                1e-9 * found.contacts[0].force / penalty + 1e-15);
    const double force = std::abs(found.contacts[0].force - rest.contacts[0].force);
    const auto values = frequencies_of(sprung, found);
    ASSERT_GE(values.size(), 4U);
    double frequency = 0.0;
    for (std::size_t i = 0; i < 4; ++i)
      frequency = std::max(frequency, std::abs(values[i] - wanted[i]) / std::abs(wanted[i]));
    if (last_force > 0.0) {
      EXPECT_NEAR(last_force / force, 10.0, 1.0);
      EXPECT_NEAR(last_frequency / frequency, 10.0, 1.0);
    }
    last_force = force;
    last_frequency = frequency;
  }
}

TEST(Penalty, DenseAndSecularSpectraAgree) {
  const Model sprung = sprung_model(1e7);
  const Equilibrium found = find_equilibrium(sprung.system, sliding_state(sprung.system, 0.01));
  ASSERT_EQ(found.status, EquilibriumStatus::converged) << found.failure;
  const Pencil pencil = linearise(sprung.system, found);
  EXPECT_EQ(pencil.num_constraints(), 0);
  const auto dense = dense_eigenvalues(pencil, DenseWork::eigenvalues);
  for (const Eigenvalue& one : secular_eigenvalues(pencil, SpectrumWindow::lowest(6))) {
    double nearest = std::numeric_limits<double>::infinity();
    for (const Eigenvalue& other : dense) nearest = std::min(nearest, std::abs(other.s - one.s));
    EXPECT_LT(nearest, 1e-7 * std::abs(one.s));
  }
}

TEST(Penalty, FrozenStepIsThatOfTheSimulation) {
  // The height about its rest obeys the recurrence whose roots are the factors of the step.
  for (const TimeParameters& time : {time_of(2e-3), exact_time(2e-3)}) {
    const System system = mass_on_spring(0.0, ContactAssumption::subs_b);
    const Equilibrium rest = find_equilibrium(system, sliding_state(system, 0.0));
    ASSERT_EQ(rest.status, EquilibriumStatus::converged) << rest.failure;
    auto factors = FrozenStep(system, time).factors(linearise_constraints(system, rest));
    // Those of the motion along the ground have magnitude 1; the spring of 100 N/m is slow.
    std::sort(factors.begin(), factors.end(), [](const auto& a, const auto& b) {
      return std::abs(std::arg(a)) > std::abs(std::arg(b));
    });
    const double sum = (factors[0] + factors[1]).real();
    const double product = (factors[0] * factors[1]).real();
    Simulation simulation(system, time);
    std::vector<double> heights;
    for (int n = 0; n < 40; ++n) {
      heights.push_back(height_of(simulation) + 10.0 / stiffness);
      ASSERT_EQ(simulation.step(), StepOutcome::done);
    }
    for (std::size_t n = 4; n < heights.size(); ++n) {
      EXPECT_NEAR(heights[n], sum * heights[n - 1] - product * heights[n - 2],
                  1e-9 * 10.0 / stiffness)
          << n;
    }
  }
}

/// A mass on a belt with friction that is smooth in the slip.
MassOnGround regularised_belt(RegularisedSign::Kind kind, double speed, double belt) {
  MassOnGround scene;
  scene.alpha = 2.0;
  scene.belt_velocity = belt;
  scene.friction = constant_friction(0.3);
  scene.friction.sign = {kind, speed};
  return scene;
}

TEST(RegularisedFriction, HoldsTheSpringWithItsShareAtTheVelocityOfTheBelt) {
  // At rest in space the mass slips with the velocity of the belt: k x = μ N s(v/v_ε).
  using Kind = RegularisedSign::Kind;
  for (const Kind kind : {Kind::tanh, Kind::linear, Kind::square_root, Kind::atan}) {
    for (const double belt : {0.02, 0.5}) {
      const MassOnGround scene = regularised_belt(kind, 0.1, belt);
      const double share = scene.friction.sign.at(belt).value;
      const System system = scene.system();
      const Equilibrium rest = find_equilibrium(system, sliding_state(system, 0.0));
      ASSERT_EQ(rest.status, EquilibriumStatus::converged) << rest.failure;
      EXPECT_NEAR(rest.contacts[0].friction_force, -3.0 * share, 1e-11);
      for (const TimeParameters& time : {time_of(1e-3), exact_time(1e-3)}) {
        Simulation simulation(system, time);
        ASSERT_EQ(simulation.step_until(20000), StepOutcome::done) << simulation.failure();
        EXPECT_NEAR(simulation.displacement(0, MassOnGround::x_row), 0.03 * share, 1e-9);
        EXPECT_NEAR(std::abs(simulation.friction_force(0)), 3.0 * share, 1e-7);
        EXPECT_EQ(simulation.contact_state(0), ContactState::slip);
      }
    }
  }
}

TEST(RegularisedFriction, DampsSmallMotionByItsSlope) {
  // m ẍ + (c + μ N s'(v)) ẋ + k x = 0.
  const MassOnGround scene = regularised_belt(RegularisedSign::Kind::tanh, 0.1, 0.05);
  const System system = scene.system();
  const Equilibrium rest = find_equilibrium(system, sliding_state(system, 0.0));
  ASSERT_EQ(rest.status, EquilibriumStatus::converged);
  const double half = 0.5 * (2.0 + 3.0 * scene.friction.sign.at(0.05).slope);
  const std::complex<double> root = std::sqrt(std::complex<double>(half * half - 100.0, 0.0));
  const auto values = dense_eigenvalues(linearise(system, rest), DenseWork::eigenvalues);
  for (const std::complex<double> expected : {-half + root, -half - root}) {
    double nearest = std::numeric_limits<double>::infinity();
    for (const Eigenvalue& one : values) nearest = std::min(nearest, std::abs(one.s - expected));
    EXPECT_LT(nearest, 1e-9 * std::abs(expected)) << expected;
  }
}

TEST(RegularisedFriction, CreepsWhereSetValuedFrictionSticks) {
  // Pulled by half of the limit it creeps with v_ε artanh ½, however small v_ε is against a step.
  for (const double speed : {1e-2, 1e-5, 1e-9}) {
    MassOnGround scene;
    scene.stiffness = 1.0;
    scene.displacement = 1.5;
    scene.friction = constant_friction(0.3);
    scene.friction.sign = {RegularisedSign::Kind::tanh, speed};
    Simulation simulation(scene.system(), time_of(1e-3));
    ASSERT_EQ(simulation.step_until(50), StepOutcome::done) << simulation.failure();
    // The spring slackens as it creeps, by 1e-4 of its pull at the fastest of the three.
    EXPECT_NEAR(simulation.slip_velocity(0), -speed * std::atanh(0.5), 1e-2 * speed);
    EXPECT_NEAR(std::abs(simulation.friction_force(0)), 1.5, 2e-2);
  }
}

TEST(RegularisedFriction, SolvesTheLawAtTheMeanSlipOfTheStep) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  int closed = 0;
  for (int i = 0; i < 2000; ++i) {
    // A positive definite compliance, as bodies have it.
    Eigen::Matrix2d root;
    root << uniform(random), uniform(random), uniform(random), uniform(random);
    const Eigen::Matrix2d w = root * root.transpose() + 0.05 * Eigen::Matrix2d::Identity();
    FrictionLaw law = i % 2 == 0 ? FrictionLaw{0.3, 0.2} : stribeck_friction(0.3, 0.2, 0.5);
    law.sign = {RegularisedSign::Kind::square_root, std::pow(10.0, 3.0 * uniform(random))};
    LocalProblem problem;
    problem.penetration = uniform(random);
    problem.slip = uniform(random);
    problem.is_unilateral = i % 3 != 0;
    problem.creep = &law;
    problem.friction_factor = 0.5;
    problem.step = 0.1;
    problem.last_slip = 10.0 * uniform(random);
    ContactSolver solver(1);
    solver.delassus() = w;
    const ContactAnswer answer = solver.solve({&problem, 1});
    if (answer.status == ContactStatus::jammed) continue;
    if (problem.is_unilateral && problem.penetration <= 0.0) {
      EXPECT_EQ(problem.state, ContactState::open);
      continue;
    }
    ++closed;
    const Eigen::Vector2d moved = w * Eigen::Vector2d(problem.normal, problem.tangential);
    EXPECT_NEAR(problem.penetration - moved.x(), 0.0, 1e-10);
    const double v = (problem.slip - moved.y()) / problem.step;
    const double expected = std::copysign(0.5 * sliding_friction(law, v), v) * problem.normal;
    // The law is as steep as μ λ/v_ε.
    const double rounding = 1e-12 * (1.0 + std::abs(problem.normal) / law.sign.speed);
    EXPECT_NEAR(problem.tangential, expected, rounding) << i;
  }
  EXPECT_GT(closed, 500);
}

}  // namespace
}  // namespace stridor
