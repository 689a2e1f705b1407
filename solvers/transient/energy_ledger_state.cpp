// What a ledger needs to go on, in a checkpoint.
#include <fmt/format.h>

#include "solvers/transient/energy_ledger.hpp"

namespace stridor {

void CompensatedSum::save(State& state, const std::string& name) const {
  const double values[] = {sum_, carry_};
  state.put(name, values);
}

void CompensatedSum::load(const State& state, const std::string& name) {
  double values[2];
  state.get(name, values);
  sum_ = values[0];
  carry_ = values[1];
}

void EnergyLedger::save(State& state, const std::string& prefix) const {
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    state.put(fmt::format("{}bodies/{}/last_increment", prefix, b),
              bodies_[b].last_increment.first(bodies_[b].size));
  }
  damping_loss_.save(state, prefix + "damping_loss");
  friction_loss_.save(state, prefix + "friction_loss");
  contact_work_.save(state, prefix + "contact_work");
  drive_work_.save(state, prefix + "drive_work");
  load_work_.save(state, prefix + "load_work");
  given_.save(state, prefix + "given");
  for (std::size_t i = 0; i < contacts_.size(); ++i) {
    const double roughness[] = {contacts_[i].roughness_before_last, contacts_[i].last_roughness};
    state.put(fmt::format("{}contacts/{}/roughness", prefix, i), roughness);
    const double forces[] = {contacts_[i].force_before_last, contacts_[i].last_force};
    state.put(fmt::format("{}contacts/{}/force", prefix, i), forces);
  }
  const double values[] = {initial_,
                           balance_.kinetic,
                           balance_.strain,
                           largest_stored_,
                           largest_error_,
                           static_cast<double>(friction_gain_.steps),
                           friction_gain_.largest_power,
                           friction_gain_.last_time,
                           least_given_,
                           contact_gain_.energy,
                           contact_gain_.last_time};
  state.put(prefix + "scalars", values);
}

void EnergyLedger::load(const State& state, const std::string& prefix) {
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    state.get(fmt::format("{}bodies/{}/last_increment", prefix, b),
              bodies_[b].last_increment.first(bodies_[b].size));
  }
  damping_loss_.load(state, prefix + "damping_loss");
  friction_loss_.load(state, prefix + "friction_loss");
  contact_work_.load(state, prefix + "contact_work");
  drive_work_.load(state, prefix + "drive_work");
  load_work_.load(state, prefix + "load_work");
  given_.load(state, prefix + "given");
  for (std::size_t i = 0; i < contacts_.size(); ++i) {
    double roughness[2];
    state.get(fmt::format("{}contacts/{}/roughness", prefix, i), roughness);
    contacts_[i].roughness_before_last = roughness[0];
    contacts_[i].last_roughness = roughness[1];
    double forces[2];
    state.get(fmt::format("{}contacts/{}/force", prefix, i), forces);
    contacts_[i].force_before_last = forces[0];
    contacts_[i].last_force = forces[1];
  }
  double values[11];
  state.get(prefix + "scalars", values);
  initial_ = values[0];
  friction_gain_ = {static_cast<std::int64_t>(values[5]), values[6], values[7]};
  least_given_ = values[8];
  contact_gain_ = {values[9], values[10]};
  largest_stored_ = values[3];
  largest_error_ = values[4];
  enter_stored(values[1], values[2]);
}

}  // namespace stridor
