// Locus of a small system from all its eigenvalues at every value, without following any.
#pragma once

#include <complex>
#include <functional>
#include <vector>

#include "analysis/locus.hpp"

namespace stridor {

/// Eigenvalues at one value of a parameter.
struct SampledSpectrum {
  std::vector<std::complex<double>> eigenvalues;  ///< Im s >= 0, ascending Im s
  std::vector<double> rounding;  ///< what rounding may have added to each real part, 1/s
};
/// Those of a system that depends on one parameter; called in any order.
struct SpectrumFamily {
  /// All that are wanted.
  std::function<SampledSpectrum(double value)> at;
  /// Where `at` takes long: the fastest growing right and others perhaps missing, between values at
  /// which all are known; and a first look, right in neither. Both or none.
  std::function<SampledSpectrum(double value)> near, glimpse;
};

/// How many spectra a locus may cost.
struct SamplingEffort {
  int least_values = 64;     ///< looked at in all, where fewer are asked for
  double tolerance = 1e-13;  ///< of the ends of windows, relative
  int climbing_steps = 40;   ///< of golden sections towards the largest growth
  enum class Ends { halving, secants } ends = Ends::halving;  ///< how ends of windows are found
  int least_glimpses = 64;                                    ///< in all, where a family has them
};
/// For spectra that take seconds: all eigenvalues where they are asked for, and few besides.
inline constexpr SamplingEffort sparing_effort{1, 1e-9, 8, SamplingEffort::Ends::secants};

/// Eigenvalues and unstable windows along a parameter, for systems whose eigenvalues coincide or
/// lie on the imaginary axis over whole intervals: without damping, with bodies that are alike.
///
/// At every value the dense problem is solved. An interval is unstable where any of the eigenvalues
/// wanted has a real part larger than rounding can make of zero,
///
///   Re s > min(20 ε ω_max κ, 1e-6 |s|),
///
/// κ its condition number, and its ends are bisected: where two eigenvalues meet on the axis their
/// real part grows like a square root, and the error of the end is of order ε all the same. Between
/// the values asked for at least 64 are looked at, and every negative maximum of the growth is
/// climbed; a window that lies between two of them is missed where nothing is damped.
///
/// @return no branches; `branch` of windows and crossings is 0
/// @throws as trace_locus()
Locus sample_locus(const PencilFamily& family, const std::vector<double>& values,
                   const LocusOptions& options = {});
/// The same from spectra that come from elsewhere. Where the family has glimpses, several of them
/// are taken between any two values, and the largest of them climbed: what grows there by their
/// account, or does not where it grows on both sides, is looked at closely.
Locus sample_locus(const SpectrumFamily& family, const std::vector<double>& values,
                   const LocusOptions& options, const SamplingEffort& effort);

}  // namespace stridor
