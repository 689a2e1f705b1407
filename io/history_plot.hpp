// Histories over time as stacked panels.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "io/axes.hpp"
#include "io/gnuplot.hpp"

namespace stridor {

/// A line in a panel. Values that are not finite leave a gap.
struct Curve {
  std::vector<double> times;   ///< s, ascending
  std::vector<double> values;  ///< as many as times
  std::string name;            ///< in the key; no key where all names of a panel are empty
};

/// A stretch of time that is shaded behind the curves.
struct TimeMark {
  double from = 0.0;  ///< s
  double to = 0.0;    ///< s, >= from
  std::string label;  ///< at its top
};

/// One diagram of a stack.
struct Panel {
  std::string title;          ///< above the panel; may be empty
  std::string label;          ///< what the axis shows, e.g. "contact force"
  std::string units;          ///< e.g. "N"; empty where dimensionless
  std::vector<Curve> curves;  ///< at least one; later ones are drawn over earlier ones
  std::vector<TimeMark> marks{};
};

/// Points to draw instead of a long series so that the picture looks the same.
///
/// Time is cut into `num_columns` equal parts; each gives its smallest and its largest value at
/// their own times. A series of at most 2·num_columns points is returned as it is. Parts in which
/// nothing is finite give one NaN, a gap.
///
/// @throws std::invalid_argument if times and values differ in length, times do not ascend or
///         num_columns is 0
Curve envelope(const Curve& curve, std::size_t num_columns);

/// Draws panels one below the other over one time axis, 16 cm wide.
///
/// Long series are drawn as envelope() of 2000 columns. Panels without a finite value stay empty.
///
/// @param panels at least one
/// @param figure .png, .svg or .pdf; replaced if it exists
/// @param title  above the stack; may be empty
/// @throws std::invalid_argument if there is no panel, a panel has no curve, or as envelope()
/// @throws ConfigError, FileError as draw_figure()
void plot_histories(const std::vector<Panel>& panels, const std::filesystem::path& figure,
                    const std::string& title);

}  // namespace stridor
