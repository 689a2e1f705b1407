// The state of a simulation in a checkpoint, from which it goes on.
#include <fmt/format.h>

#include <array>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "solvers/transient/simulation_implementation.hpp"

namespace stridor {
namespace {

/// Statistics of a contact that a saved state holds, by name.
auto saved_statistics(auto& contact) {
  using Entry = std::pair<const char*, decltype(&contact.statistics)>;
  return std::array{Entry{"statistics", &contact.statistics}, Entry{"earlier", &contact.earlier},
                    Entry{"open_interval", &contact.open_interval}};
}

void save_contact(const auto& contact, State& state, const std::string& name) {
  state.put(name, contact.numbers());
  for (const auto& [part, statistics] : saved_statistics(contact))
    state.put(name + "/" + part, statistics->numbers());
}

void load_contact(auto& contact, const State& state, const std::string& name) {
  auto numbers = contact.numbers();  // as many
  state.get(name, numbers);
  contact.restore(numbers);
  for (const auto& [part, statistics] : saved_statistics(contact)) {
    ContactStatistics::Numbers of_part;
    state.get(name + "/" + part, of_part);
    *statistics = ContactStatistics::of(of_part);
  }
  contact.interval = {};
}

}  // namespace

State Simulation::save() const {
  const Implementation& run = *implementation_;
  State state;
  state.put("step", run.clock.step);
  state.put("index", static_cast<double>(run.clock.index));
  for (std::size_t b = 0; b < run.bodies.size(); ++b) {
    const std::string prefix = fmt::format("bodies/{}/", b);
    run.bodies[b]->save(state, prefix);
    state.put(prefix + "forces", run.forces[b]);
  }
  for (std::size_t i = 0; i < run.lines.size(); ++i)
    save_contact(run.lines[i], state, fmt::format("contacts/{}", i));
  for (std::size_t i = 0; i < run.faces.size(); ++i)
    save_contact(run.faces[i], state, fmt::format("faces/{}", i));
  if (run.ledger) run.ledger->save(state, "energy/");
  return state;
}

void Simulation::load(const State& state) {
  Implementation& run = *implementation_;
  if (state.get("step") != run.clock.step)
    throw std::invalid_argument("Simulation::load: the state has another time step");
  run.clock.index = static_cast<std::int64_t>(state.get("index"));
  run.next_health_check = 0;
  run.set_loads(run.clock.now());
  for (std::size_t b = 0; b < run.bodies.size(); ++b) {
    const std::string prefix = fmt::format("bodies/{}/", b);
    if (run.nodes[b]) run.nodes[b]->restore(state.array(prefix + "rows"));
    run.bodies[b]->set_mass_damping(run.damping[b].alpha_at(run.clock.now()));
    run.bodies[b]->load(state, prefix);
    run.fit_forces();
    state.get(prefix + "forces", run.forces[b]);
  }
  // The forces are also the guess that the next step starts from.
  for (std::size_t i = 0; i < run.lines.size(); ++i) {
    const RunningLine& line = run.lines[i];
    load_contact(run.lines[i], state, fmt::format("contacts/{}", i));
    LocalProblem& problem = run.lines.problems()[i];
    problem.normal = line.force;
    problem.tangential = line.friction_force;
    problem.state = line.state;
  }
  for (std::size_t i = 0; i < run.faces.size(); ++i) {
    const RunningFace& face = run.faces[i];
    load_contact(run.faces[i], state, fmt::format("faces/{}", i));
    PlanarProblem& problem = run.faces.problems()[i];
    problem.normal = face.force;
    problem.tangential = face.whole_friction();
    problem.state = face.state;
  }
  if (run.ledger) run.ledger->load(state, "energy/");
}

}  // namespace stridor
