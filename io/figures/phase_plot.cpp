#include "io/figures/phase_plot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <stdexcept>

#include "io/figures/axes.hpp"
#include "io/figures/gnuplot.hpp"

namespace stridor {
namespace {

constexpr std::size_t num_path_columns = 1600;
constexpr std::size_t num_rows = 1000;

// Cells that have been passed through.
class Cells {
 public:
  Cells(std::size_t columns, std::size_t rows) : columns_(columns), is_taken_(columns * rows) {}

  // Takes every cell of a segment between cells. @return whether one of them was new
  bool take(double column, double row, double to_column, double to_row) {
    const double length = std::max(std::abs(to_column - column), std::abs(to_row - row));
    const auto steps = static_cast<std::size_t>(std::ceil(length));
    bool is_new = false;
    for (std::size_t i = 0; i <= steps; ++i) {
      const double share = steps == 0 ? 0.0 : static_cast<double>(i) / static_cast<double>(steps);
      const auto at_column = static_cast<std::size_t>(column + share * (to_column - column));
      const auto at_row = static_cast<std::size_t>(row + share * (to_row - row));
      auto cell = is_taken_[at_row * columns_ + at_column];
      is_new = is_new || !cell;
      cell = true;
    }
    return is_new;
  }

 private:
  std::size_t columns_;
  std::vector<bool> is_taken_;
};

// Where values lie among `count` cells.
std::vector<double> cell_places(std::span<const double> values, std::size_t count) {
  ValueRange range;
  range.include(values);
  const double width = std::max(range.upper - range.lower, std::numeric_limits<double>::min());
  std::vector<double> places;
  places.reserve(values.size());
  for (const double x : values)
    places.push_back((x - range.lower) / width * (static_cast<double>(count) - 1e-6));
  return places;
}

// The first and the last finite point; empty where there is none.
PlanePath ends_of(const std::vector<double>& x, const std::vector<double>& y) {
  PlanePath ends;
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (!std::isfinite(x[i]) || !std::isfinite(y[i])) continue;
    if (ends.x.empty()) ends = {{x[i], x[i]}, {y[i], y[i]}};
    ends.x.back() = x[i];
    ends.y.back() = y[i];
  }
  return ends;
}

void add_path(FigureScript& script, const std::string& block, const PlanePath& path,
              const AxisScale& x_scale, const AxisScale& y_scale) {
  std::string data;
  for (std::size_t i = 0; i < path.x.size(); ++i) {
    if (std::isfinite(path.x[i]) && std::isfinite(path.y[i])) {
      fmt::format_to(std::back_inserter(data), "{:.8g} {:.8g}\n", as_number(path.x[i], x_scale),
                     as_number(path.y[i], y_scale));
    } else {
      data += '\n';  // an empty line breaks the path
    }
  }
  script.append(block + " << END_OF_DATA\n" + data + "END_OF_DATA\n");
}

}  // namespace

PlanePath visible_path(std::span<const double> x, std::span<const double> y, std::size_t columns,
                       std::size_t rows) {
  if (x.size() != y.size()) {
    throw std::invalid_argument(
        fmt::format("phase plot: {} values against {}", y.size(), x.size()));
  }
  if (columns == 0 || rows == 0) throw std::invalid_argument("phase plot: no cells");
  if (x.size() <= columns) return {{x.begin(), x.end()}, {y.begin(), y.end()}};
  const std::vector<double> column = cell_places(x, columns);
  const std::vector<double> row = cell_places(y, rows);
  const auto is_finite = [&](std::size_t i) {
    return std::isfinite(column[i]) && std::isfinite(row[i]);
  };
  const auto is_same_cell = [&](std::size_t i, std::size_t j) {
    return std::floor(column[i]) == std::floor(column[j]) &&
           std::floor(row[i]) == std::floor(row[j]);
  };
  Cells cells(columns, rows);
  PlanePath path;
  const auto add = [&](double at_x, double at_y) {
    path.x.push_back(at_x);
    path.y.push_back(at_y);
  };
  constexpr double gap = std::numeric_limits<double>::quiet_NaN();
  bool is_pen_down = false;  // the path ends at point `from`
  std::size_t from = 0;
  for (std::size_t i = 1; i < x.size(); ++i) {
    if (!is_finite(from) || !is_finite(i)) {
      is_pen_down = false;
      from = i;
      continue;
    }
    // Slow motion: wait until the cell is left, so that segments reach from cell to cell.
    const bool is_end = i + 1 == x.size() || !is_finite(i + 1);
    if (is_same_cell(from, i) && !is_end) continue;
    if (cells.take(column[from], row[from], column[i], row[i]) || (is_end && is_pen_down)) {
      if (!is_pen_down) {
        if (!path.x.empty()) add(gap, gap);
        add(x[from], y[from]);
      }
      add(x[i], y[i]);
      is_pen_down = true;
    } else {
      is_pen_down = false;
    }
    from = i;
  }
  return path;
}

std::optional<double> samples_per_period(std::span<const double> values) {
  double sum = 0.0;
  std::size_t count = 0;
  for (const double value : values) {
    if (!std::isfinite(value)) continue;
    sum += value;
    ++count;
  }
  if (count == 0) return std::nullopt;
  const double mean = sum / static_cast<double>(count);
  std::size_t passes = 0;
  std::size_t first = 0;
  std::size_t last = 0;
  for (std::size_t i = 1; i < values.size(); ++i) {
    if ((values[i - 1] - mean) * (values[i] - mean) >= 0.0) continue;
    if (passes++ == 0) first = i;
    last = i;
  }
  constexpr std::size_t fewest = 4;
  if (passes < fewest) return std::nullopt;
  return 2.0 * static_cast<double>(last - first) / static_cast<double>(passes - 1);
}

void plot_phase(const PhaseAxis& across, const PhaseAxis& up, const std::string& caption,
                const std::filesystem::path& figure) {
  check_figure_name(figure);
  const PlanePath path = visible_path(across.values, up.values, num_path_columns, num_rows);
  ValueRange x_range;
  ValueRange y_range;
  x_range.include(across.values);
  y_range.include(up.values);
  x_range = x_range.widened(0.04);
  y_range = y_range.widened(0.04);
  const AxisScale x_scale = axis_scale(x_range.lower, x_range.upper, 7);
  const AxisScale y_scale = axis_scale(y_range.lower, y_range.upper, 8);

  // All lengths in cm.
  FigureSize size;
  const double line = line_height(size.font_size);
  const double character = character_width(size.font_size);
  constexpr double plane_height = 8.4;
  std::vector<std::string> y_label = wrapped_label(
      axis_label(up.label, typeset_units(up.units), y_scale), size.font_size, plane_height + 0.5);
  if (y_scale.offset != 0.0) y_label.push_back(offset_text(typeset_units(up.units), y_scale));
  const double left = (static_cast<double>(y_label.size()) + 0.3) * line +
                      (static_cast<double>(tick_characters(y_range, y_scale)) + 1.2) * character;
  const double right = size.width - 0.8;
  const std::string x_label =
      offset_axis_label(across.label, typeset_units(across.units), x_scale);
  const std::vector<std::string> x_lines = wrapped(x_label, size.font_size, right - left + 1.0);
  const std::vector<std::string> lines = wrapped(caption, caption_font, size.width - left - 0.3);
  const double below_axis = (1.7 + static_cast<double>(x_lines.size())) * line;
  const double below = below_axis + caption_height(lines);
  size.height = below + plane_height + 0.5 * line;

  FigureScript script(size);
  add_path(script, "$path", path, x_scale, y_scale);
  const PlanePath ends = ends_of(across.values, up.values);
  add_path(script, "$ends", ends, x_scale, y_scale);
  script.set_margins(left, right, below, below + plane_height);
  script.set_axis('x', x_range, x_scale);
  script.set_axis('y', y_range, y_scale);
  script.add("{}\nunset key", axes_style);
  for (std::size_t i = 0; i < x_lines.size(); ++i) {
    script.add_text(x_lines[i], 0.5 * (left + right), below - (1.9 + static_cast<double>(i)) * line,
                    "center");
  }
  for (std::size_t i = 0; i < y_label.size(); ++i) {
    script.add_text(y_label[i], (0.7 + static_cast<double>(i)) * line, below + 0.5 * plane_height,
                    "center rotate");
  }
  script.add_caption(lines, left, below - below_axis);
  script.append("plot NaN");  // without a point to draw nothing else would be left
  if (!ends.x.empty()) {
    script.append(
        ", $path using 1:2 with lines linewidth 0.8 linecolor '#0b5394', $ends every ::0::0 with "
        "points pointtype 6 pointsize 2.4 linewidth 2.5 linecolor '#e07b00', $ends every ::1::1 "
        "with points pointtype 7 pointsize 2 linecolor '#e07b00'");
  }
  draw_figure(figure, script.text(), size);
}

}  // namespace stridor
