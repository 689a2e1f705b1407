#include "solvers/modal_recurrence.hpp"

namespace stridor {

ModalRecurrence::ModalRecurrence(const ModalBody& body, const Eigen::MatrixXd& patterns,
                                 double step, int num_slots, double alpha,
                                 std::span<const double> loads)
    : Propagator(num_slots),
      size_(static_cast<std::size_t>(body.size())),
      padded_((size_ + modal_padding - 1) / modal_padding * modal_padding),
      step_(step),
      stiffness_damping_(padded_),
      position_(padded_),
      increment_(padded_),
      keep_(padded_),
      pull_(padded_),
      gain_(padded_),
      load_(padded_),
      row_table_(padded_ * static_cast<std::size_t>(body.rows.rows())),
      scaled_patterns_(step * step * patterns),
      slot_rows_(static_cast<std::size_t>(num_slots)) {
  for (std::size_t i = 0; i < size_; ++i) {
    const double omega = body.omega(static_cast<Eigen::Index>(i));
    stiffness_damping_[i] = step * body.damping.beta * omega * omega;
    pull_[i] = step * step * omega * omega;
    gain_[i] = step * step;
  }
  for (Eigen::Index row = 0; row < body.rows.rows(); ++row) {
    for (Eigen::Index i = 0; i < body.rows.cols(); ++i) {
      row_table_[static_cast<std::size_t>(row) * padded_ + static_cast<std::size_t>(i)] =
          body.rows(row, i);
    }
  }
  set_mass_damping(alpha);
  set_loads(loads);
  start();
}

double ModalRecurrence::displacement(int row) const {
  return dot(row_data(row), position_.data(), padded_);
}

double ModalRecurrence::predicted_displacement(int row) const {
  return displacement(row) + dot(row_data(row), increment_.data(), padded_);
}

double ModalRecurrence::row_compliance(int row_a, int row_b) const {
  double sum = 0.0;
  for (std::size_t i = 0; i < size_; ++i) sum += row_data(row_a)[i] * gain_[i] * row_data(row_b)[i];
  return sum;
}

void ModalRecurrence::set_loads(std::span<const double> amplitudes) {
  for (std::size_t i = 0; i < size_; ++i) {
    double sum = 0.0;
    for (std::size_t k = 0; k < amplitudes.size(); ++k) {
      sum += scaled_patterns_(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(k)) *
             amplitudes[k];
    }
    load_[i] = sum;
  }
}

void ModalRecurrence::set_mass_damping(double alpha) {
  for (std::size_t i = 0; i < size_; ++i) keep_[i] = 1.0 - step_ * alpha - stiffness_damping_[i];
}

void ModalRecurrence::advance_body(const double* forces, double* predicted) {
  const ModalArrays arrays{padded_,      position_.data(), increment_.data(), keep_.data(),
                           pull_.data(), gain_.data(),     load_.data()};
  advance_modes(arrays, slot_rows_.data(), forces, num_slots(), predicted);
}

void ModalRecurrence::slot_changed(int slot) {
  slot_rows_[static_cast<std::size_t>(slot)] = row_data(row(slot));
}

void ModalRecurrence::save_body(State& state, const std::string& prefix) const {
  state.put(prefix + "position", position_.first(size_));
  state.put(prefix + "predicted_increment", increment_.first(size_));
}

void ModalRecurrence::load_body(const State& state, const std::string& prefix) {
  state.get(prefix + "position", position_.first(size_));
  state.get(prefix + "predicted_increment", increment_.first(size_));
}

}  // namespace stridor
