// Eigenvalues of a large sparse quadratic problem in a window, with a count that none is missed.
#pragma once

#include <vector>

#include "solvers/eigenvalues/secular_eigenvalues.hpp"
#include "solvers/eigenvalues/sparse_pencil.hpp"

namespace stridor {

/// Where eigenvalues were searched and counted: 0 <= |Im s| <= height, −height/2 <= Re s <= 5/4
/// height.
///
/// A motion that grows obeys, with its unit vector in the norm of M and d, g, k as in
/// ModeQuotients, ρ² = ω² + g ω − k − d ρ. Where damping and stiffness are not negative, ρ² <= ω² +
/// |g| ω: up to |g| <= height/2 nothing that grows below the height lies outside.
struct SpectrumRectangle {
  double height = 0.0;  ///< rad/s
  double left() const { return -0.5 * height; }
  double right() const { return 1.25 * height; }
  bool contains(std::complex<double> s) const {
    return std::abs(s.imag()) <= height && s.real() >= left() && s.real() <= right();
  }
};

/// Eigenvalues in a rectangle, and whether their number is verified.
struct SparseSpectrum {
  /// Im s >= 0, ascending Im s, then ascending Re s; the residuals are scaled_residual().
  std::vector<Eigenvalue> eigenvalues;
  Eigen::MatrixXcd right;               ///< q of each, one per column, qᴴ M q = 1
  std::vector<double> backward_errors;  ///< normwise, of each
  SpectrumRectangle rectangle;
  int num_found = 0;         ///< in the rectangle, conjugates counted
  int num_counted = 0;       ///< in the rectangle by the argument principle, conjugates counted
  bool is_complete = false;  ///< as many were found as counted
  int factorisations = 0;    ///< of P(s)
  Eigen::VectorXd omega;     ///< of the lowest modes of the symmetric part, rad/s; 0 below zero
  Eigen::MatrixXd modes;     ///< their shapes, mass-normalised
};

/// All eigenvalues of M q̈ + P q̇ + Q q = 0 in a window (docs/theory.md, 10.5).
///
/// Real modes of the symmetric part of Q with M, up to 1.5 times the window, say where to look.
/// Groups of neighbours are found by nearest_pairs() with a shift beside the middle of each; a
/// projection on all of their vectors then tells apart what lies close together. Their number is
/// compared with count_in_rectangle() of det P(s). Where one is missing, the search is repeated
/// with smaller groups.
///
/// fastest_near() and closest_near() refine pairs (s, x) by inverse iteration,
///
///   P(σ) y = (P(σ) − P(s))/(σ − s) x,   y = (x − P(σ)⁻¹ P(s) x)/(σ − s)
///
/// (Neumaier 1985; a pair that is exact stays as it is) with shifts σ near groups of them: y joins
/// the space, and all pairs are projected anew. A pair has converged when y adds less than 1e-9 to
/// the space.
///
/// @param window a count, or a frequency; with a count there may be more
/// @return status in is_complete; where it is false, the eigenvalues found
/// @throws std::invalid_argument as SparsePencil, or if the window is neither
/// @throws NumericalError if M is not positive definite, the window takes more than 1,000 modes of
/// the
///         symmetric part, or as SparsePencil
/// Cost: about 2 factorisations for every pair, and 70 for the count.
SparseSpectrum sparse_spectrum(const SparseSystem& system, const SpectrumWindow& window);

/// Eigenvectors of systems like one another, as a basis for one between them.
struct SpectrumBasis {
  Eigen::MatrixXd vectors;  ///< orthonormal
  double height = 0.0;      ///< up to where they are all there, rad/s
};

/// @param spectra of systems of one size, at least one
SpectrumBasis spectrum_basis(const std::vector<const SparseSpectrum*>& spectra);

/// Eigenvalues up to the height of a basis by Galerkin's projection: approximations, among which
/// may be some near which the system has none. Im s >= 0.
/// Cost: that of a dense problem with the columns of the basis, without factorisations.
std::vector<std::complex<double>> projected_eigenvalues(const SparseSystem& system,
                                                        const SpectrumBasis& basis);

/// Those of the projected eigenvalues that grow fastest, refined as in sparse_spectrum(). Growth in
/// a direction that the basis lacks is missed, and nothing is counted.
/// @param count how many of them to refine, >= 1
/// @throws as sparse_spectrum()
/// Cost: a few factorisations.
SparseSpectrum fastest_near(const SparseSystem& system, const SpectrumBasis& basis, int count);

/// Likewise those closest to a place in the complex plane.
SparseSpectrum closest_near(const SparseSystem& system, const SpectrumBasis& basis,
                            std::complex<double> place, int count);

}  // namespace stridor
