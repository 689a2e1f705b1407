// Bodies of the coupled system on a viscoelastic substrate: a force law in the place of gap = 0.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/errors.hpp"
#include "models/model.hpp"
#include "solvers/eigenvalues/dense_eigenvalues.hpp"
#include "solvers/eigenvalues/eigenvector.hpp"
#include "solvers/eigenvalues/secular_eigenvalues.hpp"
#include "solvers/equilibrium/linearise.hpp"
#include "solvers/transient/substrate_motion.hpp"
#include "substructures/bodies/beam.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/paper_sphere.hpp"
#include "tests/support/small_systems.hpp"
#include "tests/support/substrate_stepper.hpp"

namespace stridor {
namespace {

using test::message_of;
using ::testing::HasSubstr;

SubstrateOscillator sphere(double speed, double shear) {
  test::PaperSphere model = test::paper_sphere(speed, shear);
  model.friction_normal_force = FrictionLoad::contact;
  return make_sphere(model);
}

/// The oscillator as a body of a system, y upwards, seen from the substrate: it is dragged over the
/// rigid line with minus the speed of the substrate.
System as_system(const SubstrateOscillator& oscillator, const Eigen::Vector2d& displacement) {
  System system;
  Eigen::Matrix2d stiffness = oscillator.stiffness;
  stiffness(0, 1) = stiffness(1, 0) = -oscillator.stiffness(0, 1);
  const double alpha = oscillator.damping(0, 0);
  system.bodies.push_back(test::driven_body("sphere", Eigen::Matrix2d::Identity(), stiffness,
                                            Eigen::Matrix2d::Identity(), 1, alpha));
  system.bodies[0].reduced.base_inertia(0) = 1.0;
  system.bodies[0].modal = make_modal(system.bodies[0].reduced);
  system.bodies[0].initial_displacement = Eigen::Vector2d(displacement.x(), -displacement.y());
  system.bodies[0].initial_velocity = Eigen::Vector2d::Zero();
  system.bodies.push_back(test::rigid_body("substrate"));
  system.surfaces.push_back(test::rigid_line(1));
  ContactPoint contact;
  contact.name = "contact";
  contact.slave_rows = {0, 1};
  contact.slave_position = {0.0, 0.0};
  contact.assumption = ContactAssumption::film;
  contact.substrate = oscillator.contact;
  system.contacts.push_back(contact);
  system.drives[0].velocity = TimeCurve(-oscillator.substrate_speed);
  system.drives[0].load = TimeCurve(-oscillator.load.y());
  return system;
}

TEST(SubstrateSystem, OscillatorMovesAsByItself) {
  // Slip, stick and, at 1e-3, flight.
  for (const double shear : {1e-2, 1e-3}) {
    const SubstrateOscillator oscillator = sphere(5e-3, shear);
    const SubstrateEquilibrium rest = find_equilibrium(oscillator);
    const Eigen::Vector2d start(rest.displacement.x() - 0.2, 1.5 * rest.displacement.y());
    constexpr double h = 2e-3;
    SubstrateStepper stepper(oscillator, Integrator::central_difference, h);
    stepper.start(start, Eigen::Vector2d::Zero());
    Simulation simulation(as_system(oscillator, start), test::time_of(h));
    int sticking = 0;
    for (int n = 0; n < 20000; ++n) {
      ASSERT_TRUE(stepper.advance());
      ASSERT_NEAR(simulation.displacement(0, 0), stepper.displacement().x(), 1e-9) << n;
      ASSERT_NEAR(-simulation.displacement(0, 1), stepper.displacement().y(), 1e-9) << n;
      ASSERT_NEAR(simulation.contact_force(0), stepper.normal_force(), 1e-7) << n;
      ASSERT_NEAR(simulation.friction_force(0), -stepper.tangential_force(), 1e-6) << n;
      ASSERT_EQ(simulation.contact_state(0) == ContactState::stick,
                stepper.mode() == SubstrateMode::stick)
          << n;
      sticking += stepper.mode() == SubstrateMode::stick;
      ASSERT_EQ(simulation.step(), StepOutcome::done) << simulation.failure();
    }
    EXPECT_GT(sticking, 500);
  }
}

TEST(SubstrateSystem, ExactPropagationConvergesToTheMotionFromEventToEvent) {
  // Over slip and two stretches of stick; the error of the scheme is of second order.
  const SubstrateOscillator oscillator = sphere(5e-3, 1e-2);
  const SubstrateEquilibrium rest = find_equilibrium(oscillator);
  const Eigen::Vector2d start(rest.displacement.x() - 0.2, 1.5 * rest.displacement.y());
  constexpr double end = 20.0;
  SubstrateMotion reference(oscillator, 1e-12);
  reference.start(start, Eigen::Vector2d::Zero());
  ASSERT_EQ(reference.advance(end, false), SubstrateMotion::Stop::end);
  ASSERT_GT(reference.statistics().stick_time, 2.0);
  const auto error = [&](double h) {
    TimeParameters time = test::time_of(h);
    time.integrator = Integrator::exact;
    Simulation simulation(as_system(oscillator, start), time);
    EXPECT_EQ(simulation.step_until(std::llround(end / h)), StepOutcome::done);
    return std::hypot(simulation.displacement(0, 0) - reference.state()[0],
                      -simulation.displacement(0, 1) - reference.state()[1]);
  };
  const double coarse = error(4e-3);
  const double fine = error(1e-3);
  EXPECT_LT(fine, 5e-3 * 0.2);  // of a motion of 0.2
  EXPECT_NEAR(std::log(coarse / fine) / std::log(4.0), 2.0, 0.5);
}

TEST(SubstrateSystem, EquilibriumAndEigenvaluesAreThoseOfTheOscillator) {
  for (const double speed : {1e-4, 4e-4, 5e-3, 1.0}) {
    for (const double shear : {0.0, 1e-3, 3e-2}) {
      const SubstrateOscillator oscillator = sphere(speed, shear);
      const SubstrateEquilibrium rest = find_equilibrium(oscillator);
      const System system = as_system(oscillator, Eigen::Vector2d::Zero());
      for (const ContactGeometry geometry :
           {ContactGeometry::deformed, ContactGeometry::undeformed}) {
        const Equilibrium found = find_equilibrium(system, sliding_state(system, 0.0, geometry));
        ASSERT_EQ(found.status, EquilibriumStatus::converged) << found.failure;
        const Eigen::VectorXd u = system.bodies[0].modal.shapes * found.displacement[0];
        EXPECT_NEAR(u(0), rest.displacement.x(), 1e-11 * (1.0 + std::abs(rest.displacement.x())));
        EXPECT_NEAR(-u(1), rest.displacement.y(), 1e-11 * rest.displacement.y());
        EXPECT_NEAR(found.contacts[0].force, rest.forces.normal.value, 1e-11);
        EXPECT_NEAR(found.contacts[0].friction_force, -rest.forces.tangential.value, 1e-11);

        const auto expected = eigenvalues(small_motion(oscillator, rest));
        const Pencil pencil = linearise(system, found);
        EXPECT_EQ(pencil.compatibility.rows(), 0);
        for (const auto& list :
             {dense_eigenvalues(pencil), secular_eigenvalues(pencil, SpectrumWindow::lowest(4))}) {
          EXPECT_FALSE(list.empty());
          for (const Eigenvalue& one : list) {
            double apart = 1e300;
            for (const std::complex<double>& s : expected)
              apart = std::min(apart, std::abs(one.s - s));
            EXPECT_LT(apart, 1e-7 * (1.0 + std::abs(one.s))) << speed << ' ' << shear;
          }
        }
      }
    }
  }
}

/// A reed that is dragged over a substrate.
ModelParameters reed(double youngs_modulus) {
  BeamParameters beam;
  beam.length = 0.06;
  beam.thickness = 1e-3;
  beam.width = 1e-2;
  beam.angle = std::numbers::pi / 3.0;
  beam.material = {youngs_modulus, 0.33, 2770.0};
  beam.mesh = {10, 1};
  beam.supports.end = Support::guided;
  beam.reduction.fixed_interface_modes = 4;
  ModelParameters model;
  model.substructures["reed"] = beam;
  ContactParameters contact;
  contact.slave = {"reed.tip"};
  contact.master = half_space_master;
  contact.assumption = ContactAssumption::film;
  contact.normal.law = &normal_law_type("viscoelastic");
  contact.normal.numbers["radius"] = 2e-3;
  contact.normal.numbers["modulus"] = 4e6 / 3.0;
  contact.normal.numbers["creep_time"] = 1e-2;
  contact.friction.emplace().law = &friction_law_type("shear");
  contact.friction->numbers["strength"] = 0.02 * 4e6 / 3.0;
  model.contact = contact;
  model.drive.emplace().velocity = TimeCurve(1e-3);
  model.drive->load = TimeCurve(-0.02);
  return model;
}

TEST(SubstrateSystem, StiffBeamIsAMassOnTheSpringOfTheContact) {
  const Model model = make_model(reed(71e15), {});
  const Equilibrium found = find_equilibrium(model.system, sliding_state(model.system, 0.0));
  ASSERT_EQ(found.status, EquilibriumStatus::converged) << found.failure;
  // Statics: the whole load; the indentation is where the law gives it.
  // A beam 3 E I/L³ / F_k'(y) ≈ 1e6 times as stiff as the contact multiplies the rounding of its
  // displacements by that in bending, and by 1e10 along its axis, of which its modes show a part.
  constexpr double rounding = 1e-8 * 0.02;
  EXPECT_NEAR(found.contacts[0].force, 0.02, rounding);
  const SubstrateContact& substrate = *model.system.contacts[0].substrate;
  const double v = 1e-3;
  const auto normal = [&](double y) { return substrate.at(y, v, 1.0).normal.value; };
  const double y = -found.contacts[0].gap;
  EXPECT_NEAR(normal(y), 0.02, rounding);
  // m ÿ + F_k'(y) y = 0 with the mass of the beam, which moves up and down as a whole.
  const double mass = 0.06 * 1e-3 * 1e-2 * 2770.0;
  const double stiffness = (normal(1.001 * y) - normal(0.999 * y)) / (0.002 * y);
  const auto list = secular_eigenvalues(linearise(model.system, found), SpectrumWindow::lowest(1));
  const auto first = std::find_if(list.begin(), list.end(),
                                  [](const Eigenvalue& one) { return one.s.imag() > 0.0; });
  ASSERT_NE(first, list.end());
  EXPECT_NEAR(first->s.imag(), std::sqrt(stiffness / mass), 1e-5 * first->s.imag());
}

TEST(SubstrateSystem, TransientOfABeamGrowsAsItsEigenvalueSays) {
  Model model = make_model(reed(71e9), {});
  const Equilibrium found = find_equilibrium(model.system, sliding_state(model.system, 0.0));
  ASSERT_EQ(found.status, EquilibriumStatus::converged) << found.failure;
  const Pencil pencil = linearise(model.system, found);
  const auto list = secular_eigenvalues(pencil, SpectrumWindow::lowest(3));
  const auto fastest =
      *std::max_element(list.begin(), list.end(),
                        [](const auto& a, const auto& b) { return a.s.real() < b.s.real(); });
  // The friction falls with speed.
  ASSERT_GT(fastest.s.real(), 1.0);
  const Eigen::VectorXcd shape = eigenvector(pencil, fastest.s).right;
  const PointRows tip = model.system.contacts[0].slave_rows;
  apply_initial_motion(model.system, found);
  const Eigen::VectorXd rest = model.system.bodies[0].initial_displacement;
  // Its velocity stays far below that of the drive.
  add_perturbation(model.system, shape, fastest.s, 1e-3 * 1e-3 / std::abs(fastest.s));
  const Eigen::MatrixXd& rows = model.system.bodies[0].reduced.rows;
  const auto at_tip = [&](const Eigen::VectorXd& u) {
    return Eigen::Vector2d(rows.row(tip.x) * u, rows.row(tip.y) * u);
  };
  const Eigen::Vector2d x0 = at_tip(model.system.bodies[0].initial_displacement - rest);
  const Eigen::Vector2d v0 = at_tip(model.system.bodies[0].initial_velocity);
  const Eigen::Vector2d still = at_tip(rest);

  TimeParameters time = test::time_of(2e-7);
  time.integrator = Integrator::exact;
  Simulation simulation(model.system, time);
  const double end = 0.5 / fastest.s.real();
  const auto num_steps = std::min<std::int64_t>(200000, std::llround(end / 2e-7));
  ASSERT_EQ(simulation.step_until(num_steps), StepOutcome::done) << simulation.failure();
  // x(t) = Re(z exp(st)) with z from x(0) = Re z and ẋ(0) = Re(s z).
  const std::complex<double> s = fastest.s;
  const double t = simulation.time();
  for (const int k : {0, 1}) {
    const double imaginary = (s.real() * x0(k) - v0(k)) / s.imag();
    const double expected = (std::complex<double>(x0(k), imaginary) * std::exp(s * t)).real();
    const double size = std::hypot(x0(k), imaginary) * std::exp(s.real() * t);
    const double moved = simulation.displacement(0, k == 0 ? tip.x : tip.y) - still(k);
    EXPECT_NEAR(moved, expected, 1e-2 * size) << k;
  }
}

/// Step of the central difference without damping for which k W = k h² is this at rest.
double step_for(const SubstrateOscillator& oscillator, double stiffness_in_step) {
  const double y = find_equilibrium(oscillator).displacement.y();
  const auto normal = [&](double at) {
    return oscillator.contact.at(at, -oscillator.substrate_speed, -1.0).normal.value;
  };
  const double stiffness = (normal(1.0001 * y) - normal(0.9999 * y)) / (0.0002 * y);
  return std::sqrt(stiffness_in_step / stiffness);
}

TEST(SubstrateSystem, AStepTooLongForTheSubstrateIsAnOutcome) {
  SubstrateOscillator oscillator = sphere(5e-3, 0.0);
  oscillator.damping.setZero();
  const Eigen::Vector2d rest = find_equilibrium(oscillator).displacement;
  // The bound is k W = 4; k by differences is good to 1e-6.
  const System still = as_system(oscillator, rest);
  const Simulation below(still, test::time_of(step_for(oscillator, 3.999)));
  EXPECT_THAT(message_of<NumericalError>([&] {
                const Simulation above(still, test::time_of(step_for(oscillator, 4.001)));
              }),
              ::testing::AllOf(HasSubstr("contact at t = 0 s (step 0)"),
                               HasSubstr("the substrate is too stiff for the step")));

  // The springs take their part of the 4. Beyond the rest of it a small motion grows, until the
  // substrate, which is the stiffer the deeper, says so.
  const auto last_step = [&](double stiffness_in_step) {
    const double h = step_for(oscillator, stiffness_in_step);
    const Eigen::Vector2d start(rest.x(), 1.001 * rest.y());
    Simulation simulation(as_system(oscillator, start), test::time_of(h));
    SubstrateStepper stepper(oscillator, Integrator::central_difference, h);
    stepper.start(start, Eigen::Vector2d::Zero());
    StepOutcome outcome = StepOutcome::done;
    while (outcome == StepOutcome::done && simulation.step_index() < 500) {
      EXPECT_TRUE(stepper.advance()) << stepper.failure();
      outcome = simulation.step();
    }
    if (outcome == StepOutcome::done) return simulation.step_index();
    EXPECT_EQ(outcome, StepOutcome::overshot);
    EXPECT_THAT(simulation.failure(), HasSubstr("Remedy: take a smaller time.step; about 0."));
    EXPECT_FALSE(stepper.advance());
    EXPECT_THAT(stepper.failure(), HasSubstr("the substrate is too stiff for the step"));
    return simulation.step_index();
  };
  EXPECT_EQ(last_step(3.0), 500);
  const std::int64_t stopped_at = last_step(3.98);
  EXPECT_GT(stopped_at, 2);
  EXPECT_LT(stopped_at, 500);
}

TEST(SubstrateSystem, ABodyDeeperThanItsRadiusIsAnOutcome) {
  SubstrateOscillator oscillator = sphere(5e-3, 0.0);
  const double radius = oscillator.contact.indentation_unit;
  const Eigen::Vector2d rest = find_equilibrium(oscillator).displacement;
  oscillator.load.y() *= 1e5;  // under which it falls
  Simulation simulation(as_system(oscillator, rest), test::time_of(1e-4));
  double before = 0.0;
  StepOutcome outcome = StepOutcome::done;
  while (outcome == StepOutcome::done && simulation.step_index() < 100'000) {
    before = -simulation.displacement(0, 1);
    outcome = simulation.step();
  }
  EXPECT_EQ(outcome, StepOutcome::sunk);
  EXPECT_LE(before, radius);
  EXPECT_GT(-simulation.displacement(0, 1), radius);
  EXPECT_THAT(simulation.failure(), HasSubstr("m into the substrate, more than its radius of"));
  EXPECT_THAT(simulation.failure(), HasSubstr("Remedy: take a smaller load (drive.load)"));
}

TEST(SubstrateSystem, WhatIsNotKnownOfASubstrateIsRefused) {
  const SubstrateOscillator oscillator = sphere(5e-3, 1e-2);
  const System system = as_system(oscillator, Eigen::Vector2d::Zero());
  EXPECT_THAT(
      message_of<ConfigError>([&] { Simulation(system, test::time_of(1e-3), Accounts::energy); }),
      HasSubstr("record.energy: the energy ledger does not know what a substrate stores"));
  System sliding = system;
  sliding.contacts[0].assumption = ContactAssumption::subs_b;
  EXPECT_THAT(message_of<ConfigError>([&] { Simulation(sliding, test::time_of(1e-3)); }),
              HasSubstr("contact.assumption: must be `film` on a half_space"));
  TimeParameters time = test::time_of(1e-3);
  time.integrator = Integrator::exact;
  time.retain = RetainParameters{1.0, {}};
  EXPECT_THAT(message_of<ConfigError>([&] { Simulation(system, time); }),
              HasSubstr("time.retain: a contact with a substrate takes all modes"));
}

TEST(SubstrateContact, ForcesUnderALoadCarryIt) {
  const SubstrateOscillator oscillator = sphere(5e-3, 1e-2);
  const SubstrateContact& contact = oscillator.contact;
  for (const double load : {1e-12, 1e-3, 1.0, 1e4}) {
    for (const double slip : {0.0, 1e-4, -1.0, 1e5}) {
      const SubstrateForces forces = contact.under(load, slip, slip < 0.0 ? -1.0 : 1.0);
      EXPECT_NEAR(forces.normal.value, load, 1e-13 * load);
      EXPECT_GT(forces.indentation, 0.0);
    }
  }
}

}  // namespace
}  // namespace stridor
