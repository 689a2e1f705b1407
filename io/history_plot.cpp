#include "io/history_plot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <stdexcept>

#include "io/axes.hpp"
#include "io/gnuplot.hpp"

namespace stridor {
namespace {

constexpr std::size_t num_columns = 2000;

// Blue, and for second curves an orange that stays apart from it in grey and for the colour-blind.
constexpr std::array<const char*, 4> colours{"#0b5394", "#e07b00", "#38761d", "#741b47"};

// A text that is too long for a panel in two lines, broken near the middle.
std::vector<std::string> broken(const std::string& text, FigureSize size, double length) {
  if (text_width(text, size.font_size) <= length) return {text};
  const auto middle = static_cast<std::ptrdiff_t>(text.size() / 2);
  const auto distance = [middle](std::size_t at) {
    return std::abs(static_cast<std::ptrdiff_t>(at) - middle);
  };
  std::size_t best = 0;
  for (std::size_t i = 1; i + 1 < text.size(); ++i) {
    if (text[i - 1] != ' ' && text[i - 1] != '.') continue;
    if (best == 0 || distance(i) < distance(best)) best = i;
  }
  if (best == 0) return {text};
  return {text.substr(0, best), text.substr(best)};
}

void add_data(std::string& script, const std::string& block, const Curve& curve,
              const AxisScale& time, const AxisScale& value) {
  script += block + " << END_OF_DATA\n";
  auto out = std::back_inserter(script);
  for (std::size_t i = 0; i < curve.times.size(); ++i) {
    if (std::isfinite(curve.values[i])) {
      fmt::format_to(out, "{:.9g} {:.7g}\n", as_number(curve.times[i], time),
                     as_number(curve.values[i], value));
    } else {
      script += "\n";  // an empty line breaks the curve
    }
  }
  script += "END_OF_DATA\n";
}

// Commands that shade stretches of time, and those that end it for the next panel.
struct Shading {
  std::string begin;
  std::string end;
};

Shading shading(const std::vector<TimeMark>& marks, const AxisScale& time, ValueRange shown,
                int first_tag) {
  Shading commands;
  int tag = first_tag;
  for (const TimeMark& mark : marks) {
    const double from = as_number(std::max(mark.from, shown.lower), time);
    const double to = as_number(std::min(mark.to, shown.upper), time);
    if (from > to) continue;
    commands.begin += fmt::format(
        "set object {} rectangle from {:.9g}, graph 0 to {:.9g}, graph 1 behind fillcolor "
        "'#fbe3bd' fillstyle solid noborder\n"
        "set label {} {} at {:.9g}, graph 0.92 center front\n",
        tag, from, to, tag, gnuplot_string(mark.label), 0.5 * (from + to));
    commands.end += fmt::format("unset object {}\nunset label {}\n", tag, tag);
    ++tag;
  }
  return commands;
}

bool has_names(const Panel& panel) {
  return std::any_of(panel.curves.begin(), panel.curves.end(),
                     [](const Curve& c) { return !c.name.empty(); });
}

void check(const Curve& curve) {
  if (curve.times.size() != curve.values.size()) {
    throw std::invalid_argument(fmt::format("history plot: {} times for {} values",
                                            curve.times.size(), curve.values.size()));
  }
  const auto descends = [](double a, double b) { return !(a <= b); };
  if (std::adjacent_find(curve.times.begin(), curve.times.end(), descends) != curve.times.end()) {
    throw std::invalid_argument("history plot: the times do not ascend");
  }
}

}  // namespace

Curve envelope(const Curve& curve, std::size_t columns) {
  check(curve);
  if (columns == 0)
    throw std::invalid_argument("history plot: an envelope needs at least one column");
  const std::size_t count = curve.times.size();
  if (count <= 2 * columns) return curve;
  Curve reduced;
  reduced.name = curve.name;
  const double first = curve.times.front();
  const double width = (curve.times.back() - first) / static_cast<double>(columns);
  const auto add = [&](std::size_t i) {
    reduced.times.push_back(curve.times[i]);
    reduced.values.push_back(curve.values[i]);
  };
  for (std::size_t begin = 0, column = 1; begin < count; ++column) {
    const double limit = column >= columns ? std::numeric_limits<double>::infinity()
                                           : first + width * static_cast<double>(column);
    std::size_t lowest = count;
    std::size_t highest = count;
    std::size_t i = begin;
    for (; i < count && curve.times[i] < limit; ++i) {
      if (!std::isfinite(curve.values[i])) continue;
      if (lowest == count || curve.values[i] < curve.values[lowest]) lowest = i;
      if (highest == count || curve.values[i] > curve.values[highest]) highest = i;
    }
    if (lowest != count) {
      add(std::min(lowest, highest));
      if (lowest != highest) add(std::max(lowest, highest));
    } else if (i > begin) {
      reduced.times.push_back(curve.times[begin]);
      reduced.values.push_back(std::numeric_limits<double>::quiet_NaN());
    }
    begin = i;
  }
  return reduced;
}

void plot_histories(const std::vector<Panel>& panels, const std::filesystem::path& figure,
                    const std::string& title) {
  check_figure_name(figure);
  if (panels.empty()) throw std::invalid_argument("history plot: no panels");
  ValueRange time_range;
  for (const Panel& panel : panels) {
    if (panel.curves.empty()) throw std::invalid_argument("history plot: a panel without a curve");
    for (const Curve& curve : panel.curves) {
      check(curve);
      time_range.include(curve.times);
    }
  }
  time_range = time_range.widened(0.0);
  const AxisScale time = axis_scale(time_range.lower, time_range.upper, 6);

  // All lengths in cm, from the top.
  FigureSize size;
  const double line = line_height(size.font_size);
  constexpr double panel_height = 4.2;
  constexpr double label_length = panel_height + 0.5;  // may reach a little into the gaps
  double height = 0.3 + (title.empty() ? 0.0 : 1.3 * line);
  std::vector<AxisScale> scales;
  std::vector<ValueRange> ranges;
  std::vector<double> tops;
  std::size_t widest = 1;
  std::vector<std::vector<std::string>> labels;
  std::size_t num_lines = 1;
  for (const Panel& panel : panels) {
    ValueRange data;
    for (const Curve& curve : panel.curves) data.include(curve.values);
    ranges.push_back(data.widened(0.05));
    if (!panel.marks.empty())  // room for their labels above the curves
      ranges.back().upper += 0.15 * (ranges.back().upper - ranges.back().lower);
    scales.push_back(axis_scale(ranges.back().lower, ranges.back().upper, 5));
    widest = std::max(widest, tick_characters(ranges.back(), scales.back()));
    labels.push_back(
        broken(axis_label(panel.label, panel.units, scales.back()), size, label_length));
    if (scales.back().offset != 0.0)
      labels.back().push_back(offset_text(panel.units, scales.back()));
    num_lines = std::max(num_lines, labels.back().size());
    height += panel.title.empty() && !has_names(panel) ? 0.5 * line : 1.5 * line;
    tops.push_back(height);
    height += panel_height;
  }
  height += 3.3 * line;
  size.height = height;
  // A character is 0.64 of the font size wide.
  const double left = (0.64 * static_cast<double>(widest) + 1.2) * size.font_size * 2.54 / 72.0 +
                      (static_cast<double>(num_lines) + 0.3) * line;

  std::string data_blocks;
  std::string plots;
  for (std::size_t p = 0; p < panels.size(); ++p) {
    const Panel& panel = panels[p];
    const AxisScale& scale = scales[p];
    const bool is_last = p + 1 == panels.size();
    plots += fmt::format("set tmargin at screen {:.6f}\nset bmargin at screen {:.6f}\n",
                         1.0 - tops[p] / height, 1.0 - (tops[p] + panel_height) / height);
    plots += fmt::format("set yrange [{:.12g}:{:.12g}]\nset ytics {:.12g} format '%.{}f'\n",
                         as_number(ranges[p].lower, scale), as_number(ranges[p].upper, scale),
                         scale.step, scale.decimals);
    plots += fmt::format("set xtics {:.12g} format '{}'\n", time.step,
                         is_last ? fmt::format("%.{}f", time.decimals) : std::string());
    plots += fmt::format("set xlabel {}\n",
                         gnuplot_string(is_last ? axis_label("time", "s", time) : ""));
    // Labels instead of gnuplot's own title and ylabel, which move about with the tick marks.
    const double above = 1.0 + 0.65 * line / panel_height;
    plots += fmt::format("set label 1 {} at graph 0, graph {:.4f} left\n",
                         gnuplot_string(panel.title), above);
    for (std::size_t i = 0; i < num_lines; ++i) {
      const std::string text = i < labels[p].size() ? labels[p][i] : "";
      const double font =
          size.font_size *
          std::min(1.0, label_length / std::max(text_width(text, size.font_size), 0.1));
      plots += fmt::format(
          "set label {} {} at screen {:.6f}, graph 0.5 center rotate font ',{:.2f}'\n", i + 2,
          gnuplot_string(text), (0.7 + static_cast<double>(i)) * line / size.width, font);
    }
    plots +=
        has_names(panel)
            ? fmt::format("set key at graph 1, graph {:.4f} right center horizontal samplen 1.5\n",
                          above)
            : std::string("unset key\n");
    std::string curves;
    for (std::size_t c = 0; c < panel.curves.size(); ++c) {
      const char* colour = colours[c % colours.size()];
      const Curve drawn = envelope(panel.curves[c], num_columns);
      if (std::any_of(drawn.values.begin(), drawn.values.end(),
                      [](double x) { return std::isfinite(x); })) {
        const std::string block = fmt::format("$panel_{}_{}", p, c);
        add_data(data_blocks, block, drawn, time, scale);
        curves += fmt::format("{} using 1:2 with lines linewidth 1 linecolor '{}' notitle, ", block,
                              colour);
      }
      // The key shows a thicker line than the curve; also keeps a panel without data from being an
      // error.
      curves += fmt::format("NaN with lines linewidth 3 linecolor '{}' {}", colour,
                            panel.curves[c].name.empty()
                                ? "notitle"
                                : "title " + gnuplot_string(panel.curves[c].name));
      if (c + 1 < panel.curves.size()) curves += ", ";
    }
    const Shading shaded = shading(panel.marks, time, time_range, static_cast<int>(num_lines) + 2);
    plots += shaded.begin + "plot " + curves + "\n" + shaded.end;
  }

  std::string script = data_blocks;
  script += fmt::format("set multiplot title {}\n", gnuplot_string(title));
  script += fmt::format("set lmargin at screen {:.6f}\nset rmargin at screen {:.6f}\n",
                        left / size.width, 1.0 - 0.8 / size.width);
  script += fmt::format("set xrange [{:.12g}:{:.12g}]\n", as_number(time_range.lower, time),
                        as_number(time_range.upper, time));
  script +=
      "set minussign\nset border 3 linecolor '#404040'\nset tics nomirror out scale 0.6\n"
      "set grid linetype 1 linecolor '#d0d0d0' linewidth 0.5\n";
  script += plots + "unset multiplot\n";
  draw_figure(figure, script, size);
}

}  // namespace stridor
