#include "solvers/transient/energy_ledger.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <optional>

#include "solvers/integrators/make_propagator.hpp"
#include "solvers/transient/simulation.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/small_systems.hpp"

namespace stridor {
namespace {

using namespace test;
using ::testing::HasSubstr;

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
