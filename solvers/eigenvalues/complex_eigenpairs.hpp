// Eigenvalues and eigenvectors of small dense complex matrices.
#pragma once

#include <Eigen/Core>

namespace stridor {

/// A v = s v; in no particular order.
struct ComplexEigenpairs {
  Eigen::VectorXcd values;
  Eigen::MatrixXcd vectors;  ///< of unit length, a column each
};

/// By zgeev of LAPACK: balancing, Hessenberg form, QR iteration; backward stable.
/// @param matrix square, finite
/// @throws NumericalError if the iteration fails
ComplexEigenpairs complex_eigenpairs(Eigen::MatrixXcd matrix);

}  // namespace stridor
