// Eigenpairs of dense symmetric matrices: all of them, or those at one end of the spectrum.
#pragma once

#include <Eigen/Core>
#include <string>

namespace stridor {

struct SymmetricEigenpairs {
  Eigen::VectorXd values;   ///< ascending
  Eigen::MatrixXd vectors;  ///< a column each
};

/// Solves A x = ν x with orthonormal x.
///
/// LAPACK's dsyevd, which has most of its work in products of matrices: for some hundred unknowns it
/// takes less than half of the instructions of QR iterations.
///
/// @param matrix A; its lower triangle is read
/// @param what   named in the message of an error
/// @throws NumericalError if an entry is not finite, or the method does not converge
SymmetricEigenpairs symmetric_eigenpairs(Eigen::MatrixXd matrix, const std::string& what);

/// The `count` lowest pairs of A x = ν x, ascending, with orthonormal x.
///
/// By relatively robust representations (LAPACK's dstemr), which find vectors one by one: for a
/// third of the pairs of some hundred unknowns two thirds of the instructions of
/// symmetric_eigenpairs(), for an eighth less than half.
///
/// @param matrix A; its lower triangle is read
/// @param count  from 0 to the size of A
/// @param what   named in the message of an error
/// @throws NumericalError as symmetric_eigenpairs()
SymmetricEigenpairs lowest_eigenpairs(Eigen::MatrixXd matrix, Eigen::Index count,
                                      const std::string& what);

/// The `count` highest pairs, ascending; else as lowest_eigenpairs().
SymmetricEigenpairs highest_eigenpairs(Eigen::MatrixXd matrix, Eigen::Index count,
                                       const std::string& what);

/// Solves K x = ν M x with xᵀ M x = 1, by the Cholesky factor of M.
///
/// @param stiffness K; its lower triangle is read
/// @param mass      M, likewise
/// @throws NumericalError as symmetric_eigenpairs(), or if M is not positive definite
SymmetricEigenpairs generalised_eigenpairs(Eigen::MatrixXd stiffness, const Eigen::MatrixXd& mass,
                                           const std::string& what);

}  // namespace stridor
