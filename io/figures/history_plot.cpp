#include "io/figures/history_plot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <stdexcept>

#include "io/figures/axes.hpp"
#include "io/figures/gnuplot.hpp"

namespace stridor {
namespace {

constexpr std::size_t num_history_columns = 2000;

// Blue, and for second curves an orange that stays apart from it in grey and for the colour-blind.
constexpr std::array<const char*, 4> history_colours{"#0b5394", "#e07b00", "#38761d", "#741b47"};

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

void add_band(std::string& script, const std::string& block, const ValueBand& band,
              const AxisScale& time, const AxisScale& value) {
  script += block + " << END_OF_DATA\n";
  auto out = std::back_inserter(script);
  for (std::size_t i = 0; i < band.times.size(); ++i) {
    if (!std::isfinite(band.lower[i]) || !std::isfinite(band.upper[i])) {
      script += "\n";
      continue;
    }
    for (const std::size_t edge : {i == 0 ? i : i - 1, i}) {
      fmt::format_to(out, "{:.9g} {:.7g} {:.7g}\n", as_number(band.times[edge], time),
                     as_number(band.lower[i], value), as_number(band.upper[i], value));
    }
  }
  script += "END_OF_DATA\n";
}

// Commands that shade stretches of time, and those that end it for the next panel.
struct Shading {
  std::string begin;
  std::string end;
};

Shading shading(const Panel& panel, const AxisScale& time, ValueRange shown, double width,
                const FigureSize& size, int first_tag) {
  Shading commands;
  int tag = first_tag;
  for (const TimeMark& mark : panel.marks) {
    const double from = as_number(std::max(mark.from, shown.lower), time);
    const double to = as_number(std::min(mark.to, shown.upper), time);
    if (from > to) continue;
    commands.begin += fmt::format(
        "set object {} rectangle from {:.9g}, graph 0 to {:.9g}, graph 1 behind fillcolor "
        "'#fbe3bd' fillstyle solid noborder\n",
        tag, from, to);
    commands.end += fmt::format("unset object {}\n", tag++);
  }
  for (const TimeLabel& label :
       place_time_labels(panel.marks, shown.lower, shown.upper, width, size.font_size)) {
    commands.begin += fmt::format("set label {} {} at graph {:.6f}, graph 0.92 center front\n", tag,
                                  gnuplot_string(label.text), label.middle / width);
    commands.end += fmt::format("unset label {}\n", tag++);
  }
  return commands;
}

bool has_names(const Panel& panel) {
  return std::any_of(panel.curves.begin(), panel.curves.end(),
                     [](const Curve& c) { return !c.name.empty(); });
}

/// How a panel is laid out; lengths in cm, from the top.
struct PanelLayout {
  ValueRange range;
  AxisScale scale;
  std::vector<std::string> labels;  ///< of the axis, a line each
  std::size_t tick_width = 1;       ///< characters
  double top = 0.0;
};

constexpr double panel_height = 4.2;
constexpr double label_length = panel_height + 0.5;  // may reach a little into the gaps

PanelLayout layout_of(const Panel& panel, const FigureSize& size) {
  PanelLayout layout;
  ValueRange data;
  for (const Curve& curve : panel.curves) data.include(curve.values);
  data.include(panel.band.lower);
  data.include(panel.band.upper);
  for (const NamedValue& named : panel.named_values) data.include({&named.value, 1});
  layout.range = data.widened(0.05);
  if (!panel.marks.empty())  // room for their labels above the curves
    layout.range.upper += 0.15 * (layout.range.upper - layout.range.lower);
  layout.scale = axis_scale(layout.range.lower, layout.range.upper, 5);
  layout.tick_width = tick_characters(layout.range, layout.scale);
  for (const NamedValue& named : panel.named_values)
    layout.tick_width = std::max(layout.tick_width, named.name.size());
  const std::string label =
      panel.named_values.empty() ? axis_label(panel.label, panel.units, layout.scale) : panel.label;
  layout.labels = broken(label, size, label_length);
  if (layout.scale.offset != 0.0) layout.labels.push_back(offset_text(panel.units, layout.scale));
  return layout;
}

std::string y_axis(const Panel& panel, const PanelLayout& layout) {
  const AxisScale& scale = layout.scale;
  std::string ticks = fmt::format("{:.12g} format '%.{}f'", scale.step, scale.decimals);
  if (!panel.named_values.empty()) {
    ticks = "(";
    for (const NamedValue& named : panel.named_values) {
      ticks += fmt::format("{}{} {:.9g}", ticks.size() > 1 ? ", " : "", gnuplot_string(named.name),
                           as_number(named.value, scale));
    }
    ticks += ")";
  }
  return fmt::format("set yrange [{:.12g}:{:.12g}]\nset ytics {}\n",
                     as_number(layout.range.lower, scale), as_number(layout.range.upper, scale),
                     ticks);
}

/// Title, labels and key of a panel.
std::string texts(const Panel& panel, const PanelLayout& layout, const FigureSize& size,
                  std::size_t num_lines) {
  const double line = line_height(size.font_size);
  // Labels instead of gnuplot's own title and ylabel, which move about with the tick marks.
  const double above = 1.0 + 0.65 * line / panel_height;
  const double title_room = size.width - 4.0;
  const double title_font =
      size.font_size *
      std::min(1.0, title_room / std::max(text_width(panel.title, size.font_size), 0.1));
  std::string commands =
      fmt::format("set label 1 {} at graph 0, graph {:.4f} left font ',{:.2f}'\n",
                  gnuplot_string(panel.title), above, title_font);
  for (std::size_t i = 0; i < num_lines; ++i) {
    const std::string text = i < layout.labels.size() ? layout.labels[i] : "";
    const double font =
        size.font_size *
        std::min(1.0, label_length / std::max(text_width(text, size.font_size), 0.1));
    commands += fmt::format(
        "set label {} {} at screen {:.6f}, graph 0.5 center rotate font ',{:.2f}'\n", i + 2,
        gnuplot_string(text), (0.7 + static_cast<double>(i)) * line / size.width, font);
  }
  return commands +
         (has_names(panel)
              ? fmt::format(
                    "set key at graph 1, graph {:.4f} right center horizontal samplen 1.5\n", above)
              : std::string("unset key\n"));
}

/// The curves of panel number p as arguments of `plot`; their data are added to `data_blocks`.
std::string curves_of(const Panel& panel, const PanelLayout& layout, const AxisScale& time,
                      std::size_t p, std::string& data_blocks) {
  std::string curves;
  const ValueBand band = thinned(panel.band, num_history_columns);
  if (!band.times.empty()) {
    const std::string block = fmt::format("$band_{}", p);
    add_band(data_blocks, block, band, time, layout.scale);
    curves += block +
              " using 1:2:3 with filledcurves fillcolor '#9fc5e8' fillstyle solid "
              "noborder notitle, ";
  }
  for (std::size_t c = 0; c < panel.curves.size(); ++c) {
    const char* colour = history_colours[c % history_colours.size()];
    const Curve drawn = envelope(panel.curves[c], num_history_columns);
    if (std::any_of(drawn.values.begin(), drawn.values.end(),
                    [](double x) { return std::isfinite(x); })) {
      const std::string block = fmt::format("$panel_{}_{}", p, c);
      add_data(data_blocks, block, drawn, time, layout.scale);
      curves += fmt::format("{} using 1:2 with {} linewidth 1 linecolor '{}' notitle, ", block,
                            panel.named_values.empty() ? "lines" : "steps", colour);
    }
    // The key shows a thicker line than the curve; also keeps a panel without data from being an
    // error.
    curves += fmt::format(
        "NaN with lines linewidth 3 linecolor '{}' {}", colour,
        panel.curves[c].name.empty() ? "notitle" : "title " + gnuplot_string(panel.curves[c].name));
    if (c + 1 < panel.curves.size()) curves += ", ";
  }
  return curves;
}

/// Times of all curves; checks the panels.
ValueRange shown_times(const std::vector<Panel>& panels) {
  if (panels.empty()) throw std::invalid_argument("history plot: no panels");
  if (panels.size() > most_panels) {
    throw std::invalid_argument(fmt::format("history plot: {} panels, at most {} fit one picture",
                                            panels.size(), most_panels));
  }
  ValueRange range;
  for (const Panel& panel : panels) {
    if (panel.curves.empty()) throw std::invalid_argument("history plot: a panel without a curve");
    for (const Curve& curve : panel.curves) {
      check_curve(curve);
      range.include(curve.times);
    }
    check_band(panel.band);
  }
  return range.widened(0.0);
}

/// The panels below each other, from a height on that is counted from the top, cm.
std::vector<PanelLayout> stacked(const std::vector<Panel>& panels, const FigureSize& size,
                                 double height) {
  const double line = line_height(size.font_size);
  std::vector<PanelLayout> layouts;
  for (const Panel& panel : panels) {
    layouts.push_back(layout_of(panel, size));
    height += panel.title.empty() && !has_names(panel) ? 0.5 * line : 1.5 * line;
    layouts.back().top = height;
    height += panel_height;
  }
  return layouts;
}

/// The lines of a caption at the foot of a picture.
std::string caption_labels(const std::vector<std::string>& lines, double left,
                           const FigureSize& size) {
  std::string labels;
  const double top = caption_height(lines) - 0.1;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    labels += fmt::format(
        "set label {} {} at screen {:.6f}, screen {:.6f} left font ',{:g}'\n", 10000 + i,
        gnuplot_string(lines[i]), left / size.width,
        (top - (static_cast<double>(i) + 0.5) * line_height(caption_font)) / size.height,
        caption_font);
  }
  return labels;
}

}  // namespace

std::vector<TimeLabel> place_time_labels(const std::vector<TimeMark>& marks, double from, double to,
                                         double width, double font_size) {
  struct Group {
    double left, right;  // cm, of the label
    std::string first, last;
    std::string text() const { return first == last ? first : first + "\u2013" + last; }
  };
  std::vector<Group> groups;
  const double gap = 0.1;
  const auto extend = [&](Group& group, double middle) {
    const double half = 0.5 * text_width(group.text(), font_size) + gap;
    group.left = middle - half;
    group.right = middle + half;
  };
  std::vector<TimeMark> shown;
  for (const TimeMark& mark : marks)
    if (mark.from <= to && mark.to >= from && !mark.label.empty()) shown.push_back(mark);
  std::stable_sort(shown.begin(), shown.end(), [](const TimeMark& a, const TimeMark& b) {
    return a.from + a.to < b.from + b.to;
  });
  for (const TimeMark& mark : shown) {
    const double middle =
        (0.5 * (std::max(mark.from, from) + std::min(mark.to, to)) - from) / (to - from) * width;
    Group group{0.0, 0.0, mark.label, mark.label};
    extend(group, middle);
    while (!groups.empty() && groups.back().right > group.left) {
      const double joint = 0.5 * (groups.back().left + group.right);
      group.first = groups.back().first;
      extend(group, joint);
      groups.pop_back();
    }
    groups.push_back(group);
  }
  std::vector<TimeLabel> labels;
  for (const Group& group : groups)
    labels.push_back({0.5 * (group.left + group.right), group.text()});
  return labels;
}

void plot_histories(const std::vector<Panel>& panels, const std::filesystem::path& figure,
                    const std::string& title, const std::string& caption) {
  check_figure_name(figure);
  const ValueRange time_range = shown_times(panels);
  const AxisScale time = axis_scale(time_range.lower, time_range.upper, 6);

  // All lengths in cm, from the top.
  FigureSize size;
  const double line = line_height(size.font_size);
  const std::vector<PanelLayout> layouts =
      stacked(panels, size, 0.3 + (title.empty() ? 0.0 : 1.3 * line));
  std::size_t widest = 1;
  std::size_t num_lines = 1;
  for (const PanelLayout& layout : layouts) {
    widest = std::max(widest, layout.tick_width);
    num_lines = std::max(num_lines, layout.labels.size());
  }
  // A character is 0.64 of the font size wide.
  const double left = (0.64 * static_cast<double>(widest) + 1.2) * size.font_size * 2.54 / 72.0 +
                      (static_cast<double>(num_lines) + 0.3) * line;
  const double right = size.width - 0.8;
  const std::vector<std::string> lines = wrapped(caption, caption_font, size.width - left - 0.3);
  const double axis_height = 3.3 * line;
  const double room_below = caption_height(lines);
  const double height = layouts.back().top + panel_height + (axis_height + room_below);
  size.height = height;

  std::string data_blocks;
  std::string plots;
  for (std::size_t p = 0; p < panels.size(); ++p) {
    const PanelLayout& layout = layouts[p];
    const bool is_last = p + 1 == panels.size();
    plots += fmt::format("set tmargin at screen {:.6f}\nset bmargin at screen {:.6f}\n",
                         1.0 - layout.top / height, 1.0 - (layout.top + panel_height) / height);
    plots += y_axis(panels[p], layout);
    plots += fmt::format("set xtics {:.12g} format '{}'\n", time.step,
                         is_last ? fmt::format("%.{}f", time.decimals) : std::string());
    plots += fmt::format("set xlabel {}\n",
                         gnuplot_string(is_last ? axis_label("time", "s", time) : ""));
    plots += texts(panels[p], layout, size, num_lines);
    const Shading shaded =
        shading(panels[p], time, time_range, right - left, size, static_cast<int>(num_lines) + 2);
    // Drawn once, with the last panel.
    if (is_last) plots += caption_labels(lines, left, size);
    plots += shaded.begin + "plot " + curves_of(panels[p], layout, time, p, data_blocks) + "\n" +
             shaded.end;
  }

  std::string script = data_blocks;
  script += fmt::format("set multiplot title {}\n", gnuplot_string(title));
  script += fmt::format("set lmargin at screen {:.6f}\nset rmargin at screen {:.6f}\n",
                        left / size.width, right / size.width);
  script += fmt::format("set xrange [{:.12g}:{:.12g}]\n", as_number(time_range.lower, time),
                        as_number(time_range.upper, time));
  script += axes_style;
  script += "\n" + plots + "unset multiplot\n";
  draw_figure(figure, script, size);
}

}  // namespace stridor
