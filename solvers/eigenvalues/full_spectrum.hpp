// Eigenvalues in a window of systems whose matrices are stored sparse and are not.
#pragma once

#include "solvers/eigenvalues/pencil.hpp"
#include "solvers/eigenvalues/sparse_spectrum.hpp"

namespace stridor {

/// Whether Q is full.
inline bool is_full(const SparseSystem& system) {
  return is_full(system.position);
}

/// The motion of a pencil in its modal coordinates: M = 1, P = diag(c) + Sᵀ H S, Q = diag(ω²) + Sᵀ
/// G S.
/// @throws std::invalid_argument if it has constraints
SparseSystem modal_system(const Pencil& pencil);

/// The eigenvalues in a window, from all of them by the dense method; nothing is left to count.
///
/// @return without `right`, `backward_errors` and `modes`; residuals are not computed. `pairs` are
///         by pairs_near(), to a tenth above the window, without left vectors; one may be missing
/// @throws NumericalError as dense_eigenvalues(), pairs_near()
SparseSpectrum full_spectrum(const SparseSystem& system, const SpectrumWindow& window);

/// SparsePencil::scaled_residual() of all pairs at once, since products of full matrices are made by
/// BLAS: whether every pair has a scaled residual |P(s) x| of at most 1e-6 of the sum of its three terms,
/// as in sparse_spectrum(); of a rigid motion, all of whose terms are rounding, a backward error of
/// 1e-13.
bool are_pairs(const SparseSystem& system, const TwoSidedPairs& pairs);

}  // namespace stridor
