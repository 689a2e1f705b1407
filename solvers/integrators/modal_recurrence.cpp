#include "solvers/integrators/modal_recurrence.hpp"

#include <cstring>
#include <limits>
#include <utility>

#include "core/clones.hpp"

namespace stridor {
namespace {

/// A block of one field or row; split by the compiler where the instruction set has shorter
/// vectors.
using Block = double __attribute__((vector_size(modal_block * sizeof(double))));

/// d_{n+1} = d*_{n+1} + e Σ_j row_j f_j, and q_n out of its blocks. Arguments as advance_modes().
STRIDOR_CLONES
void predict_modes(const double* blocks, std::size_t num_modes, const double* const* rows,
                   const double* forces, int num_ports, double* position, double* increment) {
  const auto* fields = reinterpret_cast<const Block*>(blocks);
  for (std::size_t first = 0; first < num_modes; first += modal_block, fields += num_modal_fields) {
    Block force{};
    for (int port = 0; port < num_ports; ++port)
      force += *reinterpret_cast<const Block*>(rows[port] + first) * forces[port];
    const Block next = fields[static_cast<std::size_t>(ModalField::increment)] +
                       fields[static_cast<std::size_t>(ModalField::gain)] * force;
    const Block& present = fields[static_cast<std::size_t>(ModalField::position)];
    if (first + modal_block <= num_modes) {
      // They need not be aligned as blocks are.
      std::memcpy(position + first, &present, sizeof present);
      std::memcpy(increment + first, &next, sizeof next);
    } else {
      for (std::size_t j = 0; first + j < num_modes; ++j) {
        position[first + j] = present[j];
        increment[first + j] = next[j];
      }
    }
  }
}

/// Σ a_i w_i b_i over all modes; the same with a and b in turn.
STRIDOR_CLONES
double weighted_product(std::size_t num_blocks, const double* a, const double* weights,
                        const double* b) {
  const auto* as = reinterpret_cast<const Block*>(a);
  const auto* bs = reinterpret_cast<const Block*>(b);
  const auto* ws = reinterpret_cast<const Block*>(weights);
  // Two sums, as one would wait for every addition.
  Block even{}, odd{};
  std::size_t i = 0;
  for (; i + 1 < num_blocks; i += 2) {
    even += as[i] * bs[i] * ws[i];
    odd += as[i + 1] * bs[i + 1] * ws[i + 1];
  }
  if (i < num_blocks) even += as[i] * bs[i] * ws[i];
  even += odd;
  double sum = 0.0;
  for (std::size_t k = 0; k < modal_block; ++k) sum += even[k];
  return sum;
}

}  // namespace

StepCoefficients step_coefficients(Integrator scheme, double omega, double damping, double step,
                                   double added) {
  return scheme == Integrator::exact ? exact_propagation(omega, damping, step, added)
                                     : central_difference(omega, damping, step, added);
}

ModalRecurrence::ModalRecurrence(const ModalBody& body, const Eigen::MatrixXd& patterns,
                                 Integrator scheme, double step, std::optional<double> added,
                                 int num_ports, double alpha, std::span<const double> loads,
                                 Residual residual)
    : Propagator(num_ports, added.has_value(), std::move(residual)),
      size_(static_cast<std::size_t>(body.size())),
      num_blocks_((size_ + modal_block - 1) / modal_block),
      scheme_(scheme),
      step_(step),
      added_(added.value_or(0.0)),
      alpha_(std::numeric_limits<double>::quiet_NaN()),
      blocks_(num_blocks_ * modal_block * num_modal_fields),
      row_table_(num_blocks_ * modal_block * static_cast<std::size_t>(body.rows.rows())),
      omega_(body.omega),
      beta_(body.damping.beta),
      patterns_(patterns),
      amplitudes_(static_cast<std::size_t>(patterns.cols()), 0.0),
      coefficients_(size_),
      feedthrough_(num_blocks_ * modal_block),
      ahead_answers_(num_blocks_ * modal_block),
      port_rows_(static_cast<std::size_t>(num_ports)) {
  for (Eigen::Index row = 0; row < body.rows.rows(); ++row) {
    double* const padded =
        row_table_.data() + static_cast<std::size_t>(row) * num_blocks_ * modal_block;
    for (Eigen::Index i = 0; i < body.rows.cols(); ++i) padded[i] = body.rows(row, i);
  }
  set_mass_damping(alpha);
  renew_gains();
  set_loads(loads);
  start();
}

double ModalRecurrence::body_displacement(int row) const {
  return gather_modes(blocks_.data(), num_blocks_, ModalField::position, row_data(row));
}

double ModalRecurrence::modal_force(std::size_t mode, const double* forces) const {
  double sum = 0.0;
  for (std::size_t port = 0; port < port_rows_.size(); ++port)
    sum += port_rows_[port][mode] * forces[port];
  return sum;
}

StartCoefficients ModalRecurrence::start_coefficients(std::size_t mode) const {
  const double omega = omega_(static_cast<Eigen::Index>(mode));
  const double damping = alpha_ + beta_ * omega * omega;
  return scheme_ == Integrator::exact ? exact_start(omega, damping, step_)
                                      : central_difference_start(damping, step_);
}

Propagator::Motion ModalRecurrence::motion(const double* forces) const {
  Motion motion{Eigen::VectorXd(size_), Eigen::VectorXd(size_)};
  for (std::size_t i = 0; i < size_; ++i) {
    const auto mode = static_cast<Eigen::Index>(i);
    const auto field = [&](ModalField f) { return blocks_[modal_index(i, f)]; };
    const double r = field(ModalField::position);
    const double force = modal_force(i, forces);
    motion.displacement(mode) = r + feedthrough_[i] * force;
    // The prediction of set_body_motion(), solved for the velocity. A mode that turns round within
    // a step does not show its velocity; it gets the mean one of the step.
    const auto [rate, share] = start_coefficients(i);
    const double by_motion = field(ModalField::increment) +
                             share * (field(ModalField::pull) * r - field(ModalField::load)) -
                             (share - 1.0) * field(ModalField::gain) * force;
    motion.velocity(mode) = by_motion / (rate > 0.25 * step_ ? rate : step_);
  }
  return motion;
}

void ModalRecurrence::predict_step(const double* forces, std::span<double> position,
                              std::span<double> increment) const {
  predict_modes(blocks_.data(), size_, port_rows_.data(), forces, num_ports(), position.data(),
                increment.data());
}

double ModalRecurrence::predicted_displacement(int row) const {
  return has_feedthrough() && !is_starting() ? body_displacement(row) : ahead_displacement(row);
}

double ModalRecurrence::row_compliance(int row_a, int row_b) const {
  return weighted_product(num_blocks_, row_data(row_a), modal_compliances().data(),
                          row_data(row_b));
}

double ModalRecurrence::ahead_displacement(int row) const {
  return body_displacement(row) +
         gather_modes(blocks_.data(), num_blocks_, ModalField::increment, row_data(row));
}

double ModalRecurrence::ahead_compliance(int row_a, int row_b) const {
  return weighted_product(num_blocks_, row_data(row_a), ahead_answers_.data(), row_data(row_b));
}

const AlignedArray& ModalRecurrence::modal_compliances() const {
  // Without direct feedthrough g = 0.
  if (!is_starting()) return has_feedthrough() ? feedthrough_ : ahead_answers_;
  // Once for all pairs of rows, of which hundreds of contacts have millions.
  if (start_answers_.size() == 0) {
    start_answers_ = AlignedArray(num_blocks_ * modal_block);
    for (std::size_t i = 0; i < size_; ++i)
      start_answers_[i] = start_coefficients(i).share * coefficients_[i].answer();
  }
  return start_answers_;
}

void ModalRecurrence::set_body_loads(std::span<const double> amplitudes) {
  amplitudes_.assign(amplitudes.begin(), amplitudes.end());
  for (std::size_t i = 0; i < size_; ++i) {
    double sum = 0.0;
    for (std::size_t k = 0; k < amplitudes.size(); ++k)
      sum += patterns_(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(k)) * amplitudes[k];
    number(i, ModalField::load) = coefficients_[i].answer() * sum;
  }
}

StepCoefficients ModalRecurrence::coefficients(std::size_t mode) const {
  const double omega = omega_(static_cast<Eigen::Index>(mode));
  const double damping = alpha_ + beta_ * omega * omega;
  const StepCoefficients c = step_coefficients(scheme_, omega, damping, step_, added_);
  if (has_feedthrough()) return c;
  return {c.keep, c.pull, c.answer()};
}

void ModalRecurrence::set_mass_damping(double alpha) {
  if (alpha == alpha_) return;
  alpha_ = alpha;
  start_answers_ = {};
  for (std::size_t i = 0; i < size_; ++i) {
    coefficients_[i] = coefficients(i);
    number(i, ModalField::keep) = coefficients_[i].keep;
    number(i, ModalField::pull) = coefficients_[i].pull;
  }
  set_body_loads(amplitudes_);
  // The forces at t_n still act as the prediction from t_n supposes.
  are_gains_due_ = scheme_ == Integrator::exact || has_feedthrough();
}

void ModalRecurrence::renew_gains() {
  for (std::size_t i = 0; i < size_; ++i) {
    number(i, ModalField::gain) = coefficients_[i].gain;
    feedthrough_[i] = coefficients_[i].feedthrough;
    ahead_answers_[i] = coefficients_[i].gain + feedthrough_[i];
  }
  renew_compliances();
  are_gains_due_ = false;
}

void ModalRecurrence::advance_body(const double* forces, double* predicted) {
  // With direct feedthrough displacements are seen at t_n, without at t_{n+1}.
  const double lookahead = has_feedthrough() ? 0.0 : 1.0;
  advance_modes(blocks_.data(), num_blocks_, port_rows_.data(), forces, num_ports(), lookahead,
                predicted);
  if (are_gains_due_) renew_gains();
}

void ModalRecurrence::port_changed(int port) {
  port_rows_[static_cast<std::size_t>(port)] = row_data(row(port));
}

void ModalRecurrence::num_ports_changed() {
  port_rows_.resize(static_cast<std::size_t>(num_ports()), row_data(0));
}

void ModalRecurrence::set_body_motion(const Eigen::VectorXd& displacement,
                                      const Eigen::VectorXd& velocity, const double* forces) {
  if (are_gains_due_) renew_gains();
  for (std::size_t i = 0; i < size_; ++i) {
    const auto mode = static_cast<Eigen::Index>(i);
    const double force = modal_force(i, forces);
    const double r = displacement(mode) - feedthrough_[i] * force;
    const auto [rate, share] = start_coefficients(i);
    number(i, ModalField::position) = r;
    number(i, ModalField::increment) =
        rate * velocity(mode) -
        share * (number(i, ModalField::pull) * r - number(i, ModalField::load)) +
        (share - 1.0) * number(i, ModalField::gain) * force;
  }
}

void ModalRecurrence::predict_body_start(const Eigen::VectorXd& displacement,
                                         const Eigen::VectorXd& velocity) {
  if (are_gains_due_) renew_gains();
  for (std::size_t i = 0; i < size_; ++i) {
    const auto mode = static_cast<Eigen::Index>(i);
    const auto [rate, share] = start_coefficients(i);
    number(i, ModalField::position) = displacement(mode);
    number(i, ModalField::increment) =
        rate * velocity(mode) -
        share * (number(i, ModalField::pull) * displacement(mode) - number(i, ModalField::load));
  }
}

double ModalRecurrence::initial_increment(int row, const Eigen::VectorXd& velocity) const {
  double sum = 0.0;
  for (std::size_t i = 0; i < size_; ++i)
    sum += row_data(row)[i] * velocity(static_cast<Eigen::Index>(i));
  return step_ * sum;
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
  if (are_gains_due_) renew_gains();
}

}  // namespace stridor
