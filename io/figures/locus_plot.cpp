#include "io/figures/locus_plot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <numbers>
#include <stdexcept>

#include "io/figures/axes.hpp"
#include "io/figures/gnuplot.hpp"
#include "io/figures/window_labels.hpp"

namespace stridor {
namespace {

// Viridis without its yellow end, which is hard to see on white.
constexpr std::array<const char*, 8> dark_viridis{"#440154", "#472d7b", "#3b528b", "#2c728e",
                                                  "#21918c", "#28ae80", "#5ec962", "#a5db36"};
constexpr const char* unstable_colour = "#c0392b";
constexpr const char* stable_colour = "#0b5394";
constexpr double label_font = 10.5;

[[noreturn]] void refuse(const std::string& what) {
  throw std::invalid_argument("locus plot: " + what);
}

struct Ranges {
  ValueRange parameter, growth, frequency;
  /// What lies left of the growth axis, for the caption; empty where all is shown.
  std::string beyond;
};

/// The growth rates that set the axis: those of motions that swing, and those that grow. Real
/// eigenvalues of strongly damped motions may lie a thousand times farther left and would press all
/// others onto the line of stability.
void set_growth_range(const LocusPicture& picture, Ranges& ranges) {
  std::size_t num_beyond = 0;
  ValueRange of_all;
  ValueRange beyond;
  for (const LocusCurve& curve : picture.curves) {
    of_all.include(curve.growth);
    for (std::size_t i = 0; i < curve.growth.size(); ++i) {
      const double growth = curve.growth[i];
      if (!std::isfinite(growth) || !std::isfinite(curve.frequency[i])) continue;
      const bool swings = -growth < 2.0 * std::numbers::pi * curve.frequency[i];
      (swings || growth >= 0.0 ? ranges.growth : beyond).include({&growth, 1});
    }
  }
  if (ranges.growth.is_empty()) {
    ranges.growth = of_all;
    return;
  }
  for (const LocusCurve& curve : picture.curves) {
    num_beyond += static_cast<std::size_t>(
        std::count_if(curve.growth.begin(), curve.growth.end(),
                      [&](double growth) { return growth < ranges.growth.lower; }));
  }
  if (num_beyond == 0) return;
  ranges.beyond =
      fmt::format(" Left of the picture: {} values of strongly damped motions, down to {:.3g} 1/s.",
                  num_beyond, beyond.lower);
}

Ranges ranges_of(const LocusPicture& picture) {
  Ranges ranges;
  for (const LocusCurve& curve : picture.curves) {
    if (curve.growth.size() != curve.parameter.size() ||
        curve.frequency.size() != curve.parameter.size()) {
      refuse(fmt::format("a curve of {} values has {} growth rates and {} frequencies",
                         curve.parameter.size(), curve.growth.size(), curve.frequency.size()));
    }
    ranges.parameter.include(curve.parameter);
    ranges.frequency.include(curve.frequency);
  }
  set_growth_range(picture, ranges);
  if (ranges.growth.is_empty() || ranges.frequency.is_empty()) refuse("there is no point");
  return ranges;
}

/// Parameter, growth rate, frequency; an empty line after every curve and at every gap.
std::string curve_data(const LocusPicture& picture, const AxisScale& parameter,
                       const AxisScale& growth, const AxisScale& frequency) {
  std::string data = "$curves << END_OF_DATA\n";
  auto out = std::back_inserter(data);
  for (const LocusCurve& curve : picture.curves) {
    for (std::size_t i = 0; i < curve.parameter.size(); ++i) {
      if (!std::isfinite(curve.growth[i]) || !std::isfinite(curve.frequency[i])) {
        data += '\n';
        continue;
      }
      // Undamped motions neither grow nor decay but by rounding.
      const bool is_rounding =
          curve.growth[i] != 0.0 && std::abs(curve.growth[i]) < 1e-9 * std::abs(curve.frequency[i]);
      fmt::format_to(out, "{:.9g} {:.7g} {:.7g} {:.7g}\n", as_number(curve.parameter[i], parameter),
                     as_number(curve.growth[i], growth), as_number(curve.frequency[i], frequency),
                     is_rounding ? -1.0 : curve.growth[i]);
    }
    data += '\n';
  }
  return data + "END_OF_DATA\n";
}

/// The axes of a picture.
struct LocusAxes {
  ValueRange parameter_range, growth_range, frequency_range;
  AxisScale parameter, growth, frequency;
};

/// How finely the axes of a picture are marked, and how much they show beyond the growth rates.
struct LocusMarks {
  double margin = 0.0;  ///< share of the range of growth rates
  int growth = 0;       ///< about as many tick marks
  int frequency = 0;
  int parameter = 0;
};

LocusAxes locus_axes(const Ranges& ranges, const LocusMarks& marks) {
  LocusAxes axes;
  axes.growth_range = ranges.growth;
  axes.growth_range.include(std::array{0.0});
  axes.growth_range = axes.growth_range.widened(marks.margin);
  axes.frequency_range = {0.0, 1.04 * std::max(ranges.frequency.upper, 1e-3)};
  axes.parameter_range = ranges.parameter.widened(0.0);
  axes.growth = axis_scale(axes.growth_range.lower, axes.growth_range.upper, marks.growth);
  axes.frequency = frequency_scale(axes.frequency_range.upper, marks.frequency);
  axes.parameter =
      axis_scale(axes.parameter_range.lower, axes.parameter_range.upper, marks.parameter);
  return axes;
}

void add_colour_bar(FigureScript& script, const ValueRange& range, const AxisScale& scale,
                    double left, double bottom, double width, double height) {
  script.add("set cbrange [{:.12g}:{:.12g}]\nset cbtics {:.12g} format '%.{}f' scale 0.6",
             as_number(range.lower, scale), as_number(range.upper, scale), scale.step,
             scale.decimals);
  script.set_colour_bar(left, bottom, width, height);
}

/// The frequencies of the windows that have no label.
std::vector<std::string> unlabelled_windows(const std::vector<LocusWindow>& windows,
                                            const std::vector<WindowLabel>& labels) {
  std::vector<std::string> unlabelled;
  for (std::size_t i = 0; i < windows.size(); ++i) {
    const auto is_of = [&](const WindowLabel& label) { return label.window == i; };
    if (std::none_of(labels.begin(), labels.end(), is_of))
      unlabelled.push_back(quantity_text(windows[i].frequency, "Hz"));
  }
  return unlabelled;
}

void shade_windows(FigureScript& script, const std::vector<LocusWindow>& windows,
                   const ValueRange& range, const AxisScale& scale) {
  int object = 1;
  for (const LocusWindow& window : windows) {
    // A window narrower than a line is still to be seen.
    const double least = 0.0015 * (range.upper - range.lower);
    const double widen = std::max(0.0, 0.5 * (least - (window.to - window.from)));
    script.add(
        "set object {} rectangle from {:.9g}, graph 0 to {:.9g}, graph 1 behind fillcolor "
        "'#f6cfc6' fillstyle solid noborder",
        object++, as_number(window.from - widen, scale), as_number(window.to + widen, scale));
  }
}

/// Draws a column of curve_data() against the parameter, what is unstable on top.
void plot_against_parameter(FigureScript& script, int column) {
  script.add(
      "plot $curves using 1:{0} with lines linewidth 1 linecolor '{1}', $curves using 1:($4 >= 0 "
      "? "
      "${0} : NaN) with lines linewidth 2.5 linecolor '{2}', $curves using 1:($4 >= 0 ? ${0} : "
      "NaN) with points pointtype 7 pointsize 0.3 linecolor '{2}'",
      column, stable_colour, unstable_colour);
}

/// From the right edge of a plane to the texts of its branches, cm.
constexpr double leader_length = 0.5;

/// Colours the side of the plane on which motions grow.
void mark_unstable_side(FigureScript& script, const AxisScale& growth) {
  script.add(
      "set object 1 rectangle from {:.9g}, graph 0 to graph 1, graph 1 behind fillcolor '#fbeae6' "
      "fillstyle solid noborder",
      as_number(0.0, growth));
  script.add(
      "set arrow 1 from {0:.9g}, graph 0 to {0:.9g}, graph 1 nohead back linecolor '{1}' "
      "linewidth 1.5",
      as_number(0.0, growth), unstable_colour);
}

/// Names branches beside a plane whose right edge and foot are given, cm.
void add_branch_labels(FigureScript& script, const std::vector<BranchLabel>& labels,
                       const AxisScale& growth, const AxisScale& frequency, double right,
                       double below) {
  int arrow = 2;
  for (const BranchLabel& label : labels) {
    script.add(
        "set arrow {} from {:.9g}, {:.9g} to screen {:.6f}, screen {:.6f} nohead back linecolor "
        "'#a0a0a0' linewidth 0.7",
        arrow++, as_number(label.growth, growth), as_number(label.frequency, frequency),
        script.across(right + leader_length), script.up(below + label.height));
    script.add_text(label.text, right + leader_length + 0.1, below + label.height, "left",
                    label_font);
  }
}

/// Names windows above a panel whose left edge is given, cm.
void add_window_labels(FigureScript& script, const std::vector<WindowLabel>& labels, double left,
                       double up) {
  for (const WindowLabel& label : labels)
    script.add_text(label.text, left + label.x, up, "left rotate", label_font);
}

/// The line of no growth across a panel.
void draw_zero(FigureScript& script, const AxisScale& growth) {
  script.add(
      "set arrow 1 from graph 0, first {0:.9g} to graph 1, first {0:.9g} nohead back "
      "linecolor '#404040' linewidth 1",
      as_number(0.0, growth));
}

/// Width to the right of an axis, cm: the number of the last tick mark stands half beyond it.
double room_beside(std::size_t num_characters, double character) {
  return std::max(0.8, 0.5 * static_cast<double>(num_characters) * character + 0.1);
}

}  // namespace

void plot_locus(const LocusPicture& picture, const std::filesystem::path& figure) {
  check_figure_name(figure);
  const Ranges ranges = ranges_of(picture);
  constexpr LocusMarks marks{.margin = 0.05, .growth = 7, .frequency = 8, .parameter = 6};
  auto [parameter_range, growth_range, frequency_range, parameter, growth, frequency] =
      locus_axes(ranges, marks);

  // All lengths in cm.
  FigureSize size;
  const double line = line_height(size.font_size);
  const double character = character_width(size.font_size);
  constexpr double plane_height = 8.4;
  constexpr double bar_width = 0.45;
  const double left =
      1.4 * line +
      (static_cast<double>(tick_characters(frequency_range, frequency)) + 1.3) * character;
  const double bar_digits = static_cast<double>(tick_characters(parameter_range, parameter));
  std::vector<std::string> unlabelled;
  const std::vector<BranchLabel> labels =
      place_branch_labels(picture.windows, frequency_range.upper, plane_height,
                          1.1 * line_height(label_font), unlabelled);
  // Beside the plane, so that they cover nothing of it.
  double label_width = 0.0;
  for (const BranchLabel& label : labels)
    label_width = std::max(label_width, text_width(label.text, label_font) + leader_length + 0.2);
  const double bar_left = size.width - (bar_width + (bar_digits + 1.9) * character + 1.2 * line);
  const double right = bar_left - 0.5 - label_width;
  growth = spaced_scale(growth_range, marks.growth, right - left, character);
  const std::vector<std::string> caption =
      wrapped(picture.caption + ranges.beyond + unlabelled_text(unlabelled), caption_font,
              size.width - left - 1.2);
  const double below = 2.7 * line + caption_height(caption);
  size.height = below + plane_height + 0.6 * line;

  FigureScript script(size);
  script.append(curve_data(picture, parameter, growth, frequency));
  script.set_palette(dark_viridis);
  script.set_margins(left, right, below, below + plane_height);
  script.set_axis('x', growth_range, growth);
  script.set_axis('y', frequency_range, frequency);
  add_colour_bar(script, parameter_range, parameter, bar_left, below, bar_width, plane_height);
  script.add("{}\nunset key", axes_style);
  mark_unstable_side(script, growth);
  add_branch_labels(script, labels, growth, frequency, right, below);

  const double middle = below + 0.5 * plane_height;
  script.add_text(axis_label("growth rate", "1/s", growth), 0.5 * (left + right),
                  below - 1.9 * line, "center");
  script.add_text(axis_label("frequency", "Hz", frequency), 0.7 * line, middle, "center rotate");
  script.add_text(offset_axis_label(picture.parameter, typeset_units(picture.units), parameter),
                  size.width - 0.6 * line, middle, "center rotate");
  script.add_caption(caption, left, below - 2.7 * line);
  script.add(
      "plot $curves using 2:3:1 with lines linewidth 1.6 linecolor palette, $curves using "
      "2:3:1 with points pointtype 7 pointsize 0.2 linecolor palette");
  draw_figure(figure, script.text(), size);
}

void plot_locus_histories(const LocusPicture& picture, const std::filesystem::path& figure) {
  check_figure_name(figure);
  const Ranges ranges = ranges_of(picture);
  const auto [parameter_range, growth_range, frequency_range, parameter, growth, frequency] =
      locus_axes(ranges, {.margin = 0.06, .growth = 6, .frequency = 6, .parameter = 7});

  // All lengths in cm.
  FigureSize size;
  const double line = line_height(size.font_size);
  const double character = character_width(size.font_size);
  constexpr double panel_height = 5.6;
  const double digits = static_cast<double>(
      std::max(tick_characters(frequency_range, frequency), tick_characters(growth_range, growth)));
  const double left = 1.4 * line + (digits + 1.3) * character;
  const double right =
      size.width - room_beside(tick_characters(parameter_range, parameter), character);
  const double label_spacing = 0.95 * line_height(label_font);
  const std::vector<WindowLabel> labels = place_window_labels(
      picture.windows, parameter_range.lower, parameter_range.upper, right - left, label_spacing);
  const std::vector<std::string> unlabelled = unlabelled_windows(picture.windows, labels);
  double label_length = 0.0;
  for (const WindowLabel& label : labels)
    label_length = std::max(label_length, text_width(label.text, label_font) + 0.25);
  const std::vector<std::string> caption =
      wrapped(picture.caption + ranges.beyond + unlabelled_text(unlabelled), caption_font,
              size.width - left - 1.2);
  const double below = 2.7 * line + caption_height(caption);
  const double upper = below + panel_height + 0.8 * line;
  size.height = upper + panel_height + 0.5 * line + label_length;

  FigureScript script(size);
  script.append(curve_data(picture, parameter, growth, frequency));
  script.add("set multiplot");
  script.add("{}\nunset key", axes_style);
  shade_windows(script, picture.windows, parameter_range, parameter);
  draw_zero(script, growth);
  script.set_margins(left, right, upper, upper + panel_height);
  script.set_axis('x', parameter_range, parameter);
  script.add("set xtics format ''");
  script.set_axis('y', growth_range, growth);
  script.add_text(axis_label("growth rate", "1/s", growth), 0.7 * line, upper + 0.5 * panel_height,
                  "center rotate");
  add_window_labels(script, labels, left, upper + panel_height + 0.15);
  plot_against_parameter(script, 2);
  script.add("unset label\nunset arrow 1");
  script.set_margins(left, right, below, below + panel_height);
  script.set_axis('x', parameter_range, parameter);
  script.set_axis('y', frequency_range, frequency);
  script.add_text(axis_label("frequency", "Hz", frequency), 0.7 * line, below + 0.5 * panel_height,
                  "center rotate");
  script.add_text(offset_axis_label(picture.parameter, typeset_units(picture.units), parameter),
                  0.5 * (left + right), below - 1.9 * line, "center");
  script.add_caption(caption, left, below - 2.7 * line);
  plot_against_parameter(script, 3);
  script.add("unset multiplot");
  draw_figure(figure, script.text(), size);
}

}  // namespace stridor
