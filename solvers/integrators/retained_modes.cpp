#include "solvers/integrators/retained_modes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <limits>
#include <numbers>
#include <utility>
#include <vector>

#include "core/errors.hpp"
#include "coupling/system/undeformed_contact.hpp"
#include "solvers/integrators/contact_path.hpp"

namespace stridor {
namespace {

/// A mode as a contact sees it.
struct SeenMode {
  double omega;
  double square;  ///< b²
};

/// Modes of both bodies at a place of the master, slowest first.
std::vector<SeenMode> modes_seen(const System& system, const ContactPoint& contact,
                                 const WeightedRows& place, const Eigen::Vector2d& normal) {
  std::vector<SeenMode> seen;
  const auto add = [&](int index, const WeightedRows& point) {
    const ModalBody& body = system.bodies[static_cast<std::size_t>(index)].modal;
    const Eigen::VectorXd entries = (normal.transpose() * rows_of(body.rows, point)).transpose();
    for (Eigen::Index i = 0; i < body.size(); ++i)
      seen.push_back({body.omega(i), entries(i) * entries(i)});
  };
  add(contact.slave_body, {{contact.slave_rows}, {1.0}});
  add(system.surface_of(contact).body, place);
  std::sort(seen.begin(), seen.end(),
            [](const SeenMode& a, const SeenMode& b) { return a.omega < b.omega; });
  return seen;
}

/// The same with two tangents, where the normal is that of the undeformed bodies at the start.
std::vector<SeenMode> modes_seen_on_face(const System& system, const ContactPoint& contact) {
  const std::optional<UndeformedContact> at = undeformed_contact(system, contact, 0.0);
  if (!at) return {};
  const TangentPorts& normal = at->kinematics.normal;
  std::vector<SeenMode> seen;
  const auto add = [&](int index, const std::vector<std::pair<int, double>>& entries) {
    const ModalBody& body = system.bodies[static_cast<std::size_t>(index)].modal;
    for (Eigen::Index i = 0; i < body.size(); ++i) {
      double sum = 0.0;
      for (const auto& [row, factor] : entries) sum += factor * body.rows(row, i);
      seen.push_back({body.omega(i), sum * sum});
    }
  };
  std::vector<std::pair<int, double>> of_slave, of_master;
  for (int i = 0; i < contact.num_slave_ports(); ++i)
    of_slave.emplace_back(contact.slave_rows.row(i), normal(normal.size() - 3 + i));
  Eigen::Index port = 0;
  for (const int row : system.master_rows(contact, at->facet))
    of_master.emplace_back(row, normal(port++));
  add(contact.slave_body, of_slave);
  add(system.master_of(contact), of_master);
  std::sort(seen.begin(), seen.end(),
            [](const SeenMode& a, const SeenMode& b) { return a.omega < b.omega; });
  return seen;
}

/// Number of the slowest modes that have to move for an error at one place.
std::size_t num_needed(const std::vector<SeenMode>& modes, const RetainParameters& retain) {
  constexpr int num_frequencies = 400;
  const double upper = 2.0 * std::numbers::pi * retain.upper;
  std::size_t needed = 0;
  for (int i = 1; i <= num_frequencies; ++i) {
    const double square = std::pow(upper * i / num_frequencies, 2);
    double allowed = 0.0;  // error Ω f'
    for (const SeenMode& mode : modes) {
      const double distance = mode.omega * mode.omega - square;
      allowed += 2.0 * *retain.error * mode.square * square / (distance * distance);
    }
    std::size_t kept = modes.size();
    double missing = 0.0;  // Δ
    while (kept > needed) {
      const double stiffness = modes[kept - 1].omega * modes[kept - 1].omega;
      // A mode within the band is never truncated.
      if (!(stiffness > square)) break;
      missing += modes[kept - 1].square * square / (stiffness * (stiffness - square));
      if (missing > allowed) break;
      --kept;
    }
    needed = std::max(needed, kept);
  }
  return needed;
}

double frequency_for_error(const System& system, const RetainParameters& retain, double end) {
  double highest = 2.0 * std::numbers::pi * retain.upper;
  if (system.contacts.empty()) return std::numeric_limits<double>::infinity();
  const auto take = [&](const std::vector<SeenMode>& modes) {
    const std::size_t needed = num_needed(modes, retain);
    if (needed > 0) highest = std::max(highest, modes[needed - 1].omega);
  };
  for (const ContactPoint& contact : system.contacts) {
    if (contact.has_two_tangents()) {
      take(modes_seen_on_face(system, contact));
      continue;
    }
    const MasterSurface& surface = system.surface_of(contact);
    const auto first = static_cast<std::size_t>(contact.first_segment);
    const Eigen::Vector2d along = surface.positions[first + 1] - surface.positions[first];
    const Eigen::Vector2d normal = Eigen::Vector2d(-along.y(), along.x()).normalized();
    for (const WeightedRows& place : path_of(system, contact, end))
      take(modes_seen(system, contact, place, normal));
  }
  return highest;
}

}  // namespace

double asked_frequency(const System& system, const TimeParameters& time) {
  if (!time.retain) return std::numeric_limits<double>::infinity();
  if (time.retain->error) return frequency_for_error(system, *time.retain, time.end);
  return 2.0 * std::numbers::pi * time.retain->frequency.value();
}

double retained_frequency(const System& system, const TimeParameters& time) {
  const double asked = asked_frequency(system, time);
  if (time.integrator != Integrator::exact) return asked;
  // Where a force law takes the place of the constraint, there is no direct feedthrough.
  if (std::any_of(system.contacts.begin(), system.contacts.end(),
                  [](const ContactPoint& contact) { return contact.substrate.has_value(); })) {
    return asked;
  }
  // Beyond a step of 2 rad a mode approaches the frequency at which it would seem to be at rest or
  // to run backwards.
  const double resolved = 2.0 / time.step;
  if (time.retain && time.retain->error && asked > resolved) {
    throw ConfigError(
        Refusal::step_too_large, "time.retain.error",
        fmt::format("takes modes up to {:.4g} Hz, of which a step of {:.4g} s resolves "
                    "those up to {:.4g} Hz; take time.step: {:.3g} or less",
                    asked / (2.0 * std::numbers::pi), time.step,
                    resolved / (2.0 * std::numbers::pi), 2.0 / asked));
  }
  return std::min(asked, resolved);
}

System retained(const System& system, const TimeParameters& time) {
  System kept = system;
  const double cutoff = retained_frequency(system, time);
  for (SystemBody& body : kept.bodies) {
    // Modes that are coupled all move; their step has a limit of its own (CoupledPropagator).
    if (!body.modal.coupled.is_empty()) continue;
    if (body.modal.size() > 0 && body.modal.omega.maxCoeff() > cutoff)
      body.modal = with_static_residual(body.modal, cutoff);
  }
  return kept;
}

}  // namespace stridor
