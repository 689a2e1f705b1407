// Pictures of eigenvalues that depend on a parameter.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "io/figures/window_labels.hpp"

namespace stridor {

/// An eigenvalue along a parameter.
struct LocusCurve {
  std::vector<double> parameter;  ///< ascending, in the unit of the picture
  std::vector<double> growth;     ///< Re s, 1/s; not finite: a gap
  std::vector<double> frequency;  ///< Hz
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

}  // namespace stridor
