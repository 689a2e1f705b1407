// Masses on rigid planes in space: closed forms, the planar contact, energy and resumption.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <random>

#include "models/model.hpp"
#include "solvers/equilibrium/linearise.hpp"
#include "solvers/transient/simulation.hpp"
#include "substructures/bodies/lumped_body.hpp"
#include "tests/support/constants.hpp"

namespace stridor {
namespace {

/// A mass that moves in all directions, on springs where a stiffness is given.
struct MassOnPlane {
  double mass = 2.0;
  double load = 10.0;  ///< against the normal, N
  double friction = 0.4;
  double stiffness = 0.0;  ///< along x and z, N/m
  double belt = 0.0;       ///< velocity of the plane in +x, m/s
  Eigen::Vector3d normal = Eigen::Vector3d::UnitY();
  Eigen::Vector3d displacement = Eigen::Vector3d::Zero();
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();
  std::optional<double> penalty;
  bool is_planar = false;  ///< on a straight line in a plane instead
  std::optional<double> static_friction;

  System system() const {
    ModelParameters scene;
    LumpedParameters block;
    block.directions =
        is_planar ? std::vector<std::string>{"x", "y"} : std::vector<std::string>{"x", "y", "z"};
    block.masses["m"].mass = mass;
    if (stiffness > 0.0) {
      block.springs["hold"].at = {"m"};
      block.springs["hold"].stiffness.xx = stiffness;
      if (!is_planar) block.springs["hold"].stiffness.zz = stiffness;
    }
    scene.substructures["block"] = block;
    ContactParameters& contact = scene.contacts["sole"];
    contact.slave = {"block.m"};
    contact.master = rigid_master;
    contact.assumption = ContactAssumption::film;
    FrictionParameters& law = contact.friction.emplace();
    law.numbers["coefficient"] = friction;
    if (penalty) {
      contact.normal.law = &normal_law_type("penalty");
      contact.normal.numbers["stiffness"] = *penalty;
    }
    if (!is_planar) {
      contact.plane.emplace().normal = {normal.x(), normal.y(), normal.z()};
      contact.plane->point = {0.0, 0.0, 0.0};
    }
    if (belt != 0.0) {
      DriveParameters& drive = scene.drive.emplace();
      drive.velocity = TimeCurve(belt);
      drive.moves = {"sole.master"};
    }
    System made = make_model(scene, {}).system;
    const Eigen::Index n = is_planar ? 2 : 3;
    SystemBody& body = made.bodies.front();
    body.held_load = (-load * normal).head(n);
    body.initial_displacement = displacement.head(n);
    body.initial_velocity = velocity.head(n);
    if (static_friction) made.contacts.front().friction.static_coefficient = *static_friction;
    return made;
  }
};

TimeParameters steps_of(double step, Integrator integrator = Integrator::central_difference) {
  TimeParameters time;
  time.step = step;
  time.end = 1.0;
  time.integrator = integrator;
  return time;
}

Eigen::Vector3d place_of(const Simulation& simulation, const System& system) {
  const PointRows& rows = system.contacts.front().slave_rows;
  return {simulation.displacement(0, rows.x), simulation.displacement(0, rows.y),
          rows.z < 0 ? 0.0 : simulation.displacement(0, rows.z)};
}

// Deceleration μ N/m against the velocity, in any plane and any direction of it.
TEST(SpaceSimulation, FrictionStopsAMassOnAStraightPathOfAnyPlaneAndHoldsIt) {
  for (const Eigen::Vector3d& normal :
       {Eigen::Vector3d(0, 1, 0), Eigen::Vector3d(0.3, 0.8, -0.2), Eigen::Vector3d(1, 0.1, 0.1)}) {
    MassOnPlane scene;
    scene.normal = normal.normalized();
    const Eigen::Vector3d along = scene.normal.unitOrthogonal();
    const Eigen::Vector3d direction = 0.6 * along + 0.8 * scene.normal.cross(along);
    constexpr double speed = 0.5, step = 1e-4;
    scene.velocity = speed * direction;
    const double rate = scene.friction * scene.load / scene.mass;
    const double way = 0.5 * speed * speed / rate;
    for (const auto integrator : {Integrator::exact, Integrator::central_difference}) {
      const System system = scene.system();
      Simulation simulation(system, steps_of(step, integrator));
      const auto num_steps = std::lround(1.3 * speed / rate / step);
      ASSERT_EQ(simulation.step_until(num_steps), StepOutcome::done) << simulation.failure();
      // The central difference starts with a force that acts for a whole step.
      const double allowed = integrator == Integrator::exact ? 1e-6 * way : 0.6 * step * speed;
      EXPECT_LT((place_of(simulation, system) - way * direction).norm(), allowed);
      EXPECT_EQ(simulation.contact_state(0), ContactState::stick);
      // Places of the size of the way, rounded, become forces by m/h²; by 6 m/h² where the force
      // grows linearly over the step.
      const double per_place = integrator == Integrator::exact ? 6.0 : 1.0;
      const double rounding = 16.0 * test::eps * way * per_place * scene.mass / (step * step);
      EXPECT_NEAR(simulation.contact_force(0), scene.load, 1e-9 * scene.load + rounding);
      const Eigen::Vector3d rest = place_of(simulation, system);
      ASSERT_EQ(simulation.step_until(2 * num_steps), StepOutcome::done);
      EXPECT_LT((place_of(simulation, system) - rest).norm(), 1e-12);
    }
  }
}

// √(2 h m/F) after it is let go; a multiplier takes its energy, a spring gives it back.
TEST(SpaceSimulation, ADroppedMassLandsWhenItFallsAndStaysOrRebounds) {
  constexpr double height = 0.01, step = 1e-5;
  for (const bool is_sprung : {false, true}) {
    MassOnPlane scene;
    scene.friction = 0.0;
    scene.normal = Eigen::Vector3d(0.2, 1.0, 0.1).normalized();
    scene.displacement = height * scene.normal;
    if (is_sprung) scene.penalty = 1e6;
    const double landing = std::sqrt(2.0 * height * scene.mass / scene.load);
    const System system = scene.system();
    // The published form of the central difference damps springs: its forces lag by a step.
    Simulation simulation(
        system, steps_of(step, is_sprung ? Integrator::exact : Integrator::central_difference));
    while (simulation.contact_state(0) == ContactState::open && simulation.time() < 2.0 * landing)
      ASSERT_EQ(simulation.step(), StepOutcome::done) << simulation.failure();
    EXPECT_NEAR(simulation.time(), landing, 2.0 * step);
    ASSERT_EQ(simulation.step_until(std::lround(2.0 * landing / step)), StepOutcome::done);
    const double gap = scene.normal.dot(place_of(simulation, system));
    EXPECT_NEAR(simulation.contact_place(0).gap, gap, 1e-12);
    if (is_sprung) {
      // Back at its height after as long again, but for the time T on the spring: there it is still
      // ½ (F/m) T² below.
      const double speed = scene.load / scene.mass * landing;
      const double angle =
          std::numbers::pi - std::atan(speed * std::sqrt(scene.mass * *scene.penalty) / scene.load);
      const double on_spring = 2.0 * angle * std::sqrt(scene.mass / *scene.penalty);
      const double below = 0.5 * scene.load / scene.mass * on_spring * on_spring;
      EXPECT_NEAR(gap, height - below, 0.02 * below);
    } else {
      EXPECT_NEAR(gap, 0.0, 1e-12);
      EXPECT_NEAR(simulation.contact_force(0), scene.load, 1e-9 * scene.load);
    }
  }
}

// A mass on a spring, carried by a belt: sticks, slips and sticks again as on a line in a plane.
TEST(SpaceSimulation, StickSlipIsThatOfThePlanarContact) {
  const auto largest_difference = [](double step) {
    MassOnPlane scene;
    scene.stiffness = 200.0;
    scene.belt = 0.1;
    scene.friction = 0.3;
    scene.static_friction = 0.5;
    MassOnPlane planar = scene;
    planar.is_planar = true;
    const System in_space = scene.system(), on_line = planar.system();
    Simulation a(in_space, steps_of(step)), b(on_line, steps_of(step));
    double largest = 0.0;
    bool has_stuck = false, has_slipped = false;
    while (a.time() < 1.5) {
      EXPECT_EQ(a.step(), StepOutcome::done) << a.failure();
      EXPECT_EQ(b.step(), StepOutcome::done) << b.failure();
      largest = std::max(largest, (place_of(a, in_space) - place_of(b, on_line)).norm());
      has_stuck = has_stuck || a.contact_state(0) == ContactState::stick;
      has_slipped = has_slipped || (has_stuck && a.contact_state(0) == ContactState::slip);
    }
    EXPECT_TRUE(has_stuck && has_slipped);
    // The planar contact has friction against the sliding of the slave positive.
    EXPECT_NEAR(a.friction_force(0), -b.friction_force(0), 1e-2 * scene.load);
    return largest;
  };
  // Both begin to slip or stick at a whole step: they differ by some steps of motion with the belt.
  const double coarse = largest_difference(1e-3);
  const double fine = largest_difference(2.5e-4);
  EXPECT_LT(coarse, 20.0 * 1e-3 * 0.1);
  EXPECT_LT(fine, 20.0 * 2.5e-4 * 0.1);
}

// On a circle, with equal springs, friction turns with the velocity and takes μ N |v|; the ledger
// balances to rounding.
TEST(SpaceSimulation, FrictionTurnsWithTheVelocityAndEnergyBalances) {
  MassOnPlane scene;
  scene.stiffness = 800.0;
  scene.friction = 0.01;
  const double omega = std::sqrt(scene.stiffness / scene.mass);
  constexpr double radius = 0.05, step = 1e-4;
  scene.displacement = {radius, 0.0, 0.0};
  scene.velocity = {0.0, 0.0, radius * omega};
  const System system = scene.system();
  Simulation simulation(system, steps_of(step), Accounts::energy);
  double way = 0.0;
  Eigen::Vector3d last = place_of(simulation, system);
  const double limit = scene.friction * scene.load;
  while (simulation.time() < 1.0) {
    ASSERT_EQ(simulation.step(), StepOutcome::done) << simulation.failure();
    const Eigen::Vector3d now = place_of(simulation, system);
    way += (now - last).norm();
    last = now;
    const Eigen::Vector2d friction(simulation.friction_force(0), simulation.friction_across(0));
    const Eigen::Vector2d sliding = simulation.sliding_velocity(0);
    ASSERT_NEAR(friction.norm(), limit, 1e-9 * limit);
    // Velocity and force belong to instants half a step apart.
    ASSERT_GT(friction.dot(sliding),
              (1.0 - std::pow(2.0 * omega * step, 2)) * limit * sliding.norm());
  }
  const EnergyBalance& balance = simulation.energy()->balance();
  EXPECT_NEAR(balance.friction_loss, limit * way, 1e-3 * limit * way);
  EXPECT_LT(simulation.energy()->relative_error(), 1e-11);
  // A circle of which the radius shrinks slowly: its energy k r² falls by the loss.
  EXPECT_NEAR(scene.stiffness * (radius * radius - last.squaredNorm()), limit * way,
              0.05 * limit * way);
}

TEST(SpaceSimulation, ResumesBitIdentically) {
  MassOnPlane scene;
  scene.stiffness = 200.0;
  scene.belt = 0.1;
  scene.velocity = {0.0, 0.0, 0.2};
  const System system = scene.system();
  for (const auto integrator : {Integrator::exact, Integrator::central_difference}) {
    const TimeParameters time = steps_of(1e-3, integrator);
    Simulation straight(system, time,
                        integrator == Integrator::exact ? Accounts::none : Accounts::energy);
    ASSERT_EQ(straight.step_until(333), StepOutcome::done) << straight.failure();
    const State state = straight.save();
    Simulation resumed(system, time,
                       integrator == Integrator::exact ? Accounts::none : Accounts::energy);
    resumed.load(state);
    ASSERT_EQ(straight.step_until(1200), StepOutcome::done);
    ASSERT_EQ(resumed.step_until(1200), StepOutcome::done);
    EXPECT_EQ(place_of(straight, system), place_of(resumed, system));
    EXPECT_EQ(straight.contact_force(0), resumed.contact_force(0));
    EXPECT_EQ(straight.sliding_velocity(0), resumed.sliding_velocity(0));
  }
}

// δ(N λ + μ(|v|) λ F v/|v|) by differences, with v = v(y) − Tᵀ ẏ.
TEST(SpaceLinearisation, ForcesChangeAsTheDerivativesSay) {
  FacetSurface surface;
  surface.positions = {{0, 0, 0}, {0.1, 0.05, 1}, {1, 0.02, 1.2}, {1.1, 0.15, 0}};
  surface.facets = {{4, {0, 1, 2, 3}}};
  connect_facets(surface, SurfaceKind::polyline);
  SpacePlace place;
  place.surface = 0;
  place.slave = {0.45, 0.2, 0.65};
  constexpr double drawn = 0.7;
  const FrictionLaw law = constant_friction(0.35);
  const auto kinematics = [&](const TangentPorts& y) {
    const SpaceInstant instant = space_instant(place, &surface, 0, 0.0, y, drawn);
    return tangent_kinematics(instant, closest_on(instant.deformed, instant.slave, {0.4, 0.4}),
                              y.size());
  };
  const auto force = [&](const TangentPorts& y, const TangentPorts& rate) -> TangentPorts {
    const TangentKinematics at = kinematics(y);
    const Eigen::Vector2d v = at.velocity - at.sliding.transpose() * rate;
    return at.normal + 0.35 * (at.friction * v.normalized());
  };
  std::mt19937 random(3);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  TangentPorts y(15);
  for (double& port : y) port = 0.05 * unit(random);
  const TangentPorts rest = TangentPorts::Zero(15);
  const ContactLinearisation local = linearise_face(kinematics(y), 15, law, 1.0);
  EXPECT_LT((local.force_row + force(y, rest)).norm(), 1e-14);
  constexpr double h = 1e-5;
  for (Eigen::Index k = 0; k < 15; ++k) {
    TangentPorts step = rest;
    step[k] = h;
    // force_row is on the left-hand side: −(N + μ F d).
    const TangentPorts by_position = -(force(y + step, rest) - force(y - step, rest)) / (2.0 * h);
    const TangentPorts by_velocity = -(force(y, step) - force(y, -step)) / (2.0 * h);
    EXPECT_LT((by_position - local.force_by_position.col(k)).norm(), 1e-8) << k;
    EXPECT_LT((by_velocity - local.force_by_velocity.col(k)).norm(), 1e-8) << k;
  }
}

}  // namespace
}  // namespace stridor
