// The values of a parameter at which eigenvalues are followed in any case.
#pragma once

#include <algorithm>
#include <vector>

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

}  // namespace stridor
