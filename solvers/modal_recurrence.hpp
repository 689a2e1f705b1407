// Two-step schemes in modal coordinates: one recurrence per mode.
#pragma once

#include "solvers/aligned_array.hpp"
#include "solvers/modal_kernel.hpp"
#include "solvers/propagator.hpp"
#include "substructures/modal_body.hpp"

namespace stridor {

/// Central difference with backward-difference damping, mode by mode, in increment form
/// (docs/theory.md, 3.2):
///
///   d_{n+1} = s d_n − k q_n + e (p_n + rowᵀ f_n),  q_{n+1} = q_n + d_{n+1}
///   s = 1 − h c,  k = h² ω²,  e = h²,  c = α(t_n) + β ω²
///
/// The increment is carried beside the position: q_{n+1} − q_n taken from positions would lose
/// ε/(ω h)² of relative accuracy.
class ModalRecurrence : public Propagator {
 public:
  /// @param body      modes; not referenced afterwards
  /// @param patterns  one column per load pattern, modal coordinates
  /// @param step      h, s
  /// @param num_slots points watched, x and y counted apart
  /// @param alpha     α at t = 0, 1/s
  /// @param loads     amplitudes at t = 0
  ModalRecurrence(const ModalBody& body, const Eigen::MatrixXd& patterns, double step,
                  int num_slots, double alpha, std::span<const double> loads);

  double displacement(int row) const override;
  Motion motion() const override;
  void foresee(const double* forces, std::span<double> position,
               std::span<double> increment) const override;
  void set_loads(std::span<const double> amplitudes) override;
  void set_mass_damping(double alpha) override;

 private:
  void advance_body(const double* forces, double* predicted) override;
  double predicted_displacement(int row) const override;
  double row_compliance(int row_a, int row_b) const override;
  void slot_changed(int slot) override;
  void set_body_motion(const Eigen::VectorXd& displacement,
                       const Eigen::VectorXd& velocity) override;
  double initial_increment(int row, const Eigen::VectorXd& velocity) const override;
  void save_body(State& state, const std::string& prefix) const override;
  void load_body(const State& state, const std::string& prefix) override;

  double& number(std::size_t mode, ModalField field) { return blocks_[modal_index(mode, field)]; }
  std::vector<double> numbers(ModalField field) const;
  void set_numbers(ModalField field, const std::vector<double>& values);
  const double* row_data(int row) const {
    return row_table_.data() + static_cast<std::size_t>(row) * num_blocks_ * modal_block;
  }

  std::size_t size_;
  std::size_t num_blocks_;
  double step_;
  AlignedArray blocks_;                ///< state and coefficients of every mode
  AlignedArray row_table_;             ///< padded rows, one after the other
  Eigen::VectorXd stiffness_damping_;  ///< h β ω²
  Eigen::MatrixXd scaled_patterns_;    ///< e times the load patterns
  std::vector<const double*> slot_rows_;
};

}  // namespace stridor
