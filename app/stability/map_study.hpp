// Stability of a scene over two of its keys.
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "analysis/locus.hpp"
#include "app/stability/stability.hpp"
#include "io/results/locus_file.hpp"

namespace stridor {

/// The method where growth has a formula, of all eigenvalues at once.
inline constexpr const char* growth_formula = "formula";

/// A key with the values that it takes along an axis of a map.
struct KeyAxis {
  NumericKey key;
  std::vector<double> values;  ///< strictly ascending, at least two
  bool is_logarithmic = false;
};

/// The growth rates at all points of a grid, with the reason where there is none, and the boundary
/// of stability.
/// @param resolution gets what may have been missed along x and along y, and the method taken
/// @throws ConfigError, Interrupted
StabilityMap make_stability_map(const StabilityScene& loaded, const std::array<KeyAxis, 2>& axes,
                                const StabilityOptions& stability,
                                std::array<Locus, 2>& resolution);

/// Points that failed for one reason.
struct FailedPoints {
  std::size_t number = 0;  ///< from 1, as StabilityMap::failure has it
  std::size_t num_points = 0;
  std::string reason;
};

/// The reasons of a map, that of most points first.
/// @param failure numbers of the reasons at all points, 0 where there is none
std::vector<FailedPoints> failed_points(const std::vector<std::string>& reasons,
                                        const std::vector<double>& failure);
std::vector<FailedPoints> failed_points(const StabilityMap& map);

}  // namespace stridor
