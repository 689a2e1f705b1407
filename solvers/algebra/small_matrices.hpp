// Determinants and traces of complex matrices of a few rows.
#pragma once

#include <Eigen/Core>
#include <complex>
#include <optional>

namespace stridor {

// By hand: a call of LAPACK would take longer than the work, and BLAS may serve one thread at a time
// (core/blas.hpp).

/// 1/z without the care for overflow that the library takes.
inline std::complex<double> reciprocal(std::complex<double> z) {
  return std::conj(z) / std::norm(z);
}

/// Scales columns and then rows of B, and B′ likewise, to largest entries of 1; false where one of
/// B is zero.
bool equilibrate(Eigen::MatrixXcd& B, Eigen::MatrixXcd& slope);

/// det B by elimination with row pivoting, B destroyed.
std::complex<double> determinant_of(Eigen::MatrixXcd& B);

/// tr(B⁻¹ C) by elimination with row pivoting, both destroyed; nothing where B is singular.
std::optional<std::complex<double>> trace_of_solution(Eigen::MatrixXcd& B, Eigen::MatrixXcd& C);

}  // namespace stridor
