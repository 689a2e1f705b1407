#include "io/figures/panel_plot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <string>

#include "io/figures/axes.hpp"
#include "io/figures/gnuplot.hpp"

namespace stridor {
namespace {

constexpr std::array<const char*, 8> panel_colours{"#0b5394", "#e07b00", "#2a8a4a", "#b02318",
                                                   "#6a3d9a", "#808080", "#17a2b8", "#8c564b"};
constexpr double gap_below_axis = 1.6;  // cm: numbers and label

const char* panel_colour(int number) {
  return panel_colours[static_cast<std::size_t>(number) % panel_colours.size()];
}

/// A text for a legend, where gnuplot does not know doubled quotes.
std::string legend_text(std::string text) {
  for (std::size_t at = text.find('\''); at != std::string::npos; at = text.find('\'', at))
    text.replace(at, 1, "\u2019");
  return "'" + text + "'";
}

std::string block_name(std::size_t panel, std::size_t curve) {
  return fmt::format("$data_{}_{}", panel, curve);
}

void add_caption(FigureScript& script, const std::vector<std::string>& lines) {
  for (std::size_t i = 0; i < lines.size(); ++i) {
    script.add_text(lines[i], 0.3,
                    (static_cast<double>(lines.size() - i) - 0.5) * line_height(caption_font) + 0.1,
                    "left", caption_font);
  }
}

/// "10⁻³".
std::string power_of_ten(int exponent) {
  constexpr std::array<const char*, 10> digits{"⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹"};
  std::string text = exponent < 0 ? "10⁻" : "10";
  for (const char digit : std::to_string(std::abs(exponent)))
    text += digits[static_cast<std::size_t>(digit - '0')];
  return text;
}

/// How the values of one direction of a diagram are drawn.
struct PanelAxis {
  AxisKind kind = AxisKind::linear;
  ValueRange range;
  AxisScale scale;

  bool shows(double value) const {
    return std::isfinite(value) && (kind == AxisKind::linear || value > 0.0);
  }
  double number(double value) const {
    return kind == AxisKind::linear ? as_number(value, scale) : value;
  }
};

PanelAxis make_axis(const DiagramPanel& panel, std::vector<double> PanelCurve::*values,
                    AxisKind kind, double least = 0.0) {
  PanelAxis axis;
  axis.kind = kind;
  for (const PanelCurve& curve : panel.curves) {
    std::vector<double> shown;
    for (const double value : curve.*values)
      if (axis.shows(value)) shown.push_back(value);
    axis.range.include(shown);
  }
  if (kind == AxisKind::logarithmic) {
    if (axis.range.is_empty()) axis.range = {1.0, 10.0};
    axis.range.lower = std::max(axis.range.lower, std::min(least, axis.range.upper));
    axis.range.lower = std::pow(10.0, std::floor(std::log10(axis.range.lower) + 1e-6));
    axis.range.upper = std::pow(10.0, std::ceil(std::log10(axis.range.upper) - 1e-6));
    if (axis.range.lower == axis.range.upper) axis.range.upper *= 10.0;
  } else {
    axis.range = axis.range.widened(0.04);
    axis.scale = axis_scale(axis.range.lower, axis.range.upper, 5);
  }
  return axis;
}

/// "frequency" and "Hz" of "frequency (Hz)".
std::string unit_of(const std::string& label) {
  const std::size_t open = label.rfind(" (");
  if (open == std::string::npos || label.back() != ')') return "";
  return label.substr(open + 2, label.size() - open - 3);
}
std::string label_words(const std::string& label) {
  return unit_of(label).empty() ? label : label.substr(0, label.rfind(" ("));
}

void add_axis(FigureScript& script, char name, const std::string& label, const PanelAxis& axis) {
  if (axis.kind == AxisKind::linear) {
    script.add("unset logscale {0}\nset {0}label {1}", name,
               gnuplot_string(axis_label(label_words(label), unit_of(label), axis.scale)));
    script.set_axis(name, axis.range, axis.scale);
    return;
  }
  const int first = static_cast<int>(std::lround(std::log10(axis.range.lower)));
  const int last = static_cast<int>(std::lround(std::log10(axis.range.upper)));
  const int step = 1 + (last - first) / 6;
  std::string ticks;
  for (int k = first; k <= last; k += step)
    ticks += fmt::format("{}'{}' 1e{}", ticks.empty() ? "" : ", ", power_of_ten(k), k);
  script.add(
      "set logscale {0}\nset {0}label {1}\nset {0}range [{2:.8g}:{3:.8g}]\nset {0}tics ({4})", name,
      gnuplot_string(label), axis.range.lower, axis.range.upper, ticks);
}

void check_panels(const std::vector<DiagramPanel>& panels) {
  if (panels.empty()) throw std::invalid_argument("plot_panels: no diagram");
  for (const DiagramPanel& panel : panels) {
    for (const PanelCurve& curve : panel.curves) {
      if (curve.x.size() == curve.y.size()) continue;
      throw std::invalid_argument(fmt::format("plot_panels: {} values against {} in '{}'",
                                              curve.y.size(), curve.x.size(), curve.label));
    }
  }
}

/// The axes of one diagram.
struct PanelPlane {
  PanelAxis x, y;
};

/// Gives both axes of a diagram to scale one power of ten, and the narrower one at least half of
/// the extent of the other.
void keep_to_scale(PanelAxis& a, PanelAxis& b) {
  const double extent = std::max(a.range.upper - a.range.lower, b.range.upper - b.range.lower);
  const int exponent = std::max(a.scale.exponent, b.scale.exponent);
  for (PanelAxis* axis : {&a, &b}) {
    const double missing = 0.5 * extent - (axis->range.upper - axis->range.lower);
    if (missing > 0.0) {
      axis->range = {axis->range.lower - 0.5 * missing, axis->range.upper + 0.5 * missing};
      axis->scale = axis_scale(axis->range.lower, axis->range.upper, 5);
    }
    axis->scale.step *= std::pow(10.0, axis->scale.exponent - exponent);
    axis->scale.exponent = exponent;
    axis->scale.decimals =
        std::max(0, -static_cast<int>(std::floor(std::log10(axis->scale.step) + 1e-9)));
  }
}

/// Writes the points of a diagram as gnuplot reads them.
PanelPlane add_panel_data(FigureScript& script, const DiagramPanel& panel, std::size_t number) {
  PanelPlane plane{make_axis(panel, &PanelCurve::x, panel.x_kind),
                   make_axis(panel, &PanelCurve::y, panel.y_kind, panel.y_least)};
  if (panel.is_share) {
    plane.y.range = ValueRange{0.0, 1.0}.widened(0.04);
    plane.y.scale = axis_scale(plane.y.range.lower, plane.y.range.upper, 5);
  }
  if (panel.is_to_scale) keep_to_scale(plane.x, plane.y);
  for (std::size_t c = 0; c < panel.curves.size(); ++c) {
    const PanelCurve& curve = panel.curves[c];
    std::string data;
    bool is_empty = true;
    for (std::size_t i = 0; i < curve.x.size(); ++i) {
      const bool is_shown = plane.x.shows(curve.x[i]) && plane.y.shows(curve.y[i]);
      data += is_shown
                  ? fmt::format("{:.8g} {:.8g}\n", plane.x.number(curve.x[i]),
                                plane.y.number(curve.y[i]))
                  : "\n";
      is_empty &= !is_shown;
    }
    if (is_empty) data = "NaN NaN\n";  // gnuplot refuses data without a number
    script.append(block_name(number, c) + " << END_OF_DATA\n" + data + "END_OF_DATA\n");
  }
  return plane;
}

/// The plots of a diagram, as gnuplot takes them.
std::string panel_plots(const DiagramPanel& panel, std::size_t number) {
  std::string plots;
  for (std::size_t c = 0; c < panel.curves.size(); ++c) {
    const PanelCurve& curve = panel.curves[c];
    const char* how = "with points pointtype 7 pointsize 0.7";
    if (curve.mark == Mark::line) how = "with lines linewidth 1.8";
    if (curve.mark == Mark::dashed_line) how = "with lines dashtype 2 linewidth 1.6";
    plots += fmt::format(
        ", {} using 1:2 {} linecolor '{}' {}", block_name(number, c), how, panel_colour(curve.colour),
        curve.label.empty() ? std::string("notitle") : "title " + legend_text(curve.label));
  }
  return plots;
}

/// Writes a field and its curve, both mirrored, as gnuplot reads them. @return the data of the curve
std::string add_field_data(FigureScript& script, const FieldPicture& picture) {
  const std::size_t nx = picture.num_columns;
  const std::size_t ny = picture.values.size() / nx;
  std::string data;
  for (std::size_t row = 0; row < 2 * ny; ++row) {
    const std::size_t j = row < ny ? ny - 1 - row : row - ny;
    for (std::size_t i = 0; i < nx; ++i) {
      const double value = picture.values[j * nx + i];
      // gnuplot complains of NaN in a matrix.
      data += std::isfinite(value) ? fmt::format("{:.5g} ", value) : "-1e30 ";
    }
    data += '\n';
  }
  script.append("$field << END_OF_DATA\n" + data + "END_OF_DATA\n");
  std::string curve;
  for (std::size_t i = 0; i < picture.curve_x.size(); ++i)
    curve += fmt::format("{:.8g} {:.8g}\n", picture.curve_x[i], picture.curve_y[i]);
  for (std::size_t i = picture.curve_x.size(); i-- > 0;)
    curve += fmt::format("{:.8g} {:.8g}\n", picture.curve_x[i], -picture.curve_y[i]);
  if (!picture.curve_x.empty())
    curve += fmt::format("{:.8g} {:.8g}\n", picture.curve_x[0], picture.curve_y[0]);
  script.append("$curve << END_OF_DATA\n" + curve + "END_OF_DATA\n");
  return curve;
}

}  // namespace

void plot_panels(const std::vector<DiagramPanel>& panels, const std::string& caption,
                 const std::filesystem::path& figure) {
  check_figure_name(figure);
  check_panels(panels);
  const std::size_t num_columns = std::min<std::size_t>(3, panels.size());
  const std::size_t num_rows = (panels.size() + num_columns - 1) / num_columns;
  FigureSize size;
  size.width = num_columns == 1 ? 16.0 : num_columns == 2 ? 22.0 : 30.0;
  const double panel_width = size.width / static_cast<double>(num_columns);
  const double panel_height = num_columns == 1 && panels.front().is_to_scale ? 15.0 : 9.0;
  const std::vector<std::string> lines = wrapped(caption, caption_font, size.width - 0.6);
  const double caption_height =
      static_cast<double>(lines.size()) * line_height(caption_font) + (lines.empty() ? 0.0 : 0.3);
  size.height = caption_height + static_cast<double>(num_rows) * panel_height;

  FigureScript script(size);
  script.add("{}", axes_style);
  script.add("set key above horizontal Left reverse samplen 1.5 spacing 1.05 font ',{}'",
             caption_font);
  std::vector<PanelPlane> planes;
  for (std::size_t p = 0; p < panels.size(); ++p)
    planes.push_back(add_panel_data(script, panels[p], p));
  script.add("set multiplot");
  add_caption(script, lines);
  for (std::size_t p = 0; p < panels.size(); ++p) {
    const double left = static_cast<double>(p % num_columns) * panel_width;
    const std::size_t rows_below = num_rows - 1 - p / num_columns;
    const double bottom = caption_height + static_cast<double>(rows_below) * panel_height;
    script.set_margins(left + 2.7, left + panel_width - 0.6, bottom + gap_below_axis,
                       bottom + panel_height - 1.3);
    add_axis(script, 'x', panels[p].x_label, planes[p].x);
    add_axis(script, 'y', panels[p].y_label, planes[p].y);
    script.add("set size {}", panels[p].is_to_scale ? "ratio -1" : "noratio");
    script.add("plot NaN notitle{}", panel_plots(panels[p], p));
    if (p == 0) script.add("unset label");  // the caption is drawn once
  }
  script.add("unset multiplot");
  draw_figure(figure, script.text(), size);
}

void plot_field(const FieldPicture& picture, const std::string& caption,
                const std::filesystem::path& figure) {
  check_figure_name(figure);
  const std::size_t nx = picture.num_columns;
  if (nx == 0 || picture.values.empty() || picture.values.size() % nx != 0) {
    throw std::invalid_argument(
        fmt::format("plot_field: {} values in rows of {}", picture.values.size(), nx));
  }
  if (picture.curve_x.size() != picture.curve_y.size())
    throw std::invalid_argument("plot_field: the curve has not as many x as y");
  const std::size_t ny = picture.values.size() / nx;
  FigureSize size;
  const std::vector<std::string> lines = wrapped(caption, caption_font, size.width - 0.6);
  const double caption_height = static_cast<double>(lines.size()) * line_height(caption_font) + 0.3;
  constexpr double left = 2.8;
  constexpr double plane_width = 9.6;
  const double plane_height =
      std::min(16.0, plane_width * 2.0 * static_cast<double>(ny) / static_cast<double>(nx));
  const double bottom = caption_height + gap_below_axis;
  size.height = bottom + plane_height + 0.6;

  FigureScript script(size);
  const std::string curve = add_field_data(script, picture);
  script.set_margins(left, left + plane_width, bottom, bottom + plane_height);
  add_caption(script, lines);
  script.add("set minussign\nset border linecolor '#404040'\nset tics out nomirror scale 0.6");
  script.add("set xlabel {}\nset ylabel {}\nset cblabel {}", gnuplot_string(picture.x_label),
             gnuplot_string(picture.y_label), gnuplot_string(picture.value_label));
  script.add(
      "set palette defined (0 '#440154', 1 '#3b528b', 2 '#21918c', 3 '#5ec962', 4 '#fde725')");
  const double side = picture.cell_side;
  const double half_x = 0.5 * static_cast<double>(nx) * side;
  const double half_y = static_cast<double>(ny) * side;
  script.add("set xrange [{:.8g}:{:.8g}]\nset yrange [{:.8g}:{:.8g}]\nunset key", -half_x, half_x,
             -half_y, half_y);
  script.add(
      "plot $field matrix using ({:.8g} + {:.8g} * $1):({:.8g} + {:.8g} * $2):($3 < -1e29 ? NaN : "
      "$3) with image, "
      "NaN{}",
      -half_x + 0.5 * side, side, -half_y + 0.5 * side, side,
      curve.empty() ? "" : ", $curve using 1:2 with lines linewidth 1.6 linecolor '#e07b00'");
  draw_figure(figure, script.text(), size);
}

}  // namespace stridor
