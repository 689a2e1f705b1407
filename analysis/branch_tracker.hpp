// Eigenvalues followed from value to value of a parameter.
#pragma once

#include <complex>
#include <vector>

#include "analysis/parameter_grid.hpp"
#include "analysis/spectrum_source.hpp"

namespace stridor {

/// Eigenvalues that differ by less, relative to their size, are tied: equal bodies have equal ones.
/// Rounding moves a double one by the root of its effect on others, so it has no meaning which of
/// them continues which.
inline constexpr double tie = 1e-7;

/// A branch with the data needed to come back to it.
struct Track {
  Branch branch;
  std::vector<double> spacing;  ///< of every sample: distance to the nearest one not tied to it
  std::vector<double> nearest;  ///< of every sample: distance to the nearest one of all
  bool is_tied = false;         ///< whether the last sample is tied to another eigenvalue
  int hint = -1;
  bool is_followed = true;

  std::complex<double> last() const { return branch.s.back(); }
};

/// Follows every eigenvalue over the grid (trace_locus()).
///
/// @param locus gives the values; receives eigenvalues, places and the unverified parts
/// @throws NumericalError if the eigenvalues at the first value cannot be found
std::vector<Track> follow_branches(SpectrumSource& source, const LocusOptions& options,
                                   const Grid& grid, Locus& locus);

}  // namespace stridor
