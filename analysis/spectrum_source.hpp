// Eigenvalues along a parameter as the two methods of solution give them.
#pragma once

#include <complex>
#include <memory>
#include <optional>
#include <vector>

#include "analysis/locus.hpp"

namespace stridor {

/// Whether an eigenvalue of the upper half plane represents itself and its conjugate.
inline bool is_pair(std::complex<double> s) {
  return s.imag() > 0.0;
}

/// Eigenvalue method of a locus. Sets are of the upper half plane and the real axis.
class SpectrumSource {
 public:
  using Complex = std::complex<double>;

  struct Followed {
    Complex s;
    bool is_converged = false;
  };

  virtual ~SpectrumSource() = default;
  virtual void move_to(double value) = 0;
  /// All eigenvalues of some region, those wanted among them; empty where the search failed.
  virtual std::optional<std::vector<Complex>> search() = 0;
  /// Whether an eigenvalue lies in the region of the last search.
  virtual bool is_searched(Complex s) const = 0;
  /// The eigenvalue next to a guess.
  virtual Followed follow(Complex guess, double spacing, int& hint) = 0;
  /// Whether every eigenvalue with Im s <= needed is in the set, and no stranger.
  virtual bool covers(const std::vector<Complex>& set, double needed) = 0;
  virtual Eigen::VectorXcd shape(Complex s) = 0;
  /// Size of the numbers whose difference is an eigenvalue, 1/s: its rounding error is proportional
  /// to it.
  virtual double magnitude(Complex s) const = 0;
};

/// @param value where the first pencil is made
std::unique_ptr<SpectrumSource> make_spectrum_source(const PencilFamily& family, double value,
                                                     const LocusOptions& options);

}  // namespace stridor
