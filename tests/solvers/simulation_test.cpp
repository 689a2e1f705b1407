#include "solvers/transient/simulation.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>

#include "core/errors.hpp"
#include "solvers/integrators/make_propagator.hpp"
#include "solvers/integrators/retained_modes.hpp"
#include "substructures/bodies/beam.hpp"
#include "tests/support/paper_model.hpp"
#include "tests/support/relative_difference.hpp"

namespace stridor {
namespace {

using namespace test;

using ::testing::HasSubstr;

constexpr double paper_step = 2.0e-7;

TEST(Simulation, ModalAndDenseFormsAgreeOver4000Steps) {
  // The forms differ by rounding only; 1e-9 leaves room for its growth over the steps.
  for (const auto assumption :
       {ContactAssumption::subs_a, ContactAssumption::subs_b, ContactAssumption::subs_c}) {
    ModelParameters parameters = paper_model(trailing_angle, assumption);
    parameters.drive->ramp = 1e-3;
    parameters.contact->armed_from = 1.0;
    const Model model = make_paper_model(parameters);
    const Model::Point tip = model.points.at(free_end);
    Simulation modal(model.system, paper_time(paper_step, Coordinates::modal));
    Simulation published(model.system, paper_time(paper_step, Coordinates::craig_bampton));
    Simulation fused(model.system, paper_time(paper_step, Coordinates::craig_bampton_fused));
    double largest_force = 0.0;
    double largest_displacement = 0.0;
    double force_difference = 0.0;
    double displacement_difference = 0.0;
    for (int n = 0; n < 4000; ++n) {
      ASSERT_EQ(modal.step(), StepOutcome::done);
      ASSERT_EQ(published.step(), StepOutcome::done);
      ASSERT_EQ(fused.step(), StepOutcome::done);
      const double force = modal.contact_force(0);
      const double displacement = modal.displacement(tip.body, tip.rows.y);
      largest_force = std::max(largest_force, std::abs(force));
      largest_displacement = std::max(largest_displacement, std::abs(displacement));
      for (const Simulation* dense : {&published, &fused}) {
        force_difference = std::max(force_difference, std::abs(dense->contact_force(0) - force));
        displacement_difference =
            std::max(displacement_difference,
                     std::abs(dense->displacement(tip.body, tip.rows.y) - displacement));
      }
    }
    EXPECT_LT(force_difference, 1e-9 * largest_force);
    EXPECT_LT(displacement_difference, 1e-9 * largest_displacement);
  }
}

TEST(Simulation, TooLargeAStepIsRefusedNamingBothValuesAndTheBody) {
  const Model model = make_paper_model(paper_model());
  try {
    const Simulation simulation(model.system, paper_time(3.0e-7));
    FAIL() << "not refused";
  } catch (const ConfigError& error) {
    EXPECT_EQ(error.problems().at(0).key, "time.step");
    EXPECT_THAT(error.what(), HasSubstr("3e-07 s is above the largest stable step 2.9162e-07 s"));
    EXPECT_THAT(error.what(), HasSubstr("'cantilever'"));
  }
}

TEST(Simulation, StepJustBelowTheLimitStaysBounded) {
  const Model model = make_paper_model(paper_model());
  Simulation simulation(model.system, paper_time(0.999 * step_limit(model.system).step));
  ASSERT_EQ(simulation.step_until(100'000), StepOutcome::done) << simulation.failure();
  // The load has reached smoothstep(0.29) of 0.2 N by then.
  EXPECT_NEAR(simulation.contact_force(0), 0.2 * TimeCurve::ramp(1.0, 0.1).value(simulation.time()),
              2e-3);
}

/// Runs straight to `end` and by way of a saved state, and compares every number of both ends.
void expect_same_after_resume(const ModelParameters& parameters, const TimeParameters& time,
                              std::int64_t stop, std::int64_t end) {
  const Model model = make_paper_model(parameters);
  Simulation straight(model.system, time);
  ASSERT_EQ(straight.step_until(stop), StepOutcome::done) << straight.failure();
  const State state = straight.save();
  Simulation resumed(model.system, time);
  resumed.load(state);
  EXPECT_EQ(resumed.save(), state);
  ASSERT_EQ(straight.step_until(end), StepOutcome::done) << straight.failure();
  ASSERT_EQ(resumed.step_until(end), StepOutcome::done) << resumed.failure();
  EXPECT_EQ(resumed.save(), straight.save());
  EXPECT_EQ(resumed.time(), straight.time());
}

TEST(Simulation, SaveLoadAndGoOnIsBitwiseTheUninterruptedRun) {
  // In the ramp, and in every form.
  for (const auto coordinates :
       {Coordinates::modal, Coordinates::craig_bampton, Coordinates::craig_bampton_fused}) {
    expect_same_after_resume(paper_model(), paper_time(paper_step, coordinates), 1500, 3000);
  }
}

TEST(Simulation, ResumesBitwiseInTheMiddleOfTheDampingSchedule) {
  ModelParameters parameters = paper_model(leading_angle);
  parameters.drive->ramp = 1e-3;
  parameters.contact->armed_from = 1.0;
  auto& oblique = parameters.substructures["oblique"].get<BeamParameters>();
  oblique.damping.hold = 2e-3;
  oblique.damping.fade = 2e-3;
  expect_same_after_resume(parameters, paper_time(), 15'000,
                           25'000);  // 3 ms of a fade from 2 to 4 ms
}

TEST(Simulation, ResumesBitwiseAcrossTheNodesOfTheMaster) {
  // 10 m/s passes a node every 500 steps.
  for (const auto assumption :
       {ContactAssumption::subs_a, ContactAssumption::subs_b, ContactAssumption::subs_c}) {
    ModelParameters parameters = paper_model(leading_angle, assumption);
    parameters.drive->velocity = TimeCurve(10.0);
    parameters.drive->ramp = 5e-4;
    parameters.contact->armed_from = 1.0;
    expect_same_after_resume(parameters, paper_time(), 6000, 9000);
  }
}

TEST(Simulation, ABodyThatRunsAwayOutsideAnyContactIsAnOutcomeWithItsName) {
  // With FiLM a position that is no number closes no contact, so that no contact force tells of it.
  const Model model = make_paper_model(paper_model(leading_angle, ContactAssumption::film));
  Simulation simulation(model.system, paper_time());
  ASSERT_EQ(simulation.step_until(10), StepOutcome::done);
  State state = simulation.save();
  std::vector<double> position = state.array("bodies/1/position");
  position.back() = std::nan("");
  state.put("bodies/1/position", position);
  simulation.load(state);
  EXPECT_EQ(simulation.step_until(3000), StepOutcome::diverged);
  EXPECT_THAT(simulation.failure(), HasSubstr("at t = "));
  EXPECT_THAT(simulation.failure(), HasSubstr("the computation has diverged. Remedy"));
}

TEST(Simulation, RefusesAStateOfAnotherStep) {
  const Model model = make_paper_model(paper_model());
  Simulation simulation(model.system, paper_time(2e-7));
  const State state = Simulation(model.system, paper_time(1e-7)).save();
  EXPECT_THROW(simulation.load(state), std::invalid_argument);
}

TEST(Simulation, SameSystemGivesBitwiseTheSameRun) {
  const Model model = make_paper_model(paper_model());
  Simulation first(model.system, paper_time());
  Simulation second(make_paper_model(paper_model()).system, paper_time());
  ASSERT_EQ(first.step_until(5000), StepOutcome::done);
  ASSERT_EQ(second.step_until(5000), StepOutcome::done);
  EXPECT_EQ(first.save(), second.save());
}

TEST(Simulation, ClosesTheGapOfSubsBInEveryStep) {
  ModelParameters parameters = paper_model(leading_angle);
  parameters.drive->velocity = TimeCurve(10.0);
  parameters.drive->ramp = 1e-3;
  parameters.contact->armed_from = 1.0;
  const Model model = make_paper_model(parameters);
  Simulation simulation(model.system, paper_time());
  for (int n = 0; n < 10'000; ++n) {
    const double before = simulation.contact_place(0).position;
    ASSERT_EQ(simulation.step(), StepOutcome::done) << simulation.failure();
    const ContactPlace place = simulation.contact_place(0);
    // Within a segment only rounding is left. Where the point has just moved on, the gap is seen
    // along the next segment: kink (below 5e-3 here) times way per step (2e-6 m).
    EXPECT_LT(std::abs(place.gap), 1e-8);
    EXPECT_GE(place.position - before, -1e-7);
  }
  // The guided end has come 15 mm; the tip lags by what its inertia bends the beam.
  EXPECT_GT(simulation.contact_place(0).position, 0.040);
}

/// A short upper beam that lies flat on the cantilever with two points.
ModelParameters two_point_model(double friction) {
  ModelParameters parameters = paper_model();
  BeamParameters upper = paper_oblique(0.0);
  upper.length = 0.030;
  upper.mesh.along = 15;
  upper.damping.alpha = 500.0;
  upper.damping.alpha_start.reset();
  upper.damping.hold = upper.damping.fade = 0.0;
  BeamParameters lower = paper_cantilever();
  lower.damping.alpha = 500.0;
  parameters.substructures["oblique"] = upper;
  parameters.substructures["cantilever"] = lower;
  parameters.contact->slave = {"oblique.start_bottom", "oblique.end_bottom"};
  parameters.contact->assumption = ContactAssumption::subs_a;
  parameters.contact->sliding = SlidingMode::frozen;
  parameters.contact->friction->numbers["coefficient"] = friction;
  parameters.contact->armed_from = 1e9;
  parameters.drive->ramp = 1e-3;
  return parameters;
}

TEST(Simulation, SeveralContactsSettleOnTheSolutionOfTheStaticSaddlePointProblem) {
  ModelParameters parameters = two_point_model(0.2);
  const Model model = make_paper_model(parameters);
  const System& system = model.system;
  ASSERT_EQ(system.contacts.size(), 2u);

  // K q + B_Eᵀ λ = f, B_C (X + rows q) = 0 with the rows of the undeformed geometry, written out
  // densely.
  const Eigen::Index n0 = system.bodies[0].reduced.size();
  const Eigen::Index n1 = system.bodies[1].reduced.size();
  const Eigen::Index n = n0 + n1;
  Eigen::MatrixXd saddle = Eigen::MatrixXd::Zero(n + 2, n + 2);
  Eigen::VectorXd right = Eigen::VectorXd::Zero(n + 2);
  saddle.topLeftCorner(n0, n0) = system.bodies[0].reduced.stiffness;
  saddle.block(n0, n0, n1, n1) = system.bodies[1].reduced.stiffness;
  const auto offset = [&](int body) { return body == 0 ? Eigen::Index{0} : n0; };
  for (std::size_t b = 0; b < 2; ++b) {
    const SystemBody& body = system.bodies[b];
    if (!body.follows_drive()) continue;
    right.segment(offset(static_cast<int>(b)), body.reduced.size()) =
        -0.2 * body.reduced.rows.row(body.loads.front().row).transpose();
  }
  for (int i = 0; i < 2; ++i) {
    const ContactPoint& contact = system.contacts[static_cast<std::size_t>(i)];
    const MasterSurface& surface = system.surfaces[static_cast<std::size_t>(contact.surface)];
    const Segment segment = surface.undeformed_segment(contact.first_segment);
    const Projection projection = project(segment, contact.slave_position);
    const ContactRows rows = make_rows(projection, 0.2, 1.0);
    const auto add = [&](int body, int row, double compatibility, double equilibrium) {
      const auto entry = system.bodies[static_cast<std::size_t>(body)].reduced.rows.row(row);
      saddle.block(n + i, offset(body), 1, entry.size()) += compatibility * entry;
      saddle.block(offset(body), n + i, entry.size(), 1) += equilibrium * entry.transpose();
    };
    const auto s = static_cast<std::size_t>(contact.first_segment);
    const PointRows points[] = {contact.slave_rows, surface.rows[s], surface.rows[s + 1]};
    const int bodies[] = {contact.slave_body, surface.body, surface.body};
    const double c[] = {rows.compatibility.slave[0],  rows.compatibility.slave[1],
                        rows.compatibility.master[0], rows.compatibility.master[1],
                        rows.compatibility.master[2], rows.compatibility.master[3]};
    const double e[] = {rows.equilibrium.slave[0],  rows.equilibrium.slave[1],
                        rows.equilibrium.master[0], rows.equilibrium.master[1],
                        rows.equilibrium.master[2], rows.equilibrium.master[3]};
    for (std::size_t k = 0; k < 3; ++k) {
      add(bodies[k], points[k].x, c[2 * k], e[2 * k]);
      add(bodies[k], points[k].y, c[2 * k + 1], e[2 * k + 1]);
    }
    // A gap left by rounding of the placement.
    right(n + i) = projection.normal.dot(contact.slave_position - segment.first);
  }
  const Eigen::VectorXd solution = saddle.partialPivLu().solve(right);

  Simulation simulation(system, paper_time());
  ASSERT_EQ(simulation.step_until(400'000), StepOutcome::done) << simulation.failure();
  // 80 ms at 250 1/s leave e^-20 of the start; the rest is rounding of the gap over
  // h² B_C M⁻¹ B_Eᵀ, 1e-9 N as above, against forces of 0.1 N.
  EXPECT_NEAR(simulation.contact_force(0), solution(n), 1e-6 * std::abs(solution(n)));
  EXPECT_NEAR(simulation.contact_force(1), solution(n + 1), 1e-6 * std::abs(solution(n + 1)));
}

TEST(Simulation, AnEdgeOfManySlavePointsCarriesTheWholeLoad) {
  ModelParameters parameters = two_point_model(0.1);
  parameters.contact->slave = {"oblique.bottom"};
  parameters.contact->start = 0.060;  // the bottom runs from the end of the beam to its start
  // Fewer and larger elements: with all of its edge in the interface a body is stiff.
  parameters.substructures["oblique"].get<BeamParameters>().mesh.along = 5;
  parameters.substructures["oblique"].get<BeamParameters>().material.youngs_modulus = 2e9;
  const Model model = make_paper_model(parameters);
  ASSERT_EQ(model.system.contacts.size(), 11u);
  Simulation simulation(model.system, paper_time());
  ASSERT_EQ(simulation.step_until(300'000), StepOutcome::done) << simulation.failure();
  double sum = 0.0;
  for (int i = 0; i < simulation.num_contacts(); ++i) sum += simulation.contact_force(i);
  // The normals are vertical, so the forces balance the load of 0.2 N.
  EXPECT_NEAR(sum, 0.2, 1e-6);
}

TEST(Simulation, StaticForceOfSubsBBalancesTheLoadOnTheSaggedMaster) {
  // λ (cos γ − χ μ sin γ) = |F_y|, where γ is the slope of the sagged segment.
  ModelParameters parameters = paper_model(leading_angle);
  parameters.contact->sliding = SlidingMode::frozen;
  parameters.contact->start = 0.0805;
  parameters.contact->armed_from = 1e9;
  parameters.drive->ramp = 0.05;
  for (auto& [name, body] : parameters.substructures) {
    body.get<BeamParameters>().damping.alpha = 400.0;
    body.get<BeamParameters>().damping.alpha_start.reset();
    body.get<BeamParameters>().damping.hold = body.get<BeamParameters>().damping.fade = 0.0;
  }
  const Model model = make_paper_model(parameters);
  Simulation simulation(model.system, paper_time());
  ASSERT_EQ(simulation.step_until(1'000'000), StepOutcome::done) << simulation.failure();
  const MasterSurface& surface = model.system.surfaces[0];
  const int segment = 80;
  const auto deformed = [&](int node) -> Eigen::Vector2d {
    const auto k = static_cast<std::size_t>(node);
    return surface.positions[k] +
           Eigen::Vector2d(simulation.displacement(surface.body, surface.rows[k].x),
                           simulation.displacement(surface.body, surface.rows[k].y));
  };
  const Eigen::Vector2d along = (deformed(segment + 1) - deformed(segment)).normalized();
  const double expected = 0.2 / (along.x() - 0.3 * along.y());
  EXPECT_LT(along.y(), -1e-3);  // it does sag
  EXPECT_NEAR(simulation.contact_force(0), expected, 1e-6 * expected);
}

TEST(Simulation, LeavingTheEndOfTheMasterIsAnOutcomeWithPlaceAndRemedy) {
  ModelParameters parameters = paper_model();
  parameters.contact->start = 0.0995;
  parameters.drive->velocity = TimeCurve(1.0);
  parameters.drive->ramp = 1e-4;
  parameters.contact->armed_from = 1.0;
  const Model model = make_paper_model(parameters);
  Simulation simulation(model.system, paper_time());
  EXPECT_EQ(simulation.step_until(10'000), StepOutcome::master_lost);
  // 0.5 mm at 1 m/s, 50 µs of it lost to the ramp; the tip lags behind the guided end.
  EXPECT_GT(simulation.time(), 5.4e-4);
  EXPECT_LT(simulation.time(), 2e-3);
  EXPECT_THAT(simulation.failure(), HasSubstr("contact at t = 0.00"));
  EXPECT_THAT(simulation.failure(), HasSubstr("position 0.1 m"));
  EXPECT_THAT(simulation.failure(),
              HasSubstr("has left the end of the surface cantilever.top (0.1 m long)"));
  EXPECT_THAT(simulation.failure(), HasSubstr("Remedy: end the run earlier (time.end)"));
}

TEST(Simulation, PullingContactIsCountedUntilArmedAndThenAnOutcome) {
  ModelParameters parameters = paper_model();
  parameters.drive->load = TimeCurve(+0.2);
  parameters.drive->ramp = 1e-3;
  parameters.contact->armed_from = 2e-3;
  const Model model = make_paper_model(parameters);
  Simulation simulation(model.system, paper_time());
  EXPECT_EQ(simulation.step_until(20'000), StepOutcome::pulling);
  EXPECT_NEAR(simulation.time(), 2e-3, 2 * paper_step);
  EXPECT_THAT(simulation.failure(),
              HasSubstr("a bilateral contact pulls where real bodies would part"));
  const ViolationCount& count = simulation.violations(0);
  EXPECT_GT(count.before_armed, 5000);
  EXPECT_EQ(count.total(), count.before_armed + 1);
}

TEST(Simulation, ReversedSlidingIsAnOutcome) {
  // The tip of a beam that is hit by its load at once swings back faster than the drive moves it
  // on.
  ModelParameters parameters = paper_model();
  parameters.drive->velocity = TimeCurve(1e-4);
  parameters.drive->load = TimeCurve(TimeTable{{0.0, 1e-3, 1.1e-3}, {-0.2, -0.2, -2.0}});
  parameters.contact->armed_from = 1.05e-3;
  const Model model = make_paper_model(parameters);
  Simulation simulation(model.system, paper_time());
  EXPECT_EQ(simulation.step_until(300'000), StepOutcome::sliding_reversed);
  EXPECT_GE(simulation.time(), 1.05e-3);
  EXPECT_THAT(simulation.failure(), HasSubstr("against the drive: real bodies would stick"));
}

TEST(Simulation, JammingIsNamed) {
  // B_C W B_Eᵀ = a + μ b with b < 0 for one way of leaning: with enough friction no force closes
  // the gap.
  bool was_jammed = false;
  for (const double angle : {trailing_angle, leading_angle}) {
    ModelParameters parameters = paper_model(angle);
    parameters.contact->friction->numbers["coefficient"] = 50.0;
    parameters.contact->armed_from = 1e9;
    parameters.drive->ramp = 1e-4;
    const Model model = make_paper_model(parameters);
    Simulation simulation(model.system, paper_time());
    const StepOutcome outcome = simulation.step_until(2000);
    if (outcome == StepOutcome::jammed) {
      was_jammed = true;
      EXPECT_THAT(simulation.failure(), HasSubstr("the contact jams"));
    }
  }
  EXPECT_TRUE(was_jammed);
}

TEST(Simulation, StatisticsStartAnewFromThePresentForce) {
  const Model model = make_paper_model(paper_model());
  Simulation simulation(model.system, paper_time());
  ASSERT_EQ(simulation.step_until(2000), StepOutcome::done);
  simulation.reset_statistics();
  EXPECT_EQ(simulation.statistics(0).force_min, simulation.contact_force(0));
  EXPECT_EQ(simulation.statistics(0).force_max, simulation.contact_force(0));
  EXPECT_EQ(simulation.statistics(0).steps, 1);
  double low = simulation.contact_force(0);
  double high = low;
  for (int n = 0; n < 100; ++n) {
    ASSERT_EQ(simulation.step(), StepOutcome::done);
    low = std::min(low, simulation.contact_force(0));
    high = std::max(high, simulation.contact_force(0));
  }
  EXPECT_EQ(simulation.statistics(0).force_min, low);
  EXPECT_EQ(simulation.statistics(0).force_max, high);
  EXPECT_EQ(simulation.statistics(0).steps, 101);
  EXPECT_EQ(simulation.statistics(0).sticking, 0);
}

TEST(Simulation, IntervalsHoldEveryStepOnceWhateverResetsTheStatistics) {
  const Model model = make_paper_model(paper_model());
  Simulation simulation(model.system, paper_time());
  ASSERT_EQ(simulation.step_until(100), StepOutcome::done);
  simulation.end_interval();
  EXPECT_EQ(simulation.interval_statistics(0).steps, 101);  // the start included
  EXPECT_EQ(simulation.statistics(0).steps, 101);
  ContactStatistics expected;
  for (int n = 0; n < 50; ++n) {
    ASSERT_EQ(simulation.step(), StepOutcome::done);
    const double force = simulation.contact_force(0);
    const double friction = simulation.friction_force(0);
    expected.add({force, force, friction, friction, 1, 0, 0});
    if (n == 20) simulation.reset_statistics();
  }
  const State state = simulation.save();
  simulation.end_interval();
  Simulation resumed(model.system, paper_time());
  resumed.load(state);
  resumed.end_interval();
  for (const Simulation* one : {&simulation, &resumed}) {
    EXPECT_EQ(one->interval_statistics(0).steps, 50);
    EXPECT_EQ(one->interval_statistics(0).force_min, expected.force_min);
    EXPECT_EQ(one->interval_statistics(0).force_max, expected.force_max);
    EXPECT_EQ(one->interval_statistics(0).friction_min, expected.friction_min);
    EXPECT_EQ(one->interval_statistics(0).friction_max, expected.friction_max);
    EXPECT_EQ(one->statistics(0).steps, 30);
  }
}

// --- exact propagation and static residual
// --------------------------------------------------------

/// The leading scene, which slides on from the start, with a short ramp.
Model short_ramp_model(ContactAssumption assumption = ContactAssumption::subs_b) {
  ModelParameters parameters = paper_model(leading_angle, assumption);
  parameters.drive->ramp = 1e-2;
  parameters.contact->armed_from = 1.0;
  return make_paper_model(parameters);
}

TimeParameters exact_time(double step, std::optional<double> frequency = {}) {
  TimeParameters time = paper_time(step, Coordinates::modal);
  time.integrator = Integrator::exact;
  if (frequency) time.retain = RetainParameters{*frequency, {}};
  return time;
}

/// Displacements of the free end every 2e-5 s up to 4 ms.
std::vector<double> free_end_motion(const Model& model, const TimeParameters& time) {
  Simulation simulation(model.system, time);
  const Model::Point tip = model.points.at(free_end);
  const std::int64_t stride = std::llround(2e-5 / time.step);
  std::vector<double> motion;
  for (int n = 1; n <= 200; ++n) {
    if (simulation.step_until(n * stride) != StepOutcome::done)
      ADD_FAILURE() << simulation.failure();
    motion.push_back(simulation.displacement(tip.body, tip.rows.y));
  }
  return motion;
}

TEST(ExactSimulation, AndTheCentralDifferenceConvergeToTheSame) {
  // The central difference is of first order: halving its step halves the difference.
  for (const auto assumption : {ContactAssumption::subs_a, ContactAssumption::subs_b,
                                ContactAssumption::subs_c, ContactAssumption::film}) {
    const Model model = short_ramp_model(assumption);
    const std::vector<double> exact = free_end_motion(model, exact_time(1e-7));
    const double coarse =
        relative_difference(free_end_motion(model, paper_time(2e-7, Coordinates::modal)), exact);
    const double fine =
        relative_difference(free_end_motion(model, paper_time(1e-7, Coordinates::modal)), exact);
    EXPECT_LT(coarse, 1e-3);
    EXPECT_GT(coarse / fine, 1.7) << coarse << ", assumption " << static_cast<int>(assumption);
    EXPECT_LT(coarse / fine, 2.3) << coarse << ", assumption " << static_cast<int>(assumption);
  }
}

TEST(ExactSimulation, IsStableAtFiftyTimesTheLimitOfTheCentralDifference) {
  const Model model = short_ramp_model();
  const double step = 50.0 * step_limit(model.system).step;
  for (const auto& time : {exact_time(step), exact_time(step, 50e3)}) {
    Simulation simulation(model.system, time);
    double largest = 0.0;
    for (int n = 0; n < 5000; ++n) {
      ASSERT_EQ(simulation.step(), StepOutcome::done);
      if (simulation.time() > 0.02)
        largest = std::max(largest, std::abs(simulation.contact_force(0) - 0.2));
    }
    // The beams swing after the short ramp; a force that the step let grow would be beyond any use.
    EXPECT_LT(largest, 1.0);
  }
}

TEST(ExactSimulation, TheResidualConvergesToAllModesAsTheCutoffRises) {
  const Model model = short_ramp_model();
  const std::vector<double> all = free_end_motion(model, exact_time(2e-7));
  double last = 1.0;
  for (const double cutoff : {20e3, 60e3, 200e3}) {
    const double difference =
        relative_difference(free_end_motion(model, exact_time(2e-7, cutoff)), all);
    EXPECT_LT(difference, 0.5 * last) << cutoff;
    last = difference;
  }
  EXPECT_LT(last, 1e-4);
  const double nothing_dropped =
      relative_difference(free_end_motion(model, exact_time(2e-7, 1e9)), all);
  EXPECT_EQ(nothing_dropped, 0.0);
}

TEST(ExactSimulation, ResumesBitwiseAcrossNodesAndInTheMiddleOfTheDampingSchedule) {
  for (const auto assumption : {ContactAssumption::subs_b, ContactAssumption::film}) {
    ModelParameters parameters = paper_model(leading_angle, assumption);
    parameters.drive->velocity = TimeCurve(10.0);  // a node every 40 steps
    parameters.drive->ramp = 5e-4;
    parameters.contact->armed_from = 1.0;
    auto& oblique = parameters.substructures["oblique"].get<BeamParameters>();
    oblique.damping.hold = 1e-3;
    oblique.damping.fade = 1e-3;
    for (const int middle : {600, 601, 639, 640, 641})
      expect_same_after_resume(parameters, exact_time(2.5e-6, 50e3), middle, 900);
  }
}

TEST(ExactSimulation, GivesTheReducedMotionOfBodiesWithAndWithoutResidual) {
  // Of the two beams only the cantilever has modes above 500 kHz.
  const Model model = short_ramp_model();
  const TimeParameters time = exact_time(6e-7, 500e3);
  Simulation simulation(model.system, time);
  ASSERT_EQ(simulation.step_until(5000), StepOutcome::done) << simulation.failure();
  std::vector<Eigen::Index> left_out;
  for (int b = 0; b < 2; ++b) {
    const SystemBody& body = model.system.bodies[static_cast<std::size_t>(b)];
    left_out.push_back((body.modal.omega.array() > retained_frequency(model.system, time)).count());
    const Eigen::VectorXd reduced = simulation.reduced_motion(b).displacement;
    ASSERT_EQ(reduced.size(), body.reduced.size());
    // Every row of the body, seen through either set of coordinates; rounding of a millimetre.
    for (Eigen::Index row = 0; row < body.reduced.rows.rows(); ++row) {
      EXPECT_NEAR(body.reduced.rows.row(row).dot(reduced),
                  simulation.displacement(b, static_cast<int>(row)), 1e-14);
    }
  }
  EXPECT_EQ(std::min(left_out[0], left_out[1]), 0);
  EXPECT_GT(std::max(left_out[0], left_out[1]), 0);
}

TEST(ExactSimulation, RefusesWhatItCannotDo) {
  const Model model = short_ramp_model();
  EXPECT_THROW(
      {
        TimeParameters time = exact_time(2e-7);
        time.coordinates = Coordinates::craig_bampton;
        Simulation(model.system, time);
      },
      ConfigError);
  EXPECT_THROW(Simulation(model.system, exact_time(2e-7), Accounts::energy), ConfigError);
}

}  // namespace
}  // namespace stridor
