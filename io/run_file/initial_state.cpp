#include "io/run_file/initial_state.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>
#include <vector>

#include "core/errors.hpp"
#include "io/hdf5/damage_guard.hpp"
#include "io/run_file/run_file.hpp"
#include "models/initial_motion.hpp"
#include "solvers/contact/starting_gap.hpp"
#include "solvers/eigenvalues/dense_eigenvalues.hpp"
#include "solvers/eigenvalues/eigenvector.hpp"
#include "solvers/equilibrium/equilibrium.hpp"
#include "solvers/equilibrium/linearise.hpp"

namespace stridor {
namespace {

constexpr const char* state_key = "initial.state";

Eigen::VectorXd as_vector(const std::vector<double>& values) {
  return Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
}

/// The reduced coordinates of two bodies mean the same where all their frequencies agree.
void check_modes(const RunFileReader& file, const std::string& path, const SystemBody& body) {
  constexpr double tolerance = 1e-6;
  const auto refuse = [&](const std::string& why) {
    throw ConfigError(Refusal::wrong_value, state_key,
                      fmt::format("{} cannot start '{}': {}", path, body.name, why));
  };
  const std::string dataset = "/modal/" + body.name + "/frequency";
  if (!file.has(dataset)) refuse("it holds no body of that name");
  const Eigen::VectorXd recorded = as_vector(file.static_array(dataset));
  const Eigen::VectorXd frequency = body.modal.omega / (2.0 * std::numbers::pi);
  if (recorded.size() != frequency.size()) {
    refuse(fmt::format("its body has {} modes, this one {}", recorded.size(), frequency.size()));
  }
  for (Eigen::Index i = 0; i < frequency.size(); ++i) {
    if (!(std::abs(recorded(i) - frequency(i)) <= tolerance * frequency.maxCoeff())) {
      refuse(fmt::format("mode {} of its body has {:.6g} Hz, that of this one {:.6g} Hz", i + 1,
                         recorded(i), frequency(i)));
    }
  }
}

/// Gives the drives and the bodies the positions and velocities at the end of the run.
void start_from_file(System& system, const std::string& path) {
  constexpr const char* drive = "/final/drive_displacement";
  const DamageGuard guard(path);
  const RunFileReader file(path);
  const std::vector<double> displaced = file.static_array(drive);
  const bool is_finite = std::all_of(displaced.begin(), displaced.end(),
                                     [](double one) { return std::isfinite(one); });
  if (displaced.size() != system.drives.size() || !is_finite) {
    throw FileError(
        Refusal::file_damaged, path, drive,
        system.drives.size() == 1
            ? std::string("should be one finite number")
            : fmt::format("should be {} finite numbers, one of each drive", system.drives.size()));
  }
  for (std::size_t d = 0; d < displaced.size(); ++d) system.drives[d].displaced = displaced[d];
  for (SystemBody& body : system.bodies) {
    if (body.modal.size() == 0) continue;
    check_modes(file, path, body);
    const std::string group = "/final/" + body.name;
    body.initial_displacement = as_vector(file.static_array(group + "/displacement"));
    body.initial_velocity = as_vector(file.static_array(group + "/velocity"));
    for (const auto& [name, motion] : {std::pair{"/displacement", &body.initial_displacement},
                                       std::pair{"/velocity", &body.initial_velocity}}) {
      if (motion->size() != body.reduced.size() || !motion->allFinite()) {
        throw FileError(Refusal::file_damaged, path, group + name,
                        fmt::format("should be {} finite numbers", body.reduced.size()));
      }
    }
  }
}

/// Steady sliding under the loads at t = 0.
Equilibrium equilibrium_at_start(const System& system) {
  EquilibriumState state;
  state.drives = drive_states(system, 0.0);
  state.friction_factor = 1.0;
  for (const ContactPoint& contact : system.contacts)
    state.friction_factor = std::min(state.friction_factor, contact.friction_rise.value(0.0));
  if (state.friction_factor < 1.0) {
    throw ConfigError(Refusal::wrong_value, state_key,
                      "equilibrium is that under the loads of t = 0, but with drive.ramp they are "
                      "still zero there; set drive.ramp: 0");
  }
  Equilibrium equilibrium = find_equilibrium(system, state);
  if (equilibrium.status != EquilibriumStatus::converged)
    throw ConfigError(Refusal::no_equilibrium, state_key,
                      "there is no sliding equilibrium: " + equilibrium.failure);
  return equilibrium;
}

/// @return the eigenvalue
std::complex<double> perturb(System& system, const Equilibrium& equilibrium,
             const PerturbationParameters& perturbation) {
  const Pencil pencil = linearise(system, equilibrium);
  std::vector<Eigenvalue> eigenvalues = dense_eigenvalues(pencil, DenseWork::eigenvalues);
  std::erase_if(eigenvalues, [](const Eigenvalue& one) { return !(one.s.imag() > 0.0); });
  const auto number = static_cast<std::size_t>(perturbation.eigenvalue);
  if (number > eigenvalues.size()) {
    throw ConfigError(Refusal::wrong_value, "initial.perturbation.eigenvalue",
                      fmt::format("{} is more than the {} eigenvalues with positive frequency",
                                  number, eigenvalues.size()));
  }
  const std::complex<double> s = eigenvalues[number - 1].s;
  add_perturbation(system, eigenvector(pencil, s).right, s, perturbation.amplitude);
  return s;
}

Eigen::VectorXd sum(const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
  if (a.size() == 0) return b;
  if (b.size() == 0) return a;
  return a + b;
}

/// Presses viscoelastic contacts in, or lifts them, without moving them along their half-space.
/// @param share of the indentation in equilibrium that comes on top
void press_in(System& system, const Equilibrium& equilibrium, double share) {
  constexpr const char* key = "initial.indentation";
  std::map<int, std::vector<PrescribedRow>> prescribed;  // by slave body
  for (std::size_t i = 0; i < system.contacts.size(); ++i) {
    const ContactPoint& contact = system.contacts[i];
    if (!contact.substrate) continue;
    std::vector<PrescribedRow>& rows = prescribed[contact.slave_body];
    rows.push_back({contact.slave_rows.x, 0.0});
    rows.push_back({contact.slave_rows.y, share * equilibrium.contacts[i].gap});
  }
  if (prescribed.empty())
    throw ConfigError(Refusal::missing, key, "needs a contact with a viscoelastic normal law");
  for (const auto& [b, rows] : prescribed) {
    SystemBody& body = system.bodies[static_cast<std::size_t>(b)];
    try {
      body.initial_displacement = sum(body.initial_displacement, static_shape(body.modal, rows));
    } catch (const NumericalError& error) {
      throw ConfigError(Refusal::wrong_value, key, error.what());
    }
  }
}

/// The key that is to blame for a gap at the start.
std::string key_of_start(const LoadedScene& loaded, const ContactPoint& contact) {
  const ModelParameters& model = loaded.scene.model;
  if (!model.initial.displacement.empty()) return "initial.displacement";
  if (model.initial.perturbation) return "initial.perturbation.amplitude";
  if (model.initial.is_file()) return state_key;
  const std::string pair = contact.pair();
  return (model.contact ? pair : "contacts." + pair) + ".slave";
}

std::string gap_message(const System& system, const StartingGap& start) {
  const ContactPoint& contact = system.contacts[static_cast<std::size_t>(start.contact)];
  const Eigen::Vector3d lift = -start.gap * start.normal + Eigen::Vector3d::Zero();  // no -0
  const std::string move = fmt::format(
      "move '{}' by x: {:.12g} m, y: {:.12g} m{} (initial.displacement)",
      system.bodies[static_cast<std::size_t>(contact.slave_body)].name, lift.x(), lift.y(),
      lift.z() == 0.0 ? "" : fmt::format(", z: {:.12g} m", lift.z()));
  if (may_start_open(contact)) {
    return fmt::format(
        "'{}' starts {:.6g} m inside its master '{}', which the first step would turn into energy "
        "from nothing; the smallest lift that removes it: {}",
        contact.name, -start.gap, system.master_name(contact), move);
  }
  return fmt::format(
      "'{}' starts {:.6g} m {} its master '{}', and a contact that slides persistently closes any "
      "gap in the first step, with energy from nothing; {}, or take assumption: film, in which a "
      "contact may start open",
      contact.name, std::abs(start.gap), start.gap < 0.0 ? "inside" : "away from",
      system.master_name(contact), move);
}

/// Refuses gaps that the contact forces would close in the first step. An overlap of a force law is
/// its indentation, which stores the energy that it gives back.
void check_gaps(const System& system, const LoadedScene& loaded) {
  // An eigenvector closes the contacts to first order in its amplitude: the normal turns as well.
  constexpr double turning = 1e-3;
  const InitialParameters& initial = loaded.scene.model.initial;
  const double amplitude = initial.perturbation ? initial.perturbation->amplitude : 0.0;
  std::map<int, StartingGap> worst;  // by slave body: one motion of it removes all
  for (const StartingGap& start : starting_gaps(system)) {
    const ContactPoint& contact = system.contacts[static_cast<std::size_t>(start.contact)];
    if (contact.substrate || contact.penalty) continue;
    if (may_start_open(contact) && start.gap >= 0.0) continue;
    const double allowed = negligible_gap(system, contact) + turning * amplitude;
    if (std::abs(start.gap) <= allowed) continue;
    const auto [known, is_new] = worst.try_emplace(contact.slave_body, start);
    if (!is_new && std::abs(start.gap) > std::abs(known->second.gap)) known->second = start;
  }
  if (worst.empty()) return;
  std::vector<Problem> problems;
  for (const auto& [body, start] : worst) {
    const ContactPoint& contact = system.contacts[static_cast<std::size_t>(start.contact)];
    problems.push_back(
        {Refusal::off_the_surface, key_of_start(loaded, contact), gap_message(system, start)});
  }
  throw loaded.located(ConfigError(std::move(problems)));
}

InitialState add_state(System& system, const LoadedScene& loaded) {
  const InitialParameters& initial = loaded.scene.model.initial;
  InitialState state;
  if (initial.state == InitialParameters::rest) return state;
  const std::vector<SystemBody> prescribed = system.bodies;
  try {
    if (initial.is_file()) {
      start_from_file(system, path_of_file(loaded.tree, state_key, initial.state));
    } else {
      const Equilibrium equilibrium = equilibrium_at_start(system);
      apply_initial_motion(system, equilibrium);
      if (initial.perturbation)
        state.perturbation = perturb(system, equilibrium, *initial.perturbation);
      if (initial.indentation) press_in(system, equilibrium, *initial.indentation - 1.0);
    }
  } catch (const ConfigError& error) {
    throw loaded.located(error);
  }
  for (std::size_t b = 0; b < system.bodies.size(); ++b) {
    SystemBody& body = system.bodies[b];
    body.initial_displacement = sum(body.initial_displacement, prescribed[b].initial_displacement);
    body.initial_velocity = sum(body.initial_velocity, prescribed[b].initial_velocity);
  }
  return state;
}

}  // namespace

InitialState set_initial_state(System& system, const LoadedScene& loaded) {
  const InitialState state = add_state(system, loaded);
  check_gaps(system, loaded);
  return state;
}

}  // namespace stridor
