// Locus of a small system from all its eigenvalues at every value, without following any.
#pragma once

#include <vector>

#include "analysis/interval_search.hpp"
#include "analysis/sampled_windows.hpp"
#include "analysis/spectrum_sampler.hpp"

namespace stridor {

/// Limits of the number of spectra for a locus.
struct SamplingEffort {
  int least_values = 64;  ///< looked at in all, where fewer are asked for
  int most_added = 256;   ///< values put between where eigenvalues cannot be told apart
  WindowEffort windows{};
  SearchFor wanted = SearchFor::every_window;
};
/// For spectra of large matrices.
inline constexpr SamplingEffort sparing_effort{32, 64, {1e-9, 8, WindowEffort::Ends::by_pairs}};

/// For the places alone where the system as a whole becomes stable or unstable, as a map draws
/// them.
inline constexpr SamplingEffort stability_effort{
    16, 256, {1e-11, 0, WindowEffort::Ends::by_pairs}, SearchFor::stability};

/// Eigenvalues and unstable windows along a parameter, for systems whose eigenvalues coincide or
/// lie on the imaginary axis over whole intervals: without damping, with bodies that are alike.
///
/// At every value the dense problem is solved. An eigenvalue grows where its real part is larger
/// than rounding can make of zero,
///
///   Re s > min(20 ε ‖A‖ κ, 1e-6 |s|),
///
/// A the linearised matrix and κ its condition number. Every one that grows has a window of its
/// own, whose ends are bisected: where two eigenvalues meet on the axis their real part grows like
/// a square root, and the error of the end is of order ε all the same. Besides the values asked for
/// at least 64 are computed; search_intervals() searches for windows between two of them.
///
/// @return where every window is searched for, with branches from sample to sample (add_branches());
///         else without them, and `branch` of windows and crossings is 0
/// @throws as trace_locus()
Locus sample_locus(const PencilFamily& family, const std::vector<double>& values,
                   const LocusOptions& options = {});
Locus sample_locus(const PencilFamily& family, const std::vector<double>& values,
                   const LocusOptions& options, const SamplingEffort& effort);
/// The same from spectra that come from elsewhere. Those that were not counted are among the values
/// not verified.
Locus sample_locus(const SpectrumFamily& family, const std::vector<double>& values,
                   const LocusOptions& options, const SamplingEffort& effort);

}  // namespace stridor
