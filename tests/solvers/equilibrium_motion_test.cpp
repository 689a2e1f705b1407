// Equilibria as the ends and the starts of transients.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "solvers/equilibrium/equilibrium.hpp"
#include "solvers/transient/simulation.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/paper_equilibrium.hpp"
#include "tests/support/paper_model.hpp"

namespace stridor {
namespace {

using namespace test;

using ::testing::HasSubstr;

/// Runs the system, pressed at once, with the drive held and strong damping, and expects it to end
/// in its equilibrium.
void expect_transient_to_end_in_equilibrium(System system, double step) {
  // So fast that vibration does not turn the sliding round.
  system.drives[0] = {TimeCurve(10.0), TimeCurve(-paper_load), true};
  for (ContactPoint& point : system.contacts) {
    point.friction_rise = TimeCurve(1.0);
    point.armed_from = 1.0;
  }
  for (SystemBody& body : system.bodies) {
    body.reduced.damping = {450.0, 4e-8, std::nullopt, 0.0, 0.0};
    body.modal.damping = body.reduced.damping;
  }
  Simulation simulation(system, paper_time(step));
  // All modes oscillate, the slowest at 40 Hz, so everything decays at 225 1/s or faster: to 1.4e-7
  // in 0.07 s. One difference stays: a step takes ξ and the normal from its prediction, in which
  // the contact has given way by W λ, 1e-9 m: 1e-6 of a segment.
  const double tolerance = 3e-6;
  ASSERT_EQ(simulation.step_until(std::llround(0.07 / step)), StepOutcome::done)
      << simulation.failure();

  const Equilibrium equilibrium = find_equilibrium(system, sliding_state(system, 0.0));
  ASSERT_EQ(equilibrium.status, EquilibriumStatus::converged) << equilibrium.failure;
  for (std::size_t i = 0; i < equilibrium.contacts.size(); ++i) {
    const ContactEquilibrium& contact = equilibrium.contacts[i];
    EXPECT_NEAR(simulation.contact_force(static_cast<int>(i)), contact.force,
                tolerance * paper_load);
    // The simulation reports the projection on the deformed master under every assumption.
    if (contact.positions.assumption != ContactAssumption::subs_a) {
      EXPECT_NEAR(simulation.contact_place(static_cast<int>(i)).position, contact.position,
                  tolerance * 0.001);
    }
  }
  for (int b = 0; b < 2; ++b) {
    const SystemBody& body = system.bodies[static_cast<std::size_t>(b)];
    const Eigen::VectorXd rows =
        body.modal.rows * equilibrium.displacement[static_cast<std::size_t>(b)];
    const double largest = rows.cwiseAbs().maxCoeff();
    for (int row = 0; row < static_cast<int>(rows.size()); ++row)
      ASSERT_NEAR(simulation.displacement(b, row), rows(row), tolerance * largest);
  }
}

TEST(Equilibrium, IsWhereADampedTransientEnds) {
  constexpr double step = 2.8e-7;
  for (const auto assumption :
       {ContactAssumption::subs_a, ContactAssumption::subs_b, ContactAssumption::subs_c})
    expect_transient_to_end_in_equilibrium(paper_system_at(trailing_angle, assumption), step);
  expect_transient_to_end_in_equilibrium(paper_system_at(leading_angle, ContactAssumption::film),
                                         step);
}

TEST(Equilibrium, OfSeveralContactsIsWhereADampedTransientEnds) {
  ModelParameters parameters = block_on_cantilever(ContactAssumption::subs_b);
  parameters.contact->slave = {"oblique.start_bottom", "oblique.end_bottom"};
  expect_transient_to_end_in_equilibrium(make_paper_model(parameters).system, 2.5e-7);
}

TEST(Equilibrium, ASimulationThatStartsInItStaysThere) {
  for (const auto assumption :
       {ContactAssumption::subs_a, ContactAssumption::subs_b, ContactAssumption::subs_c}) {
    System system = paper_system_at(trailing_angle, assumption);
    system.drives[0] = {TimeCurve(0.030), TimeCurve(-paper_load), true};
    system.contacts[0].friction_rise = TimeCurve(1.0);
    const Equilibrium equilibrium = find_equilibrium(system, sliding_state(system, 0.0));
    apply_initial_motion(system, equilibrium);
    Simulation simulation(system, paper_time());
    const PointRows tip = system.contacts[0].slave_rows;
    const Eigen::Vector2d start = moved(system, equilibrium, 1, tip);
    // A step evaluates the gap with the prediction, in which the contact has given way by what λ
    // alone does in one step. Under Subs-c it then slides along the slope, 3e-3, and the force that
    // closes the gap is off by less than that fraction until the bodies have moved to where the
    // predicted gap fits, 1e-12 m away.
    for (int n = 0; n < 2000; ++n) {
      ASSERT_NEAR(simulation.contact_force(0), equilibrium.contacts[0].force, 3e-3 * paper_load);
      ASSERT_EQ(simulation.step(), StepOutcome::done) << simulation.failure();
    }
    EXPECT_NEAR(simulation.contact_force(0), equilibrium.contacts[0].force, 2e-5 * paper_load);
    EXPECT_NEAR(simulation.displacement(1, tip.x), start.x(), 1e-6 * start.norm());
    EXPECT_NEAR(simulation.displacement(1, tip.y), start.y(), 1e-6 * start.norm());
  }
}

TEST(Equilibrium, AStartMustBeAnEquilibriumWithTheDriveAtZero) {
  System system = paper_system_at(trailing_angle);
  EXPECT_THAT(message_of<std::invalid_argument>([&] {
                apply_initial_motion(system,
                                     find_equilibrium(system, sliding_state(system, 0.001)));
              }),
              HasSubstr("the equilibrium has it at 0.001 m"));
  EXPECT_THAT(
      message_of<std::invalid_argument>([&] { apply_initial_motion(system, Equilibrium{}); }),
      HasSubstr("has not converged"));
}

}  // namespace
}  // namespace stridor
