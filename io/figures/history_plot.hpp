// Histories over time as stacked panels.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "io/figures/axes.hpp"
#include "io/figures/envelope.hpp"
#include "io/figures/gnuplot.hpp"

namespace stridor {

/// A stretch of time that is shaded behind the curves.
struct TimeMark {
  double from = 0.0;  ///< s
  double to = 0.0;    ///< s, >= from
  std::string label;  ///< at its top
};

/// A value that has a name, e.g. 2 "slip".
struct NamedValue {
  double value = 0.0;
  std::string name;
};

/// One diagram of a stack.
struct Panel {
  std::string title;          ///< above the panel; may be empty
  std::string label;          ///< quantity on the axis, e.g. "contact force"
  std::string units;          ///< e.g. "N"; empty where dimensionless
  std::vector<Curve> curves;  ///< at least one; later ones are drawn over earlier ones
  std::vector<TimeMark> marks{};
  ValueBand band{};
  std::vector<NamedValue> named_values{};  ///< at the axis, instead of numbers
};

/// A label above a stretch of time, or above several whose labels would overlap.
struct TimeLabel {
  double middle = 0.0;  ///< cm from the left edge
  std::string text;     ///< "3", "4–7"
};

/// Places the labels of marks: each over the middle of its mark; neighbours that would overlap get
/// one label, from the first to the last. So none covers another and none is omitted.
/// @param from, to  s, at the left and right edge
/// @param width     of the diagram, cm
/// @return from left to right; marks outside have none
std::vector<TimeLabel> place_time_labels(const std::vector<TimeMark>& marks, double from, double to,
                                         double width, double font_size);

/// Most panels that one picture holds, so that every terminal draws it.
inline constexpr std::size_t most_panels = 40;

/// Draws panels one below the other over one time axis, 16 cm wide.
///
/// Long series are drawn as envelope() of 2000 columns. Panels without a finite value stay empty.
///
/// @param panels  at least one, at most most_panels
/// @param figure  .png, .svg or .pdf; replaced if it exists
/// @param title   above the stack; may be empty
/// @param caption below it; may be empty
/// @throws std::invalid_argument if there is no panel or are too many, a panel has no curve, or as
///         envelope()
/// @throws ConfigError, FileError as draw_figure()
void plot_histories(const std::vector<Panel>& panels, const std::filesystem::path& figure,
                    const std::string& title, const std::string& caption = "");

}  // namespace stridor
