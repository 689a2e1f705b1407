// Several drives: closed forms, and the same motion as under one.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <memory>
#include <stdexcept>
#include <utility>
#include <vector>

#include "solvers/equilibrium/equilibrium.hpp"
#include "solvers/transient/batch.hpp"
#include "solvers/transient/simulation.hpp"
#include "tests/support/constants.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/paper_model.hpp"
#include "tests/support/small_systems.hpp"

namespace stridor {
namespace {

using test::eps;

TimeParameters time_with(double step, Integrator integrator = Integrator::central_difference) {
  TimeParameters time;
  time.step = step;
  time.integrator = integrator;
  return time;
}

/// Two masses on springs that do not touch, the second one damped, in x and y.
System two_masses() {
  System system;
  for (const double stiffness : {100.0, 250.0}) {
    Eigen::Matrix2d k = Eigen::Vector2d(stiffness, 2.0 * stiffness).asDiagonal();
    k(0, 1) = k(1, 0) = 30.0;
    system.bodies.push_back(test::driven_body(stiffness == 100.0 ? "a" : "b",
                                              Eigen::Matrix2d::Identity(), k,
                                              Eigen::Matrix2d::Identity(), 1, 0.4));
    system.bodies.back().reduced.base_inertia = Eigen::Vector2d(1.0, 0.0);
    system.bodies.back().modal = make_modal(system.bodies.back().reduced);
    system.bodies.back().loads.clear();
  }
  system.drives.resize(2);
  system.bodies[0].drive = 0;
  system.bodies[1].drive = 1;
  return system;
}

/// Displacements of both masses after some steps.
Eigen::Vector4d motion_after(const System& system, const TimeParameters& time) {
  Simulation simulation(system, time);
  EXPECT_EQ(simulation.step_until(700), StepOutcome::done) << simulation.failure();
  return {simulation.displacement(0, 0), simulation.displacement(0, 1),
          simulation.displacement(1, 0), simulation.displacement(1, 1)};
}

TEST(Drives, MotionsUnderSeveralAreTheSumOfThoseUnderEach) {
  for (const Integrator integrator : {Integrator::central_difference, Integrator::exact}) {
    for (const Coordinates form : {Coordinates::modal, Coordinates::craig_bampton_fused}) {
      if (integrator == Integrator::exact && form != Coordinates::modal) continue;
      TimeParameters time = time_with(1e-3, integrator);
      time.coordinates = form;
      System both = two_masses();
      both.bodies[0].loads = {{1, 0, BodyLoad::By::force}, {0, 1, BodyLoad::By::force},
                              {1, 1, BodyLoad::By::shift}};
      both.bodies[1].loads = {{1, 1, BodyLoad::By::force}, {0, 0, BodyLoad::By::shift}};
      std::vector<Drive> drives(2);
      drives[0].velocity = TimeCurve(TimeTable{{0.0, 0.3, 0.5}, {0.0, 0.2, -0.1}});
      drives[0].load = TimeCurve::ramp(3.0, 0.2);
      drives[0].shift = TimeCurve::ramp(0.02, 0.4);
      drives[1].velocity = TimeCurve::ramp(-0.4, 0.6);
      drives[1].load = TimeCurve(-1.5);
      drives[1].shift = TimeCurve(0.01);
      Eigen::Vector4d sum = Eigen::Vector4d::Zero();
      for (const std::size_t alone : {0, 1}) {
        System one = both;
        one.drives[alone] = drives[alone];
        const Eigen::Vector4d motion = motion_after(one, time);
        EXPECT_GT(motion.cwiseAbs().maxCoeff(), 1e-3);
        sum += motion;
      }
      both.drives = drives;
      const Eigen::Vector4d motion = motion_after(both, time);
      // Rounding of 700 steps.
      EXPECT_LT((motion - sum).cwiseAbs().maxCoeff(), 700.0 * eps * sum.cwiseAbs().maxCoeff());
    }
  }
}

TEST(Drives, EquilibriumIsThatOfAllLoads) {
  System system = two_masses();
  system.bodies[0].loads = {{1, 0, BodyLoad::By::force}, {0, 1, BodyLoad::By::force},
                            {1, 1, BodyLoad::By::shift}};
  system.drives[0].load = TimeCurve::ramp(3.0, 0.2);
  system.drives[1].load = TimeCurve(-1.5);
  system.drives[1].shift = TimeCurve(0.5);
  const Equilibrium rest = find_equilibrium(system, sliding_state(system, 0.0));
  ASSERT_EQ(rest.status, EquilibriumStatus::converged);
  Eigen::Matrix2d k;
  k << 100.0, 30.0, 30.0, 200.0;
  const Eigen::Vector2d expected = k.inverse() * Eigen::Vector2d(-1.5, 3.5);
  const Eigen::Vector2d found = system.bodies[0].modal.shapes * rest.displacement[0];
  EXPECT_LT((found - expected).norm(), 1e-14);
  EXPECT_EQ(rest.displacement[1].norm(), 0.0);
  EXPECT_EQ(rest.state.drives[1].shift, 0.5);
}

TEST(Drives, EquilibriumRefusesAStateOfOtherDrives) {
  const System system = two_masses();
  EquilibriumState state = sliding_state(system, 0.0);
  state.drives.pop_back();
  System touched = test::MassOnGround().system();
  state.drives.resize(2);
  EXPECT_EQ(test::message_of<std::invalid_argument>([&] { find_equilibrium(touched, state); }),
            "find_equilibrium: the state is of 2 drives, the system has 1");
}

/// A mass on ground that moves against it: the mass follows one drive, the ground another.
System opposite_drives(double of_mass, double of_ground, double ramp) {
  test::MassOnGround mass;
  mass.friction = constant_friction(0.3);
  mass.alpha = 2.0;
  mass.assumption = ContactAssumption::subs_b;
  System system = mass.system();
  system.drives.resize(2);
  system.drives[0].velocity = TimeCurve::ramp(of_mass, ramp);
  system.drives[1].velocity = TimeCurve::ramp(of_ground, 0.5 * ramp);
  system.bodies[1].drive = 1;
  return system;
}

TEST(Drives, OppositeVelocitiesSlideWithTheirDifferenceAndTheLedgerCloses) {
  const System system = opposite_drives(0.3, -0.2, 0.4);
  Simulation simulation(system, time_with(1e-3), Accounts::energy);
  ASSERT_EQ(simulation.step_until(20'000), StepOutcome::done) << simulation.failure();
  // 20 s at 2 1/s of damping leave nothing of the start.
  EXPECT_NEAR(simulation.slip_velocity(0), 0.5, 1e-8);
  EXPECT_NEAR(simulation.friction_force(0), 3.0, 1e-12);
  EXPECT_NEAR(simulation.displacement(0, 0), -0.03, 1e-8);
  EXPECT_NEAR(simulation.drive_displacement(0), 0.3 * 19.8, 1e-12);
  EXPECT_NEAR(simulation.drive_displacement(1), -0.2 * 19.9, 1e-12);
  // The place on the ground moves with their difference.
  EXPECT_NEAR(simulation.contact_place(0).position, 0.3 * 19.8 + 0.2 * 19.9 - 0.03, 1e-7);
  const EnergyLedger& ledger = *simulation.energy();
  EXPECT_LT(ledger.relative_error(), 1e-13);
  // Both drives together feed friction once the springs are stretched.
  const double slid = 0.3 * 19.8 + 0.2 * 19.9 - 0.03;
  EXPECT_NEAR(ledger.balance().friction_loss, 3.0 * slid, 1e-2);
}

TEST(Drives, OnlyTheDifferenceOfTheDrivesIsSeenAtAContact) {
  // The mass of the first scene is at rest on a belt; seen from its spring, nothing else differs
  // once the drives are steady.
  const System opposite = opposite_drives(0.3, -0.2, 0.0);
  System belt = opposite_drives(0.0, -0.5, 0.0);
  for (System system : {opposite, belt}) {
    Simulation simulation(system, time_with(1e-3));
    ASSERT_EQ(simulation.step_until(1000), StepOutcome::done) << simulation.failure();
    Simulation other(belt, time_with(1e-3));
    ASSERT_EQ(other.step_until(1000), StepOutcome::done);
    EXPECT_NEAR(simulation.displacement(0, 0), other.displacement(0, 0), 1e-13);
    EXPECT_NEAR(simulation.slip_velocity(0), other.slip_velocity(0), 1e-12);
  }
  const Equilibrium a = find_equilibrium(opposite, sliding_state(opposite, 0.1));
  ASSERT_EQ(a.status, EquilibriumStatus::converged);
  EXPECT_NEAR(a.contacts[0].slip_velocity, 0.5, 1e-15);
  EXPECT_NEAR(a.contacts[0].friction_force, 3.0, 1e-12);
  // The leading drive has come 0.1 m, the other one −0.2/0.3 of that.
  EXPECT_NEAR(a.contacts[0].position, 0.1 + 0.1 * 0.2 / 0.3 - 0.03, 1e-12);
}

TEST(Drives, FrozenSlidingHoldsThePlaceAndKeepsTheDifference) {
  System system = opposite_drives(0.3, -0.2, 0.1);
  for (Drive& drive : system.drives) drive.is_frozen = true;
  Simulation simulation(system, time_with(1e-3));
  ASSERT_EQ(simulation.step_until(20'000), StepOutcome::done) << simulation.failure();
  EXPECT_NEAR(simulation.slip_velocity(0), 0.5, 1e-8);
  EXPECT_NEAR(simulation.contact_place(0).position, -0.03, 1e-8);
}

TEST(Drives, TheLeadingOneIsTheFirstThatMoves) {
  System system = opposite_drives(0.3, -0.2, 0.1);
  EXPECT_EQ(&system.leading_drive(), &system.drives[0]);
  EXPECT_EQ(system.path_share(0), 1.0);
  EXPECT_EQ(system.path_share(1), -0.2 / 0.3);
  EXPECT_EQ(system.path_share(system.contacts[0]), 1.0 + 0.2 / 0.3);
  system.drives[0].velocity = TimeCurve(0.0);
  EXPECT_EQ(&system.leading_drive(), &system.drives[1]);
  EXPECT_EQ(system.path_share(0), 0.0);
  EXPECT_EQ(system.path_share(1), 1.0);
  system.drives[1].velocity = TimeCurve(0.0);
  EXPECT_EQ(&system.leading_drive(), &system.drives[0]);
  EXPECT_EQ(system.path_share(0), 1.0);
  EXPECT_EQ(system.path_share(1), 0.0);
  system.bodies[0].drive = -1;
  EXPECT_EQ(&system.leading_drive(), &system.drives[1]);
}

TEST(Drives, BodiesOfOneDriveDoNotMoveAgainstEachOther) {
  System system = opposite_drives(0.3, -0.2, 0.1);
  system.bodies[1].drive = 0;
  const DrivenMotion motion = system.driven_motion(system.contacts[0]);
  EXPECT_EQ(motion.displacement(1.0), 0.0);
  EXPECT_EQ(motion.velocity(1.0), 0.0);
  EXPECT_EQ(motion.constant_from(), 0.0);
}

/// The trailing scene with its load in a drive of its own.
System split_paper_system() {
  ModelParameters parameters = test::paper_model();
  parameters.drive->ramp = 1e-3;
  parameters.contact->armed_from = 1.0;
  parameters.drives["feed"] = *parameters.drive;
  parameters.drives["feed"].load = TimeCurve(0.0);
  parameters.drives["weight"] = *parameters.drive;
  parameters.drives["weight"].velocity = TimeCurve(0.0);
  parameters.drive.reset();
  return test::make_paper_model(parameters).system;
}

System whole_paper_system() {
  ModelParameters parameters = test::paper_model();
  parameters.drive->ramp = 1e-3;
  parameters.contact->armed_from = 1.0;
  return test::make_paper_model(parameters).system;
}

TEST(Drives, ADriveOfTheMotionAndOneOfTheLoadAreOneOfBoth) {
  const System split = split_paper_system();
  const System whole = whole_paper_system();
  ASSERT_EQ(split.drives.size(), 2);
  EXPECT_EQ(split.bodies[1].drive, 0);
  ASSERT_EQ(split.bodies[1].loads.size(), 1);
  EXPECT_EQ(split.bodies[1].loads[0].drive, 1);
  EXPECT_EQ(split.contacts[0].friction_rise.table(), whole.contacts[0].friction_rise.table());
  for (const auto& [integrator, coordinates] :
       {std::pair(Integrator::central_difference, Coordinates::modal),
        std::pair(Integrator::exact, Coordinates::modal),
        std::pair(Integrator::central_difference, Coordinates::craig_bampton)}) {
    TimeParameters time = test::paper_time(2e-7, coordinates);
    time.integrator = integrator;
    Simulation a(split, time);
    Simulation b(whole, time);
    const std::int64_t steps = coordinates == Coordinates::modal ? 8000 : 500;
    ASSERT_EQ(a.step_until(steps), StepOutcome::done) << a.failure();
    ASSERT_EQ(b.step_until(steps), StepOutcome::done) << b.failure();
    EXPECT_EQ(a.save(), b.save());
  }
}

TEST(Drives, ResumeBitIdentically) {
  const System system = split_paper_system();
  const TimeParameters time = test::paper_time();
  Simulation straight(system, time, Accounts::energy);
  ASSERT_EQ(straight.step_until(3000), StepOutcome::done);
  const State half = straight.save();
  ASSERT_EQ(straight.step_until(8000), StepOutcome::done);
  Simulation resumed(system, time, Accounts::energy);
  resumed.load(half);
  ASSERT_EQ(resumed.step_until(8000), StepOutcome::done);
  EXPECT_EQ(resumed.save(), straight.save());
}

TEST(Drives, LanesStepAsSimulationsDoButForRounding) {
  System system = split_paper_system();
  // The cantilever's supports follow a third drive against the beam.
  system.drives.push_back(Drive{TimeCurve::ramp(-0.02, 5e-4), TimeCurve(), false, 0.0, TimeCurve(), "drives.third"});
  system.bodies[0].drive = 2;
  system.bodies[0].reduced.base_inertia = Eigen::VectorXd::Zero(system.bodies[0].reduced.size());
  system.bodies[0].modal = make_modal(system.bodies[0].reduced);
  const TimeParameters time = test::paper_time();
  Simulation alone(system, time);
  ASSERT_EQ(alone.step_until(12'000), StepOutcome::done) << alone.failure();
  std::vector<std::unique_ptr<Simulation>> simulations;
  std::vector<Simulation*> runs;
  for (int i = 0; i < 3; ++i) {
    simulations.push_back(std::make_unique<Simulation>(system, time));
    runs.push_back(simulations.back().get());
  }
  Batch batch(runs);
  batch.step_until(12'000);
  batch.synchronise();
  for (const Simulation* run : runs) {
    // But for rounding, as Batch says.
    EXPECT_NEAR(run->contact_force(0), alone.contact_force(0), 1e-9);
    EXPECT_NEAR(run->slip_velocity(0), alone.slip_velocity(0), 1e-9);
    EXPECT_NEAR(run->contact_place(0).position, alone.contact_place(0).position, 1e-13);
  }
}

}  // namespace
}  // namespace stridor
