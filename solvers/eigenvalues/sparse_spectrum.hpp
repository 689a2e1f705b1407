// Eigenvalues of a large sparse quadratic problem in a window, with a count that none is missed.
#pragma once

#include <complex>
#include <functional>
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

/// Eigenpairs of a system from the real axis to a tenth above a window: what spans the motions of a
/// system like it.
struct TwoSidedPairs {
  std::vector<std::complex<double>> s;  ///< ascending Im s, then Re s; Im s >= 0
  Eigen::MatrixXcd right;               ///< P(s) x = 0, one per column, of length 1
  /// About yᴴ P(s) = 0, of length 1: a step of inverse iteration that begins with x; empty where
  /// only right vectors were asked for.
  Eigen::MatrixXcd left;

  Eigen::Index size() const { return right.cols(); }
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
  TwoSidedPairs pairs;       ///< where they are asked for
};

/// Further work of a search.
struct SpectrumWork {
  enum class Sides { right, both } sides = Sides::right;  ///< `both`: with SparseSpectrum::pairs
  /// Called with every s and factor of P(s) that the count takes.
  std::function<void(std::complex<double>, const SparseFactor&)> on_count;
};

/// All eigenvalues of M q̈ + P q̇ + Q q = 0 in a window (docs/theory.md, 10.5).
///
/// Real modes of the symmetric part of Q with M, up to 1.5 times the window, say where to look.
/// Groups of neighbours are found by nearest_pairs() with a shift beside the middle of each; a
/// projection on all of their vectors then tells apart what lies close together. Their number is
/// compared with count_in_rectangle() of det P(s). Where one is missing, the search is repeated
/// with smaller groups.
///
/// @param window a count, or a frequency; with a count there may be more
/// @return status in is_complete; where it is false, the eigenvalues found
/// @throws std::invalid_argument as SparsePencil, or if the window is neither
/// @throws NumericalError if M is not positive definite, the window takes more than 1,000 modes of
/// the
///         symmetric part, or as SparsePencil
/// Cost: about 2 factorisations for every pair, and 70 for the count.
SparseSpectrum sparse_spectrum(const SparseSystem& system, const SpectrumWindow& window,
                               const SpectrumWork& work = {});

/// A height above `count` of the heights, in the middle of the first gap that is none of
/// rounding; 1.2 times the highest where there are too few.
/// @param heights ascending, at least one, rad/s
double height_above(const std::vector<double>& heights, int count);

/// The pairs of a system that is like another one, by the same method from the vectors of that one;
/// nothing is counted.
/// @param guesses of the other system
/// @param height  of the window, rad/s
/// @param factorisations to which those of P(s) are added
/// @param sides   `right`: without left vectors
/// Cost: a factorisation for 24 pairs, and about six solves for each.
TwoSidedPairs pairs_near(const SparseSystem& system, const TwoSidedPairs& guesses, double height,
                         int& factorisations,
                         SpectrumWork::Sides sides = SpectrumWork::Sides::both);

}  // namespace stridor
