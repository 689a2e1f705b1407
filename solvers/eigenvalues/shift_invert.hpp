// Eigenpairs of a sparse quadratic problem next to a shift.
#pragma once

#include <Eigen/Core>
#include <complex>
#include <vector>

#include "solvers/eigenvalues/sparse_pencil.hpp"

namespace stridor {

/// One eigenpair P(s) x = 0.
struct SparsePair {
  std::complex<double> s;
  Eigen::VectorXcd x;
};

/// Which pairs are wanted, and how much they may cost.
struct NearestPairsWanted {
  std::complex<double> shift;   ///< σ
  double radius = 0.0;          ///< all with |s − σ| <= radius, 1/s
  Eigen::Index expected = 0;    ///< about so many
  Eigen::Index most_steps = 0;  ///< vectors of the Krylov space, at most
  double tolerance = 1e-11;     ///< of a pair of the projection, relative to |μ|
};

struct NearestPairs {
  std::vector<SparsePair> pairs;  ///< converged, ascending |s − σ|
  bool are_all = false;           ///< nothing within the radius is left that has not converged
};

/// Arnoldi's method with (A − σ)⁻¹ on the states w = (x, s x/|σ|), one factorisation for all pairs
/// (docs/theory.md, 10.5):
///
///   P(σ) x' = −(M (v + σ x) + P x),   v' = σ x' + x,   v = s x on an eigenvector,
///
/// of which (A − σ)⁻¹ w = w/(s − σ). The space grows from several vectors, so that it finds
/// eigenvalues that coincide. A pair (μ, y) of the projection has converged when
/// |(A − σ)⁻¹ W y − μ W y| <= tolerance |μ|.
///
/// @param factor of P(σ)
/// @param start  vectors x to begin with, n x k, k >= 1
/// @throws std::invalid_argument if `start` has other rows or none; StopRequested
/// Cost: a solve per step, and of order 8 n m² operations and 32 n m bytes for m steps.
NearestPairs nearest_pairs(const SparsePencil& pencil, const SparseFactor& factor,
                           const NearestPairsWanted& wanted, const Eigen::MatrixXcd& start);

}  // namespace stridor
