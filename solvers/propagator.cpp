#include "solvers/propagator.hpp"

namespace stridor {

Propagator::Propagator(int num_slots)
    : rows_(at(num_slots), 0),
      predicted_(at(num_slots), 0.0),
      current_(at(num_slots), 0.0),
      increment_(at(num_slots), 0.0),
      compliance_(at(num_slots) * at(num_slots), 0.0) {}

void Propagator::start() {
  for (int slot = 0; slot < num_slots(); ++slot) slot_changed(slot);
  const std::vector<double> no_forces(rows_.size(), 0.0);
  advance_body(no_forces.data(), predicted_.data());
}

void Propagator::watch(int slot, int row) {
  rows_[at(slot)] = row;
  slot_changed(slot);
  predicted_[at(slot)] = predicted_displacement(row);
  current_[at(slot)] = displacement(row);
  renew_compliance(slot);
}

void Propagator::set_motion(const Eigen::VectorXd& displacement, const Eigen::VectorXd& velocity) {
  set_body_motion(displacement, velocity);
  for (int slot = 0; slot < num_slots(); ++slot) {
    watch(slot, row(slot));
    increment_[at(slot)] = initial_increment(row(slot), velocity);
  }
}

void Propagator::renew_compliance(int slot) {
  for (int other = 0; other < num_slots(); ++other) {
    compliance_[at(slot) * rows_.size() + at(other)] = row_compliance(row(slot), row(other));
    compliance_[at(other) * rows_.size() + at(slot)] = row_compliance(row(other), row(slot));
  }
}

void Propagator::advance(const double* forces) {
  const std::size_t n = rows_.size();
  for (std::size_t a = 0; a < n; ++a) {
    double corrected = predicted_[a];
    for (std::size_t b = 0; b < n; ++b) corrected += compliance_[a * n + b] * forces[b];
    increment_[a] = corrected - current_[a];
    current_[a] = corrected;
  }
  advance_body(forces, predicted_.data());
}

void Propagator::save(State& state, const std::string& prefix) const {
  state.put(prefix + "rows", std::vector<double>(rows_.begin(), rows_.end()));
  state.put(prefix + "predicted", predicted_);
  state.put(prefix + "current", current_);
  state.put(prefix + "increment", increment_);
  save_body(state, prefix);
}

void Propagator::load(const State& state, const std::string& prefix) {
  std::vector<double> rows(rows_.size());
  state.get(prefix + "rows", rows);
  load_body(state, prefix);
  for (int slot = 0; slot < num_slots(); ++slot) watch(slot, static_cast<int>(rows[at(slot)]));
  state.get(prefix + "predicted", predicted_);
  state.get(prefix + "current", current_);
  state.get(prefix + "increment", increment_);
}

}  // namespace stridor
