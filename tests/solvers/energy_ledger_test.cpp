#include "solvers/transient/energy_ledger.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <tuple>

#include "solvers/integrators/make_propagator.hpp"
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

// ---------------------------------------------------------------- bodies without contact

/// Three masses between springs, damped in proportion, set in motion.
SystemBody chain_body(double alpha, double beta) {
  SystemBody body;
  body.name = "chain";
  body.reduced.mass = Eigen::Vector3d(1.0, 2.0, 0.5).asDiagonal();
  body.reduced.stiffness = Eigen::Matrix3d{{300, -100, 0}, {-100, 300, -200}, {0, -200, 200}};
  body.reduced.damping.alpha = alpha;
  body.reduced.damping.beta = beta;
  body.reduced.rows = Eigen::Matrix3d::Identity();
  body.modal = make_modal(body.reduced);
  body.initial_displacement = Eigen::Vector3d(0.01, -0.02, 0.03);
  body.initial_velocity = Eigen::Vector3d(0.5, 0.1, -0.3);
  return body;
}

/// A free body marched beside its ledger.
class FreeBody {
 public:
  FreeBody(const SystemBody& body, const TimeParameters& time)
      : ledger({{body}, {}, {}, {}}, time),
        step_(time.step),
        propagator_(make_propagator(body, time, std::nullopt, 0, {})) {
    start_motion(*propagator_, body, time, nullptr);
  }
  void march(int num_steps) {
    for (int n = 0; n < num_steps; ++n, ++index_) {
      propagator_->predict_step(nullptr, ledger.position(0), ledger.increment(0));
      propagator_->advance(nullptr);
      ledger.add(index_ * step_, {}, {});
    }
  }

  EnergyLedger ledger;

 private:
  double step_;
  int index_ = 0;
  std::unique_ptr<Propagator> propagator_;
};

constexpr Coordinates all_coordinates[] = {Coordinates::modal, Coordinates::craig_bampton,
                                           Coordinates::craig_bampton_fused};

TEST(EnergyLedger, EveryEntryIsThatOfTheSchemeWrittenOut) {
  // One oscillator, all terms evaluated plainly in long double.
  constexpr long double h = 0.01L;
  constexpr long double mass = 2.0L;
  constexpr long double stiffness = 50.0L;
  constexpr long double damping = 0.3L * mass + 0.002L * stiffness;
  SystemBody body;
  body.reduced.mass = Eigen::MatrixXd::Constant(1, 1, 2.0);
  body.reduced.stiffness = Eigen::MatrixXd::Constant(1, 1, 50.0);
  body.reduced.damping.alpha = 0.3;
  body.reduced.damping.beta = 0.002;
  body.reduced.rows = Eigen::MatrixXd::Identity(1, 1);
  body.modal = make_modal(body.reduced);
  body.initial_displacement = Eigen::VectorXd::Constant(1, 0.1);
  body.initial_velocity = Eigen::VectorXd::Constant(1, -0.7);
  for (const Coordinates coordinates : all_coordinates) {
    FreeBody free(body, time_of(0.01, coordinates));
    long double u = 0.1L;
    long double d = -0.7L * h;
    long double loss = 0.0L;
    EXPECT_NEAR(free.ledger.initial(),
                static_cast<double>(0.5L * mass * 0.49L + 0.5L * stiffness * u * (u - d)), 1e-15);
    for (int n = 0; n < 300; ++n) {
      const long double next = d - h * h / mass * (damping * d / h + stiffness * u);
      loss += damping * d / h * (d + next) / 2.0L;
      const long double strain = 0.5L * stiffness * u * (u + next);
      d = next;
      u += d;
      free.march(1);
      const EnergyBalance& balance = free.ledger.balance();
      // Energies of 0.7 J at most, rounded in every step.
      ASSERT_NEAR(balance.kinetic, static_cast<double>(0.5L * mass * d * d / (h * h)), 1e-13);
      ASSERT_NEAR(balance.strain, static_cast<double>(strain), 1e-13);
      ASSERT_NEAR(balance.damping_loss, static_cast<double>(loss), 1e-13);
      ASSERT_EQ(balance.load_work, 0.0);
    }
  }
}

TEST(EnergyLedger, UndampedFreeVibrationKeepsItsEnergy) {
  for (const Coordinates coordinates : all_coordinates) {
    FreeBody free(chain_body(0.0, 0.0), time_of(0.01, coordinates));
    const Eigen::Vector3d displacement(0.01, -0.02, 0.03);
    const Eigen::Vector3d velocity(0.5, 0.1, -0.3);
    const ReducedBody& body = chain_body(0.0, 0.0).reduced;
    EXPECT_NEAR(free.ledger.initial(),
                0.5 * velocity.dot(body.mass * velocity) +
                    0.5 * displacement.dot(body.stiffness * (displacement - 0.01 * velocity)),
                1e-15);
    for (int n = 0; n < 100; ++n) {
      free.march(100);
      const EnergyBalance& balance = free.ledger.balance();
      EXPECT_EQ(balance.damping_loss, 0.0);
      // 10^4 steps with errors of ε (position form: ε/(ω h), 1e-15) of the energy each.
      ASSERT_NEAR(balance.kinetic + balance.strain, free.ledger.initial(), 1e-12);
    }
    EXPECT_LT(free.ledger.relative_error(), 1e-11);
    EXPECT_GT(free.ledger.initial(), 0.2);
  }
}

TEST(EnergyLedger, DampedVibrationEndsWithAllOfItsEnergyInTheDamping) {
  for (const Coordinates coordinates : all_coordinates) {
    FreeBody free(chain_body(2.0, 1e-3), time_of(0.01, coordinates));
    free.march(4000);  // 40 s at no less than 1 1/s in amplitude
    EXPECT_NEAR(free.ledger.balance().damping_loss, free.ledger.initial(),
                1e-12 * free.ledger.initial());
    EXPECT_LT(free.ledger.relative_error(), 1e-12);
  }
}

TEST(EnergyLedger, BalanceIsExactWhereTheMotionIsOfFirstOrder) {
  // ü + c u̇ + ω² u = 0 from rest at 1. The backward difference damps too strongly, by the relative
  // amount h c/2: what is left of the energy is wrong to first order, the balance is not.
  constexpr double omega = 20.0;
  constexpr double c = 2.0;
  constexpr double end = 0.5;
  SystemBody body;
  body.reduced.mass = Eigen::MatrixXd::Identity(1, 1);
  body.reduced.stiffness = Eigen::MatrixXd::Constant(1, 1, omega * omega);
  body.reduced.damping.alpha = c;
  body.reduced.rows = Eigen::MatrixXd::Identity(1, 1);
  body.modal = make_modal(body.reduced);
  body.initial_displacement = Eigen::VectorXd::Constant(1, 1.0);
  const double damped = std::sqrt(omega * omega - c * c / 4.0);
  const auto error_of_energy = [&](int num_steps) {
    FreeBody free(body, time_of(end / num_steps, Coordinates::modal));
    free.march(num_steps);
    EXPECT_LT(free.ledger.relative_error(), 1e-11);
    // Without friction the energy at the end less half a step, from the closed form.
    const double t = end - 0.5 * end / num_steps;
    const double sine = std::sin(damped * t);
    const double cosine = std::cos(damped * t);
    const double u = cosine + 0.5 * c / damped * sine;
    const double v = -omega * omega / damped * sine;
    const double exact = 0.5 * std::exp(-c * t) * (v * v + omega * omega * u * u);
    const EnergyBalance& balance = free.ledger.balance();
    return std::abs(balance.kinetic + balance.strain - exact);
  };
  for (const int n : {4000, 8000}) {
    const double order = std::log2(error_of_energy(n) / error_of_energy(2 * n));
    EXPECT_GT(order, 0.9);
    EXPECT_LT(order, 1.1);
  }
}

// ---------------------------------------------------------------- what the drive does

/// Two bodies without freedom, one driven along the other: all work is that of the drive.
System driven_system(bool slave_is_driven) {
  System system;
  system.drives[0].velocity = TimeCurve(TimeTable{{0.0, 1.0}, {0.2, 0.6}});
  for (int b = 0; b < 2; ++b) {
    SystemBody body;
    body.reduced.rows.resize(1, 0);
    body.modal.rows.resize(1, 0);
    body.drive = (b == 0) == slave_is_driven ? 0 : -1;
    body.loads = {BodyLoad{0}};
    system.bodies.push_back(body);
  }
  MasterSurface surface;
  surface.body = 1;
  surface.rows = {{0, 0}, {0, 0}};
  surface.positions = {{0.0, 0.0}, {1.0, 0.0}};
  surface.arc_length = {0.0, 1.0};
  system.surfaces = {surface};
  ContactPoint point;
  point.slave_body = 0;
  system.contacts = {point};
  return system;
}

ContactAction inclined_action(double force, double friction_force) {
  return {0,
          {0.5, Eigen::Vector2d(0.8, 0.6), Eigen::Vector2d(-0.6, 0.8), weights_at({}, 0.5).value},
          force,
          friction_force,
          ContactState::slip};
}

TEST(EnergyLedger, TheDriveFeedsFrictionAndPushesAgainstTheNormalForce) {
  for (const bool slave_is_driven : {true, false}) {
    EnergyLedger ledger(driven_system(slave_is_driven), time_of(0.5, Coordinates::modal));
    const ContactAction action[] = {inclined_action(3.0, 2.0)};
    const double slip[] = {0.1};
    ledger.add(0.5, action, slip);
    // v_x(0.5) = 0.4, the slave moves 0.5 · 0.4 = 0.2 m in +x, or the master.
    const double way = slave_is_driven ? 0.2 : -0.2;
    const EnergyBalance& balance = ledger.balance();
    EXPECT_DOUBLE_EQ(balance.friction_loss, 2.0 * 0.8 * way);
    EXPECT_DOUBLE_EQ(balance.contact_work, 3.0 * -0.6 * way);
    EXPECT_DOUBLE_EQ(balance.drive_work, -(3.0 * -0.6 - 2.0 * 0.8) * way);
    EXPECT_NEAR(balance.balance_error, 0.0, 1e-16);
    EXPECT_EQ(ledger.friction_gain().steps, 0);
  }
}

TEST(EnergyLedger, InFrozenSlidingTheDriveFeedsFrictionAlone) {
  System system = driven_system(true);
  system.drives[0].is_frozen = true;
  EnergyLedger ledger(system, time_of(0.5, Coordinates::modal));
  const ContactAction action[] = {inclined_action(3.0, 2.0)};
  const double slip[] = {0.1};
  ledger.add(0.5, action, slip);
  EXPECT_DOUBLE_EQ(ledger.balance().friction_loss, 2.0 * 0.8 * 0.2);
  EXPECT_EQ(ledger.balance().contact_work, 0.0);
  EXPECT_EQ(ledger.balance().drive_work, ledger.balance().friction_loss);
}

TEST(EnergyLedger, FrictionAlongTheSlidingIsCountedWithItsLargestPower) {
  EnergyLedger ledger(driven_system(true), time_of(0.5, Coordinates::modal));
  const auto add = [&](double time, double friction_force, double slip_velocity,
                       ContactState state) {
    ContactAction action = inclined_action(3.0, friction_force);
    action.state = state;
    ledger.add(time, {&action, 1}, {&slip_velocity, 1});
  };
  add(0.0, 2.0, 0.1, ContactState::slip);
  EXPECT_EQ(ledger.friction_gain().steps, 0);
  add(0.5, 2.0, -0.1, ContactState::slip);
  add(1.0, -2.0, 0.3, ContactState::slip);
  add(1.5, -2.0, 0.2, ContactState::slip);
  add(2.0, -2.0, 1e-9, ContactState::stick);  // holds, whatever its direction
  EXPECT_EQ(ledger.friction_gain().steps, 3);
  EXPECT_DOUBLE_EQ(ledger.friction_gain().largest_power, 0.6);
  EXPECT_EQ(ledger.friction_gain().last_time, 1.5);
}

TEST(EnergyLedger, NothingTurnedOverIsNoError) {
  EnergyLedger ledger(driven_system(true), time_of(0.5, Coordinates::modal));
  EXPECT_EQ(ledger.turned_over(), 0.0);
  EXPECT_EQ(ledger.relative_error(), 0.0);
}

// ---------------------------------------------------------------- impact in closed form

TEST(EnergyLedger, AnImpactWithFrictionTakesWhatMomentumSays) {
  // A mass of 2 kg flies onto a rigid plane at (1, −1) m/s and does not bounce: the normal impulse
  // is m v, the friction impulse μ of it, so the normal force takes ½ m v² and friction
  // ½ m (1² − 0.8²).
  System system;
  SystemBody mass;
  mass.reduced.mass = 2.0 * Eigen::Matrix2d::Identity();
  mass.reduced.stiffness = Eigen::Matrix2d::Zero();
  mass.reduced.rows = Eigen::Matrix2d::Identity();
  mass.modal = make_modal(mass.reduced);
  mass.initial_velocity = Eigen::Vector2d(1.0, -1.0);
  SystemBody plane;
  plane.reduced.rows.resize(1, 0);
  plane.modal.rows.resize(1, 0);
  system.bodies = {mass, plane};
  MasterSurface surface;
  surface.body = 1;
  surface.rows = {{0, 0}, {0, 0}};
  surface.positions = {{-1.0, 0.0}, {1.0, 0.0}};
  surface.arc_length = {0.0, 2.0};
  surface.is_endless = true;
  system.surfaces = {surface};
  ContactPoint point;
  point.slave_rows = {0, 1};
  point.slave_position = {0.0, 0.01234};
  point.assumption = ContactAssumption::film;
  point.friction = constant_friction(0.2);
  system.contacts = {point};

  Simulation simulation(system, time_of(1e-3, Coordinates::modal), Accounts::energy);
  ASSERT_EQ(simulation.step_until(50), StepOutcome::done) << simulation.failure();
  const EnergyBalance& balance = simulation.energy()->balance();
  EXPECT_NEAR(simulation.energy()->initial(), 2.0, 1e-15);
  EXPECT_NEAR(balance.contact_work, -1.0, 1e-12);
  EXPECT_NEAR(balance.friction_loss, 0.36, 1e-12);
  EXPECT_NEAR(balance.kinetic, 0.64, 1e-12);
  EXPECT_EQ(balance.drive_work, 0.0);
  EXPECT_LT(simulation.energy()->relative_error(), 1e-14);
}

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

TEST(EnergyLedger, TheWorkOfAMovingRoughSurfaceIsNotFedByTheContact) {
  // A contact force of 3 N on a slave that a rough surface lifts by 0.5 m a step.
  EnergyLedger ledger(driven_system(true), time_of(0.5, Coordinates::modal));
  const auto lift_by = [&](double time, double roughness, double moved) {
    ContactAction action = inclined_action(3.0, 0.0);
    action.roughness = roughness;
    const double slip = 0.1;
    const EnergyBalance before = ledger.balance();
    ledger.add(time, {&action, 1}, {&slip, 1});
    EXPECT_NEAR(ledger.balance().contact_work - before.contact_work, 3.0 * moved, 1e-12);
  };
  // The drive moves the slave along −x, out of the inclined surface at 0.6 of its way.
  lift_by(0.0, 0.0, -0.6 * 0.5 * 0.2);
  const double loss = ledger.balance().contact_work;
  EXPECT_EQ(ledger.contact_gain().energy, 0.0);
  lift_by(0.5, -0.4, -0.6 * 0.5 * 0.4);
  // A surface that sinks by 0.2 m in the mean lets the same motion give 3 · (0.2 − 0.12) J.
  EXPECT_NEAR(ledger.contact_gain().energy, 3.0 * (0.2 - 0.12), 1e-12);
  EXPECT_LT(ledger.balance().contact_work, loss);
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

TEST(CompensatedSum, KeepsWhatPlainAdditionLoses) {
  CompensatedSum sum;
  double plain = 1.0;
  sum.add(1.0);
  for (int i = 0; i < 1'000'000; ++i) {
    sum.add(1e-17);
    plain += 1e-17;
  }
  EXPECT_EQ(plain, 1.0);
  EXPECT_NEAR(sum.value(), 1.0 + 1e-11, 2.3e-16);  // the last digit of the sum
  sum.add(1e20);
  sum.add(-1e20);
  EXPECT_NEAR(sum.value(), 1.0 + 1e-11, 2.3e-16);
}

TEST(CompensatedSum, SavesWhatItCarries) {
  CompensatedSum sum;
  sum.add(1.0);
  sum.add(1e-17);
  State state;
  sum.save(state, "sum");
  CompensatedSum again;
  again.load(state, "sum");
  again.add(-1.0);
  EXPECT_EQ(again.value(), 1e-17);
  EXPECT_THAT(message_of<std::invalid_argument>([&] { again.load(state, "other"); }),
              HasSubstr("no array 'other'"));
}

}  // namespace
}  // namespace stridor
