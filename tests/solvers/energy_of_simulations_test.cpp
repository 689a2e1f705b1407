// The ledger that a simulation keeps of bodies in contact.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <tuple>

#include "solvers/transient/energy_ledger.hpp"
#include "solvers/transient/simulation.hpp"
#include "substructures/bodies/beam.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/paper_model.hpp"
#include "tests/support/small_systems.hpp"

namespace stridor {
namespace {

using namespace test;
using ::testing::HasSubstr;

// How closely a balance of thousands of steps closes, relative to the energy exchanged. Every
// step rounds motion and energies by a few ε = 1e-16 of themselves, with either sign. Where 1 − h c
// is formed, h c is rounded by ε: for α = 40 1/s and h = 2e-7 s by 1e-11 of the damping loss.
constexpr double rounding = 2e-11;

// ---------------------------------------------------------------- the coupled system

/// Full load and drive within 1 ms.
ModelParameters lively_model() {
  ModelParameters parameters = paper_model(leading_angle);
  parameters.drive->ramp = 1e-3;
  parameters.contact->armed_from = 1e9;
  return parameters;
}

/// The system of lively_model(), built once.
System lively_system(ContactAssumption assumption) {
  static const System built = make_paper_model(lively_model()).system;
  System system = built;
  system.contacts[0].assumption = assumption;
  return system;
}

Simulation marched(const System& system, std::int64_t steps, const TimeParameters& time) {
  Simulation simulation(system, time, Accounts::energy);
  EXPECT_EQ(simulation.step_until(steps), StepOutcome::done) << simulation.failure();
  return simulation;
}

TEST(EnergyLedger, BalancesUnderEveryContactAssumption) {
  for (const auto assumption : {ContactAssumption::subs_a, ContactAssumption::subs_b,
                                ContactAssumption::subs_c, ContactAssumption::film}) {
    const std::tuple<SurfaceKind, bool, double> surfaces[] = {
        {SurfaceKind::polyline, false, 0.0},  {SurfaceKind::polyline, true, 0.0},
        {SurfaceKind::polyline, false, 1e-8}, {SurfaceKind::smooth, false, 0.0},
        {SurfaceKind::smooth, true, 0.0},     {SurfaceKind::smooth, false, 1e-8}};
    for (const auto& [kind, is_frozen, rms] : surfaces) {
      System system = lively_system(assumption);
      system.surfaces[0].kind = kind;
      if (rms > 0.0) system.surfaces[0].roughness = Roughness({rms, 2e-5, 1}, 0.1);
      system.drives[0].is_frozen = is_frozen;
      const Simulation simulation = marched(system, 10'000, paper_time());
      const EnergyLedger& ledger = *simulation.energy();
      EXPECT_LT(ledger.relative_error(), rounding);
      // Every entry takes part.
      const EnergyBalance& balance = ledger.balance();
      for (const double entry : {balance.kinetic, balance.strain, balance.damping_loss,
                                 balance.friction_loss, balance.drive_work, balance.load_work}) {
        EXPECT_GT(std::abs(entry), 1e-3 * ledger.turned_over());
      }
    }
  }
}

TEST(EnergyLedger, BalancesInTheDenseForms) {
  // The published form carries positions, whose rounding is ε/(ω h) of the velocities: 4e-12 for
  // the lowest mode (45.6 Hz). Products with the dense matrices cancel to no less than a tenth.
  const System system = lively_system(ContactAssumption::subs_b);
  for (const auto coordinates : {Coordinates::craig_bampton, Coordinates::craig_bampton_fused}) {
    const Simulation simulation = marched(system, 300, paper_time(2e-7, coordinates));
    const Simulation modal = marched(system, 300, paper_time());
    EXPECT_LT(simulation.energy()->relative_error(), 1e-10);
    const EnergyBalance& dense = simulation.energy()->balance();
    const EnergyBalance& reference = modal.energy()->balance();
    const double scale = 1e-8 * modal.energy()->turned_over();
    EXPECT_NEAR(dense.kinetic, reference.kinetic, scale);
    EXPECT_NEAR(dense.strain, reference.strain, scale);
    EXPECT_NEAR(dense.damping_loss, reference.damping_loss, scale);
    EXPECT_NEAR(dense.friction_loss, reference.friction_loss, scale);
    EXPECT_NEAR(dense.drive_work, reference.drive_work, scale);
    EXPECT_NEAR(dense.load_work, reference.load_work, scale);
  }
}

TEST(EnergyLedger, BalancesThroughTheDampingSchedule) {
  ModelParameters parameters = lively_model();
  auto& oblique = parameters.substructures["oblique"].get<BeamParameters>();
  oblique.damping.alpha = 20.0;
  oblique.damping.alpha_start = 4000.0;
  oblique.damping.hold = 5e-4;
  oblique.damping.fade = 1e-3;
  EXPECT_LT(
      marched(make_paper_model(parameters).system, 10'000, paper_time()).energy()->relative_error(),
      rounding);
}

TEST(EnergyLedger, CountsTheEnergyThatTheBodiesStartWith) {
  System system = lively_system(ContactAssumption::film);
  for (SystemBody& body : system.bodies) {
    const auto n = body.reduced.size();
    body.initial_velocity = Eigen::VectorXd::LinSpaced(n, 1e-3, -2e-3);
    body.initial_displacement = Eigen::VectorXd::Constant(n, 1e-9);
  }
  const Simulation simulation = marched(system, 2000, paper_time());
  EXPECT_GT(simulation.energy()->initial(), 1e-10);
  EXPECT_LT(simulation.energy()->relative_error(), rounding);
}

TEST(EnergyLedger, FrictionLossIsFrictionForceTimesSliding) {
  // λ_t times the mean of the two sliding velocities around it, from what the simulation shows. The
  // rows of the two steps differ by 1e-5 (6 nm on a segment of 1 mm).
  const System system = lively_system(ContactAssumption::film);
  Simulation simulation(system, paper_time(), Accounts::energy);
  double loss = 0.0;
  for (int n = 0; n < 20'000; ++n) {
    const double force = simulation.friction_force(0);
    const double before = simulation.slip_velocity(0);
    ASSERT_EQ(simulation.step(), StepOutcome::done) << simulation.failure();
    loss += force * 0.5 * (before + simulation.slip_velocity(0)) * simulation.step_size();
  }
  EXPECT_GT(loss, 1e-6);
  EXPECT_NEAR(simulation.energy()->balance().friction_loss, loss, 1e-5 * loss);
}

TEST(EnergyLedger, ContactThatSticksAndLiftsOffNeverFeedsEnergy) {
  // FiLM: impacts and reversals of sliding take energy. What the turning normal gives or takes
  // while the contact slides is of first order in h: λ_n v Δγ h with Δγ the turn of the normal,
  // which at a node is the kink.
  ModelParameters parameters = paper_model(trailing_angle, ContactAssumption::film);
  parameters.drive->ramp = 1e-3;
  const System system = make_paper_model(parameters).system;
  Simulation simulation(system, paper_time(), Accounts::energy);
  double highest = 0.0;
  double rise = 0.0;
  double least = 0.0;
  for (int n = 0; n < 50'000; ++n) {
    ASSERT_EQ(simulation.step(), StepOutcome::done) << simulation.failure();
    const double work = simulation.energy()->balance().contact_work;
    least = std::min(least, work);
    highest = std::max(highest, work);
    rise = std::max(rise, work - least);
  }
  const ContactStatistics& statistics = simulation.statistics(0);
  EXPECT_GT(statistics.open, 100);
  EXPECT_GT(statistics.sticking, 100);
  const EnergyLedger& ledger = *simulation.energy();
  EXPECT_LT(ledger.relative_error(), rounding);
  const double drift = 1e-5 * ledger.turned_over();
  EXPECT_LT(highest, drift);
  EXPECT_LT(ledger.balance().contact_work, 0.0);
  EXPECT_LT(rise, drift);
  // Rounding of the sliding velocity, ε u/h = 1e-12 m/s, times a force of 0.1 N.
  EXPECT_LT(ledger.friction_gain().largest_power, 1e-13);
  EXPECT_NEAR(ledger.contact_gain().energy, rise, 1e-9 * ledger.turned_over());
  EXPECT_FALSE(ledger.contacts_feed());
}

// ---------------------------------------------------------------- contacts that feed

TEST(EnergyLedger, ContactsThatCloseAnOverlapFeedEnergyToItsFullAmount) {
  // A mass m starts an overlap g inside the ground. The first force λ = m g/h² closes it in a step
  // and so does the work λ g/2: the mass leaves with g/h.
  constexpr double overlap = 1e-3;
  constexpr double step = 1e-3;
  MassOnGround ground;
  ground.load = 0.0;
  System system = ground.system();
  system.bodies[0].initial_displacement = Eigen::Vector2d(0.0, -overlap);
  Simulation simulation(system, time_of(step, Coordinates::modal), Accounts::energy);
  ASSERT_EQ(simulation.step_until(100), StepOutcome::done) << simulation.failure();
  const EnergyLedger& ledger = *simulation.energy();
  EXPECT_LT(ledger.relative_error(), rounding);
  EXPECT_NEAR(ledger.contact_gain().energy, 0.5 * ground.mass * std::pow(overlap / step, 2), 1e-9);
  EXPECT_EQ(ledger.contact_gain().last_time, 0.0);
  EXPECT_TRUE(ledger.contacts_feed());
}

TEST(EnergyLedger, ContactsThatBounceOrSlideDoNotFeed) {
  MassOnGround ground;
  System falling = ground.system();
  falling.bodies[0].initial_displacement = Eigen::Vector2d(0.0, 1e-3);
  falling.bodies[0].initial_velocity = Eigen::Vector2d(0.0, -0.1);
  Simulation landed(falling, time_of(1e-4, Coordinates::modal), Accounts::energy);
  ASSERT_EQ(landed.step_until(2000), StepOutcome::done) << landed.failure();
  EXPECT_LT(landed.energy()->balance().contact_work, -1e-3);
  EXPECT_LT(landed.energy()->contact_gain().energy, 1e-12);
  for (const auto assumption : {ContactAssumption::subs_a, ContactAssumption::subs_b,
                                ContactAssumption::subs_c, ContactAssumption::film}) {
    const Simulation sliding = marched(lively_system(assumption), 20'000, paper_time());
    EXPECT_FALSE(sliding.energy()->contacts_feed()) << static_cast<int>(assumption);
  }
}

TEST(EnergyLedger, SeveralContactsBalanceAsOneDoes) {
  ModelParameters parameters = lively_model();
  parameters.contact->assumption = ContactAssumption::film;
  BeamParameters upper = paper_oblique(0.0);
  upper.length = 0.030;
  upper.mesh.along = 15;
  parameters.substructures["oblique"] = upper;
  parameters.contact->slave = {"oblique.start_bottom", "oblique.end_bottom"};
  const System system = make_paper_model(parameters).system;
  ASSERT_EQ(system.contacts.size(), 2u);
  const Simulation simulation = marched(system, 5000, paper_time());
  EXPECT_LT(simulation.energy()->relative_error(), rounding);
}

TEST(EnergyLedger, DoesNotChangeTheMotionAndIsNotKeptUnasked) {
  const System system = lively_system(ContactAssumption::film);
  Simulation plain(system, paper_time());
  EXPECT_EQ(plain.energy(), nullptr);
  ASSERT_EQ(plain.step_until(3000), StepOutcome::done);
  const Simulation simulation = marched(system, 3000, paper_time());
  const State kept = simulation.save();
  const State without = plain.save();
  for (const auto& [name, values] : without.arrays()) EXPECT_EQ(kept.array(name), values);
}

TEST(EnergyLedger, GoesOnBitwiseAfterSaveAndLoad) {
  for (const auto coordinates : {Coordinates::modal, Coordinates::craig_bampton_fused}) {
    const System system = lively_system(ContactAssumption::film);
    const TimeParameters time = paper_time(2e-7, coordinates);
    const int half = coordinates == Coordinates::modal ? 3000 : 150;
    Simulation straight = marched(system, half, time);
    Simulation resumed(system, time, Accounts::energy);
    resumed.load(straight.save());
    EXPECT_EQ(resumed.save(), straight.save());
    EXPECT_EQ(resumed.energy()->balance().balance_error,
              straight.energy()->balance().balance_error);
    ASSERT_EQ(straight.step_until(2 * half), StepOutcome::done);
    ASSERT_EQ(resumed.step_until(2 * half), StepOutcome::done);
    EXPECT_EQ(resumed.save(), straight.save());
    EXPECT_EQ(resumed.energy()->relative_error(), straight.energy()->relative_error());
    EXPECT_EQ(resumed.energy()->balance().friction_loss,
              straight.energy()->balance().friction_loss);
  }
}

TEST(EnergyLedger, RefusesAStateWithoutIt) {
  const System system = lively_system(ContactAssumption::subs_b);
  const State state = Simulation(system, paper_time()).save();
  Simulation simulation(system, paper_time(), Accounts::energy);
  EXPECT_THAT(message_of<std::invalid_argument>([&] { simulation.load(state); }),
              HasSubstr("no array 'energy/"));
}

// ---------------------------------------------------------------- wrong books are noticed

/// Keeps a ledger of its own beside a simulation from what that shows between its steps.
class OutsideLedger {
 public:
  /// @param believed what the ledger takes the system for
  OutsideLedger(const System& believed, const TimeParameters& time) : ledger(believed, time) {}

  /// @param change applied to what the contact is entered as doing
  template <class Change>
  void march(Simulation& simulation, int num_bodies, int num_steps, Change change) {
    for (int n = 0; n < num_steps; ++n) {
      for (int b = 0; b < num_bodies; ++b) {
        const Eigen::VectorXd position = simulation.motion(b).displacement;
        std::copy(position.begin(), position.end(), ledger.position(b).begin());
      }
      const double time = simulation.time();
      ContactAction action = simulation.contact_action(0);
      change(action);
      ASSERT_EQ(simulation.step(), StepOutcome::done) << simulation.failure();
      for (int b = 0; b < num_bodies; ++b) {
        const Eigen::VectorXd increment = simulation.step_size() * simulation.motion(b).velocity;
        std::copy(increment.begin(), increment.end(), ledger.increment(b).begin());
      }
      const double slip = simulation.slip_velocity(0);
      ledger.add(time, {&action, 1}, {&slip, 1});
    }
  }

  EnergyLedger ledger;
};

TEST(EnergyLedger, FlippedFrictionIsCaught) {
  const System system = lively_system(ContactAssumption::subs_b);
  constexpr int steps = 10'000;
  Simulation right_simulation(system, paper_time(), Accounts::energy);
  OutsideLedger right(system, paper_time());
  right.march(right_simulation, 2, steps, [](ContactAction&) {});
  // Increments taken back from velocities have lost some digits.
  EXPECT_LT(right.ledger.relative_error(), 1e-9);
  EXPECT_NEAR(right.ledger.balance().friction_loss,
              right_simulation.energy()->balance().friction_loss,
              1e-9 * right.ledger.turned_over());
  EXPECT_EQ(right.ledger.friction_gain().steps, right_simulation.energy()->friction_gain().steps);

  Simulation simulation(system, paper_time());
  OutsideLedger wrong(system, paper_time());
  wrong.march(simulation, 2, steps,
              [](ContactAction& action) { action.friction_force = -action.friction_force; });
  // By the balance, in spite of the drive that appears to feed it as friction is flipped; by the
  // sign of the loss; and by the power of friction in every sliding step.
  EXPECT_GT(wrong.ledger.relative_error(), 1e-2);
  EXPECT_LT(wrong.ledger.balance().friction_loss, 0.0);
  EXPECT_GT(wrong.ledger.friction_gain().steps, 4 * right.ledger.friction_gain().steps);
}

TEST(EnergyLedger, DampingSwitchedOffInTheBooksIsCaughtToItsFullAmount) {
  const System system = lively_system(ContactAssumption::subs_b);
  System believed = system;
  for (SystemBody& body : believed.bodies) body.modal.damping = {};
  Simulation simulation(system, paper_time(), Accounts::energy);
  OutsideLedger wrong(believed, paper_time());
  wrong.march(simulation, 2, 10'000, [](ContactAction&) {});
  EXPECT_EQ(wrong.ledger.balance().damping_loss, 0.0);
  EXPECT_GT(wrong.ledger.relative_error(), 1e-2);
  const EnergyBalance& right = simulation.energy()->balance();
  EXPECT_NEAR(wrong.ledger.balance().balance_error, -right.damping_loss,
              1e-9 * simulation.energy()->turned_over());
}

}  // namespace
}  // namespace stridor
