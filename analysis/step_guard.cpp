#include "analysis/step_guard.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/QR>
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <iterator>
#include <limits>
#include <numbers>
#include <span>
#include <stdexcept>
#include <thread>
#include <utility>
#include <vector>

#include "core/errors.hpp"
#include "core/tasks.hpp"
#include "coupling/system/undeformed_contact.hpp"
#include "solvers/equilibrium/equilibrium.hpp"
#include "solvers/equilibrium/linearise.hpp"
#include "solvers/integrators/contact_path.hpp"
#include "solvers/integrators/make_propagator.hpp"

namespace stridor {
namespace {

/// Growth that a run tolerates: its accuracy is another matter than its stability.
GrowthTolerance tolerance_of(const TimeParameters& time) {
  constexpr double share = 0.5;
  constexpr double by_the_end = 0.1;
  constexpr double share_of_bodies = 0.1;
  return {share, by_the_end / time.end, share_of_bodies};
}

bool has_coupled_modes(const System& system) {
  return std::any_of(system.bodies.begin(), system.bodies.end(),
                     [](const SystemBody& body) { return !body.modal.coupled.is_empty(); });
}

bool may_open(const ContactPoint& contact) {
  return std::isfinite(contact.unilateral_from()) || contact.assumption == ContactAssumption::film;
}

/// Displacements of the leading drive.
std::vector<double> places_of(const System& system, const TimeParameters& time) {
  const auto [least, most] = drive_range(system.leading_drive(), time.end);
  double shortest = std::numeric_limits<double>::infinity();
  for (const FacetSurface& surface : system.facet_surfaces) {
    for (std::size_t f = 0; f < surface.facets.size(); ++f)
      shortest = std::min(shortest, surface.patch(static_cast<int>(f)).nodes[1].norm());
  }
  for (const MasterSurface& surface : system.surfaces) {
    for (std::size_t k = 1; k < surface.arc_length.size(); ++k)
      shortest = std::min(shortest, surface.arc_length[k] - surface.arc_length[k - 1]);
  }
  const int num_most = has_coupled_modes(system) ? 3 : 9;
  const double parts = std::min((most - least) / (0.5 * shortest), num_most - 1.0);
  const int num_parts = static_cast<int>(std::max(0.0, std::floor(parts)));
  std::vector<double> places;
  for (int i = 0; i <= num_parts; ++i)
    places.push_back(num_parts == 0 ? 0.0 : least + (most - least) * i / num_parts);
  return places;
}

/// Sliding contacts, and what they are called.
struct SlidingContacts {
  Pencil rows;
  std::vector<std::size_t> contacts;  ///< of the constraints
  std::vector<double> positions;      ///< along the masters, m; empty on undeformed masters
  std::vector<TangentPair> tangents;  ///< of the contacts with two of them

  std::string place(const System& system, std::size_t constraint, double displacement) const {
    const ContactPoint& contact = system.contacts[contacts[constraint]];
    if (contact.face) return fmt::format("at a radius of {:.4g} m", contact.face->radius);
    return positions.empty() ? fmt::format("with the drive displaced by {:.4g} m", displacement)
                             : fmt::format("at {:.4g} m of its master", positions[constraint]);
  }
};

std::optional<SlidingContacts> in_equilibrium(const System& system, double displacement) {
  const Equilibrium equilibrium = find_equilibrium(system, sliding_state(system, displacement));
  if (equilibrium.status != EquilibriumStatus::converged) return std::nullopt;
  SlidingContacts sliding;
  for (std::size_t c = 0; c < equilibrium.contacts.size(); ++c) {
    if (!equilibrium.contacts[c].is_closed) continue;
    sliding.contacts.push_back(c);
    sliding.positions.push_back(equilibrium.contacts[c].position);
    const ContactPoint& contact = system.contacts[c];
    sliding.tangents.emplace_back();
    if (contact.has_two_tangents()) {
      sliding.tangents.back() =
          tangent_kinematics(system, contact, equilibrium.contacts[c], ContactGeometry::deformed)
              .sliding;
    }
  }
  if (sliding.contacts.empty()) return std::nullopt;
  sliding.rows = linearise_constraints(system, equilibrium);
  return sliding;
}

/// As Pencil::compliance.
Eigen::VectorXd compliance_of(const System& system) {
  Eigen::VectorXd compliance(static_cast<Eigen::Index>(system.contacts.size()));
  for (std::size_t c = 0; c < system.contacts.size(); ++c)
    compliance(static_cast<Eigen::Index>(c)) = system.contacts[c].compliance();
  if (compliance.isZero(0.0)) compliance.resize(0);
  return compliance;
}

/// B_E is linear in the friction coefficient.
SlidingContacts on_undeformed_masters(const System& system, double displacement) {
  SlidingContacts sliding;
  sliding.rows = make_modal_pencil(system);
  Pencil rough = sliding.rows;
  place_undeformed(sliding.rows, system, displacement, 0.0, 1.0);
  place_undeformed(rough, system, displacement, 1.0, 1.0);
  for (std::size_t c = 0; c < system.contacts.size(); ++c) {
    const ContactPoint& contact = system.contacts[c];
    double slip = system.driven_motion(contact).end_velocity();
    sliding.tangents.emplace_back();
    if (contact.has_two_tangents()) {
      const auto at = undeformed_contact(system, contact, displacement);
      sliding.tangents.back() = at->kinematics.sliding;
      slip = contact.face ? at->kinematics.velocity.x() : at->kinematics.velocity.norm();
    }
    const double factor = (slip < 0.0 ? -1.0 : 1.0) * sliding_friction(contact.friction, slip);
    const auto row = static_cast<Eigen::Index>(c);
    sliding.rows.equilibrium.row(row) +=
        factor * (rough.equilibrium.row(row) - sliding.rows.equilibrium.row(row));
    sliding.contacts.push_back(c);
  }
  sliding.rows.compliance = compliance_of(system);
  return sliding;
}

std::optional<SlidingContacts> sliding_at(const System& system, double displacement) {
  try {
    if (auto found = in_equilibrium(system, displacement)) return found;
  } catch (const NumericalError&) {  // there is none
  }
  try {
    return on_undeformed_masters(system, displacement);
  } catch (const std::invalid_argument&) {
    return std::nullopt;  // a slave is beside its master
  }
}

/// Leaves of the rigid rows of B_C as many as hold motions of their own: those of a basis of the
/// rows of B_C S, by QR with pivoting. Few modes at many contacts leave some dependent. With
/// B_E = B_C these change no motion, but make B_C S Sᵀ B_Eᵀ singular and its determinant rounding.
///
/// @param held B_C, constraints x ports; B_E is not looked at. Compliant rows stay: their
/// compliance
///             keeps them independent.
void drop_dependent_rows(Pencil& held) {
  constexpr double rounding = 1e-10;  // of the largest pivot
  std::vector<Eigen::Index> rigid;
  std::vector<Eigen::Index> kept;
  for (Eigen::Index row = 0; row < held.compatibility.rows(); ++row) {
    const bool is_spring = held.compliance.size() > 0 && held.compliance(row) > 0.0;
    (is_spring ? kept : rigid).push_back(row);
  }
  const Eigen::MatrixXd modal = held.compatibility(rigid, Eigen::all) * held.ports;
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> columns(modal.transpose());
  columns.setThreshold(rounding);
  if (columns.rank() == modal.rows()) return;
  for (Eigen::Index i = 0; i < columns.rank(); ++i)
    kept.push_back(rigid[static_cast<std::size_t>(columns.colsPermutation().indices()(i))]);
  std::sort(kept.begin(), kept.end());
  held.compatibility = held.compatibility(kept, Eigen::all).eval();
  if (held.compliance.size() > 0) held.compliance = held.compliance(kept).eval();
}

/// The tangents of contacts held as well: t = (n_y, −n_x) in every pair of ports, or both of two.
Pencil sticking(const System& system, const SlidingContacts& at) {
  const Pencil& sliding = at.rows;
  Pencil held = sliding;
  const Eigen::Index k = sliding.num_constraints();
  Eigen::Index num_rows = k;
  for (const std::size_t c : at.contacts) num_rows += system.contacts[c].has_two_tangents() ? 2 : 1;
  held.compatibility.setZero(num_rows, sliding.num_ports());
  held.compatibility.topRows(k) = sliding.compatibility;
  Eigen::Index row = k;
  Eigen::Index port = 0;
  for (std::size_t i = 0; i < at.contacts.size(); ++i) {
    const ContactPoint& contact = system.contacts[at.contacts[i]];
    const Eigen::Index num_ports = system.num_contact_ports(contact);
    const auto normal = sliding.compatibility.row(static_cast<Eigen::Index>(i));
    if (contact.has_two_tangents()) {
      for (Eigen::Index direction = 0; direction < 2; ++direction) {
        held.compatibility.row(row++).segment(port, num_ports) =
            at.tangents[i].col(direction).head(num_ports).transpose();
      }
    } else {
      for (Eigen::Index s = port; s < port + num_ports; s += 2) {
        held.compatibility(row, s) = normal(s + 1);
        held.compatibility(row, s + 1) = -normal(s);
      }
      ++row;
    }
    port += num_ports;
  }
  if (sliding.compliance.size() > 0) {
    held.compliance.setZero(num_rows);
    held.compliance.head(k) = sliding.compliance;
  }
  drop_dependent_rows(held);
  held.equilibrium = held.compatibility;
  return held;
}

void add_states(const System& system, const SlidingContacts& at, double displacement,
                std::vector<HeldContacts>& states) {
  const auto name_of = [&](std::size_t constraint) {
    return fmt::format("'{}'", system.contacts[at.contacts[constraint]].name);
  };
  const bool can_open = std::any_of(at.contacts.begin(), at.contacts.end(),
                                    [&](std::size_t c) { return may_open(system.contacts[c]); });
  constexpr std::size_t most_named = 8;
  const std::size_t num_contacts = at.contacts.size();
  std::string all = name_of(0);
  if (num_contacts > most_named) {
    all = fmt::format("{} contacts from {} to {}", num_contacts, all, name_of(num_contacts - 1));
  } else {
    for (std::size_t c = 1; c < num_contacts; ++c) all += ", " + name_of(c);
  }
  states.push_back({fmt::format("{} sliding {}", all, at.place(system, 0, displacement)), at.rows});
  // Of many, some from one end to the other: neighbours are alike.
  constexpr std::size_t most_alone = 8;
  const std::size_t stride = (at.contacts.size() + most_alone - 1) / most_alone;
  for (std::size_t c = 0; can_open && at.contacts.size() > 1 && c < at.contacts.size(); c += stride) {
    Pencil alone = at.rows;
    const auto row = static_cast<Eigen::Index>(c);
    alone.compatibility = at.rows.compatibility.row(row).eval();
    alone.equilibrium = at.rows.equilibrium.row(row).eval();
    if (at.rows.compliance.size() > 0) alone.compliance = at.rows.compliance.segment(row, 1).eval();
    states.push_back(
        {fmt::format("{} sliding alone {}", name_of(c), at.place(system, c, displacement)),
         std::move(alone)});
  }
  const bool can_stick =
      can_open && std::any_of(at.contacts.begin(), at.contacts.end(), [&](std::size_t c) {
        const FrictionLaw& friction = system.contacts[c].friction;
        return friction.static_coefficient > 0.0 && !friction.is_regularised();
      });
  if (can_stick && has_coupled_modes(system))
    states.push_back({fmt::format("{} sticking {}", all, at.place(system, 0, displacement)),
                      sticking(system, at)});
}

/// Does work(0) … work(count − 1) on all processors: every state of a scene by itself.
void for_each_of(std::size_t count, const std::function<void(std::size_t)>& work) {
  run_tasks(
      count, static_cast<int>(std::thread::hardware_concurrency()),
      [&](std::size_t task, std::size_t) { work(task); }, [](std::size_t, std::size_t) {});
}

std::string remedy_text(const StepRemedy& remedy, const TimeParameters& time) {
  if (remedy.is_empty()) {
    return fmt::format(
        "at a hundredth of the step ({:.3g} s) it does so too: contacts like these "
        "have a fast motion of their own; lower the friction coefficient",
        0.01 * time.step);
  }
  std::vector<std::string> ways;
  const auto add = [&](const char* form, const std::optional<double>& value) {
    if (value) ways.push_back(fmt::format(fmt::runtime(form), *value));
  };
  add("time.step: {:.6g}", remedy.step);
  add("time.retain: {{frequency: {:.4g} Hz}}", remedy.retained);
  add("time.step: {:.6g} without time.retain", remedy.with_all_modes);
  add("time.integrator: central_difference with time.step: {:.6g} and without time.retain",
      remedy.with_central_difference);
  return fmt::format("take {}, with which it does not", fmt::join(ways, ", or "));
}

}  // namespace

std::vector<HeldContacts> held_contacts(const System& system, const TimeParameters& time) {
  std::vector<HeldContacts> states;
  if (system.contacts.empty() ||
      std::any_of(system.contacts.begin(), system.contacts.end(),
                  [](const ContactPoint& contact) { return contact.substrate.has_value(); }))
    return states;
  const std::vector<double> places = places_of(system, time);
  std::vector<std::vector<HeldContacts>> at_places(places.size());
  for_each_of(places.size(), [&](std::size_t i) {
    if (const auto at = sliding_at(system, places[i]))
      add_states(system, *at, places[i], at_places[i]);
  });
  for (std::vector<HeldContacts>& here : at_places)
    std::move(here.begin(), here.end(), std::back_inserter(states));
  return states;
}

std::optional<OwnGrowth> own_growth(const System& system, const TimeParameters& time,
                                    const std::vector<HeldContacts>& contacts) {
  if (contacts.empty()) return std::nullopt;
  const FrozenStep step(system, time);
  std::vector<StepStability> stability(contacts.size());
  for_each_of(contacts.size(), [&](std::size_t i) {
    try {
      stability[i] = step_stability(step, contacts[i].rows, tolerance_of(time));
    } catch (const NumericalError&) {  // it jams, which the run finds out
    }
  });
  std::optional<OwnGrowth> worst;
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const StepStability& found = stability[i];
    if (found.verdict != StepVerdict::step_grows) continue;
    if (!worst || found.own_growth() > worst->stability.own_growth())
      worst = OwnGrowth{contacts[i].name, found};
  }
  return worst;
}

StepRemedy step_remedy(const System& system, const TimeParameters& time,
                       const std::vector<HeldContacts>& contacts) {
  const auto cures = [&](const TimeParameters& other) {
    try {
      return other.step <= step_limit(system, other).step && !own_growth(system, other, contacts);
    } catch (const ConfigError&) {
      return false;  // settings that do not go together
    }
  };
  const auto largest_step = [&](TimeParameters other, double whole,
                                std::span<const int> parts) -> std::optional<double> {
    for (const int part : parts) {
      other.step = whole / part;
      if (cures(other)) return other.step;
    }
    return std::nullopt;
  };
  StepRemedy remedy;
  constexpr std::array parts{1, 2, 4, 5, 8, 10, 20, 25, 40, 50, 80, 100};
  remedy.step = largest_step(time, time.step, std::span(parts).subspan(1));
  TimeParameters other = time;
  if (!time.retain) {
    // Modes that turn by 1 rad in a step.
    const double frequency = 1.0 / (2.0 * std::numbers::pi * time.step);
    other.retain = RetainParameters{frequency, {}};
    if (cures(other)) remedy.retained = frequency;
  }
  if (!remedy.is_empty()) return remedy;
  other.retain.reset();
  if (time.retain) remedy.with_all_modes = largest_step(other, time.step, parts);
  if (!remedy.is_empty() || time.integrator == Integrator::central_difference) return remedy;
  other.integrator = Integrator::central_difference;
  // Below its limit, a whole part of the step.
  const double limit = 0.99 * step_limit(system, other).step;
  remedy.with_central_difference =
      largest_step(other, time.step / std::ceil(time.step / limit), parts);
  return remedy;
}

void require_no_own_growth(const System& system, const TimeParameters& time) {
  const std::vector<HeldContacts> contacts = held_contacts(system, time);
  const std::optional<OwnGrowth> found = own_growth(system, time, contacts);
  if (!found) return;
  const StepStability& stability = found->stability;
  throw NumericalError(
      Refusal::step_too_large,
      fmt::format(
          "time.step: with a step of {:.6g} s a motion of {:.4g} Hz grows by {:.4g} 1/s, {}, where "
          "the bodies in contact do not grow at about that frequency, or less than a tenth as "
          "fast. "
          "Remedy: {}; stridor check --stability shows the whole path.",
          time.step, stability.frequency, stability.growth, found->name,
          remedy_text(step_remedy(system, time, contacts), time)));
}

Simulation make_run_simulation(const System& system, const TimeParameters& time,
                               Accounts accounts) {
  // Settings that do not go together are refused first.
  Simulation simulation(system, time, accounts);
  require_no_own_growth(system, time);
  return simulation;
}

}  // namespace stridor
