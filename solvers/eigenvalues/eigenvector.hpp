// The motion that belongs to an eigenvalue of a pencil, and how well the two fit.
#pragma once

#include <Eigen/Core>
#include <complex>

#include "solvers/eigenvalues/pencil.hpp"

namespace stridor {

/// Motion that belongs to an eigenvalue, in modal coordinates.
struct Eigenvector {
  Eigen::VectorXcd right;  ///< q, n, unit length
  Eigen::VectorXcd left;   ///< n, unit length: leftᴴ (s² + s C + K) q = 0 for all q that fit B_C
  Eigen::VectorXcd force;  ///< δλ, k, for this q
};

/// Eigenvector of an eigenvalue, from the small problem on the ports.
///
///   q_i = (Sᵀ f)_i/(s² + c_i s + ω_i²)
///
/// @param s an eigenvalue of the pencil, as accurate as can be had
/// @throws std::invalid_argument as check_pencil()
/// Cost: n (k + rank of G and H). Where s is a multiple eigenvalue, one vector of its space.
Eigenvector eigenvector(const Pencil& pencil, std::complex<double> s);

/// The same with the modal_rows() of the pencil at hand, which all its eigenvalues share: with some
/// hundred ports they cost more than an eigenvector.
Eigenvector eigenvector(const Pencil& pencil, const ModalRows& rows, std::complex<double> s);

/// What is left of the equations of motion, in proportion to their terms.
///
///   ‖W⁻¹ (P(s) q + Sᵀ B_Eᵀ δλ)‖ / Σ ‖W⁻¹ term‖ + ‖B_C S q‖/‖ |B_C S| |q| ‖,
///   P(s) = s² + s C + Ω² + Sᵀ (G + s H) S,   W = diag(|s| + ω)
///
/// with the δλ that makes it least. W weighs slow and fast modes alike. Of the order of rounding,
/// 1e-16 to 1e-12, for an exact pair.
double relative_residual(const Pencil& pencil, std::complex<double> s,
                         const Eigen::VectorXcd& right);

/// Modal assurance criterion |aᴴb|²/(aᴴa bᴴb): 1 for the same shape, 0 for orthogonal ones.
double modal_assurance(const Eigen::VectorXcd& a, const Eigen::VectorXcd& b);

}  // namespace stridor
