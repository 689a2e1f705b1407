#include "solvers/transient/simulation.hpp"

#include <algorithm>
#include <array>
#include <optional>
#include <utility>

#include "solvers/integrators/added_feedthrough.hpp"
#include "solvers/integrators/retained_modes.hpp"
#include "solvers/transient/simulation_implementation.hpp"

namespace stridor {
namespace {

/// Statistics of a contact that a saved state holds, by name.
auto saved_statistics(auto& contact) {
  using Entry = std::pair<const char*, decltype(&contact.statistics)>;
  return std::array{Entry{"statistics", &contact.statistics}, Entry{"earlier", &contact.earlier},
                    Entry{"open_interval", &contact.open_interval}};
}

}  // namespace

Simulation::Simulation(const System& given, const TimeParameters& time, Accounts accounts)
    : implementation_(std::make_unique<Implementation>()) {
  if (time.is_event_driven()) {
    throw ConfigError(Refusal::contradiction, "time.integrator",
                      "event_driven has no steps of a given length, which are asked for here; set "
                      "central_difference or exact and time.step");
  }
  if (time.coordinates != Coordinates::modal &&
      (time.integrator == Integrator::exact || time.retain)) {
    throw ConfigError(Refusal::contradiction, "time.coordinates",
                      "integrator: exact and retain take coordinates: modal");
  }
  if ((time.integrator == Integrator::exact || time.retain) && accounts == Accounts::energy) {
    throw ConfigError(Refusal::contradiction, "record.energy",
                      "the energy ledger takes time.integrator: central_difference with all modes");
  }
  const bool has_substrate =
      std::any_of(given.contacts.begin(), given.contacts.end(),
                  [](const ContactPoint& point) { return point.substrate.has_value(); });
  for (const ContactPoint& point : given.contacts) {
    if (point.substrate && point.assumption != ContactAssumption::film) {
      throw ConfigError(Refusal::contradiction, "contact.assumption",
                        "must be `film` on a half_space: the others slide on a rigid constraint, "
                        "and cannot be compared with it");
    }
  }
  for (const ContactPoint& point : given.contacts) {
    if (!point.face) continue;
    for (const int body : {point.slave_body, point.face->body}) {
      if (!given.bodies[static_cast<std::size_t>(body)].follows_drive()) continue;
      throw ConfigError(Refusal::wrong_value, given.drive_of(body)->key + ".moves",
                        fmt::format("'{}' touches a face of a spinning body, on which contacts "
                                    "stay where they are: the drive cannot move it",
                                    given.bodies[static_cast<std::size_t>(body)].name));
    }
  }
  if (has_substrate && time.retain) {
    throw ConfigError(Refusal::contradiction, "time.retain",
                      "a contact with a substrate takes all modes; leave out the key, or reduce "
                      "the bodies to fewer modes (reduction.fixed_interface_modes)");
  }
  if (has_substrate && accounts == Accounts::energy) {
    throw ConfigError(Refusal::contradiction, "record.energy",
                      "the energy ledger does not know what a substrate stores and dissipates; "
                      "leave it out");
  }
  const System system = retained(given, time);
  const StepLimit limit = step_limit(given, time);
  if (!(time.step <= limit.step)) {
    throw ConfigError(
        Refusal::step_too_large, "time.step",
        fmt::format(
            "{:.6g} s is above the largest stable step {:.6g} s of the central difference, set by "
            "the highest mode of '{}'; take at most that, or integrator: exact, which has no such "
            "limit",
            time.step, limit.step, limit.body));
  }
  Implementation& run = *implementation_;
  run.surfaces = system.surfaces;
  run.facet_surfaces = system.facet_surfaces;
  run.drives = system.drives;
  for (const Drive& drive : run.drives) run.driven_by.emplace_back(&drive, nullptr);
  run.step = time.step;
  run.loads_constant_from = system.drives_constant_from();

  std::vector<int> num_ports(system.bodies.size(), 0);
  for (const ContactPoint& point : system.contacts) {
    if (point.has_two_tangents()) {
      num_ports[static_cast<std::size_t>(point.slave_body)] += point.num_slave_ports();
      // Nodes of facets get theirs as contacts come to them (NodePorts).
      if (point.face)
        num_ports[static_cast<std::size_t>(point.face->body)] += system.num_master_ports(point);
      continue;
    }
    num_ports[static_cast<std::size_t>(point.slave_body)] += slave_ports;
    const MasterSurface& surface = system.surface_of(point);
    num_ports[static_cast<std::size_t>(surface.body)] += 2 * surface.stencil_size();
  }
  const std::optional<double> added = added_feedthrough(system, time);
  run.has_feedthrough = added.has_value();
  for (std::size_t b = 0; b < system.bodies.size(); ++b) {
    const SystemBody& body = system.bodies[b];
    run.loading.emplace_back(body);
    run.bodies.push_back(make_propagator(body, time, added, num_ports[b],
                                         run.loading.back().amplitudes(system.drives, 0.0)));
    const bool is_modal = time.coordinates == Coordinates::modal;
    run.shapes.push_back(is_modal ? body.modal.shapes : Eigen::MatrixXd());
    run.names.push_back(body.name);
    run.damping.push_back(body.modal.damping);
    run.forces.emplace_back(static_cast<std::size_t>(num_ports[b]), 0.0);
  }
  run.add_contacts(system);
  run.solver = ContactSolver(static_cast<int>(run.contacts.size()),
                             {time.contact_tolerance, static_cast<int>(time.contact_sweeps)},
                             static_cast<int>(run.faces.size()));
  run.local.resize(run.contacts.size());
  if (accounts == Accounts::energy) {
    run.ledger.emplace(system, time);
    run.actions.resize(run.records.size());
    run.slip_velocities.resize(run.records.size());
  }
  run.start(system, time);
}

Simulation::~Simulation() = default;
Simulation::Simulation(Simulation&&) noexcept = default;
Simulation& Simulation::operator=(Simulation&&) noexcept = default;

StepOutcome Simulation::step() {
  Implementation& run = *implementation_;
  if (!run.ledger) {
    run.advance();
    return run.finish_step();
  }
  const StepOutcome outcome = run.advance_on_account();
  return outcome == StepOutcome::done ? run.solve() : outcome;
}

StepOutcome Simulation::step_until(std::int64_t target) {
  Implementation& run = *implementation_;
  StepOutcome outcome = StepOutcome::done;
  while (outcome == StepOutcome::done && run.index < target) outcome = step();
  if (outcome == StepOutcome::done && run.index >= run.next_health_check)
    outcome = run.check_health();
  return outcome;
}

std::int64_t Simulation::step_index() const {
  return implementation_->index;
}
double Simulation::time() const {
  return implementation_->time(implementation_->index);
}
double Simulation::step_size() const {
  return implementation_->step;
}

double Simulation::displacement(int body, int row) const {
  return implementation_->bodies[static_cast<std::size_t>(body)]->displacement(row);
}

Propagator::Motion Simulation::motion(int body) const {
  const auto b = static_cast<std::size_t>(body);
  return implementation_->bodies[b]->motion(implementation_->forces[b].data());
}

Propagator::Motion Simulation::reduced_motion(int body) const {
  const auto b = static_cast<std::size_t>(body);
  Propagator::Motion motion = this->motion(body);
  const Eigen::MatrixXd& shapes = implementation_->shapes[b];
  if (shapes.rows() == 0) return motion;
  motion.displacement = shapes * motion.displacement;
  motion.velocity = shapes * motion.velocity;
  const Eigen::VectorXd residual = implementation_->bodies[b]->residual_displacement();
  if (residual.size() > 0) motion.displacement += residual;
  return motion;
}

double Simulation::drive_displacement(int drive) const {
  return implementation_->driven_by[static_cast<std::size_t>(drive)].displacement(time());
}

int Simulation::num_contacts() const {
  return static_cast<int>(implementation_->records.size());
}

double Simulation::contact_force(int contact) const {
  return implementation_->records[static_cast<std::size_t>(contact)]->force;
}

double Simulation::friction_force(int contact) const {
  return implementation_->records[static_cast<std::size_t>(contact)]->friction_force;
}

ContactState Simulation::contact_state(int contact) const {
  return implementation_->records[static_cast<std::size_t>(contact)]->state;
}

double Simulation::contact_area(int contact) const {
  const RunningContact* const on_line = implementation_->line(contact);
  if (on_line == nullptr) return 0.0;
  const RunningContact& of = *on_line;
  const std::optional<SubstrateContact>& substrate = of.point().substrate;
  return substrate ? substrate->area(-contact_place(contact).gap, of.slip_velocity) : 0.0;
}

ContactAction Simulation::contact_action(int contact) const {
  const RunningContact* const on_line = implementation_->line(contact);
  return on_line != nullptr ? Implementation::action_of(*on_line)
                            : implementation_->action_of(*implementation_->on_face(contact));
}

double Simulation::slip_velocity(int contact) const {
  return implementation_->records[static_cast<std::size_t>(contact)]->slip_velocity;
}

ContactPlace Simulation::contact_place(int contact) const {
  if (const RunningFace* const face = implementation_->on_face(contact)) {
    const FacePoint& kinematics = *face->kinematics;
    return {kinematics.present_gap(time()), kinematics.position()};
  }
  const RunningContact& on_line = *implementation_->line(contact);
  return on_line.sliding.present_place(on_line.driven.displacement(time()));
}

double Simulation::friction_across(int contact) const {
  const RunningFace* const face = implementation_->on_face(contact);
  return face != nullptr ? face->friction_across : 0.0;
}

Eigen::Vector2d Simulation::sliding_velocity(int contact) const {
  const RunningFace* const face = implementation_->on_face(contact);
  return face != nullptr ? face->velocities[0] : Eigen::Vector2d(slip_velocity(contact), 0.0);
}

const ViolationCount& Simulation::violations(int contact) const {
  return implementation_->records[static_cast<std::size_t>(contact)]->violations;
}

ContactStatistics Simulation::statistics(int contact) const {
  const ContactRecord& of = *implementation_->records[static_cast<std::size_t>(contact)];
  ContactStatistics all = of.earlier;
  all.add(of.statistics);
  return all;
}

void Simulation::reset_statistics() {
  for (ContactRecord* const contact : implementation_->records) {
    contact->open_interval.add(contact->statistics);
    contact->statistics = {};
    contact->count();
    contact->earlier = std::exchange(contact->statistics, {});
  }
}

void Simulation::end_interval() {
  for (ContactRecord* const contact : implementation_->records) {
    contact->earlier.add(contact->statistics);
    contact->interval = std::exchange(contact->open_interval, {});
    contact->interval.add(std::exchange(contact->statistics, {}));
  }
}

const ContactStatistics& Simulation::interval_statistics(int contact) const {
  return implementation_->records[static_cast<std::size_t>(contact)]->interval;
}

const EnergyLedger* Simulation::energy() const {
  return implementation_->ledger ? &*implementation_->ledger : nullptr;
}

Refusal refusal_of(StepOutcome outcome) {
  switch (outcome) {
    case StepOutcome::master_lost:
      return Refusal::left_the_surface;
    case StepOutcome::pulling:
      return Refusal::contact_pulls;
    case StepOutcome::sliding_reversed:
      return Refusal::sliding_turns;
    case StepOutcome::jammed:
      return Refusal::contact_jams;
    case StepOutcome::not_converged:
      return Refusal::no_convergence;
    case StepOutcome::sunk:
      return Refusal::indentation_too_deep;
    case StepOutcome::overshot:
      return Refusal::substrate_too_stiff;
    case StepOutcome::diverged:
    case StepOutcome::done:
      break;
  }
  return Refusal::diverged;
}

const std::string& Simulation::failure() const {
  return implementation_->failure;
}

Refusal Simulation::refusal() const {
  return implementation_->refusal;
}

State Simulation::save() const {
  const Implementation& run = *implementation_;
  State state;
  state.put("step", run.step);
  state.put("index", static_cast<double>(run.index));
  for (std::size_t b = 0; b < run.bodies.size(); ++b) {
    const std::string prefix = fmt::format("bodies/{}/", b);
    run.bodies[b]->save(state, prefix);
    state.put(prefix + "forces", run.forces[b]);
  }
  for (std::size_t i = 0; i < run.contacts.size(); ++i) {
    const RunningContact& c = run.contacts[i];
    const Projection& p = c.sliding.projection();
    const double values[] = {static_cast<double>(c.sliding.segment()),
                             p.xi,
                             p.tangent.x(),
                             p.tangent.y(),
                             c.force,
                             c.friction_force,
                             static_cast<double>(c.state),
                             c.slip_velocity,
                             c.anchor,
                             static_cast<double>(c.steady_steps),
                             static_cast<double>(c.violations.negative_force),
                             static_cast<double>(c.violations.reversed_sliding),
                             static_cast<double>(c.violations.before_armed),
                             c.violations.last_time};
    state.put(fmt::format("contacts/{}", i), values);
    for (const auto& [name, statistics] : saved_statistics(c))
      state.put(fmt::format("contacts/{}/{}", i, name), statistics->numbers());
  }
  for (std::size_t i = 0; i < run.faces.size(); ++i) {
    const std::string name = fmt::format("faces/{}", i);
    state.put(name, run.faces[i].numbers());
    for (const auto& [part, statistics] : saved_statistics(run.faces[i]))
      state.put(name + "/" + part, statistics->numbers());
  }
  if (run.ledger) run.ledger->save(state, "energy/");
  return state;
}

void Simulation::load(const State& state) {
  Implementation& run = *implementation_;
  if (state.get("step") != run.step)
    throw std::invalid_argument("Simulation::load: the state has another time step");
  run.index = static_cast<std::int64_t>(state.get("index"));
  run.next_health_check = 0;
  run.set_loads(run.time(run.index));
  for (std::size_t b = 0; b < run.bodies.size(); ++b) {
    const std::string prefix = fmt::format("bodies/{}/", b);
    if (run.nodes[b]) run.nodes[b]->restore(state.array(prefix + "rows"));
    run.bodies[b]->set_mass_damping(run.damping[b].alpha_at(run.time(run.index)));
    run.bodies[b]->load(state, prefix);
    run.fit_forces();
    state.get(prefix + "forces", run.forces[b]);
  }
  for (std::size_t i = 0; i < run.contacts.size(); ++i) {
    RunningContact& c = run.contacts[i];
    double values[14];
    state.get(fmt::format("contacts/{}", i), values);
    const auto count = [&](int k) { return static_cast<std::int64_t>(values[k]); };
    c.sliding.restore(static_cast<int>(values[0]), values[1], {values[2], values[3]});
    c.force = values[4];
    c.friction_force = values[5];
    c.state = static_cast<ContactState>(count(6));
    c.slip_velocity = values[7];
    c.anchor = values[8];
    c.steady_steps = static_cast<int>(values[9]);
    c.violations = {count(10), count(11), count(12), values[13]};
    for (const auto& [name, statistics] : saved_statistics(c)) {
      ContactStatistics::Numbers numbers;
      state.get(fmt::format("contacts/{}/{}", i, name), numbers);
      *statistics = ContactStatistics::of(numbers);
    }
    c.interval = {};
    // The guess that the next step starts from.
    run.local[i].normal = c.force;
    run.local[i].tangential = c.friction_force;
    run.local[i].state = c.state;
  }
  for (std::size_t i = 0; i < run.faces.size(); ++i) {
    const std::string name = fmt::format("faces/{}", i);
    std::vector<double> values(run.faces[i].numbers().size());
    state.get(name, values);
    run.faces[i].restore(values);
    for (const auto& [part, statistics] : saved_statistics(run.faces[i])) {
      ContactStatistics::Numbers numbers;
      state.get(name + "/" + part, numbers);
      *statistics = ContactStatistics::of(numbers);
    }
    run.faces[i].interval = {};
    PlanarProblem& problem = run.faces.problems()[i];
    problem.normal = run.faces[i].force;
    problem.tangential = run.faces[i].whole_friction();
    problem.state = run.faces[i].state;
  }
  if (run.ledger) run.ledger->load(state, "energy/");
}

}  // namespace stridor
