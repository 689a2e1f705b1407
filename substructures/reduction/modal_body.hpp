// A reduced body in its own modes.
#pragma once

#include "substructures/reduction/craig_bampton.hpp"

namespace stridor {

/// Truncated modes of a body: instantaneous response u = R f with the residual flexibility R
/// (docs/theory.md, 3.6).
///
/// In the sums below over the truncated modes, φ is the entry of a mode at a row.
struct ModalResidual {
  Eigen::MatrixXd flexibility;  ///< R = Σ φ φᵀ/ω², rows x rows, m/N; empty where none is truncated
  Eigen::MatrixXd shapes;       ///< Σ Φ φᵀ/ω², reduced coordinates per force on a row
  Eigen::VectorXd base_rows;    ///< Σ φ g/ω² with g of base_inertia, per m/s²; or empty
  Eigen::VectorXd base_shapes;  ///< Σ Φ g/ω²; or empty
  double beta = 0.0;            ///< β of their damping, s; their α is nothing beside it
  Eigen::Index num_modes = 0;   ///< truncated
};

/// One component as independent modes: q̈_i + c_i q̇_i + ω_i² q_i = p_i, c_i = α(t) + β ω_i²
/// (docs/theory.md, 1.4), with gyroscopic, circulatory and non-proportional damping terms where the
/// body has them (1.5).
struct ModalBody {
  Eigen::VectorXd omega;  ///< ω, ascending, rad/s; exactly 0 for rigid modes
  RayleighDamping damping;
  Eigen::MatrixXd rows;          ///< as ReducedBody::rows, in modal coordinates
  Eigen::VectorXd base_inertia;  ///< as ReducedBody::base_inertia, in modal coordinates
  Eigen::MatrixXd shapes;        ///< Φ, reduced coordinates of every mode: q_reduced = Φ q_modal
  ModalResidual residual;        ///< of modes that are not among the above
  CoupledTerms coupled;          ///< in modal coordinates; empty where there are none

  Eigen::Index size() const { return omega.size(); }
  /// c of every mode for a given α: α + β ω² and the diagonal of the coupled damping, 1/s.
  Eigen::VectorXd mode_damping(double alpha) const;
};

/// Diagonalises a reduced body: q_reduced = Φ q_modal with ΦᵀMΦ = I, ΦᵀKΦ = diag(ω²).
///
/// Frequencies below 1e-6 of the largest, and squares of frequencies that are negative by no more
/// than the rounding of the reduced stiffness (ReducedBody::interface_rounding), are rounding of
/// rigid modes and are set to 0 exactly.
/// @throws NumericalError if the mass is not positive definite or a stiffness is negative beyond
/// rounding
ModalBody make_modal(const ReducedBody& body);

/// The body with the modes up to a frequency; those above become its residual flexibility.
///
/// @param body   without residual flexibility and without CoupledTerms
/// @param cutoff ω, rad/s, > 0
/// @throws std::invalid_argument if the body has either or `cutoff` is not positive
ModalBody with_static_residual(const ModalBody& body, double cutoff);

/// Largest step at which the central difference with backward-difference damping is stable for
/// every mode at the largest damping of the schedule: min over modes of 4/(c + √(c² + 4 ω²))
/// (docs/theory.md, 1.3); infinite for a body without stiffness and damping.
double central_difference_limit(const ModalBody& body);

}  // namespace stridor
