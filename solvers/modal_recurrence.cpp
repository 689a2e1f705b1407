#include "solvers/modal_recurrence.hpp"

namespace stridor {

ModalRecurrence::ModalRecurrence(const ModalBody& body, const Eigen::MatrixXd& patterns,
                                 double step, int num_slots, double alpha,
                                 std::span<const double> loads)
    : Propagator(num_slots),
      size_(static_cast<std::size_t>(body.size())),
      num_blocks_((size_ + modal_block - 1) / modal_block),
      step_(step),
      blocks_(num_blocks_ * modal_block * num_modal_fields),
      row_table_(num_blocks_ * modal_block * static_cast<std::size_t>(body.rows.rows())),
      stiffness_damping_(step * body.damping.beta * body.omega.array().square()),
      scaled_patterns_(step * step * patterns),
      slot_rows_(static_cast<std::size_t>(num_slots)) {
  for (std::size_t i = 0; i < size_; ++i) {
    const double omega = body.omega(static_cast<Eigen::Index>(i));
    number(i, ModalField::pull) = step * step * omega * omega;
    number(i, ModalField::gain) = step * step;
  }
  for (Eigen::Index row = 0; row < body.rows.rows(); ++row) {
    double* const padded =
        row_table_.data() + static_cast<std::size_t>(row) * num_blocks_ * modal_block;
    for (Eigen::Index i = 0; i < body.rows.cols(); ++i) padded[i] = body.rows(row, i);
  }
  set_mass_damping(alpha);
  set_loads(loads);
  start();
}

double ModalRecurrence::displacement(int row) const {
  return gather_modes(blocks_.data(), num_blocks_, ModalField::position, row_data(row));
}

double ModalRecurrence::predicted_displacement(int row) const {
  return displacement(row) +
         gather_modes(blocks_.data(), num_blocks_, ModalField::increment, row_data(row));
}

double ModalRecurrence::row_compliance(int row_a, int row_b) const {
  double sum = 0.0;
  for (std::size_t i = 0; i < size_; ++i) {
    sum += row_data(row_a)[i] * blocks_[modal_index(i, ModalField::gain)] * row_data(row_b)[i];
  }
  return sum;
}

void ModalRecurrence::set_loads(std::span<const double> amplitudes) {
  for (std::size_t i = 0; i < size_; ++i) {
    double sum = 0.0;
    for (std::size_t k = 0; k < amplitudes.size(); ++k) {
      sum += scaled_patterns_(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(k)) *
             amplitudes[k];
    }
    number(i, ModalField::load) = sum;
  }
}

void ModalRecurrence::set_mass_damping(double alpha) {
  for (std::size_t i = 0; i < size_; ++i) {
    number(i, ModalField::keep) =
        1.0 - step_ * alpha - stiffness_damping_(static_cast<Eigen::Index>(i));
  }
}

void ModalRecurrence::advance_body(const double* forces, double* predicted) {
  advance_modes(blocks_.data(), num_blocks_, slot_rows_.data(), forces, num_slots(), predicted);
}

void ModalRecurrence::slot_changed(int slot) {
  slot_rows_[static_cast<std::size_t>(slot)] = row_data(row(slot));
}

std::vector<double> ModalRecurrence::numbers(ModalField field) const {
  std::vector<double> values(size_);
  for (std::size_t i = 0; i < size_; ++i) values[i] = blocks_[modal_index(i, field)];
  return values;
}

void ModalRecurrence::set_numbers(ModalField field, const std::vector<double>& values) {
  for (std::size_t i = 0; i < size_; ++i) number(i, field) = values[i];
}

void ModalRecurrence::save_body(State& state, const std::string& prefix) const {
  state.put(prefix + "position", numbers(ModalField::position));
  state.put(prefix + "predicted_increment", numbers(ModalField::increment));
}

void ModalRecurrence::load_body(const State& state, const std::string& prefix) {
  std::vector<double> position(size_);
  std::vector<double> increment(size_);
  state.get(prefix + "position", position);
  state.get(prefix + "predicted_increment", increment);
  set_numbers(ModalField::position, position);
  set_numbers(ModalField::increment, increment);
}

}  // namespace stridor
