// Ends of unstable windows, from spectra at single values.
#pragma once

#include <cstddef>

#include "analysis/spectrum_sampler.hpp"

namespace stridor {

/// Search for the ends and the largest growth of windows.
struct WindowEffort {
  double tolerance = 1e-13;  ///< of the ends, relative
  int climbing_steps = 40;   ///< of golden sections towards the largest growth
  /// How ends are approached: where spectra are dear by the pairs of eigenvalues that meet there.
  /// Then parabolas also give the integral of the growth where its curvature adds little.
  enum class Ends { halving, by_pairs } ends = Ends::halving;
};

/// Narrows the interval in which the rank-th largest excess (Sample::ranked_excess) changes its
/// sign: by halves until nothing lies between, or by pairs until it is as narrow as the tolerance
/// says.
///
/// @param rank    from 1 on
/// @param stable  where that excess is not positive; takes the sample at that end
/// @param growing where it is
void narrow_end(const SpectrumSampler& sampler, const WindowEffort& effort, std::size_t rank,
                Sample& stable, Sample& growing);

}  // namespace stridor
