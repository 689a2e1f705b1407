// Reproducible random samples.
#pragma once

#include <cstddef>
#include <random>
#include <vector>

namespace stridor::test {

/// Normal, of unit variance about 0.3.
inline std::vector<double> noise(std::size_t count) {
  std::mt19937_64 generator(5);
  std::normal_distribution<double> normal;
  std::vector<double> samples(count);
  for (double& x : samples) x = 0.3 + normal(generator);
  return samples;
}

}  // namespace stridor::test
