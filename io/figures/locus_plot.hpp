// Pictures of eigenvalues that depend on a parameter, and of stability over two of them.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace stridor {

/// An eigenvalue along a parameter.
struct LocusCurve {
  std::vector<double> parameter;  ///< ascending, in the unit of the picture
  std::vector<double> growth;     ///< Re s, 1/s; not finite: a gap
  std::vector<double> frequency;  ///< Hz
};

/// A stretch of the parameter on which an eigenvalue has a positive real part.
struct LocusWindow {
  double from = 0.0;
  double to = 0.0;
  double frequency = 0.0;   ///< Hz, where it grows fastest
  double growth_max = 0.0;  ///< 1/s
};

struct LocusPicture {
  std::string parameter;  ///< its key, e.g. "contact.start"
  std::string units;      ///< of the parameter, as in a run file; "1" or empty: dimensionless
  std::vector<LocusCurve> curves;
  std::vector<LocusWindow> windows;
  std::string caption;  ///< below; may be empty
};

/// Draws frequency against growth rate, the parameter as colour; unstable is right of the line.
/// The windows are labelled with their frequencies.
/// @param picture at least one point that is finite
/// @param figure  .png, .svg or .pdf; replaced if it exists
/// @throws std::invalid_argument if there is no point or a curve has lists of different lengths
/// @throws ConfigError, FileError as draw_figure()
void plot_locus(const LocusPicture& picture, const std::filesystem::path& figure);

/// Draws growth rate and frequency against the parameter, one above the other, unstable stretches
/// shaded and labelled with their frequencies. As plot_locus().
void plot_locus_histories(const LocusPicture& picture, const std::filesystem::path& figure);

/// The label of a window above a diagram, written upwards.
struct WindowLabel {
  std::size_t window = 0;  ///< index into the windows
  std::string text;        ///< "3.52 kHz"
  double x = 0.0;          ///< of its middle, cm from the left edge of the diagram
};

/// Lays out labels over the middles of windows, moved apart to at least `spacing`. Where there is
/// no room for all of them, those of the windows with the least growth are omitted.
/// @param from, to parameter at the left and right edge
/// @param width    of the diagram, cm
/// @param spacing  cm, > 0
/// @return from left to right
std::vector<WindowLabel> place_window_labels(const std::vector<LocusWindow>& windows, double from,
                                             double to, double width, double spacing);

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
