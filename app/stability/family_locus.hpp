// Eigenvalues followed along one key of a family of small motions, and where their stability
// changes.
#pragma once

#include <vector>

#include "analysis/locus.hpp"
#include "analysis/sampled_locus.hpp"
#include "app/stability/stability_family.hpp"

namespace stridor {

/// Follows eigenvalues along one key of a family. Along a key of whole numbers nothing is put
/// between the values, there are no branches, and windows end at the first and last value at which
/// something grows.
/// @param key    index of the one that varies
/// @param values of all keys
/// @param range  values of that key, strictly ascending
/// @param wanted where stability alone is wanted, sampled loci have a window for every stretch in
///               which anything grows
/// @return with the method taken: secular, dense, followed (of large dense problems) or sparse
/// @throws ConfigError, NumericalError
Locus locus_along(StabilityFamily& family, const NumericKey& varied, std::size_t key,
                  const std::vector<double>& values, const std::vector<double>& range,
                  const LocusOptions& options, SearchFor wanted = SearchFor::every_window);

/// A value at which the system as a whole becomes stable or unstable.
struct StabilityChange {
  double value = 0.0;
  double frequency = 0.0;  ///< Hz, of the eigenvalue on the imaginary axis
  bool is_unstable_beyond = false;
};

/// Of all crossings those at which the number of growing eigenvalues leaves or reaches zero.
std::vector<StabilityChange> stability_changes(const Locus& locus);

}  // namespace stridor
