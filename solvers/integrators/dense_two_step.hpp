// The published algorithm on assembled Craig-Bampton matrices, kept as the baseline.
#pragma once

#include "solvers/integrators/propagator.hpp"
#include "substructures/reduction/craig_bampton.hpp"

namespace stridor {

/// Equations (13) and (14) of BDF line by line, one body at a time (its M, C and K are blocks of
/// the paper's block-diagonal matrices):
///
///   u*_{n+1} = h² M⁻¹ [f_n − C (u_n − u_{n−1})/h − K u_n] + 2 u_n − u_{n−1}
///   u^c_{n+1} = −h² M⁻¹ B_Eᵀ λ_n
///
/// Cost per step: four products with a dense n x n matrix.
class PublishedTwoStep : public Propagator {
 public:
  /// Parameters as ModalRecurrence, in reduced coordinates.
  /// @throws NumericalError if the mass is not positive definite
  PublishedTwoStep(const ReducedBody& body, const Eigen::MatrixXd& patterns, double step,
                   int num_ports, double alpha, std::span<const double> loads);

  Motion motion(const double* forces) const override;
  void predict_step(const double* forces, std::span<double> position,
               std::span<double> increment) const override;
  void set_mass_damping(double alpha) override;

 private:
  void advance_body(const double* forces, double* predicted) override;
  /// u*_{n+1} from the present state.
  void predict();
  double body_displacement(int row) const override;
  double predicted_displacement(int row) const override;
  double row_compliance(int row_a, int row_b) const override;
  void port_changed(int) override {}
  void set_body_loads(std::span<const double> amplitudes) override;
  void set_body_motion(const Eigen::VectorXd& displacement, const Eigen::VectorXd& velocity,
                       const double* forces) override;
  double initial_increment(int row, const Eigen::VectorXd& velocity) const override;
  void save_body(State& state, const std::string& prefix) const override;
  void load_body(const State& state, const std::string& prefix) override;

  ReducedBody body_;
  Eigen::MatrixXd row_table_;  ///< column r: rows.row(r)ᵀ, contiguous
  Eigen::MatrixXd patterns_;
  double step_;
  Eigen::MatrixXd inverse_mass_;
  Eigen::MatrixXd damping_;
  Eigen::VectorXd load_;
  Eigen::VectorXd current_, previous_, predicted_;
  Eigen::VectorXd contact_, acceleration_;  ///< scratch
};

/// The same scheme with everything constant folded in advance, for an honest comparison with the
/// modal form. With A = M⁻¹ K and proportional damping,
///
///   u*_{n+1} = u_n + (1 − h α) d_n − A (h² u_n + h β d_n) + h² M⁻¹ f_n,  d_n = u_n − u_{n−1}
///
/// Cost per step: one product with a dense n x n matrix and one column of M⁻¹ per port.
class FusedTwoStep : public Propagator {
 public:
  /// As PublishedTwoStep.
  FusedTwoStep(const ReducedBody& body, const Eigen::MatrixXd& patterns, double step, int num_ports,
               double alpha, std::span<const double> loads);

  Motion motion(const double* forces) const override;
  void predict_step(const double* forces, std::span<double> position,
               std::span<double> increment) const override;
  void set_mass_damping(double alpha) override { alpha_ = alpha; }

 private:
  void advance_body(const double* forces, double* predicted) override;
  /// u*_{n+1} from the present state.
  void predict();
  double body_displacement(int row) const override;
  double predicted_displacement(int row) const override;
  double row_compliance(int row_a, int row_b) const override;
  void port_changed(int) override {}
  void set_body_loads(std::span<const double> amplitudes) override;
  void set_body_motion(const Eigen::VectorXd& displacement, const Eigen::VectorXd& velocity,
                       const double* forces) override;
  double initial_increment(int row, const Eigen::VectorXd& velocity) const override;
  void save_body(State& state, const std::string& prefix) const override;
  void load_body(const State& state, const std::string& prefix) override;

  Eigen::MatrixXd row_table_;  ///< column r: rows.row(r)ᵀ, contiguous
  double step_, alpha_, beta_;
  Eigen::MatrixXd mass_to_stiffness_;  ///< A = M⁻¹ K
  Eigen::MatrixXd port_gain_;          ///< column r: h² M⁻¹ rows.row(r)ᵀ
  Eigen::MatrixXd load_gain_;          ///< h² M⁻¹ patterns
  Eigen::VectorXd load_;
  Eigen::VectorXd current_, increment_, next_increment_;
  Eigen::VectorXd blend_;  ///< scratch
};

}  // namespace stridor
