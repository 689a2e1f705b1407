#include "io/locus_plot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <numeric>
#include <stdexcept>

#include "io/axes.hpp"
#include "io/gnuplot.hpp"

namespace stridor {
namespace {

// Viridis without its yellow end, which is hard to see on white.
constexpr std::array<const char*, 8> dark_viridis{"#440154", "#472d7b", "#3b528b", "#2c728e",
                                                  "#21918c", "#28ae80", "#5ec962", "#a5db36"};
// From blue through white to red, lightness alike on both sides.
constexpr std::array<const char*, 7> blue_red{"#0b3c7a", "#3b74b4", "#a6c8e4", "#f7f7f7",
                                              "#f2b49a", "#d0553f", "#8a1020"};
constexpr const char* unstable_colour = "#c0392b";
constexpr const char* stable_colour = "#0b5394";
constexpr double caption_font = 10.5;
constexpr double label_font = 10.5;

[[noreturn]] void refuse(const std::string& what) {
  throw std::invalid_argument("locus plot: " + what);
}

struct Ranges {
  ValueRange parameter, growth, frequency;
};

Ranges ranges_of(const LocusPicture& picture) {
  Ranges ranges;
  for (const LocusCurve& curve : picture.curves) {
    if (curve.growth.size() != curve.parameter.size() ||
        curve.frequency.size() != curve.parameter.size()) {
      refuse(fmt::format("a curve of {} values has {} growth rates and {} frequencies",
                         curve.parameter.size(), curve.growth.size(), curve.frequency.size()));
    }
    ranges.parameter.include(curve.parameter);
    ranges.growth.include(curve.growth);
    ranges.frequency.include(curve.frequency);
  }
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

template <std::size_t size>
std::string palette(const std::array<const char*, size>& colours) {
  std::string text = "set palette defined (";
  for (std::size_t i = 0; i < size; ++i)
    text += fmt::format("{}{} '{}'", i == 0 ? "" : ", ", i, colours[i]);
  return text + ")\n";
}

void add_caption(FigureScript& script, const std::vector<std::string>& lines, double left,
                 double top) {
  for (std::size_t i = 0; i < lines.size(); ++i) {
    script.add_text(lines[i], left,
                    top - (static_cast<double>(i) + 0.5) * line_height(caption_font), "left",
                    caption_font);
  }
}

double caption_height(const std::vector<std::string>& lines) {
  return lines.empty() ? 0.0 : 0.2 + static_cast<double>(lines.size()) * line_height(caption_font);
}

/// The label of the parameter's axis with what was taken off its numbers.
std::string parameter_label(const std::string& name, const std::string& units,
                            const AxisScale& scale) {
  std::string label = axis_label(name, typeset_units(units), scale);
  if (scale.offset != 0.0) label += ", " + offset_text(typeset_units(units), scale);
  return label;
}

void add_colour_bar(FigureScript& script, const ValueRange& range, const AxisScale& scale,
                    double left, double bottom, double width, double height) {
  script.add("set cbrange [{:.12g}:{:.12g}]\nset cbtics {:.12g} format '%.{}f' scale 0.6",
             as_number(range.lower, scale), as_number(range.upper, scale), scale.step,
             scale.decimals);
  script.add(
      "set colorbox vertical user origin screen {:.6f}, screen {:.6f} size screen {:.6f}, screen "
      "{:.6f} noborder",
      script.across(left), script.up(bottom), script.across(width), script.up(height));
}

constexpr const char* axes_style =
    "set minussign\nset border 3 linecolor '#404040'\nset tics nomirror out scale 0.6\n"
    "set grid linetype 1 linecolor '#d0d0d0' linewidth 0.5\nunset key";

double character_width(const FigureSize& size) {
  return 0.64 * size.font_size * 2.54 / 72.0;
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
  for (std::size_t i = 1; i < labels.size(); ++i)
    labels[i].x = std::max(labels[i].x, labels[i - 1].x + spacing);
  for (std::size_t i = labels.size(); i-- > 0;) {
    const double limit = i + 1 == labels.size() ? width : labels[i + 1].x - spacing;
    labels[i].x = std::min(labels[i].x, limit);
  }
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
  const double character = character_width(size);
  constexpr double plane_height = 8.4;
  constexpr double bar_width = 0.45;
  const double left =
      1.4 * line +
      (static_cast<double>(tick_characters(frequency_range, frequency)) + 1.3) * character;
  const double bar_digits = static_cast<double>(tick_characters(parameter_range, parameter));
  const double right = size.width - (0.5 + bar_width + (bar_digits + 1.9) * character + 1.2 * line);
  const std::vector<std::string> caption =
      wrapped(picture.caption, caption_font, size.width - left - 1.2);
  const double below = 2.7 * line + caption_height(caption);
  size.height = below + plane_height + 0.6 * line;

  FigureScript script(size);
  script.append(curve_data(picture, parameter, growth, frequency));
  script.append(palette(dark_viridis));
  script.set_margins(left, right, below, below + plane_height);
  script.set_axis('x', growth_range, growth);
  script.set_axis('y', frequency_range, frequency);
  add_colour_bar(script, parameter_range, parameter, right + 0.5, below, bar_width, plane_height);
  script.add("{}", axes_style);
  script.add(
      "set object 1 rectangle from {:.9g}, graph 0 to graph 1, graph 1 behind fillcolor '#fbeae6' "
      "fillstyle solid noborder",
      as_number(0.0, growth));
  script.add(
      "set arrow 1 from {0:.9g}, graph 0 to {0:.9g}, graph 1 nohead back linecolor '{1}' "
      "linewidth 1.5",
      as_number(0.0, growth), unstable_colour);

  // Where several windows belong to one branch, one label says it: the strongest of each frequency.
  std::vector<LocusWindow> labelled = picture.windows;
  std::sort(labelled.begin(), labelled.end(),
            [](const LocusWindow& a, const LocusWindow& b) { return a.growth_max > b.growth_max; });
  std::vector<double> taken;
  const double across = (right - left) / (growth_range.upper - growth_range.lower);
  for (const LocusWindow& window : labelled) {
    const double height = plane_height * window.frequency / frequency_range.upper;
    const double needed = 1.1 * line_height(label_font);
    if (std::any_of(taken.begin(), taken.end(),
                    [&](double other) { return std::abs(other - height) < needed; })) {
      continue;
    }
    taken.push_back(height);
    const std::string text = quantity_text(window.frequency, "Hz");
    const double width = text_width(text, label_font);
    double x = left + (window.growth_max - growth_range.lower) * across + 0.25;
    const bool is_right = x + width < right;
    if (!is_right) x -= 0.5;
    script.add_text(text, x, below + height + (is_right ? 0.0 : 0.35),
                    is_right ? "left front" : "right front", label_font);
  }

  const double middle = below + 0.5 * plane_height;
  script.add_text(axis_label("growth rate", "1/s", growth), 0.5 * (left + right),
                  below - 1.9 * line, "center");
  script.add_text(axis_label("frequency", "Hz", frequency), 0.7 * line, middle, "center rotate");
  script.add_text(parameter_label(picture.parameter, picture.units, parameter),
                  size.width - 0.6 * line, middle, "center rotate");
  add_caption(script, caption, left, below - 2.7 * line);
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
  const double character = character_width(size);
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
  double label_length = 0.0;
  for (const WindowLabel& label : labels)
    label_length = std::max(label_length, text_width(label.text, label_font) + 0.25);
  const std::vector<std::string> caption =
      wrapped(picture.caption, caption_font, size.width - left - 1.2);
  const double below = 2.7 * line + caption_height(caption);
  const double upper = below + panel_height + 0.8 * line;
  size.height = upper + panel_height + 0.5 * line + label_length;

  FigureScript script(size);
  script.append(curve_data(picture, parameter, growth, frequency));
  script.add("set multiplot");
  script.add("{}", axes_style);
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
  script.add_text(parameter_label(picture.parameter, picture.units, parameter),
                  0.5 * (left + right), below - 1.9 * line, "center");
  add_caption(script, caption, left, below - 2.7 * line);
  plot(3);
  script.add("unset multiplot");
  draw_figure(figure, script.text(), size);
}

namespace {

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
  ValueRange data;
  for (const auto& row : picture.growth) data.include(row);
  double largest = std::max(std::abs(data.lower), std::abs(data.upper));
  if (data.is_empty() || largest == 0.0) largest = 1.0;
  // The side that grows sets the colours: decay is often faster and of less interest.
  const double limit = data.upper > 0.0 ? data.upper : largest;
  const ValueRange colour{-limit, limit};
  const AxisScale colour_scale = axis_scale(colour.lower, colour.upper, 6);
  const auto scale_of = [](const MapAxis& axis, int ticks) {
    const auto [low, high] = std::minmax(axis.values.front(), axis.values.back());
    return axis_scale(low, high, ticks);
  };
  const AxisScale x_scale = scale_of(picture.x, 7);
  const AxisScale y_scale = scale_of(picture.y, 7);

  // All lengths in cm.
  FigureSize size;
  const double line = line_height(size.font_size);
  const double character = character_width(size);
  constexpr double plane_height = 8.4;
  constexpr double bar_width = 0.45;
  const auto label_of = [](const MapAxis& axis, const AxisScale& scale) {
    return axis.is_logarithmic ? axis_label(axis.label, typeset_units(axis.units), {})
                               : parameter_label(axis.label, axis.units, scale);
  };
  const double y_digits = static_cast<double>(map_tick_characters(picture.y, y_scale));
  const double left = 1.4 * line + (y_digits + 1.3) * character;
  const double bar_digits = static_cast<double>(tick_characters(colour, colour_scale));
  const double right = size.width - (0.5 + bar_width + (bar_digits + 1.9) * character + 1.2 * line);
  const std::vector<std::string> caption =
      wrapped(picture.caption, caption_font, size.width - left - 1.2);
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
      const bool is_known = std::isfinite(value);
      map += is_known
                 ? fmt::format("{:.5g} ", as_number(std::clamp(value, -limit, limit), colour_scale))
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
  script.append(palette(blue_red));
  script.set_margins(left, right, below, below + plane_height);
  set_map_axis(script, 'x', picture.x, x_scale);
  set_map_axis(script, 'y', picture.y, y_scale);
  script.add("set x2range [-0.5:{:.1f}]\nset y2range [-0.5:{:.1f}]",
             static_cast<double>(raster_columns) - 0.5, static_cast<double>(raster_rows) - 0.5);
  add_colour_bar(script, colour, colour_scale, right + 0.5, below, bar_width, plane_height);
  script.add(
      "set minussign\nset border 15 linecolor '#404040'\nset tics nomirror out scale 0.6\nunset "
      "key");
  const double middle = below + 0.5 * plane_height;
  script.add_text(label_of(picture.x, x_scale), 0.5 * (left + right), below - 1.9 * line, "center");
  script.add_text(label_of(picture.y, y_scale), 0.7 * line, middle, "center rotate");
  script.add_text(axis_label("largest growth rate", "1/s", colour_scale), size.width - 0.6 * line,
                  middle, "center rotate");
  add_caption(script, caption, left, below - 2.7 * line);
  script.add(
      "plot $map matrix using 1:2:($3 < -1e29 ? NaN : $3) with image axes x2y2, NaN, $boundary "
      "using 1:2 with "
      "lines linewidth 2 linecolor '#000000', $boundary using 1:2 with points pointtype 7 "
      "pointsize "
      "0.3 linecolor '#000000'");
  draw_figure(figure, script.text(), size);
}

}  // namespace stridor
