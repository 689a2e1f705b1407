// Exact propagation of coupled linear motion: gyroscopic, circulatory, of any damping.
#pragma once

#include <Eigen/Core>

#include "solvers/decoupling.hpp"
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
/// stability but that of the system itself. M need not be symmetric. The system is taken apart first
/// (decouple()): every group of coordinates z, q = T z, has an exponential of its own.
class ExponentialPropagator {
 public:
  /// @param system without constraints
  /// @param step   h, s, > 0
  /// @throws std::invalid_argument if the step is not positive, sizes do not fit together or there
  ///         are constraints
  /// @throws NumericalError if M is singular
  /// Cost: of order 10 (4 m)³ operations for every group of m coordinates; a step costs 8 m² each.
  ExponentialPropagator(const LinearSystem& system, double step);

  Eigen::Index size() const { return apart_.system.size(); }
  double step() const { return step_; }

  /// From t_n to t_{n+1} without forces.
  void advance(Eigen::VectorXd& q, Eigen::VectorXd& v) const;
  /// The same under forces that go linearly from `before` to `after`.
  void advance(Eigen::VectorXd& q, Eigen::VectorXd& v, const Eigen::VectorXd& before,
               const Eigen::VectorXd& after) const;

  /// The coordinates z and their groups.
  const DecoupledSystem& apart() const { return apart_; }
  /// (z, ż) at t_{n+1} without forces. Vectors are of padded_size(size()) numbers.
  void advance(const double* z, const double* v, double* next_z, double* next_v) const;

  /// z and ż at t_{n+1} per velocity ż at t_n.
  const GroupDiagonal& z_by_v() const { return z_by_v_; }
  const GroupDiagonal& v_by_v() const { return v_by_v_; }

  /// Displacement at t_{n+1} per force that is constant from t_n on, m/N: n x n.
  Eigen::MatrixXd compliance() const { return by_constant_.topRows(size()); }
  /// (q, q̇) at t_{n+1} per force that is constant from t_n on: 2n x n.
  const Eigen::MatrixXd& constant_response() const { return by_constant_; }
  /// (q, q̇) at t_{n+1} per force that grows from nothing at t_n: 2n x n.
  const Eigen::MatrixXd& slope_response() const { return by_slope_; }
  /// e^{Ah}: (q, q̇) at t_{n+1} per (q, q̇) at t_n.
  Eigen::MatrixXd free_response() const;

 private:
  DecoupledSystem apart_;
  double step_;
  GroupDiagonal z_by_z_, z_by_v_, v_by_z_, v_by_v_;  ///< e^{Ah}
  Eigen::MatrixXd by_constant_;                      ///< h φ₁(Ah) B, of q
  Eigen::MatrixXd by_slope_;                         ///< h φ₂(Ah) B
};

}  // namespace stridor
