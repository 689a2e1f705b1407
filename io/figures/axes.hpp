// Functions common to pictures with numbers along their axes: ranges, labels, units, the room
// that text takes.
#pragma once

#include <fmt/format.h>

#include <cstddef>
#include <iterator>
#include <limits>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "io/figures/gnuplot.hpp"

namespace stridor {

/// Form of the numbers along an axis: value = offset + 10^exponent · number.
struct AxisScale {
  double offset = 0.0;  ///< taken off where the values differ only from the fifth digit on
  int exponent = 0;     ///< multiple of 3; 0 for values between 10⁻² and 10⁵
  double step = 0.1;    ///< between two tick marks, as a number
  int decimals = 1;     ///< that the step needs
};

/// Scale of an axis with about `num_ticks` marks from lower to upper.
/// @param lower, upper finite, lower < upper
AxisScale axis_scale(double lower, double upper, int num_ticks);

struct ValueRange;

/// The same with fewer marks where their numbers would run into each other.
/// @param length    of the axis, cm
/// @param character width of one, cm
AxisScale spaced_scale(const ValueRange& range, int num_ticks, double length, double character);

/// The values along an axis; empty at first.
struct ValueRange {
  double lower = std::numeric_limits<double>::infinity();
  double upper = -std::numeric_limits<double>::infinity();

  /// Includes the finite values.
  void include(std::span<const double> values);
  bool is_empty() const { return !(lower <= upper); }
  /// The same with a margin of a share of the width at both ends; never empty and never a point.
  ValueRange widened(double share) const;
};

/// A tick mark of a logarithmic axis; small ones have no text.
struct LogTick {
  double value;
  std::string text;
};

/// All that are 1 to 9 times a power of ten, those with 1 written, and with 2 and 5 where there
/// would be less than three; of more than ten powers some. All are written alike: 0.01 where all
/// powers lie from 0.001 to 10000, else 1e-2.
/// @param lower, upper 0 < lower < upper
std::vector<LogTick> log_ticks(double lower, double upper);

/// Characters in the longer of the numbers at both ends of an axis.
std::size_t tick_characters(const ValueRange& range, const AxisScale& scale);

/// Scale of a frequency axis from 0 to `highest` Hz with about `num_ticks` marks; in kHz from 2000
/// Hz on.
/// @param highest finite, positive
AxisScale frequency_scale(double highest, int num_ticks);

/// Number written at an axis for a value.
double as_number(double value, const AxisScale& scale);

/// "contact force (10⁻⁶ N)": the quantity on an axis and the unit of its numbers.
/// @param units as typeset_units() gives them; empty where dimensionless
std::string axis_label(const std::string& label, const std::string& units, const AxisScale& scale);

/// "minus 0.2 N", the offset subtracted from the numbers of an axis; empty if none.
std::string offset_text(const std::string& units, const AxisScale& scale);

/// Both: the label of an axis with what was taken off its numbers.
/// @param units as typeset_units() gives them
std::string offset_axis_label(const std::string& label, const std::string& units,
                              const AxisScale& scale);

/// Units of a run file as they are printed: "m/s²" for "m/s^2", "" for "1".
std::string typeset_units(const std::string& units);

/// The text with blanks at which wrapped() does not break.
std::string unbroken(std::string text);

/// "amplitude (dB re 1 µm/s²)".
/// @param units as in a run file
std::string level_label(double reference, const std::string& units);

/// A value with its unit and three digits, with an SI prefix where the unit takes one: "1 µm/s²",
/// "3.53 kHz", "12.2 ms"; "0.02" where dimensionless.
/// @param units as in a run file; prefixes are set to m…, N, s, Hz
std::string quantity_text(double value, const std::string& units);

/// Tick marks and lines of diagrams with an axis below and one on the left.
inline constexpr const char* axes_style =
    "set minussign\nset border 3 linecolor '#404040'\nset tics nomirror out scale 0.6\n"
    "set grid linetype 1 linecolor '#d0d0d0' linewidth 0.5";
/// Of maps, which have a frame and no grid.
inline constexpr const char* map_style =
    "set minussign\nset border 15 linecolor '#404040'\nset tics nomirror out scale 0.6";

/// Commands of gnuplot, a line each, on a page laid out in cm from its lower left corner.
class FigureScript {
 public:
  explicit FigureScript(FigureSize size) : size_(size) {}

  /// Appends a line.
  template <typename... Arguments>
  void add(fmt::format_string<Arguments...> format, Arguments&&... arguments) {
    fmt::format_to(std::back_inserter(text_), format, std::forward<Arguments>(arguments)...);
    text_ += '\n';
  }
  void append(const std::string& text) { text_ += text; }
  /// Appends a text of the page, centred on (x, y) or beginning there, in the size of the figure
  /// unless `font_size` says otherwise.
  void add_text(const std::string& text, double x, double y, const char* how,
                double font_size = 0.0);
  /// Appends the lines of a caption from its upper left corner, cm.
  void add_caption(const std::vector<std::string>& lines, double left, double top);
  /// Appends the colours of a scale, at equal steps.
  void set_palette(std::span<const char* const> colours);
  /// Sets the place of the bar that shows the colours of the next map, cm.
  void set_colour_bar(double left, double bottom, double width, double height);
  /// Sets the position of the axes of the next diagram, cm.
  void set_margins(double left, double right, double bottom, double top);
  /// Sets range and tick marks of the axis 'x' or 'y'.
  void set_axis(char axis, const ValueRange& range, const AxisScale& scale);
  /// Likewise with logarithmic spacing.
  /// @param range positive
  void set_log_axis(char axis, const ValueRange& range);

  const std::string& text() const { return text_; }
  FigureSize size() const { return size_; }
  double across(double cm) const { return cm / size_.width; }
  double up(double cm) const { return cm / size_.height; }

 private:
  FigureSize size_;
  std::string text_;
  int next_label_ = 1;
};

/// Height of a line of text, cm.
double line_height(double font_size);

/// Height of a caption with the gap above it, cm; 0 without lines.
double caption_height(const std::vector<std::string>& lines);

/// Room for a character of the numbers along an axis, cm: wider than that of a text.
double character_width(double font_size);

/// Width of a text, cm, about: a character is 0.52 of the font size wide.
double text_width(const std::string& text, double font_size);

/// Words in lines that are no wider than `width` cm, as far as single words allow; text that is
/// unbroken() counts as a word.
std::vector<std::string> wrapped(const std::string& text, double font_size, double width);

/// The label of an axis in lines, its unit in one of them.
std::vector<std::string> wrapped_label(const std::string& label, double font_size, double width);

/// Spreads intervals over rows so that none overlaps another in its row.
///
/// In the order of their beginnings, each goes into the lowest row that is free there.
///
/// @param intervals beginning and end of each
/// @param num_rows  rows there are
/// @return the row of each from 0, in the order given; −1 where no row is free
std::vector<int> rows_without_overlap(const std::vector<std::pair<double, double>>& intervals,
                                      int num_rows);

}  // namespace stridor
