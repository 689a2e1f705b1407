// Unstable windows of every eigenvalue that grows, from spectra at single values.
#pragma once

#include <vector>

#include "analysis/spectrum_sampler.hpp"
#include "analysis/window_ends.hpp"

namespace stridor {

/// Solves for all changes in the number of eigenvalues that grow, and appends a window for each
/// eigenvalue from where it begins to grow to where it ends.
///
/// The k-th largest excess is a continuous function of the parameter, and the number of those that
/// grow changes where one of them changes its sign. Growing eigenvalues are connected with the
/// closest ones of the next sample.
///
/// @param samples ascending values
void find_sampled_windows(const SpectrumSampler& sampler, const WindowEffort& effort,
                          std::vector<Sample> samples, Locus& locus);

/// Solves for the changes of stability alone: a window for every stretch in which anything grows,
/// with the fastest eigenvalue of the samples at hand, and its ends as crossings.
///
/// @param samples ascending values
void find_unstable_stretches(const SpectrumSampler& sampler, const WindowEffort& effort,
                             std::vector<Sample> samples, Locus& locus);

}  // namespace stridor
