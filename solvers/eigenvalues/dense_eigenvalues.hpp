// Eigenvalues of a pencil with dense matrices: primal assembly, the reference.
#pragma once

#include <vector>

#include "solvers/eigenvalues/pencil.hpp"

namespace stridor {

enum class DenseWork {
  eigenvalues,  ///< no residuals, at less than half the cost
  /// As `eigenvalues`, with condition numbers of those on the imaginary axis but for little,
  /// is_near_axis(); at hardly more cost where they are few.
  near_axis,
  residuals,   ///< with eigenvectors and residuals
  conditions,  ///< as `residuals`, with condition numbers
};

/// Whether rounding may decide on which side of the imaginary axis an eigenvalue lies:
/// |Re s| <= 1e-6 |s|.
bool is_near_axis(std::complex<double> s);

/// All eigenvalues of a pencil and the motions that belong to them.
struct DenseSpectrum {
  std::vector<Eigenvalue> eigenvalues;  ///< Im s >= 0, ascending Im s, then ascending Re s
  Eigen::MatrixXcd right;               ///< q of each, one per column; empty without residuals
  /// Magnification of rounding in the linearised matrix for each: 1/|yᴴx| for its unit left
  /// and right eigenvectors, large where two eigenvalues and their motions are about to coincide.
  /// Empty unless asked for; NaN of those it was not asked for.
  std::vector<double> conditions;
  /// Norm of the linearised matrix, balanced, 1/s: by ε times it and the condition rounding moves
  /// an eigenvalue.
  double norm = 0.0;
};

/// Primal assembly, linearised and handed to LAPACK (docs/theory.md, 7.2; BDF section 2.4).
///
///   q = L_C a,  L_C = null(B_C S),  L_E = null(B_E S):
///   (s² L_Eᵀ L_C + s L_Eᵀ C L_C + L_Eᵀ K L_C) a = 0,
///   K = diag(ω²) + Sᵀ G S,  C = diag(c) + Sᵀ H S
///
/// L_C and L_E are orthonormal bases from Householder factorisations; they differ under friction.
/// The problem is linearised with displacements scaled by the frequencies of their modes,
/// p = W q ∈ null(B_C S W⁻¹), W = diag(ω):
///
///   s p = W v,   s v = −M⁻¹ (K W⁻¹ p + C v)
///
/// so that without strong damping no entry is larger than the highest ω and every eigenvalue has an
/// absolute error of the order of that ω times rounding. With displacements unscaled the entries
/// reach ω², and the slow eigenvalues of a stiff mesh lose half of their digits.
///
/// Where the norm of that matrix A exceeds the slowest ω by 1e10 or more (a damper on hardly any
/// mass), the slow eigenvalues would be lost in its rounding. Those below the geometric mean of
/// both are then taken from (A − σ)⁻¹, σ the slowest ω.
///
/// @throws std::invalid_argument as check_pencil()
/// @throws NumericalError if the constraints are not independent, if L_Eᵀ L_C is singular to
/// working
///         precision (the contact forces for an acceleration are then not unique), or if the
///         iteration fails
/// Cost: of order 10 (2n)³ operations, 25 (2n)³ with residuals, 35 (2n)³ with condition numbers.
DenseSpectrum dense_spectrum(const Pencil& pencil, DenseWork work = DenseWork::residuals);

/// Eigenvalues of dense_spectrum().
std::vector<Eigenvalue> dense_eigenvalues(const Pencil& pencil,
                                          DenseWork work = DenseWork::residuals);

/// Up to how many eigenvalues the dense method steps in where another fails: about a minute.
inline constexpr Eigen::Index most_dense = 2000;

/// Whether all eigenvalues by the dense method cost less than a search for zeros of the secular
/// function. That is a determinant of as many rows as contacts and the ports that they and coupled
/// bodies join, taken some tens of times for every eigenvalue.
bool is_dense_cheaper(const Pencil& pencil);

/// All eigenvalues of a square matrix, balanced first; conjugates one by one.
/// @throws NumericalError if the iteration fails
std::vector<std::complex<double>> matrix_eigenvalues(Eigen::MatrixXd matrix);

}  // namespace stridor
