// Branches of a locus from spectra at single values.
#pragma once

#include <vector>

#include "analysis/spectrum_sampler.hpp"

namespace stridor {

/// Appends a branch for each eigenvalue that is connected from sample to sample (SampleChains), and
/// says of each window and crossing on which branch it lies: the nearest one, by straight lines
/// between samples; −1 where no branch is at its value.
///
/// @param whole samples with all eigenvalues, ascending values, at least one
void add_branches(const std::vector<Sample>& whole, Locus& locus);

}  // namespace stridor
