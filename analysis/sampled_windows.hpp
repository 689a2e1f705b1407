// Unstable windows of every eigenvalue that grows, from spectra at single values.
#pragma once

#include <vector>

#include "analysis/spectrum_sampler.hpp"

namespace stridor {

/// Search for the ends and the largest growth of windows.
struct WindowEffort {
  double tolerance = 1e-13;  ///< of the ends, relative
  int climbing_steps = 40;   ///< of golden sections towards the largest growth
  enum class Ends { halving, secants } ends = Ends::halving;
};

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

}  // namespace stridor
