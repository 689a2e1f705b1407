// The lowest eigenpairs of a sparse symmetric pencil.
#pragma once

#include "substructures/matrices/sparse_cholesky.hpp"

namespace stridor {

struct Modes {
  Eigen::VectorXd omega_squared;  ///< ω², ascending, rad²/s²
  Eigen::MatrixXd shapes;  ///< n rows; columns φ with φᵀ M φ = 1, largest entry positive
};

/// The `count` lowest solutions of K φ = ω² M φ by shift-invert Lanczos about 0. DoFs that the
/// factor leaves out are held: shapes are zero there.
///
/// @param stiffness factorised K, or a part of it, positive definite
/// @param stiffness_matrix K itself, n x n
/// @param mass M, symmetric positive semidefinite, n x n
/// @param count 0 .. number of DoFs that are factorised
/// @throws std::invalid_argument if count is out of range
/// @throws NumericalError if Lanczos does not converge, or a residual
///         |K φ − ω² M φ| / |K φ| exceeds 1e-6
/// Cost: about 2 count + 20 solves with the factor; a dense eigenproblem where count is near n.
Modes lowest_modes(const SparseCholesky& stiffness, const SparseMatrix& stiffness_matrix,
                   const SparseMatrix& mass, Eigen::Index count);

}  // namespace stridor
