// Any linear system as a pencil: all of its coordinates are ports.
#pragma once

#include "solvers/eigenvalues/pencil.hpp"
#include "substructures/matrices/linear_system.hpp"

namespace stridor {

/// The pencil of M q̈ + P q̇ + Q q = Fᵀ Λ, N q = 0 (docs/theory.md, 10.3).
///
/// Its modes Φ are those of the symmetric part of Q with M, its ports the coordinates, S = Φ, and
///
///   c = 0,  H = P,  G = Q − M Φ diag(ω²) Φᵀ M,  B_C = −N,  B_E = −F
///
/// so that G is the skew part of Q, plus the part that makes the symmetric part indefinite: ω = 0
/// there.
///
/// @throws std::invalid_argument if sizes do not fit together, a number is not finite, or M is not
///         symmetric positive definite
Pencil make_pencil(const LinearSystem& system);

}  // namespace stridor
