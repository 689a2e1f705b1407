// One recorded quantity against another.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace stridor {

/// The values along one axis.
struct PhaseAxis {
  std::string label;  ///< quantity on the axis
  std::string units;  ///< as in a run file
  std::vector<double> values;
};

/// A line through points; values that are not finite break it.
struct PlanePath {
  std::vector<double> x;
  std::vector<double> y;
};

/// A path to draw instead of a long one so that the picture looks the same.
///
/// The plane is cut into columns × rows cells between the extremes of the path. Points that stay in
/// the cell of the last one are passed over. Of the segments between the others those are kept that
/// pass through a cell through which no segment before has passed. So no more than
/// columns·rows segments are kept, however often an orbit is run through, and no cell that the path
/// touches stays empty. A path of at most `columns` points is returned as it is.
///
/// @throws std::invalid_argument if x and y differ in length, or columns or rows is 0
PlanePath visible_path(std::span<const double> x, std::span<const double> y, std::size_t columns,
                       std::size_t rows);

/// Samples per period of the oscillation of a series, from how often it passes its mean value.
/// @return nothing where it passes that less than four times
std::optional<double> samples_per_period(std::span<const double> values);

/// Draws one quantity against another as a path in the plane, 16 cm wide; a ring marks its
/// beginning, a dot its end.
///
/// @param across  the horizontal axis
/// @param up      the vertical axis, with as many values
/// @param caption below; may be empty
/// @param figure  .png, .svg or .pdf; replaced if it exists
/// @throws std::invalid_argument if the axes differ in length
/// @throws ConfigError, FileError as draw_figure()
void plot_phase(const PhaseAxis& across, const PhaseAxis& up, const std::string& caption,
                const std::filesystem::path& figure);

}  // namespace stridor
