// The lowest eigenpairs of a sparse symmetric pencil.
#pragma once

#include "substructures/matrices/sparse_cholesky.hpp"

namespace stridor {

struct Modes {
  Eigen::VectorXd omega_squared;  ///< ω², ascending, rad²/s²
  Eigen::MatrixXd shapes;         ///< columns φ with φᵀ M φ = 1, largest entry positive
};

/// The `count` lowest solutions of K φ = ω² M φ by shift-invert Lanczos about 0.
///
/// @param stiffness factorised K, positive definite, n x n
/// @param stiffness_matrix K itself
/// @param mass M, symmetric positive definite, n x n
/// @param count 0 .. n
/// @throws std::invalid_argument if count is out of range
/// @throws NumericalError if Lanczos does not converge, or a residual
///         |K φ − ω² M φ| / |K φ| exceeds 1e-6
/// Cost: about 2 count + 20 solves with the factor; a dense eigenproblem where count is near n.
Modes lowest_modes(const SparseCholesky& stiffness, const SparseMatrix& stiffness_matrix,
                   const SparseMatrix& mass, Eigen::Index count);

}  // namespace stridor
