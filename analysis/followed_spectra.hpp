// Spectra of large full systems along a parameter, each from the vectors of one close by.
#pragma once

#include <complex>
#include <list>
#include <map>
#include <optional>
#include <vector>

#include "analysis/spectrum_sampler.hpp"
#include "solvers/eigenvalues/sparse_spectrum.hpp"

namespace stridor {

/// Eigenvalues in a window of systems whose matrices are full, along a parameter.
///
/// The first system takes all its eigenvalues by the dense method. Of any other one those in the
/// window, and to a tenth above it, are found by shift and invert from the vectors at the nearest
/// value known (pairs_near()): a factorisation for some 48 of them, where all take n times that.
/// They are taken where every one has a scaled residual of 1e-6 and there are exactly as many as at
/// that value within edges next to those of the window, in the widest strips without any at both;
/// else the system takes all its eigenvalues too, as it may where more than two coincide. The
/// coordinates may change with the value.
class FollowedSpectra {
 public:
  explicit FollowedSpectra(const SpectrumWindow& window) : window_(window) {}

  /// @throws NumericalError as full_spectrum()
  /// Cost: O(n³) for systems at a distance, the dense method of order 25 n³ more at the first.
  SampledSpectrum at(double value, const SparseSystem& system);
  /// The spectrum at a value, where it is at hand.
  std::optional<SampledSpectrum> known(double value) const;
  int num_searched() const { return num_searched_; }  ///< systems by the dense method
  int num_followed() const { return num_followed_; }

 private:
  struct Known {
    double value;
    TwoSidedPairs pairs;
    double bytes() const;
  };

  const Known* nearest(double value, Eigen::Index size) const;
  bool agree(const TwoSidedPairs& known, const TwoSidedPairs& found) const;
  bool are_enough(const TwoSidedPairs& found) const;
  SampledSpectrum sampled(const std::vector<std::complex<double>>& all, bool is_counted) const;
  void keep(double value, TwoSidedPairs pairs);
  SampledSpectrum search(double value, const SparseSystem& system);

  SpectrumWindow window_;
  SpectrumRectangle rectangle_;
  std::map<double, SampledSpectrum> spectra_;
  std::list<Known> known_;  ///< with all their pairs; the latest first, as many as memory is for
  double bytes_ = 0.0;
  int num_searched_ = 0;
  int num_followed_ = 0;
};

}  // namespace stridor
