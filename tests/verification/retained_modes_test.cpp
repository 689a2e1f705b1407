// As few modes as an error allows, and contacts that stay stable with them.
#include "solvers/integrators/retained_modes.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "core/errors.hpp"
#include "io/scene/scene.hpp"
#include "solvers/equilibrium/equilibrium.hpp"
#include "solvers/integrators/added_feedthrough.hpp"
#include "solvers/transient/frozen_step.hpp"
#include "tests/support/constants.hpp"
#include "tests/support/program.hpp"

namespace stridor {
namespace {

using test::scene_path;
using test::two_pi;

struct Loaded {
  TimeParameters time;
  System system;
};

Loaded load(const std::vector<std::string>& sets) {
  const LoadedScene loaded = load_scene(scene_path("beam_on_beam.yaml"), sets);
  return {*loaded.scene.time, build_model(loaded).system};
}

/// Entries of all modes of both bodies along y, the slave above a place of the master.
std::vector<std::pair<double, double>> modes_at(const System& system, int segment, double xi) {
  std::vector<std::pair<double, double>> modes;  // ω, b
  const ContactPoint& contact = system.contacts.front();
  const MasterSurface& surface = system.surface_of(contact);
  const ModalBody& slave = system.bodies[static_cast<std::size_t>(contact.slave_body)].modal;
  for (Eigen::Index i = 0; i < slave.size(); ++i)
    modes.emplace_back(slave.omega(i), slave.rows(contact.slave_rows.y, i));
  const ModalBody& master = system.bodies[static_cast<std::size_t>(surface.body)].modal;
  const auto node = static_cast<std::size_t>(segment);
  for (Eigen::Index i = 0; i < master.size(); ++i) {
    modes.emplace_back(master.omega(i), (1.0 - xi) * master.rows(surface.rows[node].y, i) +
                                            xi * master.rows(surface.rows[node + 1].y, i));
  }
  return modes;
}

/// Frequencies up to `upper` at which the contact needs no force, by bisection between the modes;
/// modes above `cutoff` answer statically.
std::vector<double> contact_frequencies(std::vector<std::pair<double, double>> modes, double cutoff,
                                        double upper) {
  std::sort(modes.begin(), modes.end());
  const auto flexibility = [&](double omega) {
    double sum = 0.0;
    for (const auto& [own, b] : modes)
      sum += b * b / (own > cutoff ? own * own : own * own - omega * omega);
    return sum;
  };
  std::vector<double> zeros;
  for (std::size_t i = 0; i + 1 < modes.size() && modes[i].first < upper; ++i) {
    double low = modes[i].first * (1.0 + 1e-12);
    double high = std::min(modes[i + 1].first, cutoff) * (1.0 - 1e-12);
    if (!(flexibility(low) < 0.0 && flexibility(high) > 0.0)) continue;
    for (int k = 0; k < 200; ++k) {
      const double middle = 0.5 * (low + high);
      (flexibility(middle) < 0.0 ? low : high) = middle;
    }
    if (low < upper) zeros.push_back(low);
  }
  return zeros;
}

TEST(RetainedModes, KeepTheErrorOfTheFrequenciesInContact) {
  const Loaded scene = load({});
  std::size_t last_moving = 0;
  for (const double error : {1e-2, 1e-3, 1e-4, 1e-5}) {
    TimeParameters time = scene.time;
    time.retain = RetainParameters{{}, error};
    const double cutoff = retained_frequency(scene.system, time);
    std::size_t moving = 0;
    double worst = 0.0;
    for (int segment = 30; segment < 96; segment += 5) {
      for (const double xi : {0.0, 0.3, 0.5}) {
        const auto modes = modes_at(scene.system, segment, xi);
        moving = 0;
        for (const auto& mode : modes) moving += mode.first <= cutoff ? 1 : 0;
        const auto exact = contact_frequencies(modes, 1e300, two_pi * 15e3);
        const auto approximate = contact_frequencies(modes, cutoff, two_pi * 15.5e3);
        ASSERT_GE(approximate.size(), exact.size());
        for (std::size_t i = 0; i < exact.size(); ++i)
          worst = std::max(worst, std::abs(approximate[i] / exact[i] - 1.0));
      }
    }
    EXPECT_LT(worst, 1.2 * error);
    EXPECT_GT(worst, 0.02 * error) << "more modes than it takes";
    EXPECT_GT(moving, last_moving);
    last_moving = moving;
  }
}

TEST(RetainedModes, RefuseAnErrorThatTheStepDoesNotResolve) {
  const Loaded scene = load({"time.integrator=exact", "time.step=1e-5", "time.retain.error=1e-6"});
  try {
    retained_frequency(scene.system, scene.time);
    FAIL() << "expected an error";
  } catch (const ConfigError& error) {
    EXPECT_THAT(error.what(), testing::AllOf(testing::HasSubstr("time.retain.error"),
                                             testing::HasSubstr("take time.step")));
  }
}

TEST(RetainedModes, TakeEitherAFrequencyOrAnError) {
  EXPECT_THROW(load({"time.retain.frequency=50 kHz", "time.retain.error=1e-3"}), ConfigError);
  EXPECT_THROW(load({"time.retain.upper=5 kHz"}), ConfigError);
}

/// Spectral radius of a step with the undeformed slave at a place of the master, without friction.
double radius_at(const System& system, const FrozenStep& step, int segment, double xi) {
  const MasterSurface& surface = system.surface_of(system.contacts.front());
  const auto node = static_cast<std::size_t>(segment);
  const double position = (1.0 - xi) * surface.arc_length[node] + xi * surface.arc_length[node + 1];
  Pencil contacts = make_modal_pencil(system);
  place_undeformed(contacts, system, drive_displacement_at(system, 0, position), 0.0, 1.0);
  return spectral_radius(step.factors(contacts));
}

TEST(AddedFeedthrough, KeepsContactsStableAllAlongThePath) {
  for (const auto& [size, modes] : {std::pair("5e-6", "30 kHz"),
                                    {"5e-6", "50 kHz"},
                                    {"1e-5", "25 kHz"},
                                    {"2.5e-6", "120 kHz"}}) {
    SCOPED_TRACE(std::string(size) + " s, modes to " + modes);
    const Loaded scene = load({"time.integrator=exact", std::string("time.step=") + size,
                               std::string("time.retain.frequency=") + modes});
    const FrozenStep step(scene.system, scene.time);
    for (int segment = 30; segment < 97; segment += 3) {
      for (const double xi : {0.0, 0.25, 0.5, 0.75})
        EXPECT_LT(radius_at(scene.system, step, segment, xi), 1.0 + 1e-9)
            << "segment " << segment << ", " << xi;
    }
  }
}

TEST(AddedFeedthrough, IsNeeded) {
  const Loaded scene =
      load({"time.integrator=exact", "time.step=1e-5", "time.retain.frequency=25 kHz"});
  const System system = retained(scene.system, scene.time);
  EXPECT_GT(added_feedthrough(system, scene.time).value(), 0.0);
  const FrozenStep step(scene.system, scene.time, 0.0);
  double worst = 0.0;
  for (int segment = 30; segment < 97; ++segment)
    worst = std::max(worst, radius_at(scene.system, step, segment, 0.5));
  EXPECT_GT(worst, 1.0 + 1e-3);
}

}  // namespace
}  // namespace stridor
