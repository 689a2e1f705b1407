// Eigenvalues and eigenvectors of a square matrix.
#pragma once

#include <Eigen/Core>

namespace stridor {

/// Eigenvalues of a square matrix and vectors of unit length, one per column.
struct MatrixModes {
  Eigen::VectorXcd values;  ///< of a pair of conjugates that with Im > 0 first, the other next
  Eigen::MatrixXcd vectors;
};

/// All eigenvalues and eigenvectors of a square matrix, balanced first, by LAPACK.
/// @throws NumericalError if the iteration fails
MatrixModes matrix_modes(Eigen::MatrixXd matrix);

}  // namespace stridor
