// Picture of stability over two parameters.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace stridor {

/// An axis of a stability map.
struct MapAxis {
  std::string label;           ///< e.g. "contact.friction.coefficient"
  std::string units;           ///< as in a run file
  std::vector<double> values;  ///< ascending, at least two, evenly spaced (in the logarithm)
  bool is_logarithmic = false;
};

/// A point on the boundary between stable and unstable.
struct MapPoint {
  double x = 0.0;
  double y = 0.0;
};

struct StabilityMapPicture {
  MapAxis x;
  MapAxis y;
  std::vector<std::vector<double>> growth;      ///< largest growth rate, 1/s, a row per y
  std::vector<std::vector<MapPoint>> boundary;  ///< lines
  std::string caption;
};

/// Draws the largest growth rate over two parameters as colour, blue where it is negative and red
/// where it is positive, with the boundary.
/// @throws std::invalid_argument if an axis has less than two values or the rows do not fit
/// @throws ConfigError, FileError as draw_figure()
void plot_stability_map(const StabilityMapPicture& picture, const std::filesystem::path& figure);

}  // namespace stridor
