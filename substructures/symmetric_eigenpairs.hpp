// Eigenpairs of dense symmetric matrices: all of them, or some neighbours.
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

/// The pairs number `first` to first + count − 1 of A x = ν x, in ascending order, x orthonormal.
///
/// LAPACK's dsyevr: bisection and inverse iteration on the tridiagonal form. Of 150 unknowns 20
/// pairs take a third of the instructions of all.
///
/// @param matrix A; its lower triangle is read
/// @param first  0 .. n − count
/// @param count  0 .. n
/// @param what   named in the message of an error
/// @throws std::invalid_argument if there are no such pairs
/// @throws NumericalError as symmetric_eigenpairs()
SymmetricEigenpairs neighbouring_eigenpairs(Eigen::MatrixXd matrix, Eigen::Index first,
                                            Eigen::Index count, const std::string& what);

/// Solves K x = ν M x with xᵀ M x = 1, by the Cholesky factor of M.
///
/// @param stiffness K; its lower triangle is read
/// @param mass      M, likewise
/// @throws NumericalError as symmetric_eigenpairs(), or if M is not positive definite
SymmetricEigenpairs generalised_eigenpairs(Eigen::MatrixXd stiffness, const Eigen::MatrixXd& mass,
                                           const std::string& what);

}  // namespace stridor
