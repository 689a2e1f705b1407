// The discrete coupled step against the limit that the program announces.
#include "analysis/step_stability.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/errors.hpp"
#include "io/scene/scene.hpp"
#include "solvers/eigenvalues/dense_eigenvalues.hpp"
#include "solvers/equilibrium/equilibrium.hpp"
#include "solvers/equilibrium/linearise.hpp"
#include "solvers/integrators/make_propagator.hpp"
#include "solvers/integrators/retained_modes.hpp"
#include "tests/support/program.hpp"
#include "tests/support/random_bodies.hpp"

namespace stridor {
namespace {

using namespace test;

TimeParameters stepping(Integrator integrator, double step) {
  TimeParameters time;
  time.integrator = integrator;
  time.step = step;
  time.end = 1.0;
  return time;
}

double lowest_frequency(const System& system) {
  return std::min(system.bodies[0].modal.omega(0), system.bodies[1].modal.omega(0)) /
         (2.0 * std::numbers::pi);
}

/// Rows of the contact as it slides, or sticks: then those of the tangent as well.
Pencil rows_of_contact(const System& system, double friction) {
  Pencil pencil = make_modal_pencil(system);
  place_undeformed(pencil, system, 0.0, friction, 1.0);
  return pencil;
}

Pencil sticking(const System& system) {
  Pencil pencil = rows_of_contact(system, 0.0);
  const Eigen::Index ports = pencil.num_ports();
  Eigen::MatrixXd both = Eigen::MatrixXd::Zero(2, ports);
  both.row(0) = pencil.compatibility;
  // B_C = −n on the slave, +w n on the master; the same along t = (n_y, −n_x).
  for (Eigen::Index port = 0; port < ports - pencil.num_body_ports; port += 2) {
    both(1, port) = pencil.compatibility(0, port + 1);
    both(1, port + 1) = -pencil.compatibility(0, port);
  }
  pencil.compatibility = both;
  pencil.equilibrium = both;
  return pencil;
}

/// How far a sequence is from Σ c_j y_{n+j} = 0 with c the coefficients of Π (z − z_i), relative to
/// its terms.
double recurrence_error(const std::vector<std::complex<double>>& factors,
                        const std::vector<double>& sequence) {
  std::vector<std::complex<double>> c{1.0};  // highest power first
  for (const std::complex<double>& factor : factors) {
    c.push_back(0.0);
    for (std::size_t i = c.size() - 1; i > 0; --i) c[i] -= factor * c[i - 1];
  }
  double worst = 0.0;
  for (std::size_t n = 0; n + c.size() <= sequence.size(); ++n) {
    double sum = 0.0;
    double size = 0.0;
    for (std::size_t j = 0; j < c.size(); ++j) {
      const double term = c[c.size() - 1 - j].real() * sequence[n + j];
      sum += term;
      size += std::abs(term);
    }
    worst = std::max(worst, std::abs(sum) / size);
  }
  return worst;
}

/// Motion recorded over forty steps from a displacement.
std::vector<double> motion_from(System system, const TimeParameters& time, double displacement) {
  for (SystemBody& body : system.bodies) {
    body.initial_displacement =
        Eigen::VectorXd::LinSpaced(body.reduced.size(), displacement, -2.0 * displacement);
  }
  std::vector<double> seen;
  Simulation simulation(system, time);
  for (int n = 0; n < 40; ++n) {
    EXPECT_EQ(simulation.step(), StepOutcome::done) << simulation.failure();
    seen.push_back(simulation.displacement(0, 0));
  }
  return seen;
}

TEST(FrozenStep, FactorsAreThoseOfTheSimulation) {
  // Cayley and Hamilton: what is seen of a linear step repeats its characteristic polynomial. The
  // difference of two runs is free of loads.
  int runs = 0;
  int told_apart = 0;
  for (unsigned seed = 1; seed <= 12; ++seed) {
    for (const bool is_damped : {false, true}) {
      const System system = random_sliding_bodies(seed, 0.3, is_damped);
      const double limit = step_limit(system).step;
      for (const auto& [integrator, step, cutoff] :
           {std::tuple(Integrator::central_difference, 0.3 * limit, 0.0),
            {Integrator::exact, 0.3 * limit, 0.0},
            {Integrator::exact, 2.0 * limit, 0.0},
            {Integrator::exact, 0.5 * limit, 3.0},
            {Integrator::central_difference, 0.3 * limit, 3.0}}) {
        TimeParameters time = stepping(integrator, step);
        if (cutoff > 0.0) time.retain = RetainParameters{cutoff * lowest_frequency(system), {}};
        SCOPED_TRACE(testing::Message() << "seed " << seed << ", damped " << is_damped << ", "
                                        << (integrator == Integrator::exact ? "exact " : "central ")
                                        << step / limit << " cutoff " << cutoff);
        std::vector<std::complex<double>> factors;
        std::vector<double> seen;
        try {
          factors = FrozenStep(system, time).factors(rows_of_contact(system, 0.3));
          seen = motion_from(system, time, 1e-3);
        } catch (const NumericalError&) {
          continue;  // it jams
        }
        const std::vector<double> rest = motion_from(system, time, 0.0);
        for (std::size_t n = 0; n < seen.size(); ++n) seen[n] -= rest[n];
        EXPECT_LT(recurrence_error(factors, seen), 1e-12);
        // Without friction it is another step; where all motions are slow, little tells.
        const auto others = FrozenStep(system, time).factors(rows_of_contact(system, 0.0));
        if (recurrence_error(others, seen) > 1e-9) ++told_apart;
        ++runs;
      }
    }
  }
  EXPECT_GT(runs, 60);
  EXPECT_GT(told_apart, runs / 2);
}

TEST(FrozenStep, FactorsOfCoupledBodiesAreThoseOfTheSimulation) {
  int runs = 0;
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const System system = with_coupling(random_sliding_bodies(seed, 0.3, true), seed,
                                        {.gyroscopic = 0.5, .damper = 0.1, .circulatory = 0.1});
    for (const double turn : {0.3, 1.5}) {
      const TimeParameters time = stepping(Integrator::exact, turn / fastest_motion(system));
      std::vector<double> seen;
      std::vector<std::complex<double>> factors;
      try {
        factors = FrozenStep(system, time).factors(rows_of_contact(system, 0.3));
        seen = motion_from(system, time, 1e-3);
      } catch (const NumericalError&) {
        continue;  // it jams
      }
      const std::vector<double> rest = motion_from(system, time, 0.0);
      for (std::size_t n = 0; n < seen.size(); ++n) seen[n] -= rest[n];
      EXPECT_LT(recurrence_error(factors, seen), 1e-11) << "seed " << seed << ", turn " << turn;
      ++runs;
    }
  }
  EXPECT_GT(runs, 20);
}

TEST(StepStability, GyroscopicBodiesWithoutDampingAreStableWithoutFriction) {
  // Up to the largest turn: they conserve energy, and so do contacts that slide without friction or
  // stick.
  for (unsigned seed = 1; seed <= 150; ++seed) {
    const System system = with_coupling(random_sliding_bodies(seed, 0.0, false), seed,
                                        {.gyroscopic = 0.05 * (seed % 20)});
    for (const double turn : {0.05, 0.2, 0.5, 1.0, 1.5, 1.999}) {
      const TimeParameters time = stepping(Integrator::exact, turn / fastest_motion(system));
      const FrozenStep step(system, time);
      for (const Pencil& contacts : {rows_of_contact(system, 0.0), sticking(system)}) {
        EXPECT_LT(spectral_radius(step.factors(contacts)), 1.0 + 1e-9)
            << "seed " << seed << ", turn " << turn;
      }
    }
  }
}

/// Whether the bodies in contact are stable, by their eigenvalues.
bool is_stable(const Pencil& contacts) {
  const std::vector<Eigenvalue> eigenvalues = dense_eigenvalues(contacts);
  return std::all_of(eigenvalues.begin(), eigenvalues.end(),
                     [](const Eigenvalue& one) { return one.growth() < 0.0; });
}

/// Cases of damped bodies with gyroscopic, circulatory or non-proportional damping terms that are
/// stable in contact, and how many of the steps grow.
struct CoupledCases {
  int cases = 0;
  int growing = 0;

  CoupledCases(const RandomCoupling& coupling, double friction, double least_turn,
               double largest_turn) {
    for (unsigned seed = 1; seed <= 300; ++seed) {
      const System system =
          with_coupling(random_sliding_bodies(seed, friction, true), seed, coupling);
      const double turn = least_turn + (largest_turn - least_turn) * (seed % 10) / 9.0;
      const TimeParameters time = stepping(Integrator::exact, turn / fastest_motion(system));
      std::vector<Pencil> places{rows_of_contact(system, friction)};
      if (friction == 0.0) places.push_back(sticking(system));
      for (const Pencil& contacts : places) {
        try {
          if (!is_stable(contacts)) continue;
          growing += spectral_radius(FrozenStep(system, time).factors(contacts)) > 1.0 + 1e-9;
          ++cases;
        } catch (const NumericalError&) {
          continue;  // it jams
        }
      }
    }
  }
};

TEST(StepStability, DampedGyroscopicBodiesAreStableWithoutFriction) {
  const CoupledCases found({.gyroscopic = 0.5, .damper = 0.1}, 0.0, 0.05, 1.0);
  EXPECT_EQ(found.growing, 0);
  EXPECT_GT(found.cases, 500);
}

TEST(StepStability, CirculatoryBodiesAreStableWhereTheyAreInContact) {
  const CoupledCases found({.gyroscopic = 0.2, .damper = 0.1, .circulatory = 0.2}, 0.0, 0.05, 1.0);
  EXPECT_EQ(found.growing, 0);
  EXPECT_GT(found.cases, 200);
}

TEST(StepStability, WithoutFrictionCouplingDoesNotLowerTheLimit) {
  for (unsigned seed = 1; seed <= 100; ++seed) {
    for (const bool is_damped : {false, true}) {
      const System system = random_sliding_bodies(seed, 0.0, is_damped);
      const double limit = step_limit(system).step;
      const auto expect_stable = [&](const TimeParameters& time) {
        SCOPED_TRACE(testing::Message() << "seed " << seed << ", damped " << is_damped << ", step "
                                        << time.step / limit << " of the limit");
        const FrozenStep step(system, time);
        for (const Pencil& contacts : {rows_of_contact(system, 0.0), sticking(system)})
          EXPECT_LT(spectral_radius(step.factors(contacts)), 1.0 + 1e-9);
      };
      for (const double share : {0.01, 0.5, 0.9, 0.999})
        expect_stable(stepping(Integrator::central_difference, share * limit));
      for (const double share : {0.01, 0.5, 1.0, 3.0, 10.0, 50.0})
        expect_stable(stepping(Integrator::exact, share * limit));
      for (const double cutoff : {1.5, 5.0}) {
        TimeParameters time = stepping(Integrator::exact, 0.7 * limit);
        time.retain = RetainParameters{cutoff * lowest_frequency(system), {}};
        expect_stable(time);
        time.integrator = Integrator::central_difference;
        time.step = 0.999 * step_limit(system, time).step;
        expect_stable(time);
      }
    }
  }
}

TEST(StepStability, HeavilyDampedBodiesBesideUndampedOnesAreStableWithoutFriction) {
  // The feedthrough that a slow mode with c h = 2.14 needs is more than the flexibility of undamped
  // modes near ω h = 2.
  for (unsigned seed = 1; seed <= 100; ++seed) {
    System system = random_sliding_bodies(seed, 0.0, false);
    const TimeParameters time =
        stepping(Integrator::exact, 1.99 / system.bodies[1].modal.omega.maxCoeff());
    system.bodies[0].reduced.damping.alpha = 2.14 / time.step;
    system.bodies[0].modal = make_modal(system.bodies[0].reduced);
    const FrozenStep step(system, time, 0.309);
    for (const Pencil& contacts : {rows_of_contact(system, 0.0), sticking(system)})
      EXPECT_LT(spectral_radius(step.factors(contacts)), 1.0 + 1e-9) << "seed " << seed;
  }
}

TEST(StepStability, BodiesApartAreUnstableBeyondTheLimit) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    for (const bool is_damped : {false, true}) {
      const System system = random_sliding_bodies(seed, 0.0, is_damped);
      Pencil apart = make_modal_pencil(system);
      apart.compatibility.resize(0, apart.num_ports());
      apart.equilibrium.resize(0, apart.num_ports());
      const double limit = step_limit(system).step;
      const auto radius = [&](double share) {
        return spectral_radius(
            FrozenStep(system, stepping(Integrator::central_difference, share * limit))
                .factors(apart));
      };
      EXPECT_LT(radius(0.9999), 1.0 + 1e-9);
      EXPECT_GT(radius(1.0001), 1.0 + 1e-4);
    }
  }
}

/// One body on rigid ground: with λ = k_xy x it moves along x as
/// m ẍ + (k_xx + μ k_xy) x = 0, whatever the limit of the body by itself.
System body_on_ground(double friction) {
  MassOnGround mass;
  mass.friction = constant_friction(friction);
  mass.assumption = ContactAssumption::subs_a;
  mass.load = 1e3;
  System system = mass.system();
  system.bodies[0].reduced.stiffness = Eigen::Matrix2d{{100.0, 20.0}, {20.0, 20.0}};
  system.bodies[0].modal = make_modal(system.bodies[0].reduced);
  system.bodies[0].initial_displacement = Eigen::Vector2d(0.01, 0.0);
  system.drives[0].velocity = TimeCurve(1e6);
  system.drives[0].is_frozen = true;
  return system;
}

TEST(StepStability, FrictionLowersTheLimitAsInClosedForm) {
  constexpr double friction = 0.3;
  const System system = body_on_ground(friction);
  const double announced = step_limit(system).step;
  EXPECT_NEAR(announced, 2.0 / std::sqrt(60.0 + std::sqrt(2000.0)), 1e-12);
  const double coupled = 2.0 / std::sqrt(100.0 + friction * 20.0);
  ASSERT_LT(coupled, 0.999 * announced);

  const TimeParameters time = stepping(Integrator::central_difference, 0.9995 * announced);
  const std::vector<PathStability> path = stability_along_path(system, time, 5);
  ASSERT_EQ(path.size(), 1u) << "the drive is frozen";
  const StepStability& found = path.front().stability;
  EXPECT_EQ(found.verdict, StepVerdict::step_grows) << path.front().failure;
  // z + 1/z = 2 − (ωh)², negative.
  const double half = 1.0 - 0.5 * std::pow(2.0 * time.step / coupled, 2);
  EXPECT_NEAR(found.radius, -half + std::sqrt(half * half - 1.0), 1e-9);
  EXPECT_NEAR(found.frequency, 0.5 / time.step, 1e-9 / time.step);
  EXPECT_NEAR(found.growth_of_bodies.value(), 0.0, 1e-9);
  EXPECT_NEAR(stable_step(system, time, path.front().contacts).value(), coupled, 1e-4 * coupled);

  // And so it goes: the simulation runs away at the one step and not at the other.
  const auto largest = [&](double step) {
    Simulation simulation(system, stepping(Integrator::central_difference, step));
    double size = 0.0;
    for (int n = 0; n < 1000; ++n) {
      EXPECT_EQ(simulation.step(), StepOutcome::done) << simulation.failure();
      size = std::max(size, std::abs(simulation.displacement(0, MassOnGround::x_row)));
    }
    return size;
  };
  EXPECT_GT(largest(time.step), 1e3 * largest(0.999 * coupled));
}

TEST(StepStability, FlutterIsNotTakenForAStepTooLarge) {
  // Two modes that friction couples: growth of the bodies, at any small step.
  int fluttering = 0;
  for (unsigned seed = 1; seed <= 60; ++seed) {
    const System system = random_sliding_bodies(seed, 0.6, false);
    const Pencil contacts = rows_of_contact(system, 0.6);
    try {
      const TimeParameters time =
          stepping(Integrator::central_difference, 0.02 * step_limit(system).step);
      const StepStability found = step_stability(FrozenStep(system, time), contacts);
      if (found.verdict == StepVerdict::stable) continue;
      EXPECT_EQ(found.verdict, StepVerdict::bodies_grow) << "seed " << seed;
      EXPECT_NEAR(found.growth / found.growth_of_bodies.value(), 1.0, 0.05) << "seed " << seed;
      ++fluttering;
    } catch (const NumericalError&) {
      continue;  // it jams
    }
  }
  EXPECT_GT(fluttering, 5);
}

TEST(StepStability, BeamsUnderEveryAssumptionKeepTheAnnouncedLimitWithoutFriction) {
  for (const char* assumption : {"subs_a", "subs_b", "subs_c", "film"}) {
    for (const char* friction : {"0", "0.3", "0.8"}) {
      const LoadedScene loaded = load_scene(
          scene_path("beam_on_beam.yaml"),
          {std::string("contact.assumption=") + assumption,
           std::string("contact.friction.coefficient=") + friction,
           "substructures.cantilever.mesh.along=20", "substructures.cantilever.interface={}",
           "substructures.oblique.mesh.along=15"});
      const Model model = build_model(loaded);
      const double limit = step_limit(model.system).step;
      for (const auto& [integrator, share] : {std::pair(Integrator::central_difference, 0.99),
                                              {Integrator::exact, 1.0},
                                              {Integrator::exact, 20.0}}) {
        TimeParameters time = *loaded.scene.time;
        time.integrator = integrator;
        time.step = share * limit;
        for (const PathStability& place : stability_along_path(model.system, time, 4)) {
          ASSERT_EQ(place.failure, "");
          if (std::string(friction) == "0") {
            EXPECT_LT(place.stability.radius, 1.0 + 1e-9)
                << assumption << " at " << place.positions.front() << " m, " << share;
          } else {
            EXPECT_NE(place.stability.verdict, StepVerdict::step_grows)
                << assumption << " at " << place.positions.front() << " m, friction " << friction
                << ", " << share << ": " << place.stability.growth << " 1/s at "
                << place.stability.frequency << " Hz, bodies "
                << place.stability.growth_of_bodies.value_or(0.0);
          }
        }
      }
    }
  }
}

}  // namespace
}  // namespace stridor
