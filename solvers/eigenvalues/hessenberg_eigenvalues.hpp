// Eigenvalues of a dense matrix, with condition numbers of the few that need them.
#pragma once

#include <Eigen/Core>
#include <complex>
#include <functional>
#include <optional>

namespace stridor {

/// Eigenvalues of a balanced matrix, in LAPACK's order: of a pair that with Im s > 0 comes first.
struct HessenbergEigenvalues {
  Eigen::VectorXcd values;
  /// |yᴴx| of unit left and right eigenvectors of the balanced matrix; NaN unless asked for.
  Eigen::VectorXd reciprocal_condition;
  double norm = 0.0;  ///< of the balanced matrix, its largest sum of a column
};

/// All eigenvalues of a square matrix; of some the condition too, by inverse iteration on the
/// Hessenberg form, which costs as little as n² operations for each.
///
/// @param is_wanted whether the condition of an eigenvalue with Im s >= 0 is wanted
/// @param most      conditions that are computed in this way
/// @return nothing where more are wanted, or where an inverse iteration fails or meets eigenvectors
///         that nearly coincide, |yᴴx| < 1e-6: LAPACK's dgeevx is better at those
/// @throws NumericalError if the QR iteration fails
/// Cost: about 10 n³ operations.
std::optional<HessenbergEigenvalues> hessenberg_eigenvalues(
    Eigen::MatrixXd matrix, const std::function<bool(std::complex<double>)>& is_wanted, int most);

}  // namespace stridor
