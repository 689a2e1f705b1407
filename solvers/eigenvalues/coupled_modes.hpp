// Complex modes of bodies whose terms couple their real ones.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "solvers/eigenvalues/pencil.hpp"

namespace stridor {

/// The modes of a pencil that gyroscopic, circulatory and non-proportional damping terms of bodies
/// couple (docs/theory.md, 7.3): for q of them
///
///   (s² + s C + K)⁻¹ = Σ_j x_j y_jᵀ/(s − s_j),   j = 1 … 2q,
///   K = diag(ω²) + Sᵀ G S,  C = diag(c) + Sᵀ H S  with the ports of bodies only
///
/// Contacts leave this sum as it is, so that it serves every place and every friction.
struct CoupledModes {
  std::vector<Eigen::Index> modes;  ///< which modes of the pencil, ascending
  Eigen::VectorXcd poles;    ///< s_j, 2q, 1/s: in pairs, conjugates or two real ones of one sign
  Eigen::MatrixXcd shapes;   ///< x_j, q x 2q
  Eigen::MatrixXcd adjoint;  ///< y_j, q x 2q

  Eigen::Index num_pairs() const { return poles.size() / 2; }
};

/// Diagonalises the coupled modes of a pencil.
///
/// @return no modes where none are coupled. Nothing where they have no basis of eigenvectors to
///         working precision (rigid motions with gyroscopic terms, a pair at its critical damping):
///         where the matrix put together again is off by more than 1e-12 of its norm.
/// Cost: of order 25 (2q)³ operations for each set of modes that are joined, in BLAS (core/blas.hpp).
std::optional<CoupledModes> coupled_modes(const Pencil& pencil);

}  // namespace stridor
