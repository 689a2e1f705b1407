// Simulations whose contacts stick, slip and lift off: film, and on_violation: unilateral.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/errors.hpp"
#include "coupling/laws/static_dynamic_friction.hpp"
#include "coupling/laws/stribeck_friction.hpp"
#include "solvers/transient/simulation.hpp"
#include "tests/support/constants.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/paper_model.hpp"
#include "tests/support/pressed_beams.hpp"
#include "tests/support/small_systems.hpp"
#include "tests/support/static_contact.hpp"

namespace stridor {
namespace {

using namespace test;

using ::testing::HasSubstr;

using test::eps;
constexpr Coordinates all_forms[] = {Coordinates::modal, Coordinates::craig_bampton,
                                     Coordinates::craig_bampton_fused};

/// A mass that a belt with static and dynamic friction takes along: it sticks until 0.04 m, then
/// swings back.
MassOnGround belt_scene() {
  MassOnGround scene;
  scene.belt_velocity = 0.1;
  scene.friction = static_dynamic_friction(0.4, 0.3);
  return scene;
}

TEST(UnilateralContact, CarriesTheLoadOnRigidGroundInEveryForm) {
  for (const Coordinates form : all_forms) {
    MassOnGround scene;
    scene.load = 7.5;
    scene.friction = constant_friction(0.3);
    Simulation simulation(scene.system(), time_of(1e-3, form));
    for (int n = 0; n < 100; ++n) {
      // A few roundings of 7.5, though the body it stands on has no degree of freedom.
      EXPECT_NEAR(simulation.contact_force(0), 7.5, 64.0 * eps);
      EXPECT_EQ(simulation.friction_force(0), 0.0);
      EXPECT_EQ(simulation.contact_state(0), ContactState::stick);
      EXPECT_NEAR(simulation.contact_place(0).gap, 0.0, 1e-20);
      ASSERT_EQ(simulation.step(), StepOutcome::done) << simulation.failure();
    }
  }
}

TEST(UnilateralContact, HoldsTheSpringUpToTheStaticLimitThenRubs) {
  MassOnGround scene = belt_scene();
  scene.velocity = 0.1;  // it starts with the belt
  Simulation simulation(scene.system(), time_of(1e-4));
  int sticking = 0;
  for (int n = 0; n < 6000; ++n) {
    const double pull = 100.0 * simulation.displacement(0, MassOnGround::x_row);
    if (simulation.contact_state(0) == ContactState::stick) {
      // In steady motion with the belt friction balances the spring, which pulls back (λ_t < 0),
      // to the rounding of an inertia force, eps · 0.04 m · 1 kg/h²; only the first step stops a
      // slip. The slip velocity left is that rounding over h.
      if (n > 0) {
        ++sticking;
        EXPECT_NEAR(simulation.friction_force(0), -pull, 1e-8);
        EXPECT_NEAR(simulation.slip_velocity(0), 0.0, 1e-12);
      }
      EXPECT_LE(std::abs(simulation.friction_force(0)), 0.4 * simulation.contact_force(0));
    } else {
      EXPECT_NEAR(std::abs(simulation.friction_force(0)), 3.0, 1e-14);
      EXPECT_LE(simulation.friction_force(0) * simulation.slip_velocity(0), 0.0 + 3.0 * 0.4);
    }
    ASSERT_EQ(simulation.step(), StepOutcome::done) << simulation.failure();
  }
  // It sticks from 0 to 0.04 m, 0.4 s, slips for 0.471 s and is sticking or slipping by then.
  EXPECT_NEAR(sticking, 4000, 2);
}

TEST(UnilateralContact, StopsForGoodWhereTheStaticLimitHoldsItWhateverTheStep) {
  // From x0 = 0.55 mm the mass swings to −0.35 mm: 2 μ_d N/k = 0.2 mm less. There the spring pulls
  // with 3.5 N, more than the dynamic 1 N and less than the static 5 N. The moment at which a step
  // meets the reversal is arbitrary, so many steps are tried.
  for (int k = 0; k < 40; ++k) {
    MassOnGround scene;
    scene.stiffness = 1e4;
    scene.displacement = 0.55e-3;
    scene.friction = static_dynamic_friction(0.5, 0.1);
    const double step = 1e-5 * (1.0 + 0.025 * k);
    Simulation simulation(scene.system(), time_of(step));
    ASSERT_EQ(simulation.step_until(std::llround(0.1 / step)), StepOutcome::done);
    EXPECT_EQ(simulation.contact_state(0), ContactState::stick) << step;
    // Amplitudes err by (ω h)² and by what one step at the reversal moves, h² k/m.
    EXPECT_NEAR(simulation.displacement(0, MassOnGround::x_row), -0.35e-3, 1e-8) << step;
  }
}

TEST(UnilateralContact, FrictionNeverDrives) {
  // λ_t times the slip of the step it acts in is the energy that friction takes out. The steps are
  // coarse, so that the sliding velocity and with it μ changes much within one.
  const FrictionLaw laws[] = {constant_friction(0.3),
                              static_dynamic_friction(0.5, 0.1),
                              stribeck_friction(0.5, 0.1, 1e-3),
                              stribeck_friction(0.1, 0.5, 1e-3)};
  for (const FrictionLaw& law : laws) {
    for (int k = 0; k < 20; ++k) {
      MassOnGround scene;
      scene.stiffness = 1e4;
      scene.displacement = 3e-3 + 1e-5 * k;
      scene.belt_velocity = 0.02;
      scene.friction = law;
      Simulation simulation(scene.system(), time_of(5e-4));
      int sticking = 0;
      for (int n = 0; n < 2000; ++n) {
        const double force = simulation.friction_force(0);
        ASSERT_EQ(simulation.step(), StepOutcome::done) << simulation.failure();
        // The slip velocity after the step is the slip within it over h.
        EXPECT_GE(force * simulation.slip_velocity(0), -1e-12) << n;
        sticking += simulation.contact_state(0) == ContactState::stick;
      }
      if (law.static_coefficient >= law.dynamic_coefficient) {
        EXPECT_GT(sticking, 20);
      }
    }
  }
}

TEST(UnilateralContact, LiftsOffLandsAndNeverPenetrates) {
  // Pressed with 10 N, lifted with 5 N from 0.1 to 0.15 s, pressed again.
  MassOnGround scene;
  System system = scene.system();
  system.drives[0].load = TimeCurve(TimeTable{{0.099, 0.101, 0.149, 0.151}, {-10.0, 5.0, 5.0, -10.0}});
  Simulation simulation(system, time_of(1e-4));
  std::int64_t open = 0;
  double highest = 0.0;
  for (int n = 0; n < 5000; ++n) {
    if (n == 0) simulation.reset_statistics();
    const bool is_open = simulation.contact_state(0) == ContactState::open;
    open += is_open;
    EXPECT_EQ(simulation.contact_force(0) == 0.0, is_open);
    EXPECT_EQ(simulation.friction_force(0), 0.0);
    EXPECT_GE(simulation.contact_force(0), 0.0);
    const double gap = simulation.contact_place(0).gap;
    EXPECT_GE(gap, -1e-15);
    highest = std::max(highest, gap);
    ASSERT_EQ(simulation.step(), StepOutcome::done) << simulation.failure();
  }
  // 5 m/s² for 0.05 s, then −10 m/s²: it rises for 0.025 s more, to 6.25 mm + 3.125 mm. The ramps
  // of 2 ms move the velocity by 5 % at most.
  EXPECT_NEAR(highest, 9.375e-3, 0.1 * 9.375e-3);
  EXPECT_EQ(simulation.contact_state(0), ContactState::stick);
  const ContactStatistics& statistics = simulation.statistics(0);
  EXPECT_EQ(statistics.steps, 5001);
  EXPECT_EQ(statistics.open, open);
  EXPECT_EQ(statistics.sticking + statistics.open, statistics.steps);
  EXPECT_EQ(statistics.force_min, 0.0);
  EXPECT_EQ(simulation.violations(0).total(), 0);
}

TEST(UnilateralContact, IsBitwiseSubsBWhileItSlides) {
  MassOnGround scene = belt_scene();
  scene.belt_velocity = 10.0;  // the mass never reaches it
  Simulation film(scene.system(), time_of(1e-4));
  scene.assumption = ContactAssumption::subs_b;
  Simulation subs_b(scene.system(), time_of(1e-4));
  for (int n = 0; n < 2000; ++n) {
    EXPECT_EQ(film.contact_state(0), ContactState::slip);
    EXPECT_EQ(film.contact_force(0), subs_b.contact_force(0));
    EXPECT_EQ(film.friction_force(0), subs_b.friction_force(0));
    ASSERT_EQ(film.step(), StepOutcome::done);
    ASSERT_EQ(subs_b.step(), StepOutcome::done);
    EXPECT_EQ(film.displacement(0, 0), subs_b.displacement(0, 0));
  }
}

TEST(UnilateralContact, OnViolationItSticksWhereStopEndsTheRun) {
  // μ N/k (1 − cos ω t) reaches the belt's velocity at sin ω t = 1/3.
  MassOnGround scene = belt_scene();
  scene.friction = constant_friction(0.3);
  scene.assumption = ContactAssumption::subs_b;
  System system = scene.system();
  system.contacts[0].armed_from = 0.01;
  Simulation stopped(system, time_of(1e-4));
  EXPECT_EQ(stopped.step_until(10'000), StepOutcome::sliding_reversed);
  EXPECT_NEAR(stopped.time(), 0.1 * std::asin(1.0 / 3.0), 2e-4);
  EXPECT_THAT(stopped.failure(), HasSubstr("against the drive: real bodies would stick"));
  EXPECT_THAT(stopped.failure(), HasSubstr("contact.on_violation: unilateral"));

  system.contacts[0].on_violation = OnViolation::unilateral;
  Simulation unilateral(system, time_of(1e-4));
  system.contacts[0].assumption = ContactAssumption::film;
  Simulation film(system, time_of(1e-4));
  for (int n = 0; n < 10'000; ++n) {
    ASSERT_EQ(unilateral.step(), StepOutcome::done) << unilateral.failure();
    ASSERT_EQ(film.step(), StepOutcome::done);
    ASSERT_EQ(unilateral.displacement(0, 0), film.displacement(0, 0)) << n;
  }
  EXPECT_EQ(unilateral.violations(0).reversed_sliding, unilateral.statistics(0).sticking);
  EXPECT_GT(unilateral.statistics(0).sticking, 1000);
  EXPECT_EQ(unilateral.violations(0).before_armed, 0);
  EXPECT_EQ(unilateral.violations(0).negative_force, 0);
  EXPECT_GT(film.statistics(0).sticking, 1000);
  EXPECT_EQ(film.violations(0).total(), 0);
}

TEST(UnilateralContact, BeforeItIsArmedItStaysBilateral) {
  MassOnGround scene;
  scene.assumption = ContactAssumption::subs_b;
  System system = scene.system();
  system.drives[0].load = TimeCurve(TimeTable{{0.05, 0.06}, {-10.0, 5.0}});
  system.contacts[0].armed_from = 0.1;
  system.contacts[0].on_violation = OnViolation::unilateral;
  Simulation simulation(system, time_of(1e-4));
  ASSERT_EQ(simulation.step_until(999), StepOutcome::done);
  EXPECT_NEAR(simulation.contact_force(0), -5.0, 1e-10);
  const std::int64_t tolerated = simulation.violations(0).negative_force;
  EXPECT_GT(tolerated, 400);
  EXPECT_EQ(simulation.violations(0).before_armed, tolerated);
  ASSERT_EQ(simulation.step_until(2000), StepOutcome::done);
  EXPECT_EQ(simulation.contact_state(0), ContactState::open);
  EXPECT_GT(simulation.contact_place(0).gap, 0.01);
  EXPECT_EQ(simulation.violations(0).before_armed, tolerated);
  EXPECT_EQ(simulation.violations(0).negative_force, tolerated + 1001);
  EXPECT_EQ(simulation.violations(0).last_time, simulation.time());
}

TEST(UnilateralContact, NodesOfAStraightMasterDoNotDisturbIt) {
  // 0.7 mm apart they lie under the mass some 150 times.
  const auto run = [](bool has_nodes) {
    System system = belt_scene().system();
    if (has_nodes) {
      MasterSurface& surface = system.surfaces[0];
      surface = rigid_line(1);
      surface.positions.clear();
      surface.arc_length.clear();
      surface.rows.clear();
      for (int k = 0; k <= 100; ++k) {
        surface.positions.emplace_back(-0.05 + 7e-4 * k, 0.0);
        surface.arc_length.push_back(7e-4 * k);
        surface.rows.push_back({0, 0});
      }
      system.contacts[0].first_segment = 71;
    }
    Simulation simulation(system, time_of(1e-3));
    std::vector<double> motion;
    for (int n = 0; n < 1500; ++n) {
      EXPECT_EQ(simulation.step(), StepOutcome::done) << simulation.failure();
      motion.push_back(simulation.displacement(0, MassOnGround::x_row));
    }
    return motion;
  };
  const std::vector<double> plain = run(false);
  const std::vector<double> noded = run(true);
  // Rounding of the place on the master, eps · 0.15 m, is the slip of one step; it grows little in
  // two cycles of a motion that friction damps.
  for (std::size_t n = 0; n < plain.size(); ++n) ASSERT_NEAR(noded[n], plain[n], 1e-13) << n;
}

TEST(UnilateralContact, AFrozenDriveSlidesTheMasterAwayBelow) {
  System system = belt_scene().system();
  Simulation moving(system, time_of(1e-3));
  system.drives[0].is_frozen = true;
  Simulation frozen(system, time_of(1e-3));
  for (int n = 0; n < 3000; ++n) {
    ASSERT_EQ(moving.step(), StepOutcome::done);
    ASSERT_EQ(frozen.step(), StepOutcome::done);
    // On an endless straight line there is no difference but rounding.
    ASSERT_NEAR(frozen.displacement(0, 0), moving.displacement(0, 0), 1e-12) << n;
    ASSERT_EQ(frozen.contact_state(0), moving.contact_state(0)) << n;
    ASSERT_NEAR(frozen.contact_place(0).position, frozen.displacement(0, 0), 1e-15);
  }
  EXPECT_GT(frozen.statistics(0).sticking, 1000);
}

/// The belt scene on a plank that tilts and bobs on springs at its ends, which start at the given
/// heights (m).
System bobbing_plank(double left, double right) {
  System system = belt_scene().system();
  SystemBody plank;
  plank.name = "plank";
  plank.reduced.mass = 10.0 * Eigen::Matrix2d::Identity();
  plank.reduced.stiffness = 4e4 * Eigen::Matrix2d::Identity();
  plank.reduced.rows = Eigen::MatrixXd::Zero(3, 2);  // x is held, y of either end
  plank.reduced.rows(1, 0) = plank.reduced.rows(2, 1) = 1.0;
  plank.initial_displacement = Eigen::Vector2d(left, right);
  plank.modal = make_modal(plank.reduced);
  system.bodies[1] = plank;
  MasterSurface& surface = system.surfaces[0];
  surface.rows = {{0, 1}, {0, 2}};
  surface.positions = {{-0.5, 0.0}, {0.5, 0.0}};
  return system;
}

TEST(UnilateralContact, FrozenSlipDoesNotDependOnHowFarTheDriveHasCome) {
  // A pulse of the drive's velocity in the first millisecond stands for 10 m that it came before.
  // Friction is the same for any speed, so the motion must be the same.
  System system = bobbing_plank(-0.03, 0.03);
  system.drives[0].is_frozen = true;
  Simulation fresh(system, time_of(1e-4));
  system.drives[0].velocity = TimeCurve(TimeTable{{0.0, 1e-3}, {-2e4, -0.1}});
  Simulation seasoned(system, time_of(1e-4));
  for (int n = 0; n < 5000; ++n) {
    ASSERT_EQ(fresh.step(), StepOutcome::done) << fresh.failure();
    ASSERT_EQ(seasoned.step(), StepOutcome::done) << seasoned.failure();
    ASSERT_NEAR(seasoned.displacement(0, 0), fresh.displacement(0, 0), 1e-12) << n;
  }
  EXPECT_GT(fresh.statistics(0).sticking, 100);
}

TEST(UnilateralContact, ModalAndDenseFormsAgreeInStickAndSlip) {
  // The start-up of the trailing scene, in which the tip bounces, then sticks and slips. The forms
  // differ by rounding, about 1e-9 after 4000 steps of sliding (Simulation); every landing and
  // every change between stick and slip magnifies it. The forces of landings feel it most.
  ModelParameters parameters = paper_model(trailing_angle, ContactAssumption::film);
  parameters.drive->ramp = 1e-3;
  const Model model = make_paper_model(parameters);
  const Model::Point tip = model.points.at(free_end);
  Simulation modal(model.system, paper_time(2e-7, Coordinates::modal));
  Simulation dense(model.system, paper_time(2e-7, Coordinates::craig_bampton_fused));
  double largest_force = 0.0;
  double force_difference = 0.0;
  double largest_displacement = 0.0;
  double displacement_difference = 0.0;
  for (int n = 0; n < 9500; ++n) {
    ASSERT_EQ(modal.step(), StepOutcome::done) << modal.failure();
    ASSERT_EQ(dense.step(), StepOutcome::done) << dense.failure();
    const double force = modal.contact_force(0);
    const double displacement = modal.displacement(tip.body, tip.rows.y);
    largest_force = std::max(largest_force, force);
    force_difference = std::max(force_difference, std::abs(dense.contact_force(0) - force));
    largest_displacement = std::max(largest_displacement, std::abs(displacement));
    displacement_difference = std::max(
        displacement_difference, std::abs(dense.displacement(tip.body, tip.rows.y) - displacement));
  }
  EXPECT_LT(force_difference, 1e-4 * largest_force);
  EXPECT_LT(displacement_difference, 1e-6 * largest_displacement);
  EXPECT_GT(modal.statistics(0).open, 1000);
  EXPECT_GT(modal.statistics(0).sticking, 100);
  EXPECT_EQ(modal.statistics(0).sticking, dense.statistics(0).sticking);
}

/// Saves at `stop`, goes on from there in another simulation and compares every number at `end`.
void expect_bitwise_resume(const System& system, const TimeParameters& time, std::int64_t stop,
                           std::int64_t end) {
  Simulation straight(system, time);
  ASSERT_EQ(straight.step_until(stop), StepOutcome::done) << straight.failure();
  const State state = straight.save();
  Simulation resumed(system, time);
  resumed.load(state);
  EXPECT_EQ(resumed.save(), state);
  EXPECT_EQ(resumed.contact_state(0), straight.contact_state(0));
  EXPECT_EQ(resumed.friction_force(0), straight.friction_force(0));
  ASSERT_EQ(straight.step_until(end), StepOutcome::done) << straight.failure();
  ASSERT_EQ(resumed.step_until(end), StepOutcome::done) << resumed.failure();
  EXPECT_EQ(resumed.save(), straight.save());
}

TEST(UnilateralContact, ResumesBitwiseInTheMiddleOfStick) {
  for (const Coordinates form : all_forms) {
    const System system = belt_scene().system();
    Simulation probe(system, time_of(1e-3, form));
    ASSERT_EQ(probe.step_until(200), StepOutcome::done);
    ASSERT_EQ(probe.contact_state(0), ContactState::stick);
    expect_bitwise_resume(system, time_of(1e-3, form), 200, 1500);
  }
}

TEST(UnilateralContact, ResumesBitwiseInStickSlipAndFlightAndFrozen) {
  const System plank = bobbing_plank(-0.02, 0.01);  // the mass starts above it
  System frozen = plank;
  frozen.drives[0].is_frozen = true;
  for (const System& system : {plank, frozen}) {
    Simulation probe(system, time_of(1e-4));
    bool has_been[3] = {false, false, false};
    for (int n = 0; n < 3000; ++n) {
      ASSERT_EQ(probe.step(), StepOutcome::done) << probe.failure();
      bool& seen = has_been[static_cast<int>(probe.contact_state(0))];
      if (!seen) expect_bitwise_resume(system, time_of(1e-4), probe.step_index(), 4000);
      seen = true;
    }
    for (const ContactState state : {ContactState::open, ContactState::stick, ContactState::slip})
      EXPECT_TRUE(has_been[static_cast<int>(state)]) << static_cast<int>(state);
  }
}

TEST(UnilateralContact, ResumesBitwiseWithManyPoints) {
  // The guess of the iteration is part of the state.
  const Model model = make_model(pressed_beams(0.3, ContactAssumption::film), {});
  expect_bitwise_resume(model.system, time_of(pressed_beams_step), 100, 200);
}

TEST(UnilateralContact, StartUpOfThePaperSceneResumesBitwise) {
  ModelParameters parameters = paper_model(trailing_angle, ContactAssumption::film);
  parameters.drive->ramp = 1e-3;
  const Model model = make_paper_model(parameters);
  Simulation probe(model.system, paper_time());
  while (probe.contact_state(0) != ContactState::stick && probe.step_index() < 10'000)
    ASSERT_EQ(probe.step(), StepOutcome::done) << probe.failure();
  ASSERT_EQ(probe.contact_state(0), ContactState::stick);
  expect_bitwise_resume(model.system, paper_time(), probe.step_index(), probe.step_index() + 2000);
}

TEST(UnilateralContact, APressedEdgeSettlesOnTheLinearComplementarityProblem) {
  for (const ContactAssumption assumption : {ContactAssumption::subs_a, ContactAssumption::film}) {
    for (const double friction : {0.0, 0.3}) {
      const Model model = make_model(pressed_beams(friction, assumption), {});
      ASSERT_EQ(model.system.contacts.size(), 21u);
      const StaticContact expected = static_contact(model.system, pressed_beams_load);
      ASSERT_TRUE(expected.is_solution);
      EXPECT_GT(expected.num_closed(), 10);
      EXPECT_LT(expected.num_closed(), 18);
      Simulation simulation(model.system, time_of(pressed_beams_step));
      ASSERT_EQ(simulation.step_until(pressed_beams_rest), StepOutcome::done)
          << simulation.failure();
      const double largest = expected.force.maxCoeff();
      for (int i = 0; i < 21; ++i) {
        EXPECT_NEAR(simulation.contact_force(i), expected.force(i), 1e-6 * largest) << i;
        EXPECT_EQ(simulation.contact_state(i),
                  expected.force(i) > 0.0 ? ContactState::slip : ContactState::open);
        EXPECT_NEAR(simulation.friction_force(i), friction * expected.force(i), 1e-6 * largest);
      }
    }
  }
}

TEST(UnilateralContact, TheOrderOfThePointsDoesNotMatter) {
  Model model = make_model(pressed_beams(0.3, ContactAssumption::film), {});
  Simulation given(model.system, time_of(pressed_beams_step));
  std::reverse(model.system.contacts.begin(), model.system.contacts.end());
  Simulation reversed(model.system, time_of(pressed_beams_step));
  double largest = 0.0;
  double difference = 0.0;
  for (int n = 0; n < 300; ++n) {
    ASSERT_EQ(given.step(), StepOutcome::done);
    ASSERT_EQ(reversed.step(), StepOutcome::done);
    for (int i = 0; i < 21; ++i) {
      largest = std::max(largest, given.contact_force(i));
      difference =
          std::max(difference, std::abs(given.contact_force(i) - reversed.contact_force(20 - i)));
    }
  }
  // The sweeps end at 1e-12 of the largest force. What they leave in the motion returns as force
  // times 1/W, so 300 steps of that are allowed.
  EXPECT_LT(difference, 300e-12 * largest);
}

TEST(UnilateralContact, SweepsThatDoNotSufficeEndTheRunWithPlaceAndRemedy) {
  const Model model = make_model(pressed_beams(0.3, ContactAssumption::film), {});
  TimeParameters time = time_of(pressed_beams_step);
  time.contact_sweeps = 2;
  std::string message;
  try {
    Simulation simulation(model.system, time);
    EXPECT_EQ(simulation.step_until(1000), StepOutcome::not_converged);
    message = simulation.failure();
  } catch (const NumericalError& error) {  // the start itself is a step
    message = error.what();
  }
  EXPECT_THAT(message, HasSubstr("contact["));
  EXPECT_THAT(message, HasSubstr("the contact forces have not settled in the sweeps allowed"));
  EXPECT_THAT(message, HasSubstr("let time.contact_sweeps be larger"));
}

TEST(UnilateralContact, ALoadThatIsNoNumberIsDivergence) {
  for (const ContactAssumption assumption : {ContactAssumption::film, ContactAssumption::subs_b}) {
    MassOnGround scene;
    scene.assumption = assumption;
    for (const double load : {1e31, std::numeric_limits<double>::quiet_NaN()}) {
      scene.load = load;
      const std::string message = message_of<NumericalError>(
          [&] { const Simulation simulation(scene.system(), time_of(1e-3)); });
      EXPECT_THAT(message, HasSubstr(std::isnan(load) ? "nan N" : "1e+31 N"));
      EXPECT_THAT(message, HasSubstr("the computation has diverged"));
    }
  }
}

TEST(UnilateralContact, TheFirstStepKnowsTheVelocityOfTheSlavePoint) {
  // Whichever rows of the body belong to it.
  for (const bool is_x_first : {true, false}) {
    for (const Coordinates form : all_forms) {
      MassOnGround scene;
      scene.velocity = -0.5;
      scene.friction = constant_friction(0.1);
      scene.assumption = ContactAssumption::subs_b;
      System system = scene.system();
      if (!is_x_first) {
        SystemBody& body = system.bodies[0];
        body.reduced.rows = Eigen::Matrix2d{{0.0, 1.0}, {1.0, 0.0}};
        body.modal = make_modal(body.reduced);
        body.loads = {BodyLoad{0}};
        system.contacts[0].slave_rows = {1, 0};
      }
      const Simulation simulation(system, time_of(1e-3, form));
      EXPECT_NEAR(simulation.slip_velocity(0), -0.5, 4.0 * eps);
      // λ_t opposes +t: against backward sliding it is negative.
      EXPECT_NEAR(simulation.friction_force(0), -1.0, 1e-13);
    }
  }
}

}  // namespace
}  // namespace stridor
