// Eigenpairs where some motions have no mass.
#pragma once

#include <Eigen/Core>
#include <string>

namespace stridor {

struct SemidefinitePairs {
  Eigen::VectorXd values;    ///< ν, ascending
  Eigen::MatrixXd vectors;   ///< x, a column each: xᵀ M x = 1
  Eigen::MatrixXd massless;  ///< n, a column each: M n = 0 and nᵀ K n = 1; may be none
};

/// Solves K x = ν M x for a positive semidefinite M.
///
/// Motions n without mass follow the others at rest: with an M-orthonormal Z beside them,
///
///   x = Z a + n b,   nᵀ K (Z a + n b) = 0,   (Zᵀ K Z − Zᵀ K n nᵀ K Z) a = ν a   (nᵀ K n = 1)
///
/// so none of the pairs at hand depends on a factor of M. They are told from the eigenvalues of M
/// scaled to a unit diagonal, those of `massless_ratio` or less in magnitude. Where there are none,
/// as generalised_eigenpairs().
///
/// @param stiffness K, symmetric
/// @param mass      M, symmetric
/// @throws NumericalError as generalised_eigenpairs(), if M has a negative eigenvalue, or if a
///         motion has neither mass nor a positive stiffness
SemidefinitePairs semidefinite_eigenpairs(const Eigen::MatrixXd& stiffness,
                                          const Eigen::MatrixXd& mass, const std::string& what);

}  // namespace stridor
