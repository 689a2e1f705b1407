#include "io/figures/locus_plot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <numbers>
#include <numeric>
#include <stdexcept>

#include "io/figures/axes.hpp"
#include "io/figures/gnuplot.hpp"

namespace stridor {
namespace {

// Viridis without its yellow end, which is hard to see on white.
constexpr std::array<const char*, 8> dark_viridis{"#440154", "#472d7b", "#3b528b", "#2c728e",
                                                  "#21918c", "#28ae80", "#5ec962", "#a5db36"};
// Decay in blue, growth in red, lightness alike on both sides. Both begin with a colour that cannot
// be taken for white, so that the verdict is to be seen where rates are small.
constexpr std::array<const char*, 3> blues{"#0b3c7a", "#3b74b4", "#c3daee"};
constexpr std::array<const char*, 3> reds{"#f6cbb9", "#d0553f", "#8a1020"};
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
  ranges.beyond = fmt::format(
      " Left of the picture: {} values of strongly damped motions, down to {:.3g} 1/s.", num_beyond,
      beyond.lower);
}

/// Positions moved apart to at least `spacing` within 0 to `length`, in their order; there must be
/// room for them.
void spread(std::vector<double*> positions, double length, double spacing) {
  for (std::size_t i = 1; i < positions.size(); ++i)
    *positions[i] = std::max(*positions[i], *positions[i - 1] + spacing);
  for (std::size_t i = positions.size(); i-- > 0;) {
    const double limit = i + 1 == positions.size() ? length : *positions[i + 1] - spacing;
    *positions[i] = std::min(*positions[i], limit);
  }
}

/// " Without room for a label: 3.5 kHz, 7 kHz."; empty where all have one.
std::string unlabelled_text(const std::vector<std::string>& labels) {
  if (labels.empty()) return "";
  return fmt::format(" Without room for a label: {}.", fmt::join(labels, ", "));
}

/// The label of a window beside a diagram, with a line to where its branch is farthest right.
struct BranchLabel {
  std::string text;
  double growth = 0.0;     ///< 1/s, of the tip
  double frequency = 0.0;  ///< Hz, likewise
  double height = 0.0;     ///< cm above the lower edge of the diagram, of the text
};

/// Lays out labels beside a diagram; windows of one branch, whose labels say the same, get one.
/// @param unlabelled gets those for which there is no room, of the least growth
std::vector<BranchLabel> place_branch_labels(const std::vector<LocusWindow>& windows,
                                             double frequency_limit, double height, double spacing,
                                             std::vector<std::string>& unlabelled) {
  std::vector<LocusWindow> strongest = windows;
  std::stable_sort(strongest.begin(), strongest.end(), [](const auto& a, const auto& b) {
    return a.growth_max > b.growth_max;
  });
  const auto most = static_cast<std::size_t>(height / spacing) + 1;
  std::vector<BranchLabel> labels;
  for (const LocusWindow& window : strongest) {
    const std::string text = quantity_text(window.frequency, "Hz");
    const auto says_it = [&](const BranchLabel& other) { return other.text == text; };
    if (std::any_of(labels.begin(), labels.end(), says_it)) continue;
    if (labels.size() == most) {
      unlabelled.push_back(text);
      continue;
    }
    labels.push_back(
        {text, window.growth_max, window.frequency, height * window.frequency / frequency_limit});
  }
  std::stable_sort(labels.begin(), labels.end(),
                   [](const auto& a, const auto& b) { return a.frequency < b.frequency; });
  std::vector<double*> heights;
  for (BranchLabel& label : labels) heights.push_back(&label.height);
  spread(heights, height, spacing);
  return labels;
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

void add_colour_bar(FigureScript& script, const ValueRange& range, const AxisScale& scale,
                    double left, double bottom, double width, double height) {
  script.add("set cbrange [{:.12g}:{:.12g}]\nset cbtics {:.12g} format '%.{}f' scale 0.6",
             as_number(range.lower, scale), as_number(range.upper, scale), scale.step,
             scale.decimals);
  script.set_colour_bar(left, bottom, width, height);
}

}  // namespace

std::vector<WindowLabel> place_window_labels(const std::vector<LocusWindow>& windows, double from,
                                             double to, double width, double spacing) {
  std::vector<std::size_t> order(windows.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return windows[a].growth_max > windows[b].growth_max;
  });
  const auto most = static_cast<std::size_t>(width / spacing) + 1;
  if (order.size() > most) order.resize(most);
  std::vector<WindowLabel> labels;
  for (const std::size_t i : order) {
    const double middle = 0.5 * (windows[i].from + windows[i].to);
    const double x = to == from ? 0.5 * width : width * (middle - from) / (to - from);
    labels.push_back({i, quantity_text(windows[i].frequency, "Hz"), x});
  }
  std::stable_sort(labels.begin(), labels.end(),
                   [](const WindowLabel& a, const WindowLabel& b) { return a.x < b.x; });
  std::vector<double*> positions;
  for (WindowLabel& label : labels) positions.push_back(&label.x);
  spread(positions, width, spacing);
  return labels;
}

void plot_locus(const LocusPicture& picture, const std::filesystem::path& figure) {
  check_figure_name(figure);
  const Ranges ranges = ranges_of(picture);
  ValueRange growth_range = ranges.growth;
  growth_range.include(std::array{0.0});
  growth_range = growth_range.widened(0.05);
  const ValueRange frequency_range{0.0, 1.04 * std::max(ranges.frequency.upper, 1e-3)};
  const ValueRange parameter_range = ranges.parameter.widened(0.0);
  const AxisScale growth = axis_scale(growth_range.lower, growth_range.upper, 7);
  const AxisScale frequency = frequency_scale(frequency_range.upper, 8);
  const AxisScale parameter = axis_scale(parameter_range.lower, parameter_range.upper, 6);

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
  constexpr double leader_length = 0.5;
  double label_width = 0.0;
  for (const BranchLabel& label : labels)
    label_width = std::max(label_width, text_width(label.text, label_font) + leader_length + 0.2);
  const double bar_left =
      size.width - (bar_width + (bar_digits + 1.9) * character + 1.2 * line);
  const double right = bar_left - 0.5 - label_width;
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
  script.add(
      "set object 1 rectangle from {:.9g}, graph 0 to graph 1, graph 1 behind fillcolor '#fbeae6' "
      "fillstyle solid noborder",
      as_number(0.0, growth));
  script.add(
      "set arrow 1 from {0:.9g}, graph 0 to {0:.9g}, graph 1 nohead back linecolor '{1}' "
      "linewidth 1.5",
      as_number(0.0, growth), unstable_colour);

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
  ValueRange growth_range = ranges.growth;
  growth_range.include(std::array{0.0});
  growth_range = growth_range.widened(0.06);
  const ValueRange frequency_range{0.0, 1.04 * std::max(ranges.frequency.upper, 1e-3)};
  const ValueRange parameter_range = ranges.parameter.widened(0.0);
  const AxisScale growth = axis_scale(growth_range.lower, growth_range.upper, 6);
  const AxisScale frequency = frequency_scale(frequency_range.upper, 6);
  const AxisScale parameter = axis_scale(parameter_range.lower, parameter_range.upper, 7);

  // All lengths in cm.
  FigureSize size;
  const double line = line_height(size.font_size);
  const double character = character_width(size.font_size);
  constexpr double panel_height = 5.6;
  const double digits = static_cast<double>(
      std::max(tick_characters(frequency_range, frequency), tick_characters(growth_range, growth)));
  const double left = 1.4 * line + (digits + 1.3) * character;
  // The last tick mark's number stands half beyond the axis.
  const double right =
      size.width -
      std::max(
          0.8,
          0.5 * static_cast<double>(tick_characters(parameter_range, parameter)) * character + 0.1);
  const double label_spacing = 0.95 * line_height(label_font);
  const std::vector<WindowLabel> labels = place_window_labels(
      picture.windows, parameter_range.lower, parameter_range.upper, right - left, label_spacing);
  std::vector<std::string> unlabelled;
  for (std::size_t i = 0; i < picture.windows.size(); ++i) {
    const auto is_of = [&](const WindowLabel& label) { return label.window == i; };
    if (std::none_of(labels.begin(), labels.end(), is_of))
      unlabelled.push_back(quantity_text(picture.windows[i].frequency, "Hz"));
  }
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
  int object = 1;
  for (const LocusWindow& window : picture.windows) {
    // A window narrower than a line is still to be seen.
    const double least = 0.0015 * (parameter_range.upper - parameter_range.lower);
    const double widen = std::max(0.0, 0.5 * (least - (window.to - window.from)));
    script.add(
        "set object {} rectangle from {:.9g}, graph 0 to {:.9g}, graph 1 behind fillcolor "
        "'#f6cfc6' fillstyle solid noborder",
        object++, as_number(window.from - widen, parameter),
        as_number(window.to + widen, parameter));
  }
  script.add(
      "set arrow 1 from graph 0, first {0:.9g} to graph 1, first {0:.9g} nohead back "
      "linecolor '#404040' linewidth 1",
      as_number(0.0, growth));
  script.set_margins(left, right, upper, upper + panel_height);
  script.set_axis('x', parameter_range, parameter);
  script.add("set xtics format ''");
  script.set_axis('y', growth_range, growth);
  script.add_text(axis_label("growth rate", "1/s", growth), 0.7 * line, upper + 0.5 * panel_height,
                  "center rotate");
  for (const WindowLabel& label : labels) {
    script.add_text(label.text, left + label.x, upper + panel_height + 0.15, "left rotate",
                    label_font);
  }
  const auto plot = [&](int column) {
    script.add(
        "plot $curves using 1:{0} with lines linewidth 1 linecolor '{1}', $curves using 1:($4 >= 0 "
        "? "
        "${0} : NaN) with lines linewidth 2.5 linecolor '{2}', $curves using 1:($4 >= 0 ? ${0} : "
        "NaN) with points pointtype 7 pointsize 0.3 linecolor '{2}'",
        column, stable_colour, unstable_colour);
  };
  plot(2);
  script.add("unset label\nunset arrow 1");
  script.set_margins(left, right, below, below + panel_height);
  script.set_axis('x', parameter_range, parameter);
  script.set_axis('y', frequency_range, frequency);
  script.add_text(axis_label("frequency", "Hz", frequency), 0.7 * line, below + 0.5 * panel_height,
                  "center rotate");
  script.add_text(offset_axis_label(picture.parameter, typeset_units(picture.units), parameter),
                  0.5 * (left + right), below - 1.9 * line, "center");
  script.add_caption(caption, left, below - 2.7 * line);
  plot(3);
  script.add("unset multiplot");
  draw_figure(figure, script.text(), size);
}

namespace {

/// How growth rates become colours: decay and growth each have half of the scale and limits of
/// their own, so that neither side is pale because the other is fast.
struct MapColours {
  double decay_limit = 0.0;   ///< 1/s, positive: the darkest blue; 0: nothing decays
  double growth_limit = 0.0;  ///< 1/s, positive: the darkest red; 0: nothing grows
  double rounding = 0.0;      ///< 1/s, rates no larger are taken for zero
  AxisScale scale;            ///< of the numbers beside the colours
  std::vector<std::pair<double, std::string>> ticks;  ///< from -1 to 1
  std::string note;                                   ///< for the caption; may be empty

  /// Where a rate lies from -1 to 1.
  double place(double growth) const {
    // Not 0 itself, at which the two halves meet.
    constexpr double least = 1e-3;
    const double limit = growth < 0.0 ? decay_limit : growth_limit;
    // Undamped motions neither grow nor decay but by rounding.
    if (std::abs(growth) <= rounding || limit == 0.0) return -least;
    const double share = std::min(1.0, std::abs(growth) / limit);
    return std::copysign(std::max(least, share), growth);
  }

  std::string palette() const {
    std::string text = "set palette defined (";
    for (std::size_t i = 0; i < blues.size(); ++i)
      text += fmt::format("{:g} '{}', ", -1.0 + 0.5 * static_cast<double>(i), blues[i]);
    for (std::size_t i = 0; i < reds.size(); ++i)
      text += fmt::format("{}{:g} '{}'", i == 0 ? "" : ", ",
                          i == 0 ? 1e-6 : 0.5 * static_cast<double>(i), reds[i]);
    return text + ")\n";
  }
};

MapColours map_colours(const std::vector<std::vector<double>>& rates) {
  MapColours colours;
  std::vector<double> decays;
  double largest_rate = 0.0;
  for (const auto& row : rates) {
    for (const double growth : row) {
      if (!std::isfinite(growth)) continue;
      largest_rate = std::max(largest_rate, std::abs(growth));
      colours.growth_limit = std::max(colours.growth_limit, growth);
      if (growth < 0.0) decays.push_back(-growth);
    }
  }
  colours.rounding = 1e-12 * largest_rate;
  if (colours.growth_limit <= colours.rounding) colours.growth_limit = 0.0;
  std::erase_if(decays, [&](double decay) { return decay <= colours.rounding; });
  if (!decays.empty()) {
    // A corner that decays much faster than the rest does not set the scale.
    std::sort(decays.begin(), decays.end());
    const double typical = decays[decays.size() / 2];
    colours.decay_limit = std::min(decays.back(), 4.0 * typical);
    if (decays.back() > colours.decay_limit) {
      colours.note =
          fmt::format(" Darkest blue: decay of {:.3g} 1/s or faster, up to {:.3g} 1/s.",
                      colours.decay_limit, decays.back());
    }
  }
  const double largest = std::max(colours.decay_limit, colours.growth_limit);
  colours.scale = axis_scale(-largest, largest > 0.0 ? largest : 1.0, 6);
  const auto add = [&](double place, double growth) {
    const double number = as_number(growth, colours.scale);
    colours.ticks.emplace_back(place, std::abs(number) >= 1000.0 ? fmt::format("{:.0f}", number)
                                                                 : fmt::format("{:.3g}", number));
  };
  if (colours.decay_limit > 0.0) {
    add(-1.0, -colours.decay_limit);
    add(-0.5, -0.5 * colours.decay_limit);
  }
  add(0.0, 0.0);
  if (colours.growth_limit > 0.0) {
    add(0.5, 0.5 * colours.growth_limit);
    add(1.0, colours.growth_limit);
  }
  return colours;
}

/// Range and tick marks of an axis of a map.
void set_map_axis(FigureScript& script, char name, const MapAxis& axis, const AxisScale& scale) {
  const ValueRange range{axis.values.front(), axis.values.back()};
  if (!axis.is_logarithmic) {
    script.set_axis(name, range, scale);
    return;
  }
  script.set_log_axis(name, range);
}

/// Characters in the longest number along an axis of a map.
std::size_t map_tick_characters(const MapAxis& axis, const AxisScale& scale) {
  if (!axis.is_logarithmic)
    return tick_characters({axis.values.front(), axis.values.back()}, scale);
  std::size_t most = 1;
  for (const LogTick& tick : log_ticks(axis.values.front(), axis.values.back()))
    most = std::max(most, tick.text.size());
  return most;
}

/// Index of the value of an axis nearest to the middle of a cell; values are evenly spaced on it.
std::size_t nearest_index(std::size_t cell, std::size_t cells, std::size_t count) {
  const double share = (static_cast<double>(cell) + 0.5) / static_cast<double>(cells);
  return static_cast<std::size_t>(std::lround(share * static_cast<double>(count - 1)));
}

}  // namespace

void plot_stability_map(const StabilityMapPicture& picture, const std::filesystem::path& figure) {
  check_figure_name(figure);
  const std::size_t columns = picture.x.values.size();
  const std::size_t rows = picture.y.values.size();
  if (columns < 2 || rows < 2) refuse("a map needs at least two values along each axis");
  if (picture.growth.size() != rows ||
      std::any_of(picture.growth.begin(), picture.growth.end(),
                  [&](const auto& row) { return row.size() != columns; })) {
    refuse(fmt::format("the growth rates are not {} rows of {}", rows, columns));
  }
  const MapColours colour = map_colours(picture.growth);
  const auto scale_of = [](const MapAxis& axis, int ticks) {
    const auto [low, high] = std::minmax(axis.values.front(), axis.values.back());
    return axis_scale(low, high, ticks);
  };
  const AxisScale x_scale = scale_of(picture.x, 7);
  const AxisScale y_scale = scale_of(picture.y, 7);

  // All lengths in cm.
  FigureSize size;
  const double line = line_height(size.font_size);
  const double character = character_width(size.font_size);
  constexpr double plane_height = 8.4;
  constexpr double bar_width = 0.45;
  const auto label_of = [](const MapAxis& axis, const AxisScale& scale) {
    return axis.is_logarithmic ? axis_label(axis.label, typeset_units(axis.units), {})
                               : offset_axis_label(axis.label, typeset_units(axis.units), scale);
  };
  const double y_digits = static_cast<double>(map_tick_characters(picture.y, y_scale));
  const double left = 1.4 * line + (y_digits + 1.3) * character;
  std::size_t bar_digits = 1;
  for (const auto& [place, text] : colour.ticks) bar_digits = std::max(bar_digits, text.size());
  const double right =
      size.width -
      (0.5 + bar_width + (static_cast<double>(bar_digits) + 1.9) * character + 1.2 * line);
  const std::vector<std::string> caption =
      wrapped(picture.caption + colour.note, caption_font, size.width - left - 1.2);
  const double below = 2.7 * line + caption_height(caption);
  size.height = below + plane_height + 0.6 * line;

  const std::size_t raster_columns = std::min<std::size_t>(800, 40 * columns);
  const std::size_t raster_rows = std::min<std::size_t>(600, 40 * rows);
  FigureScript script(size);
  std::string map = "$map << END_OF_DATA\n";
  for (std::size_t r = 0; r < raster_rows; ++r) {
    for (std::size_t c = 0; c < raster_columns; ++c) {
      const double value = picture.growth[nearest_index(r, raster_rows, rows)]
                                         [nearest_index(c, raster_columns, columns)];
      map += std::isfinite(value)
                 ? fmt::format("{:.5g} ", colour.place(value))
                 : std::string("-1e30 ");  // gnuplot complains about NaN in a matrix
    }
    map += '\n';
  }
  script.append(map + "END_OF_DATA\n");
  std::string lines = "$boundary << END_OF_DATA\n";
  const auto coordinate = [](double value, const MapAxis& axis, const AxisScale& scale) {
    return axis.is_logarithmic ? value : as_number(value, scale);
  };
  for (const auto& polyline : picture.boundary) {
    for (const MapPoint& point : polyline) {
      lines += fmt::format("{:.9g} {:.9g}\n", coordinate(point.x, picture.x, x_scale),
                           coordinate(point.y, picture.y, y_scale));
    }
    lines += '\n';
  }
  script.append(lines + "END_OF_DATA\n");
  script.append(colour.palette());
  script.set_margins(left, right, below, below + plane_height);
  set_map_axis(script, 'x', picture.x, x_scale);
  set_map_axis(script, 'y', picture.y, y_scale);
  script.add("set x2range [-0.5:{:.1f}]\nset y2range [-0.5:{:.1f}]",
             static_cast<double>(raster_columns) - 0.5, static_cast<double>(raster_rows) - 0.5);
  std::string ticks;
  for (const auto& [place, text] : colour.ticks)
    ticks += fmt::format("{}{} {:.6g}", ticks.empty() ? "" : ", ", gnuplot_string(text), place);
  script.add("set cbrange [-1:1]\nset cbtics ({}) scale 0.6", ticks);
  script.set_colour_bar(right + 0.5, below, bar_width, plane_height);
  script.add("{}\nunset key", map_style);
  const double middle = below + 0.5 * plane_height;
  script.add_text(label_of(picture.x, x_scale), 0.5 * (left + right), below - 1.9 * line, "center");
  script.add_text(label_of(picture.y, y_scale), 0.7 * line, middle, "center rotate");
  script.add_text(axis_label("largest growth rate", "1/s", colour.scale), size.width - 0.6 * line,
                  middle, "center rotate");
  script.add_caption(caption, left, below - 2.7 * line);
  script.add(
      "plot $map matrix using 1:2:($3 < -1e29 ? NaN : $3) with image axes x2y2, NaN, $boundary "
      "using 1:2 with "
      "lines linewidth 2 linecolor '#000000', $boundary using 1:2 with points pointtype 7 "
      "pointsize "
      "0.3 linecolor '#000000'");
  draw_figure(figure, script.text(), size);
}

}  // namespace stridor
