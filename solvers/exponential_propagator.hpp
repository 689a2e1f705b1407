// Exact propagation of coupled linear motion: gyroscopic, circulatory, of any damping.
#pragma once

#include <Eigen/Core>

#include "substructures/linear_system.hpp"

namespace stridor {

/// The system on the motions that fit its constraints (docs/theory.md, 10.3; HS (24)).
///
///   q = Z a,  Z = null(N),  Y = null(F):   Yᵀ M Z ä + Yᵀ P Z ȧ + Yᵀ Q Z a = 0
///
/// with orthonormal Z and Y, which differ under friction; the mass matrix then is not symmetric.
struct EliminatedSystem {
  LinearSystem system;     ///< of the coordinates a, without constraints
  Eigen::MatrixXd motion;  ///< Z, n x (n − k)
};

/// @throws NumericalError if the rows of gaps or of forces are not independent
EliminatedSystem eliminate_constraints(const LinearSystem& system);

/// Marches M q̈ + P q̇ + Q q = f by the exponential of its first-order form (docs/theory.md, 10.4).
///
///   x = (q, q̇),  ẋ = A x + B f,   x_{n+1} = e^{Ah} x_n + h φ₁(Ah) B f_n + h φ₂(Ah) B (f_{n+1} −
///   f_n)
///
/// Exact for free motion at any step, and for forces that are linear over it; there is no limit of
/// stability but that of the system itself. M need not be symmetric.
class ExponentialPropagator {
 public:
  /// @param system without constraints
  /// @param step   h, s, > 0
  /// @throws std::invalid_argument if the step is not positive, sizes do not fit together or there
  ///         are constraints
  /// @throws NumericalError if M is singular
  /// Cost: of order 10 (2n + 2n)³ operations; a step costs (2n)² + 4n².
  ExponentialPropagator(const LinearSystem& system, double step);

  Eigen::Index size() const { return size_; }
  double step() const { return step_; }

  /// From t_n to t_{n+1} without forces.
  void advance(Eigen::VectorXd& q, Eigen::VectorXd& v);
  /// The same under forces that go linearly from `before` to `after`.
  void advance(Eigen::VectorXd& q, Eigen::VectorXd& v, const Eigen::VectorXd& before,
               const Eigen::VectorXd& after);

  /// Displacement at t_{n+1} per force that is constant from t_n on, m/N: n x n.
  Eigen::MatrixXd compliance() const { return by_constant_.topRows(size_); }
  /// (q, q̇) at t_{n+1} per force that grows from nothing at t_n: 2n x n.
  const Eigen::MatrixXd& slope_response() const { return by_slope_; }
  /// e^{Ah}: (q, q̇) at t_{n+1} per (q, q̇) at t_n.
  const Eigen::MatrixXd& free_response() const { return free_; }

 private:
  Eigen::Index size_;
  double step_;
  Eigen::MatrixXd free_;         ///< e^{Ah}
  Eigen::MatrixXd by_constant_;  ///< h φ₁(Ah) B
  Eigen::MatrixXd by_slope_;     ///< h φ₂(Ah) B
  Eigen::VectorXd state_, next_;
};

}  // namespace stridor
