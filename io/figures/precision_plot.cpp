#include "io/figures/precision_plot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "io/figures/axes.hpp"
#include "io/figures/gnuplot.hpp"

namespace stridor {
namespace {

constexpr std::array<const char*, 10> setting_colours{"#0b5394", "#e07b00", "#38761d", "#cc0000",
                                                      "#674ea7", "#7f6000", "#45818e", "#a64d79",
                                                      "#000000", "#6aa84f"};
constexpr std::array<int, 6> marks{7, 5, 9, 11, 13, 4};

bool is_drawable(const PrecisionCurve::Point& point) {
  return std::isfinite(point.seconds) && point.seconds > 0.0 && std::isfinite(point.error) &&
         point.error > 0.0;
}

/// Whole half decades around the values.
ValueRange log_range(const ValueRange& values) {
  const double lower = std::floor(2.0 * std::log10(values.lower) - 0.2) / 2.0;
  const double upper = std::ceil(2.0 * std::log10(values.upper) + 0.2) / 2.0;
  return {std::pow(10.0, lower), std::pow(10.0, upper)};
}

void add_points(FigureScript& script, const std::string& block, const PrecisionCurve& curve) {
  std::string data;
  for (const PrecisionCurve::Point& point : curve.points) {
    if (!is_drawable(point)) continue;
    data +=
        fmt::format("{:.6g} {:.6g} {}\n", point.seconds, point.error, point.is_on_front ? 1 : 0);
  }
  script.append(block + " << END_OF_DATA\n" + data + "END_OF_DATA\n");
}

std::string legend_of(const PrecisionCurve& curve) {
  return curve.slope ? fmt::format("{} (slope {:.2f})", curve.name, *curve.slope) : curve.name;
}

constexpr double legend_font = 9.5;

/// The curves that have points, and what their axes show.
struct PrecisionPlane {
  std::vector<PrecisionCurve> curves;
  ValueRange x_range, y_range;
};

PrecisionPlane plane_of(const PrecisionPicture& picture) {
  ValueRange times;
  ValueRange errors;
  PrecisionPlane plane;
  for (const PrecisionCurve& curve : picture.curves) {
    if (std::none_of(curve.points.begin(), curve.points.end(), is_drawable)) continue;
    plane.curves.push_back(curve);
    for (const PrecisionCurve::Point& point : curve.points) {
      if (!is_drawable(point)) continue;
      times.include(std::span(&point.seconds, 1));
      errors.include(std::span(&point.error, 1));
    }
  }
  if (plane.curves.empty()) throw std::invalid_argument("precision plot: no point to draw");
  for (const double error : {picture.reference_error, picture.wanted.value_or(0.0)})
    if (error > 0.0) errors.include(std::span(&error, 1));
  plane.x_range = log_range(times);
  plane.y_range = log_range(errors);
  return plane;
}

/// Places on the page, cm.
struct PrecisionLayout {
  FigureSize size;
  double line = 0.0;
  double left = 3.2, right = 0.0;
  double below = 0.0, plane_height = 10.5;
  std::vector<std::string> caption;
  double caption_height = 0.0;

  /// Height of a row of the legend, counted from the top.
  double legend_height(double row) const {
    return below + plane_height - row * line_height(legend_font) * 1.15;
  }
};

PrecisionLayout precision_layout(const PrecisionPicture& picture,
                                 const std::vector<PrecisionCurve>& curves) {
  PrecisionLayout layout;
  layout.size.width = 23.0;
  layout.line = line_height(layout.size.font_size);
  double legend_width = text_width("none is better in both", legend_font) + 1.0;
  for (const PrecisionCurve& curve : curves)
    legend_width = std::max(legend_width, text_width(legend_of(curve), legend_font) + 1.0);
  layout.right = layout.size.width - legend_width - 0.8;
  layout.caption = wrapped(picture.caption, caption_font, layout.size.width - layout.left - 0.3);
  layout.caption_height =
      static_cast<double>(layout.caption.size()) * line_height(caption_font) + 0.3;
  layout.below = 2.7 * layout.line + layout.caption_height;
  layout.size.height = layout.below + layout.plane_height + 0.5 * layout.line;
  return layout;
}

void add_axes(FigureScript& script, const PrecisionPicture& picture, const PrecisionPlane& plane,
              const PrecisionLayout& layout) {
  script.set_margins(layout.left, layout.right, layout.below, layout.below + layout.plane_height);
  script.set_log_axis('x', plane.x_range);
  script.set_log_axis('y', plane.y_range);
  script.add("{}\nunset key", axes_style);
  script.add_text("time of stepping (s)", 0.5 * (layout.left + layout.right),
                  layout.below - 1.9 * layout.line, "center");
  script.add_text(picture.error_label, 0.7 * layout.line,
                  layout.below + 0.5 * layout.plane_height, "center rotate");
  for (std::size_t i = 0; i < layout.caption.size(); ++i) {
    script.add_text(
        layout.caption[i], layout.left,
        layout.caption_height - 0.2 - (static_cast<double>(i) + 0.3) * line_height(caption_font),
        "left", caption_font);
  }
}

/// A line across the plane, named in the legend, where its name covers no curve.
void add_level(FigureScript& script, const PrecisionLayout& layout, double error, double row,
               const char* text, const char* colour) {
  const double height = layout.legend_height(row);
  script.add(
      "set arrow from graph 0, first {0:.6g} to graph 1, first {0:.6g} nohead dashtype 2 "
      "linecolor '{1}' linewidth 1.2\n"
      "set arrow from screen {2:.6f}, screen {4:.6f} to screen {3:.6f}, screen {4:.6f} nohead "
      "dashtype 2 linecolor '{1}' linewidth 1.2",
      error, colour, script.across(layout.right + 0.35), script.across(layout.right + 0.85),
      script.up(height));
  script.add_text(text, layout.right + 0.9, height, "left", legend_font);
}

/// Data and legend of the curves. @return what gnuplot is to plot
std::string add_curves(FigureScript& script, const PrecisionLayout& layout,
                       const std::vector<PrecisionCurve>& curves) {
  int next_label = 1000;  // beyond those of add_text()
  std::string plot = "plot NaN";
  for (std::size_t i = 0; i < curves.size(); ++i) {
    const std::string block = fmt::format("$curve{}", i);
    add_points(script, block, curves[i]);
    const char* colour = setting_colours[i % setting_colours.size()];
    const int mark = marks[i % marks.size()];
    plot += fmt::format(
        ", {0} using 1:2 with linespoints linewidth 1.3 pointtype {1} pointsize 1.6 linecolor "
        "'{2}', "
        "{0} using 1:($3 > 0 ? $2 : NaN) with points pointtype 6 pointsize 3 linewidth 1.8 "
        "linecolor '#000000'",
        block, mark, colour);
    const double height = layout.legend_height(static_cast<double>(i) + 0.6);
    script.add(
        "set label {} at screen {:.6f}, screen {:.6f} point pointtype {} pointsize 1.6 "
        "linecolor '{}'",
        next_label++, script.across(layout.right + 0.6), script.up(height), mark, colour);
    script.add_text(legend_of(curves[i]), layout.right + 0.9, height, "left", legend_font);
  }
  const double ring_height = layout.legend_height(static_cast<double>(curves.size()) + 0.9);
  script.add(
      "set label {} at screen {:.6f}, screen {:.6f} point pointtype 6 pointsize 3 "
      "linewidth 1.8 linecolor '#000000'",
      next_label, script.across(layout.right + 0.6), script.up(ring_height));
  script.add_text("none is better in both", layout.right + 0.9, ring_height, "left", legend_font);
  return plot;
}

}  // namespace

void plot_precision(const PrecisionPicture& picture, const std::filesystem::path& figure) {
  const PrecisionPlane plane = plane_of(picture);
  const PrecisionLayout layout = precision_layout(picture, plane.curves);
  FigureScript script(layout.size);
  add_axes(script, picture, plane, layout);
  double row = static_cast<double>(plane.curves.size()) + 1.9;
  if (picture.reference_error > 0.0)
    add_level(script, layout, picture.reference_error, row++, "reference itself", "#707070");
  if (const double wanted = picture.wanted.value_or(0.0); wanted > 0.0)
    add_level(script, layout, wanted, row, "asked for", "#cc0000");
  script.append(add_curves(script, layout, plane.curves));
  draw_figure(figure, script.text(), layout.size);
}

}  // namespace stridor
