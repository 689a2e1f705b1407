// Damping of given matrices that is proportional to mass and stiffness.
#pragma once

#include <optional>

#include "substructures/matrices/body_matrices.hpp"

namespace stridor {

/// α and β where C = α M + β K; nothing where C is something else (docs/theory.md, 1.5).
///
/// They are found by least squares on the entries of the matrices. C is proportional where
/// ‖C − α M − β K‖ ≤ 1e-12 ‖C‖ (Frobenius) with α, β ≥ 0. Modes are then damped as C damps them up
/// to 1e-12 ‖C‖/‖M‖, which for a stiff mesh is about what rounding of C itself does.
///
/// @param velocity C, or all that multiplies the velocity, n x n
/// @param mass, stiffness symmetric, n x n
std::optional<RayleighDamping> proportional_damping(const SparseMatrix& velocity,
                                                    const SparseMatrix& mass,
                                                    const SparseMatrix& stiffness);

}  // namespace stridor
