// Exact propagation of a body whose modes are coupled: gyroscopic, circulatory, of any damping.
#pragma once

#include <Eigen/LU>
#include <optional>
#include <string>

#include "solvers/integrators/coupled_step.hpp"
#include "solvers/integrators/propagator.hpp"
#include "solvers/integrators/time_parameters.hpp"
#include "substructures/reduction/modal_body.hpp"

namespace stridor {

/// @param body its name
/// @throws ConfigError (time.integrator) if a body with gyroscopic, circulatory or non-proportional
///         damping terms is to be marched otherwise
void require_exact(const std::string& body, const TimeParameters& time);

/// The exact scheme of ModalRecurrence for a body with gyroscopic, circulatory or non-proportional
/// damping terms (docs/theory.md, 3.8), in modal coordinates, r̈ + V ṙ + Q r = p with
/// V = diag(c) + coupled, Q = diag(ω²) + coupled:
///
///   x = (r, v),  x_{n+1} = e^{Ah} (x_n + J rowᵀ f_n + (0, h K⁻¹ p_n)),   q_n = r_n + G rowᵀ f_n
///
/// with the matrices of CoupledStep. Free motion and the static response are exact; without coupled
/// terms every number is that of ModalRecurrence up to rounding. x is the state just before the
/// impulses at t_n.
class CoupledPropagator : public Propagator {
 public:
  /// Parameters as ModalRecurrence.
  /// @throws ConfigError (time.step) as make_coupled_step()
  /// Cost: that of make_coupled_step(); a step costs (2n)² and 3n for every port.
  CoupledPropagator(const ModalBody& body, const Eigen::MatrixXd& patterns, double step,
                    std::optional<double> added, int num_ports, double alpha,
                    std::span<const double> loads, const std::string& name);

  Motion motion(const double* forces) const override;
  void predict_step(const double* forces, std::span<double> position,
               std::span<double> increment) const override;
  /// Cost: that of the constructor where α changes.
  void set_mass_damping(double alpha) override;

 private:
  void advance_body(const double* forces, double* predicted) override;
  double body_displacement(int row) const override;
  double predicted_displacement(int row) const override;
  double row_compliance(int row_a, int row_b) const override;
  double ahead_displacement(int row) const override;
  double ahead_compliance(int row_a, int row_b) const override;
  void port_changed(int) override {}
  void set_body_loads(std::span<const double> amplitudes) override;
  void set_body_motion(const Eigen::VectorXd& displacement, const Eigen::VectorXd& velocity,
                       const double* forces) override;
  void predict_body_start(const Eigen::VectorXd& displacement,
                          const Eigen::VectorXd& velocity) override;
  double initial_increment(int row, const Eigen::VectorXd& velocity) const override;
  void save_body(State& state, const std::string& prefix) const override;
  void load_body(const State& state, const std::string& prefix) override;

  /// Everything that follows from α.
  void renew();
  /// rowᵀ f of all ports.
  Eigen::VectorXd modal_force(const double* forces) const;
  /// Velocity just before the impulses less that of the continuous motion under constant forces.
  Eigen::VectorXd velocity_before(const Eigen::VectorXd& force) const;
  /// x_{n+1} without forces on the ports.
  void predict();

  ModalBody body_;
  std::string name_;
  Eigen::MatrixXd row_table_;  ///< column r: rows.row(r)ᵀ
  Eigen::MatrixXd patterns_;
  double step_;
  std::optional<double> added_;
  double alpha_;
  bool is_renewal_due_ = false;

  CoupledStep by_step_;
  Eigen::MatrixXd row_gains_;                         ///< column r: x_{n+1} per force on row r
  /// Likewise of CoupledStep::by_constant, and of CoupledStep::feedthrough where there is any.
  Eigen::MatrixXd constant_gains_, feedthrough_gains_;
  Eigen::PartialPivLU<Eigen::MatrixXd> by_velocity_;  ///< r_{n+1} per v_n

  Eigen::VectorXd load_;          ///< p
  Eigen::VectorXd load_impulse_;  ///< x_{n+1} by p
  Eigen::VectorXd state_, next_;  ///< x_n; x_{n+1} without forces on the ports
};

}  // namespace stridor
