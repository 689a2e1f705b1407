// Numbers of eigenvalues along a line of systems, from the determinants of one of them.
#pragma once

#include <complex>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "solvers/eigenvalues/sparse_spectrum.hpp"

namespace stridor {

/// Counts the eigenvalues of P(s) + c D(s) in a rectangle for any c up to a reach, from
///
///   det (P + c D) = det P  det (1 + c P⁻¹ D),   det (1 + c P⁻¹ D) = ∏ (1 + c γ_i) .
///
/// The γ_i of every place on the rectangle are found by Arnoldi's method with the factor of P(s)
/// there, starting from two random vectors, until those with |c γ_i| >= 0.3 have converged. The
/// others cannot change a count: their factors stay to the right of the imaginary axis, so that
/// their phases come back to where they began.
class CountAlong {
 public:
  /// @param direction D; `reach` is the largest |c|
  CountAlong(SparseSystem base, SparseSystem direction, double reach);

  /// Takes the determinant and the γ_i at a place, with the factor of P(s).
  void add(std::complex<double> s, const SparseFactor& factor);

  /// Eigenvalues in a rectangle, conjugates counted, as count_in_rectangle().
  /// @param known eigenvalues of the system, Im s >= 0
  /// @return nothing if |c| is beyond the reach or a γ_i has not converged
  /// Cost: little at places that were added, a factorisation at others.
  std::optional<int> count(double c, const SpectrumRectangle& rectangle,
                           const std::vector<std::complex<double>>& known);

  int factorisations() const { return factorisations_; }

 private:
  struct Place {
    std::complex<double> logarithm;  ///< log det P
    std::vector<std::complex<double>> gamma;
    bool has_converged = false;
  };

  const Place& at(std::complex<double> s);

  SparsePencil pencil_;
  SparseSystem direction_;
  double reach_;
  std::map<std::pair<double, double>, Place> places_;
  int factorisations_ = 0;
};

}  // namespace stridor
