// Curves and points in diagrams side by side, and fields over a plane.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace stridor {

enum class AxisKind { linear, logarithmic };
enum class Mark { line, dashed_line, points };

/// One curve or cloud of points of a diagram.
struct PanelCurve {
  std::string label;  ///< in the legend; empty: none
  std::vector<double> x;
  std::vector<double> y;  ///< as many; values that are not finite are omitted
  Mark mark = Mark::line;
  int colour = 0;  ///< curves of the same number have the same colour
};

/// One diagram.
struct DiagramPanel {
  std::string x_label;
  std::string y_label;
  AxisKind x_kind = AxisKind::linear;
  AxisKind y_kind = AxisKind::linear;
  bool is_to_scale = false;  ///< the same length for the same number along both axes
  std::vector<PanelCurve> curves;
  double y_least = 0.0;  ///< of a logarithmic axis: what lies below is cut off; 0: nothing
  bool is_share = false;  ///< y goes from 0 to 1, whatever there is
};

/// Draws diagrams side by side, at most three in a row, with a caption below.
/// @param panels at least one
/// @throws std::invalid_argument if there is none, or x and y of a curve differ in length
/// @throws ConfigError, FileError as draw_figure()
void plot_panels(const std::vector<DiagramPanel>& panels, const std::string& caption,
                 const std::filesystem::path& figure);

/// A field on square cells, mirrored at y = 0, with a curve over it.
struct FieldPicture {
  std::vector<double> values;   ///< rows along x, the first next to y = 0; NaN is left white
  std::size_t num_columns = 0;  ///< along x
  double cell_side = 0.0;       ///< in the unit of the axes, > 0
  std::string x_label;
  std::string y_label;
  std::string value_label;
  std::vector<double> curve_x;  ///< of the upper half
  std::vector<double> curve_y;
};

/// Draws a field whose middle column lies at x = 0.
/// @throws std::invalid_argument if the values do not fill whole rows
/// @throws ConfigError, FileError as draw_figure()
void plot_field(const FieldPicture& picture, const std::string& caption,
                const std::filesystem::path& figure);

}  // namespace stridor
