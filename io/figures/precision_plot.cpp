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

}  // namespace

void plot_precision(const PrecisionPicture& picture, const std::filesystem::path& figure) {
  ValueRange times;
  ValueRange errors;
  std::vector<PrecisionCurve> curves;
  for (const PrecisionCurve& curve : picture.curves) {
    if (std::none_of(curve.points.begin(), curve.points.end(), is_drawable)) continue;
    curves.push_back(curve);
    for (const PrecisionCurve::Point& point : curve.points) {
      if (!is_drawable(point)) continue;
      times.include(std::span(&point.seconds, 1));
      errors.include(std::span(&point.error, 1));
    }
  }
  if (curves.empty()) throw std::invalid_argument("precision plot: no point to draw");
  const auto include_line = [&](double error) {
    if (error > 0.0) errors.include(std::span(&error, 1));
  };
  include_line(picture.reference_error);
  include_line(picture.wanted.value_or(0.0));
  const ValueRange x_range = log_range(times);
  const ValueRange y_range = log_range(errors);

  // All lengths in cm.
  FigureSize size;
  size.width = 23.0;
  const double line = line_height(size.font_size);
  constexpr double plane_height = 10.5;
  constexpr double legend_font = 9.5;
  const double legend_line = line_height(legend_font);
  const double left = 3.2;
  double legend_width = text_width("none is better in both", legend_font) + 1.0;
  for (const PrecisionCurve& curve : curves)
    legend_width = std::max(legend_width, text_width(legend_of(curve), legend_font) + 1.0);
  const double right = size.width - legend_width - 0.8;
  const std::vector<std::string> caption =
      wrapped(picture.caption, caption_font, size.width - left - 0.3);
  const double caption_height =
      static_cast<double>(caption.size()) * line_height(caption_font) + 0.3;
  const double below = 2.7 * line + caption_height;
  size.height = below + plane_height + 0.5 * line;

  FigureScript script(size);
  script.set_margins(left, right, below, below + plane_height);
  script.set_log_axis('x', x_range);
  script.set_log_axis('y', y_range);
  script.add("{}\nunset key", axes_style);
  script.add_text("time of stepping (s)", 0.5 * (left + right), below - 1.9 * line, "center");
  script.add_text(picture.error_label, 0.7 * line, below + 0.5 * plane_height, "center rotate");
  for (std::size_t i = 0; i < caption.size(); ++i) {
    script.add_text(
        caption[i], left,
        caption_height - 0.2 - (static_cast<double>(i) + 0.3) * line_height(caption_font), "left",
        caption_font);
  }
  int next_label = 1000;  // beyond those of add_text()
  // Named in the legend, where their names cover no curve.
  double next_row = static_cast<double>(curves.size()) + 1.9;
  const auto across = [&](double error, const char* text, const char* colour) {
    if (!(error > 0.0)) return;
    const double height = below + plane_height - next_row * legend_line * 1.15;
    next_row += 1.0;
    script.add(
        "set arrow from graph 0, first {0:.6g} to graph 1, first {0:.6g} nohead dashtype 2 "
        "linecolor '{1}' linewidth 1.2\n"
        "set arrow from screen {2:.6f}, screen {4:.6f} to screen {3:.6f}, screen {4:.6f} nohead "
        "dashtype 2 linecolor '{1}' linewidth 1.2",
        error, colour, script.across(right + 0.35), script.across(right + 0.85), script.up(height));
    script.add_text(text, right + 0.9, height, "left", legend_font);
  };
  across(picture.reference_error, "reference itself", "#707070");
  across(picture.wanted.value_or(0.0), "asked for", "#cc0000");
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
    const double height =
        below + plane_height - (static_cast<double>(i) + 0.6) * legend_line * 1.15;
    script.add(
        "set label {} at screen {:.6f}, screen {:.6f} point pointtype {} pointsize 1.6 "
        "linecolor '{}'",
        next_label++, script.across(right + 0.6), script.up(height), mark, colour);
    script.add_text(legend_of(curves[i]), right + 0.9, height, "left", legend_font);
  }
  const double ring_height =
      below + plane_height - (static_cast<double>(curves.size()) + 0.9) * legend_line * 1.15;
  script.add(
      "set label {} at screen {:.6f}, screen {:.6f} point pointtype 6 pointsize 3 "
      "linewidth 1.8 linecolor '#000000'",
      next_label, script.across(right + 0.6), script.up(ring_height));
  script.add_text("none is better in both", right + 0.9, ring_height, "left", legend_font);
  script.append(plot);
  draw_figure(figure, script.text(), size);
}

}  // namespace stridor
