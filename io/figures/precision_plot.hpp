// Error against run time of several ways to integrate one scene.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace stridor {

/// One way to integrate at several steps.
struct PrecisionCurve {
  struct Point {
    double seconds;  ///< of stepping
    double error;
    bool is_on_front;  ///< no other setting has less of both
  };
  std::string name;
  std::vector<Point> points;    ///< of the stable settings
  std::optional<double> slope;  ///< of log error over log time
};

struct PrecisionPicture {
  std::string error_label;       ///< quantity of the errors
  double reference_error = 0.0;  ///< of the reference itself; none where not positive
  std::optional<double> wanted;  ///< error that a setting was sought for
  std::string caption;
  std::vector<PrecisionCurve> curves;
};

/// Draws the errors over the times, both logarithmic: a line per way, a ring around the points that
/// are on the front, lines across for the error of the reference and the error wanted.
///
/// Points with an error of 0 or without one are omitted.
/// @throws ConfigError, FileError as draw_figure(); std::invalid_argument where there is no point
void plot_precision(const PrecisionPicture& picture, const std::filesystem::path& figure);

}  // namespace stridor
