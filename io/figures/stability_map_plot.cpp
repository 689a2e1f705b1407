#include "io/figures/stability_map_plot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "io/figures/axes.hpp"
#include "io/figures/gnuplot.hpp"

namespace stridor {
namespace {

// Decay in blue, growth in red, lightness alike on both sides. Both begin with a colour that cannot
// be taken for white, so that the verdict is to be seen where rates are small.
constexpr std::array<const char*, 3> blues{"#0b3c7a", "#3b74b4", "#c3daee"};
constexpr std::array<const char*, 3> reds{"#f6cbb9", "#d0553f", "#8a1020"};

[[noreturn]] void refuse_map(const std::string& what) {
  throw std::invalid_argument("stability map: " + what);
}

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
      colours.note = fmt::format(" Darkest blue: decay of {:.3g} 1/s or faster, up to {:.3g} 1/s.",
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

void check_map(const StabilityMapPicture& picture) {
  const std::size_t columns = picture.x.values.size();
  const std::size_t rows = picture.y.values.size();
  if (columns < 2 || rows < 2) refuse_map("a map needs at least two values along each axis");
  if (picture.growth.size() != rows ||
      std::any_of(picture.growth.begin(), picture.growth.end(),
                  [&](const auto& row) { return row.size() != columns; })) {
    refuse_map(fmt::format("the growth rates are not {} rows of {}", rows, columns));
  }
}

AxisScale map_scale(const MapAxis& axis) {
  const auto [low, high] = std::minmax(axis.values.front(), axis.values.back());
  return axis_scale(low, high, 7);
}

std::string map_axis_label(const MapAxis& axis, const AxisScale& scale) {
  const std::string units = typeset_units(axis.units);
  return axis.is_logarithmic ? axis_label(axis.label, units, {})
                             : offset_axis_label(axis.label, units, scale);
}

/// Cells of a picture, of which each value of the map fills many.
struct MapRaster {
  std::size_t columns = 0;
  std::size_t rows = 0;
};

/// Where the rates in the cells lie from -1 to 1.
std::string map_block(const StabilityMapPicture& picture, const MapColours& colour,
                      const MapRaster& raster) {
  const std::size_t columns = picture.x.values.size();
  const std::size_t rows = picture.y.values.size();
  std::string map = "$map << END_OF_DATA\n";
  for (std::size_t r = 0; r < raster.rows; ++r) {
    for (std::size_t c = 0; c < raster.columns; ++c) {
      const double value = picture.growth[nearest_index(r, raster.rows, rows)]
                                         [nearest_index(c, raster.columns, columns)];
      map += std::isfinite(value)
                 ? fmt::format("{:.5g} ", colour.place(value))
                 : std::string("-1e30 ");  // gnuplot complains about NaN in a matrix
    }
    map += '\n';
  }
  return map + "END_OF_DATA\n";
}

/// The lines between stable and unstable, an empty line after each.
std::string boundary_block(const StabilityMapPicture& picture, const AxisScale& x_scale,
                           const AxisScale& y_scale) {
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
  return lines + "END_OF_DATA\n";
}

}  // namespace

void plot_stability_map(const StabilityMapPicture& picture, const std::filesystem::path& figure) {
  check_figure_name(figure);
  check_map(picture);
  const MapColours colour = map_colours(picture.growth);
  const AxisScale x_scale = map_scale(picture.x);
  const AxisScale y_scale = map_scale(picture.y);

  // All lengths in cm.
  FigureSize size;
  const double line = line_height(size.font_size);
  const double character = character_width(size.font_size);
  constexpr double plane_height = 8.4;
  constexpr double bar_width = 0.45;
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

  const MapRaster raster{std::min<std::size_t>(800, 40 * picture.x.values.size()),
                         std::min<std::size_t>(600, 40 * picture.y.values.size())};
  FigureScript script(size);
  script.append(map_block(picture, colour, raster));
  script.append(boundary_block(picture, x_scale, y_scale));
  script.append(colour.palette());
  script.set_margins(left, right, below, below + plane_height);
  set_map_axis(script, 'x', picture.x, x_scale);
  set_map_axis(script, 'y', picture.y, y_scale);
  script.add("set x2range [-0.5:{:.1f}]\nset y2range [-0.5:{:.1f}]",
             static_cast<double>(raster.columns) - 0.5, static_cast<double>(raster.rows) - 0.5);
  std::string ticks;
  for (const auto& [place, text] : colour.ticks)
    ticks += fmt::format("{}{} {:.6g}", ticks.empty() ? "" : ", ", gnuplot_string(text), place);
  script.add("set cbrange [-1:1]\nset cbtics ({}) scale 0.6", ticks);
  script.set_colour_bar(right + 0.5, below, bar_width, plane_height);
  script.add("{}\nunset key", map_style);
  const double middle = below + 0.5 * plane_height;
  script.add_text(map_axis_label(picture.x, x_scale), 0.5 * (left + right), below - 1.9 * line,
                  "center");
  script.add_text(map_axis_label(picture.y, y_scale), 0.7 * line, middle, "center rotate");
  script.add_text(axis_label("largest growth rate", "1/s", colour.scale), size.width - 0.6 * line,
                  middle, "center rotate");
  script.add_caption(caption, left, below - 2.7 * line);
  // gnuplot fails over a block without lines.
  const std::string boundary =
      picture.boundary.empty()
          ? ""
          : ", $boundary using 1:2 with lines linewidth 2 linecolor '#000000', $boundary using 1:2 "
            "with points pointtype 7 pointsize 0.3 linecolor '#000000'";
  script.add("plot $map matrix using 1:2:($3 < -1e29 ? NaN : $3) with image axes x2y2, NaN{}",
             boundary);
  draw_figure(figure, script.text(), size);
}

}  // namespace stridor
