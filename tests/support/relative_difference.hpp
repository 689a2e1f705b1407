// How far two lists of samples are apart.
#pragma once

#include <cmath>
#include <vector>

namespace stridor::test {

/// Relative L2 norm of the difference.
inline double relative_difference(const std::vector<double>& a,
                                  const std::vector<double>& reference) {
  double difference = 0.0;
  double size = 0.0;
  for (std::size_t i = 0; i < reference.size(); ++i) {
    difference += std::pow(a.at(i) - reference[i], 2);
    size += reference[i] * reference[i];
  }
  return std::sqrt(difference / size);
}

}  // namespace stridor::test
