// A reduced body in its own modes.
#pragma once

#include "substructures/craig_bampton.hpp"

namespace stridor {

/// One component as independent modes: q̈_i + c_i q̇_i + ω_i² q_i = p_i, c_i = α(t) + β ω_i²
/// (docs/theory.md, 1.4).
struct ModalBody {
  Eigen::VectorXd omega;  ///< ω, ascending, rad/s; exactly 0 for rigid modes
  RayleighDamping damping;
  Eigen::MatrixXd rows;          ///< as ReducedBody::rows, in modal coordinates
  Eigen::VectorXd base_inertia;  ///< as ReducedBody::base_inertia, in modal coordinates
  Eigen::MatrixXd shapes;        ///< Φ, reduced coordinates of every mode: q_reduced = Φ q_modal

  Eigen::Index size() const { return omega.size(); }
};

/// Diagonalises a reduced body: q_reduced = Φ q_modal with ΦᵀMΦ = I, ΦᵀKΦ = diag(ω²).
///
/// Frequencies below 1e-6 of the largest are rounding of rigid modes and are set to 0 exactly.
/// @throws NumericalError if the mass is not positive definite or a stiffness is negative beyond
/// rounding
ModalBody make_modal(const ReducedBody& body);

/// Largest step at which the central difference with backward-difference damping is stable for
/// every mode at the largest damping of the schedule: min over modes of 4/(c + √(c² + 4 ω²))
/// (docs/theory.md, 1.3); infinite for a body without stiffness and damping.
double central_difference_limit(const ModalBody& body);

}  // namespace stridor
