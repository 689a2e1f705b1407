// Whether symmetric matrices are positive definite or semidefinite, to working precision.
#pragma once

#include "substructures/matrices/body_matrices.hpp"

namespace stridor {

/// Eigenvalues of a mass scaled to a unit diagonal count as 0 up to this size: rounding of programs
/// that integrate the mass with too few points leaves some 1e-16, the next ones are 1e-2.
inline constexpr double massless_ratio = 1e-10;

/// Whether the least eigenvalue of A, scaled to a unit diagonal, is not below −massless_ratio.
/// Unknowns without a diagonal entry must have no entry at all.
/// @param matrix symmetric, both triangles stored
bool is_positive_semidefinite(const SparseMatrix& matrix);

/// Least ratio l_ii²/A_ii of the Cholesky factor A = L Lᵀ; 0 or below where there is none. About 1e-16
/// for a singular matrix.
double smallest_pivot_ratio(const SparseMatrix& matrix);

}  // namespace stridor
