#include "io/figures/spectrum_plot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <stdexcept>

#include "io/figures/axes.hpp"
#include "io/figures/envelope.hpp"
#include "io/figures/gnuplot.hpp"

namespace stridor {
namespace {

constexpr std::size_t num_spectrum_columns = 2000;
constexpr double mark_font = 11.0;

// Told apart also in grey and by the colour-blind.
constexpr std::array<const char*, 6> spectrum_colours{"#0b5394", "#e07b00", "#38761d",
                                                      "#741b47", "#5b9bd5", "#7f7f7f"};

[[noreturn]] void refuse_spectrum(const std::string& what) {
  throw std::invalid_argument("spectrum plot: " + what);
}

bool is_positive_number(double value) {
  return value > 0.0 && std::isfinite(value);
}

double drawn_value(double amplitude, double reference, AmplitudeScale scale) {
  return scale == AmplitudeScale::level ? decibels(amplitude, reference) : amplitude;
}

// The part up to the end of the axis, as levels or amplitudes, at the resolution of a picture.
Curve drawn_curve(const SpectrumCurve& curve, double reference, const SpectrumPicture& picture) {
  Curve drawn;
  drawn.name = curve.name;
  const Spectrum& spectrum = curve.spectrum;
  for (std::size_t k = 0; k < spectrum.frequencies.size(); ++k) {
    if (spectrum.frequencies[k] > picture.max_frequency) break;
    drawn.times.push_back(spectrum.frequencies[k]);
    drawn.values.push_back(drawn_value(spectrum.amplitude[k], reference, picture.scale));
  }
  return envelope(drawn, num_spectrum_columns);
}

// What the vertical axis shows: not the mean value, which would leave no room for the rest.
ValueRange value_range(const SpectrumPanel& panel, const SpectrumPicture& picture) {
  ValueRange range;
  for (const SpectrumCurve& curve : panel.curves) {
    const Spectrum& spectrum = curve.spectrum;
    for (std::size_t k = picture.mean_lines; k < spectrum.frequencies.size(); ++k) {
      if (spectrum.frequencies[k] > picture.max_frequency) break;
      const double value = drawn_value(spectrum.amplitude[k], panel.reference, picture.scale);
      range.include({&value, 1});
    }
  }
  if (picture.scale == AmplitudeScale::linear)
    return {0.0, range.is_empty() || range.upper <= 0.0 ? 1.0 : 1.05 * range.upper};
  if (!range.is_empty()) range.lower = std::max(range.lower, range.upper - picture.range);
  return range.widened(0.05);
}

// What a panel draws, and the room that it needs.
struct Layout {
  std::vector<Curve> curves;
  ValueRange range;
  AxisScale scale;
  std::vector<std::string> labels;  // of the vertical axis, a line each
  double bottom = 0.0;              // cm
};

void add_data(FigureScript& script, const std::string& block, const Curve& curve,
              const AxisScale& frequency, const Layout& layout) {
  script.add("{} << END_OF_DATA", block);
  std::string text;
  for (std::size_t i = 0; i < curve.times.size(); ++i) {
    // Zero has no level; it is drawn at the lower edge of the diagram, which cuts it off.
    const double value = std::max(curve.values[i], layout.range.lower);
    fmt::format_to(std::back_inserter(text), "{:.9g} {:.7g}\n",
                   as_number(curve.times[i], frequency), as_number(value, layout.scale));
  }
  script.append(text);
  script.add("END_OF_DATA");
}

}  // namespace

std::vector<MarkGroup> grouped(const std::vector<FrequencyMark>& marks, double distance) {
  std::vector<FrequencyMark> sorted = marks;
  std::stable_sort(
      sorted.begin(), sorted.end(),
      [](const FrequencyMark& a, const FrequencyMark& b) { return a.frequency < b.frequency; });
  std::vector<MarkGroup> groups;
  for (const FrequencyMark& mark : sorted) {
    if (groups.empty() || mark.frequency - groups.back().upper >= distance)
      groups.push_back({mark.frequency, mark.frequency, ""});
    groups.back().upper = mark.frequency;
  }
  for (MarkGroup& group : groups) {
    for (const FrequencyMark& mark : marks) {
      if (mark.frequency < group.lower || mark.frequency > group.upper) continue;
      group.label += (group.label.empty() ? "" : ", ") + mark.name;
    }
    const std::string lower = quantity_text(group.lower, "Hz");
    const std::string upper = quantity_text(group.upper, "Hz");
    group.label += ": ";
    if (lower == upper) {
      group.label += lower;
    } else if (lower.substr(lower.find(' ')) == upper.substr(upper.find(' '))) {
      group.label += lower.substr(0, lower.find(' ')) + "–" + upper;
    } else {
      group.label += lower + "–" + upper;
    }
  }
  return groups;
}

void plot_spectra(const std::vector<SpectrumPanel>& panels, const SpectrumPicture& picture,
                  const std::filesystem::path& figure) {
  check_figure_name(figure);
  if (panels.empty()) refuse_spectrum("no panels");
  if (!is_positive_number(picture.max_frequency))
    refuse_spectrum("the highest frequency must be positive");
  if (!is_positive_number(picture.range)) refuse_spectrum("the range must be positive");
  const bool is_level = picture.scale == AmplitudeScale::level;

  FigureSize size;
  const double line = line_height(size.font_size);
  const double key_line = line_height(mark_font);
  const double character = character_width(size.font_size);
  const double panel_height = panels.size() == 1 ? 6.0 : 4.2;

  std::vector<Layout> layouts;
  std::size_t most_characters = 1;
  std::size_t most_lines = 1;
  for (const SpectrumPanel& panel : panels) {
    if (panel.curves.empty()) refuse_spectrum("a panel without a curve");
    if (!is_positive_number(panel.reference)) refuse_spectrum("the reference must be positive");
    Layout layout;
    for (const SpectrumCurve& curve : panel.curves)
      layout.curves.push_back(drawn_curve(curve, panel.reference, picture));
    layout.range = value_range(panel, picture);
    layout.scale = axis_scale(layout.range.lower, layout.range.upper, 5);
    const std::string label =
        is_level ? level_label(panel.reference, panel.units)
                 : axis_label("amplitude", typeset_units(panel.units), layout.scale);
    layout.labels = wrapped_label(label, size.font_size, panel_height + 0.5);
    most_characters = std::max(most_characters, tick_characters(layout.range, layout.scale));
    most_lines = std::max(most_lines, layout.labels.size());
    layouts.push_back(std::move(layout));
  }
  const double left = (static_cast<double>(most_lines) + 0.45) * line +
                      (static_cast<double>(most_characters) + 1.2) * character;
  const double right = size.width - 0.8;
  const ValueRange frequencies{0.0, picture.max_frequency};
  const AxisScale frequency = frequency_scale(picture.max_frequency, 8);

  // Labels of the marks, in rows above the first panel.
  std::vector<FrequencyMark> marks;
  for (const FrequencyMark& mark : picture.marks) {
    if (mark.frequency >= 0.0 && mark.frequency <= picture.max_frequency) marks.push_back(mark);
  }
  const auto place_of_frequency = [&](double hertz) {
    return left + (right - left) * hertz / picture.max_frequency;
  };
  const std::vector<MarkGroup> groups = grouped(marks, 0.02 * picture.max_frequency);
  std::vector<std::pair<double, double>> extents;
  for (const MarkGroup& group : groups) {
    const double width = text_width(group.label, mark_font) + 0.3;
    const double begin =
        std::clamp(place_of_frequency(0.5 * (group.lower + group.upper)) - 0.5 * width, left,
                   std::max(left, right - width));
    extents.emplace_back(begin, begin + width);
  }
  // As many rows as it takes: none is left out.
  const std::vector<int> rows =
      rows_without_overlap(extents, static_cast<int>(std::max<std::size_t>(1, extents.size())));
  const int num_rows = rows.empty() ? 0 : *std::max_element(rows.begin(), rows.end()) + 1;

  const std::vector<std::string> caption =
      wrapped(picture.caption, caption_font, size.width - left - 0.3);
  double height = 2.7 * line + caption_height(caption);
  for (std::size_t p = panels.size(); p-- > 0;) {
    layouts[p].bottom = height;
    height += panel_height + 0.3 + key_line * static_cast<double>(panels[p].curves.size()) +
              (p == 0 ? key_line * num_rows : 0.3);
  }
  size.height = height + 0.2;

  FigureScript script(size);
  for (std::size_t p = 0; p < panels.size(); ++p) {
    for (std::size_t c = 0; c < layouts[p].curves.size(); ++c) {
      add_data(script, fmt::format("$curve_{}_{}", p, c), layouts[p].curves[c], frequency,
               layouts[p]);
    }
  }
  script.add("set multiplot");
  script.add("{}\nunset key", axes_style);
  script.set_axis('x', frequencies, frequency);
  script.add_caption(caption, left, layouts.back().bottom - 2.7 * line);
  for (std::size_t p = 0; p < panels.size(); ++p) {
    const Layout& layout = layouts[p];
    const double top = layout.bottom + panel_height;
    script.set_margins(left, right, layout.bottom, top);
    script.set_axis('y', layout.range, layout.scale);
    const bool is_last = p + 1 == panels.size();
    if (is_last) {
      script.add_text(axis_label("frequency", "Hz", frequency), 0.5 * (left + right),
                      layout.bottom - 1.9 * line, "center");
    }
    script.add("set format x '{}'", is_last ? fmt::format("%.{}f", frequency.decimals) : "");
    for (std::size_t i = 0; i < layout.labels.size(); ++i) {
      script.add_text(layout.labels[i], (0.7 + static_cast<double>(i)) * line,
                      layout.bottom + 0.5 * panel_height, "center rotate");
    }
    int arrow = 1;
    script.add("unset arrow");
    for (const FrequencyMark& mark : marks) {
      const double x = as_number(mark.frequency, frequency);
      script.add(
          "set arrow {} from first {:.9g}, graph 0 to first {:.9g}, graph 1 nohead back "
          "linecolor '#b00020' linewidth 1 dashtype (16,10)",
          arrow++, x, x);
    }
    // The key: a line each above the panel.
    for (std::size_t c = 0; c < layout.curves.size(); ++c) {
      const double y = top + 0.25 +
                       key_line * (static_cast<double>(layout.curves.size() - c) - 0.5) +
                       (p == 0 ? key_line * num_rows : 0.0);
      script.add(
          "set arrow {} from screen {:.6f}, screen {:.6f} to screen {:.6f}, screen {:.6f} nohead "
          "linecolor '{}' linewidth 2",
          arrow++, script.across(left), script.up(y), script.across(left + 0.7), script.up(y),
          spectrum_colours[c % spectrum_colours.size()]);
      script.add_text(layout.curves[c].name, left + 0.85, y, "left", mark_font);
    }
    if (p == 0) {
      for (std::size_t g = 0; g < groups.size(); ++g) {
        if (rows[g] < 0) continue;
        script.add_text(groups[g].label, 0.5 * (extents[g].first + extents[g].second),
                        top + 0.15 + key_line * (rows[g] + 0.5), "center textcolor '#b00020'",
                        mark_font);
      }
    }
    std::string curves;
    for (std::size_t c = 0; c < layout.curves.size(); ++c) {
      curves +=
          fmt::format("{}$curve_{}_{} using 1:2 with lines linewidth 1 linecolor '{}'",
                      c == 0 ? "" : ", ", p, c, spectrum_colours[c % spectrum_colours.size()]);
    }
    script.add("plot {}\nunset label", curves);
  }
  script.add("unset multiplot");
  draw_figure(figure, script.text(), size);
}

}  // namespace stridor
