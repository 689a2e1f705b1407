// Two-step schemes in modal coordinates: one recurrence per mode.
#pragma once

#include <optional>

#include "solvers/algebra/aligned_array.hpp"
#include "solvers/integrators/modal_kernel.hpp"
#include "solvers/integrators/propagator.hpp"
#include "solvers/integrators/time_parameters.hpp"
#include "solvers/integrators/two_step_scheme.hpp"
#include "substructures/reduction/modal_body.hpp"

namespace stridor {

/// Coefficients of a mode by a scheme; parameters as exact_propagation().
StepCoefficients step_coefficients(Integrator scheme, double omega, double damping, double step,
                                   double added);

/// A two-step scheme, mode by mode, in increment form (docs/theory.md, 3.2):
///
///   d_{n+1} = s d_n − k r_n + e rowᵀ f_n + (e + k g) p_n,  r_{n+1} = r_n + d_{n+1},
///   q_n = r_n + g rowᵀ f_n
///
/// with the coefficients of two_step_scheme.hpp for c = α(t_n) + β ω²; g = 0 and r = q where the
/// body has no direct feedthrough.
///
/// The increment is carried beside the position: r_{n+1} − r_n taken from positions would lose
/// ε/(ω h)² of relative accuracy.
class ModalRecurrence : public Propagator {
  friend struct LaneAccess;

 public:
  /// @param body      modes; not referenced afterwards
  /// @param patterns  one column per load pattern, modal coordinates
  /// @param scheme    a scheme of two steps
  /// @param step      h, s
  /// @param added   δ of the scheme; absent: the body has no direct feedthrough
  /// @param num_ports points watched, x and y counted apart
  /// @param alpha     α at t = 0, 1/s
  /// @param loads     amplitudes at t = 0
  /// @param residual  of the truncated modes of the body
  ModalRecurrence(const ModalBody& body, const Eigen::MatrixXd& patterns, Integrator scheme,
                  double step, std::optional<double> added, int num_ports, double alpha,
                  std::span<const double> loads, Residual residual = {});

  Motion motion(const double* forces) const override;
  void predict_step(const double* forces, std::span<double> position,
               std::span<double> increment) const override;
  void set_mass_damping(double alpha) override;

 private:
  void advance_body(const double* forces, double* predicted) override;
  double body_displacement(int row) const override;
  double predicted_displacement(int row) const override;
  double row_compliance(int row_a, int row_b) const override;
  double ahead_displacement(int row) const override;
  double ahead_compliance(int row_a, int row_b) const override;
  void port_changed(int port) override;
  void num_ports_changed() override;
  void set_body_loads(std::span<const double> amplitudes) override;
  void set_body_motion(const Eigen::VectorXd& displacement, const Eigen::VectorXd& velocity,
                       const double* forces) override;
  void predict_body_start(const Eigen::VectorXd& displacement,
                          const Eigen::VectorXd& velocity) override;
  double initial_increment(int row, const Eigen::VectorXd& velocity) const override;
  void save_body(State& state, const std::string& prefix) const override;
  void load_body(const State& state, const std::string& prefix) override;

  /// Takes the gains of the present damping.
  void renew_gains();
  StepCoefficients coefficients(std::size_t mode) const;
  StartCoefficients start_coefficients(std::size_t mode) const;
  /// W of all modes, padded.
  const AlignedArray& modal_compliances() const;
  /// Σ_j row_j f_j of a mode.
  double modal_force(std::size_t mode, const double* forces) const;
  double& number(std::size_t mode, ModalField field) { return blocks_[modal_index(mode, field)]; }
  std::vector<double> numbers(ModalField field) const;
  void set_numbers(ModalField field, const std::vector<double>& values);
  const double* row_data(int row) const {
    return row_table_.data() + static_cast<std::size_t>(row) * num_blocks_ * modal_block;
  }

  std::size_t size_;
  std::size_t num_blocks_;
  Integrator scheme_;
  double step_;
  double added_;  ///< 0 without direct feedthrough
  double alpha_;
  AlignedArray blocks_;     ///< state and coefficients of every mode
  AlignedArray row_table_;  ///< padded rows, one after the other
  Eigen::VectorXd omega_;
  double beta_;
  Eigen::MatrixXd patterns_;
  std::vector<double> amplitudes_;              ///< of the loads
  std::vector<StepCoefficients> coefficients_;  ///< of the damping set last
  // Padded like the rows.
  AlignedArray feedthrough_;    ///< g
  AlignedArray ahead_answers_;  ///< e + g: at t_{n+1} per force that is constant from t_n on
  mutable AlignedArray start_answers_;  ///< W at the start; empty until asked for
  bool are_gains_due_ = false;  ///< those of a changed damping hold from the next step on
  std::vector<const double*> port_rows_;
};

}  // namespace stridor
