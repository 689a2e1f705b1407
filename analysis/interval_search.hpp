// Growth between two neighbouring samples that neither of them shows.
#pragma once

#include <vector>

#include "analysis/spectrum_sampler.hpp"

namespace stridor {

/// Aim of a search along a parameter.
enum class SearchFor {
  every_window,  ///< windows of each eigenvalue that grows
  stability,     ///< where the system as a whole becomes stable or unstable
};

/// Result of a search between samples.
struct IntervalSearch {
  std::vector<Sample> between;  ///< samples of any kind, in any order
  /// Largest distance of two values between which something may have been missed; 0 if none.
  double unresolved = 0.0;
};

/// Looks for growth that begins and ends between two samples, and for its absence where both ends
/// grow (docs/theory.md, 10.3).
///
/// Eigenvalues are connected from sample to sample by extrapolation. A narrow window has one of two
/// causes, and each shows at the ends of its interval.
///
/// *Two eigenvalues approach each other*, or one its conjugate. Of a pair, mean m = (s₁ + s₂)/2 and
/// square D = ((s₁ − s₂)/2)² are smooth functions of the parameter even where the eigenvalues meet
/// and leave the imaginary axis: without damping they do so where D changes its sign. The distance
/// |s₁ − s₂| changes between samples by no more than L h, L the fastest change in this interval and
/// its neighbours. Where the distances at both ends add up to 3/2 L h or less, the largest
/// Re D and the largest growth Re m + |Re √D| of the pair are solved for by parabolas through m and
/// D, on spectra and not on their interpolation.
///
/// *The real part of one eigenvalue has a maximum.* Where the tangents at both ends meet above
/// zero, it is climbed, likewise a minimum.
///
/// Intervals in which eigenvalues cannot be connected without doubt are halved, as are those where
/// the parabola of a pair does not agree with both ends. No spectrum is spent on a pair that its
/// damping keeps stable by the samples at hand, growth_bound() < 0, nor, where stability is looked
/// for, on an interval throughout which one eigenvalue grows.
///
/// @param whole       samples with all eigenvalues, ascending values; more of them are added
/// @param most_values that may be added
/// Cost: three to six samples for every approach of two eigenvalues.
IntervalSearch search_intervals(const SpectrumSampler& sampler, std::vector<Sample>& whole,
                                int most_values, SearchFor wanted = SearchFor::every_window);

}  // namespace stridor
