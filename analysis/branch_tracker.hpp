// Eigenvalues followed from value to value of a parameter.
#pragma once

#include <algorithm>
#include <complex>
#include <vector>

#include "analysis/spectrum_source.hpp"

namespace stridor {

/// Values to be visited in any case, ascending.
struct Grid {
  std::vector<double> values;
  std::vector<double> kinks;  ///< those inside the range

  bool is_kink(double value) const { return std::binary_search(kinks.begin(), kinks.end(), value); }
};

/// @param wanted values asked for, ascending
/// @param kinks  values where the pencil is not smooth, ascending
Grid make_grid(const std::vector<double>& wanted, const std::vector<double>& kinks);

/// A branch with what is needed to come back to it.
struct Track {
  Branch branch;
  std::vector<double> spacing;  ///< of every sample: distance to the nearest other eigenvalue
  int hint = -1;
  bool is_followed = true;

  std::complex<double> last() const { return branch.s.back(); }
};

/// Follows every eigenvalue over the grid (trace_locus()).
///
/// @param locus its values are asked for; receives eigenvalues, places and what is unverified
/// @throws NumericalError if the eigenvalues at the first value cannot be found
std::vector<Track> follow_branches(SpectrumSource& source, const LocusOptions& options,
                                   const Grid& grid, Locus& locus);

}  // namespace stridor
