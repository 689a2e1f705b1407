// How a simulation begins: what it refuses, its bodies and contacts, and their first forces.
#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <optional>
#include <utility>

#include "solvers/integrators/added_feedthrough.hpp"
#include "solvers/integrators/retained_modes.hpp"
#include "solvers/transient/simulation_implementation.hpp"

namespace stridor {
namespace {

/// Ports that a contact with one tangent takes of its slave.
constexpr int line_slave_ports = 2;

/// @throws ConfigError for keys of the time section that do not go together
void check_integration(const TimeParameters& time, Accounts accounts) {
  if (time.is_event_driven()) {
    throw ConfigError(Refusal::contradiction, "time.integrator",
                      "event_driven has no steps of a given length, which are asked for here; set "
                      "central_difference or exact and time.step");
  }
  const bool is_modal_only = time.integrator == Integrator::exact || time.retain;
  if (time.coordinates != Coordinates::modal && is_modal_only) {
    throw ConfigError(Refusal::contradiction, "time.coordinates",
                      "integrator: exact and retain take coordinates: modal");
  }
  if (is_modal_only && accounts == Accounts::energy) {
    throw ConfigError(Refusal::contradiction, "record.energy",
                      "the energy ledger takes time.integrator: central_difference with all modes");
  }
}

/// @throws ConfigError for contacts on half-spaces with what they do not know
void check_substrates(const System& system, const TimeParameters& time, Accounts accounts) {
  const bool has_substrate =
      std::any_of(system.contacts.begin(), system.contacts.end(),
                  [](const ContactPoint& point) { return point.substrate.has_value(); });
  if (!has_substrate) return;
  if (time.retain) {
    throw ConfigError(Refusal::contradiction, "time.retain",
                      "a contact with a substrate takes all modes; leave out the key, or reduce "
                      "the bodies to fewer modes (reduction.fixed_interface_modes)");
  }
  if (accounts == Accounts::energy) {
    throw ConfigError(Refusal::contradiction, "record.energy",
                      "the energy ledger does not know what a substrate stores and dissipates; "
                      "leave it out");
  }
}

void check_contacts(const System& system) {
  for (const ContactPoint& point : system.contacts) {
    if (point.substrate && point.assumption != ContactAssumption::film) {
      throw ConfigError(Refusal::contradiction, "contact.assumption",
                        "must be `film` on a half_space: the others slide on a rigid constraint, "
                        "and cannot be compared with it");
    }
  }
  for (const ContactPoint& point : system.contacts) {
    if (!point.face) continue;
    for (const int body : {point.slave_body, point.face->body}) {
      if (!system.bodies[static_cast<std::size_t>(body)].follows_drive()) continue;
      throw ConfigError(Refusal::wrong_value, system.drive_of(body)->key + ".moves",
                        fmt::format("'{}' touches a face of a spinning body, on which contacts "
                                    "stay where they are: the drive cannot move it",
                                    system.bodies[static_cast<std::size_t>(body)].name));
    }
  }
}

void check_step(const System& system, const TimeParameters& time) {
  const StepLimit limit = step_limit(system, time);
  if (time.step <= limit.step) return;
  throw ConfigError(
      Refusal::step_too_large, "time.step",
      fmt::format(
          "{:.6g} s is above the largest stable step {:.6g} s of the central difference, set by "
          "the highest mode of '{}'; take at most that, or integrator: exact, which has no such "
          "limit",
          time.step, limit.step, limit.body));
}

/// Ports of every body for its contacts. Nodes of facets get theirs as contacts come to them
/// (NodePorts).
std::vector<int> num_contact_ports(const System& system) {
  std::vector<int> num_ports(system.bodies.size(), 0);
  for (const ContactPoint& point : system.contacts) {
    int& of_slave = num_ports[static_cast<std::size_t>(point.slave_body)];
    if (point.has_two_tangents()) {
      of_slave += point.num_slave_ports();
      if (point.face)
        num_ports[static_cast<std::size_t>(point.face->body)] += system.num_master_ports(point);
      continue;
    }
    of_slave += line_slave_ports;
    const MasterSurface& surface = system.surface_of(point);
    num_ports[static_cast<std::size_t>(surface.body)] += 2 * surface.stencil_size();
  }
  return num_ports;
}

}  // namespace

Simulation::Simulation(const System& given, const TimeParameters& time, Accounts accounts)
    : implementation_(std::make_unique<Implementation>()) {
  check_integration(time, accounts);
  check_contacts(given);
  check_substrates(given, time, accounts);
  const System system = retained(given, time);
  check_step(given, time);
  implementation_->set_up(system, time, accounts);
  implementation_->start(system, time);
}

void Simulation::Implementation::set_up(const System& system, const TimeParameters& time,
                                        Accounts accounts) {
  surfaces = system.surfaces;
  facet_surfaces = system.facet_surfaces;
  drives = system.drives;
  for (const Drive& drive : drives) driven_by.emplace_back(&drive, nullptr);
  clock.step = time.step;
  loads_constant_from = system.drives_constant_from();
  add_bodies(system, time);
  add_contacts(system);
  solver = ContactSolver(static_cast<int>(lines.size()),
                         {time.contact_tolerance, static_cast<int>(time.contact_sweeps)},
                         static_cast<int>(faces.size()));
  if (accounts == Accounts::energy) {
    ledger.emplace(system, time);
    actions.resize(records.size());
    slip_velocities.resize(records.size());
  }
}

void Simulation::Implementation::add_bodies(const System& system, const TimeParameters& time) {
  const std::vector<int> num_ports = num_contact_ports(system);
  const std::optional<double> added = added_feedthrough(system, time);
  clock.has_feedthrough = added.has_value();
  for (std::size_t b = 0; b < system.bodies.size(); ++b) {
    const SystemBody& body = system.bodies[b];
    loading.emplace_back(body);
    bodies.push_back(make_propagator(body, time, added, num_ports[b],
                                     loading.back().amplitudes(system.drives, 0.0)));
    const bool is_modal = time.coordinates == Coordinates::modal;
    shapes.push_back(is_modal ? body.modal.shapes : Eigen::MatrixXd());
    names.push_back(body.name);
    damping.push_back(body.modal.damping);
    forces.emplace_back(static_cast<std::size_t>(num_ports[b]), 0.0);
  }
}

void Simulation::Implementation::add_contacts(const System& system) {
  std::vector<int> next_port(bodies.size(), 0);
  nodes.resize(bodies.size());
  for (const ContactPoint& point : system.contacts) {
    if (point.has_two_tangents()) {
      add_face(system, point, next_port);
    } else {
      add_line(system, point, next_port);
    }
  }
  slides_only =
      faces.empty() && std::none_of(lines.begin(), lines.end(),
                                    [](const RunningLine& one) { return one.tracks_slip; });
  fit_forces();
  std::size_t next_line = 0;
  std::size_t next_face = 0;
  for (const ContactPoint& point : system.contacts) {
    if (point.has_two_tangents()) {
      records.push_back(&faces[next_face++]);
    } else {
      records.push_back(&lines[next_line++]);
    }
  }
}

void Simulation::Implementation::add_line(const System& system, const ContactPoint& point,
                                          std::vector<int>& next_port) {
  const MasterSurface& surface = surfaces[static_cast<std::size_t>(point.surface)];
  const auto slave = static_cast<std::size_t>(point.slave_body);
  const auto master = static_cast<std::size_t>(surface.body);
  const int slave_port = next_port[slave];
  next_port[slave] += line_slave_ports;
  const int master_port = next_port[master];
  next_port[master] += 2 * surface.stencil_size();
  RunningLine contact(
      SlidingPoint(point, surface, *bodies[slave], *bodies[master], slave_port, master_port));
  contact.driven = system.driven_motion(point);
  contact.begin(point);
  contact.tracks_slip = contact.unilateral_from < std::numeric_limits<double>::infinity() ||
                        point.friction.is_regularised();
  lines.add(std::move(contact));
}

void Simulation::Implementation::add_face(const System& system, const ContactPoint& point,
                                          std::vector<int>& next_port) {
  const auto slave = static_cast<std::size_t>(point.slave_body);
  const auto master = static_cast<std::size_t>(system.master_of(point));
  const int slave_port = next_port[slave];
  next_port[slave] += point.num_slave_ports();
  if (point.face) {
    const int master_port = next_port[master];
    next_port[master] += system.num_master_ports(point);
    faces.add(make_spinning_point(point, *bodies[slave], *bodies[master], slave_port, master_port),
              *bodies[slave], *bodies[master]);
  } else {
    const bool is_on_facets = point.space->surface >= 0;
    const FacetSurface* const surface =
        is_on_facets ? &facet_surfaces[static_cast<std::size_t>(point.space->surface)] : nullptr;
    if (is_on_facets && nodes[master] == nullptr)
      nodes[master] = std::make_unique<NodePorts>(*bodies[master]);
    faces.add(make_space_point(point, surface, nodes[master].get(), system.driven_motion(point),
                               *bodies[slave], *bodies[master], slave_port),
              *bodies[slave], *bodies[master]);
  }
  faces[faces.size() - 1].master = static_cast<int>(master);
}

void Simulation::Implementation::start(const System& system,
                                       const TimeParameters& time_parameters) {
  const bool is_loaded = std::any_of(drives.begin(), drives.end(), [](const Drive& drive) {
    return drive.load.value(0.0) != 0.0 || drive.shift.value(0.0) != 0.0 ||
           drive.acceleration(0.0) != 0.0;
  });
  if (clock.has_feedthrough && (is_loaded || !starts_at_rest(system))) {
    // The instantaneous part of the motion is known with the forces only.
    clock.is_predicting_start = true;
    for (std::size_t b = 0; b < bodies.size(); ++b)
      predict_start(*bodies[b], system.bodies[b], time_parameters);
    find_first_forces(system);
    clock.is_predicting_start = false;
  }
  const auto set_moving = [&] {
    for (std::size_t b = 0; b < bodies.size(); ++b)
      start_motion(*bodies[b], system.bodies[b], time_parameters, forces[b].data());
  };
  set_moving();
  if (apply_substrates()) set_moving();
  find_first_forces(system);
  // The forces at the start are now those of the springs at t_0, not of t_1.
  const bool has_springs =
      std::any_of(records.begin(), records.end(),
                  [](const ContactRecord* one) { return one->compliance > 0.0; });
  if (clock.has_feedthrough && !faces.empty() && has_springs) {
    set_moving();
    find_first_forces(system);
  }
}

void Simulation::Implementation::find_first_forces(const System& system) {
  for (RunningLine& contact : lines) {
    contact.forget();
    contact.stand(clock);
  }
  const auto lost = faces.stand(system, clock.instant(clock.time(clock.sought_index())));
  fit_forces();
  const StepOutcome outcome = lost ? fail(faces[*lost], StepOutcome::master_lost) : solve();
  if (outcome != StepOutcome::done) throw NumericalError(failure.refusal, failure.text);
}

bool Simulation::Implementation::apply_substrates() {
  bool has_any = false;
  for (RunningLine& contact : lines) {
    const auto& substrate = contact.point().substrate;
    if (!substrate) continue;
    has_any = true;
    contact.stand(clock);
    const double indentation = -contact.sliding.present_place(contact.driven_now(clock)).gap;
    const double direction = contact.slip_velocity > 0.0 ? 1.0 : -1.0;
    const SubstrateForces acting = substrate->at(indentation, contact.slip_velocity, direction);
    contact.force = acting.normal.value;
    // At rest it sticks; the force needed for that is not known before the first step.
    contact.friction_force = contact.slip_velocity == 0.0 ? 0.0 : -acting.tangential.value;
    apply_forces(contact);
  }
  return has_any;
}

}  // namespace stridor
