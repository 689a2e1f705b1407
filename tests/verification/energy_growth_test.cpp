// Long runs without friction: their energy does not grow beyond what load and drive put in.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "io/scene/scene.hpp"
#include "solvers/integrators/make_propagator.hpp"
#include "tests/support/program.hpp"
#include "tests/support/random_bodies.hpp"

namespace stridor {
namespace {

using namespace test;

constexpr std::int64_t num_steps = 200000;
constexpr std::int64_t num_windows = 10;

TimeParameters time_of(Integrator integrator, double step) {
  TimeParameters time;
  time.integrator = integrator;
  time.step = step;
  time.end = step * num_steps;
  return time;
}

/// Bodies let go with a random displacement each.
System released(unsigned seed, bool is_damped) {
  System system = random_sliding_bodies(seed, 0.0, is_damped);
  std::mt19937 engine(seed + 1000);
  std::normal_distribution<double> normal;
  for (SystemBody& body : system.bodies) {
    body.initial_displacement =
        Eigen::VectorXd::NullaryExpr(body.reduced.size(), [&] { return 1e-3 * normal(engine); });
  }
  return system;
}

/// Kinetic and strain energy of all modes, J.
double energy_of(const System& system, const Simulation& simulation) {
  double sum = 0.0;
  for (std::size_t b = 0; b < system.bodies.size(); ++b) {
    const Propagator::Motion motion = simulation.motion(static_cast<int>(b));
    const Eigen::VectorXd& omega = system.bodies[b].modal.omega;
    sum += 0.5 * motion.velocity.squaredNorm() +
           0.5 * (omega.array() * motion.displacement.array()).square().sum();
  }
  return sum;
}

/// Of all modes of both bodies, m² kg.
double square_of_motion(const Simulation& simulation) {
  return simulation.motion(0).displacement.squaredNorm() +
         simulation.motion(1).displacement.squaredNorm();
}

/// Largest energy in every window of a run, seen every few steps.
template <class Energy>
std::vector<double> window_peaks(Simulation& simulation, const Energy& energy) {
  constexpr std::int64_t stride = 7;
  std::vector<double> peaks(num_windows, 0.0);
  // The bodies are let go anywhere; the first steps bring them into contact.
  EXPECT_EQ(simulation.step_until(3), StepOutcome::done) << simulation.failure();
  for (std::int64_t n = 3; n + stride < num_steps; n += stride) {
    EXPECT_EQ(simulation.step_until(n + stride), StepOutcome::done) << simulation.failure();
    double& peak = peaks[static_cast<std::size_t>(n * num_windows / num_steps)];
    peak = std::max(peak, energy());
  }
  return peaks;
}

TEST(EnergyGrowth, UndampedBodiesInContactKeepTheirEnergy) {
  // The central difference conserves ½ dᵀd/h² + ½ q_nᵀ ω² q_{n+1}, that of the ledger: to rounding.
  for (unsigned seed = 1; seed <= 10; ++seed) {
    const System system = released(seed, false);
    const double step = (0.1 * seed - 0.01) * step_limit(system).step;
    Simulation simulation(system, time_of(Integrator::central_difference, step), Accounts::energy);
    const std::vector<double> peaks = window_peaks(simulation, [&] {
      return simulation.energy()->balance().kinetic + simulation.energy()->balance().strain;
    });
    for (const double peak : peaks) EXPECT_NEAR(peak / peaks.front(), 1.0, 1e-9) << seed;
  }
}

TEST(EnergyGrowth, ExactPropagationDoesNotGainEither) {
  // The energy swings with the direct feedthrough of contact forces; the peaks of the motion stay.
  int moving = 0;
  for (unsigned seed = 1; seed <= 10; ++seed) {
    for (const double share : {0.3, 1.0, 3.0}) {
      const System system = released(seed, false);
      const double step = share * step_limit(system).step;
      Simulation simulation(system, time_of(Integrator::exact, step));
      const std::vector<double> peaks =
          window_peaks(simulation, [&] { return square_of_motion(simulation); });
      if (peaks.front() > 0.0) ++moving;  // else no mode is slow enough for the step
      for (const double peak : peaks)
        EXPECT_LE(peak, 1.1 * peaks.front()) << "seed " << seed << ", " << share << " of the limit";
    }
  }
  EXPECT_GE(moving, 20);
}

TEST(EnergyGrowth, DampedBodiesInContactOnlyLose) {
  for (unsigned seed = 1; seed <= 10; ++seed) {
    for (const auto& [integrator, share] : {std::pair(Integrator::central_difference, 0.9),
                                            {Integrator::exact, 0.5},
                                            {Integrator::exact, 10.0}}) {
      const System system = released(seed, true);
      const double step = share * step_limit(system).step;
      Simulation simulation(system, time_of(integrator, step));
      const std::vector<double> peaks =
          window_peaks(simulation, [&] { return square_of_motion(simulation); });
      for (std::size_t window = 1; window < peaks.size(); ++window)
        EXPECT_LE(peaks[window], peaks[window - 1] * (1.0 + 1e-9)) << "seed " << seed;
      EXPECT_LT(peaks.back(), 0.5 * peaks.front()) << "seed " << seed;
    }
  }
}

TEST(EnergyGrowth, ImpactsOnRigidGroundOnlyLose) {
  // A random body bounces on the ground under a load.
  for (unsigned seed = 1; seed <= 20; ++seed) {
    std::mt19937 engine(seed);
    System system = MassOnGround{}.system();
    system.bodies[0] = random_body("body", engine, 1, seed % 2 == 0);
    system.bodies[0].loads = {BodyLoad{1}};
    system.drives[0].velocity = TimeCurve(0.0);
    system.drives[0].load = TimeCurve(-1.0);
    system.contacts[0].slave_position = {0.0, 0.01};
    std::normal_distribution<double> normal;
    system.bodies[0].initial_velocity = Eigen::VectorXd::NullaryExpr(
        system.bodies[0].reduced.size(), [&] { return 3.0 * normal(engine); });
    const double step = 0.9 * step_limit(system).step;
    Simulation simulation(system, time_of(Integrator::central_difference, step), Accounts::energy);
    const double initial = energy_of(system, simulation);
    double turned_over = 0.0;
    std::int64_t open = 0;
    for (std::int64_t n = 1; n <= num_steps; n += 5) {
      ASSERT_EQ(simulation.step_until(n), StepOutcome::done) << simulation.failure();
      const EnergyBalance& now = simulation.energy()->balance();
      turned_over = std::max(turned_over, now.kinetic + now.strain + std::abs(now.load_work));
      ASSERT_LE(now.kinetic + now.strain, initial + now.load_work + 1e-10 * turned_over)
          << "seed " << seed << ", step " << n;
      ASSERT_LE(now.contact_work, 1e-10 * turned_over) << "seed " << seed << ", step " << n;
      if (simulation.contact_state(0) == ContactState::open) ++open;
    }
    EXPECT_GT(open, 0) << "seed " << seed;
  }
}

TEST(EnergyGrowth, BeamsTakeNoMoreThanLoadAndDrivePutIn) {
  std::mt19937 engine(5);
  std::uniform_real_distribution<double> uniform;
  const auto between = [&](double low, double high) {
    return std::to_string(low + (high - low) * uniform(engine));
  };
  for (int scene = 0; scene < 8; ++scene) {
    const std::vector<std::string> sets{
        std::string("contact.assumption=") + (scene % 2 == 0 ? "subs_b" : "film"),
        "contact.friction.coefficient=0",
        "contact.start=" + between(20.0, 60.0) + " mm",
        "contact.armed_from=1e9",
        "substructures.oblique.angle=" + between(20.0, 160.0) + " deg",
        "substructures.oblique.material.youngs_modulus=" + between(1.0, 200.0) + " GPa",
        "substructures.oblique.damping={alpha: 0, beta: 0}",
        "substructures.oblique.mesh.along=12",
        "substructures.cantilever.damping={alpha: 0, beta: 0}",
        "substructures.cantilever.mesh.along=15",
        "substructures.cantilever.interface={}",
        "drive.ramp=0.01",
        "time.step=1e-7"};
    const LoadedScene loaded = load_scene(scene_path("beam_on_beam.yaml"), sets);
    const System system = build_model(loaded).system;
    TimeParameters time = *loaded.scene.time;
    time.step = 0.9 * step_limit(system).step;
    Simulation simulation(system, time, Accounts::energy);
    double turned_over = 0.0;
    for (std::int64_t n = 1; n <= num_steps / 2; n += 50) {
      ASSERT_EQ(simulation.step_until(n), StepOutcome::done) << simulation.failure();
      const EnergyBalance& now = simulation.energy()->balance();
      turned_over = std::max(turned_over, now.kinetic + now.strain + std::abs(now.load_work) +
                                              std::abs(now.drive_work));
      // On a master that bends the normal turns within a step, so that closing the gap works a
      // little: of the order of the square of that turn.
      ASSERT_LE(now.kinetic + now.strain, now.load_work + now.drive_work + 1e-4 * turned_over)
          << "scene " << scene << ", step " << n;
    }
  }
}

}  // namespace
}  // namespace stridor
