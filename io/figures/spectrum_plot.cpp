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
struct SpectraOfPanel {
  std::vector<Curve> curves;
  ValueRange range;
  AxisScale scale;
  std::vector<std::string> labels;  // of the vertical axis, a line each
  double bottom = 0.0;              // cm
};

void add_data(FigureScript& script, const std::string& block, const Curve& curve,
              const AxisScale& frequency, const SpectraOfPanel& layout) {
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

namespace {

void check_spectra(const std::vector<SpectrumPanel>& panels, const SpectrumPicture& picture) {
  if (panels.empty()) refuse_spectrum("no panels");
  if (!is_positive_number(picture.max_frequency))
    refuse_spectrum("the highest frequency must be positive");
  if (!is_positive_number(picture.range)) refuse_spectrum("the range must be positive");
  for (const SpectrumPanel& panel : panels) {
    if (panel.curves.empty()) refuse_spectrum("a panel without a curve");
    if (!is_positive_number(panel.reference)) refuse_spectrum("the reference must be positive");
  }
}

/// Everything on the page, cm.
struct SpectrumPage {
  FigureSize size;
  double line = 0.0;      ///< height of one of text
  double key_line = 0.0;  ///< of one of the key
  double panel_height = 0.0;
  double left = 0.0, right = 0.0;
  ValueRange frequencies;
  AxisScale frequency;
  std::vector<SpectraOfPanel> panels;
  std::vector<FrequencyMark> marks;                 ///< that are on the axis
  std::vector<MarkGroup> groups;                    ///< of marks with one label
  std::vector<std::pair<double, double>> extents;   ///< of the labels, across
  std::vector<int> rows;                            ///< of the labels, above the first panel
  int num_rows = 0;
  std::vector<std::string> caption;
};

SpectraOfPanel panel_layout(const SpectrumPanel& panel, const SpectrumPicture& picture,
                    const SpectrumPage& page) {
  SpectraOfPanel layout;
  for (const SpectrumCurve& curve : panel.curves)
    layout.curves.push_back(drawn_curve(curve, panel.reference, picture));
  layout.range = value_range(panel, picture);
  layout.scale = axis_scale(layout.range.lower, layout.range.upper, 5);
  const bool is_level = picture.scale == AmplitudeScale::level;
  const std::string label =
      is_level ? level_label(panel.reference, panel.units)
               : axis_label("amplitude", typeset_units(panel.units), layout.scale);
  layout.labels = wrapped_label(label, page.size.font_size, page.panel_height + 0.5);
  return layout;
}

/// Labels of the marks, in as many rows above the first panel as it takes: none is left out.
void place_marks(const SpectrumPicture& picture, SpectrumPage& page) {
  for (const FrequencyMark& mark : picture.marks) {
    if (mark.frequency >= 0.0 && mark.frequency <= picture.max_frequency)
      page.marks.push_back(mark);
  }
  page.groups = grouped(page.marks, 0.02 * picture.max_frequency);
  for (const MarkGroup& group : page.groups) {
    const double width = text_width(group.label, mark_font) + 0.3;
    const double share = 0.5 * (group.lower + group.upper) / picture.max_frequency;
    const double begin =
        std::clamp(page.left + (page.right - page.left) * share - 0.5 * width, page.left,
                   std::max(page.left, page.right - width));
    page.extents.emplace_back(begin, begin + width);
  }
  page.rows = rows_without_overlap(
      page.extents, static_cast<int>(std::max<std::size_t>(1, page.extents.size())));
  page.num_rows =
      page.rows.empty() ? 0 : *std::max_element(page.rows.begin(), page.rows.end()) + 1;
}

SpectrumPage spectrum_page(const std::vector<SpectrumPanel>& panels,
                           const SpectrumPicture& picture) {
  SpectrumPage page;
  page.line = line_height(page.size.font_size);
  page.key_line = line_height(mark_font);
  page.panel_height = panels.size() == 1 ? 6.0 : 4.2;
  std::size_t most_characters = 1;
  std::size_t most_lines = 1;
  for (const SpectrumPanel& panel : panels) {
    const SpectraOfPanel& layout = page.panels.emplace_back(panel_layout(panel, picture, page));
    most_characters = std::max(most_characters, tick_characters(layout.range, layout.scale));
    most_lines = std::max(most_lines, layout.labels.size());
  }
  page.left = (static_cast<double>(most_lines) + 0.45) * page.line +
              (static_cast<double>(most_characters) + 1.2) * character_width(page.size.font_size);
  page.right = page.size.width - 0.8;
  page.frequencies = {0.0, picture.max_frequency};
  page.frequency = frequency_scale(picture.max_frequency, 8);
  place_marks(picture, page);

  page.caption = wrapped(picture.caption, caption_font, page.size.width - page.left - 0.3);
  double height = 2.7 * page.line + caption_height(page.caption);
  for (std::size_t p = panels.size(); p-- > 0;) {
    page.panels[p].bottom = height;
    height += page.panel_height + 0.3 +
              page.key_line * static_cast<double>(panels[p].curves.size()) +
              (p == 0 ? page.key_line * page.num_rows : 0.3);
  }
  page.size.height = height + 0.2;
  return page;
}

/// The key of a panel, a line each above it, and the marks with their labels.
void add_key_and_marks(FigureScript& script, const SpectrumPage& page, std::size_t p) {
  const SpectraOfPanel& layout = page.panels[p];
  const double top = layout.bottom + page.panel_height;
  int arrow = 1;
  script.add("unset arrow");
  for (const FrequencyMark& mark : page.marks) {
    const double x = as_number(mark.frequency, page.frequency);
    script.add(
        "set arrow {} from first {:.9g}, graph 0 to first {:.9g}, graph 1 nohead back "
        "linecolor '#b00020' linewidth 1 dashtype (16,10)",
        arrow++, x, x);
  }
  for (std::size_t c = 0; c < layout.curves.size(); ++c) {
    const double y = top + 0.25 +
                     page.key_line * (static_cast<double>(layout.curves.size() - c) - 0.5) +
                     (p == 0 ? page.key_line * page.num_rows : 0.0);
    script.add(
        "set arrow {} from screen {:.6f}, screen {:.6f} to screen {:.6f}, screen {:.6f} nohead "
        "linecolor '{}' linewidth 2",
        arrow++, script.across(page.left), script.up(y), script.across(page.left + 0.7),
        script.up(y), spectrum_colours[c % spectrum_colours.size()]);
    script.add_text(layout.curves[c].name, page.left + 0.85, y, "left", mark_font);
  }
  if (p > 0) return;
  for (std::size_t g = 0; g < page.groups.size(); ++g) {
    if (page.rows[g] < 0) continue;
    script.add_text(page.groups[g].label,
                    0.5 * (page.extents[g].first + page.extents[g].second),
                    top + 0.15 + page.key_line * (page.rows[g] + 0.5),
                    "center textcolor '#b00020'", mark_font);
  }
}

void add_spectrum_panel(FigureScript& script, const SpectrumPage& page, std::size_t p) {
  const SpectraOfPanel& layout = page.panels[p];
  script.set_margins(page.left, page.right, layout.bottom, layout.bottom + page.panel_height);
  script.set_axis('y', layout.range, layout.scale);
  const bool is_last = p + 1 == page.panels.size();
  if (is_last) {
    script.add_text(axis_label("frequency", "Hz", page.frequency), 0.5 * (page.left + page.right),
                    layout.bottom - 1.9 * page.line, "center");
  }
  script.add("set format x '{}'", is_last ? fmt::format("%.{}f", page.frequency.decimals) : "");
  for (std::size_t i = 0; i < layout.labels.size(); ++i) {
    script.add_text(layout.labels[i], (0.7 + static_cast<double>(i)) * page.line,
                    layout.bottom + 0.5 * page.panel_height, "center rotate");
  }
  add_key_and_marks(script, page, p);
  std::string curves;
  for (std::size_t c = 0; c < layout.curves.size(); ++c) {
    curves += fmt::format("{}$curve_{}_{} using 1:2 with lines linewidth 1 linecolor '{}'",
                          c == 0 ? "" : ", ", p, c, spectrum_colours[c % spectrum_colours.size()]);
  }
  script.add("plot {}\nunset label", curves);
}

}  // namespace

void plot_spectra(const std::vector<SpectrumPanel>& panels, const SpectrumPicture& picture,
                  const std::filesystem::path& figure) {
  check_figure_name(figure);
  check_spectra(panels, picture);
  const SpectrumPage page = spectrum_page(panels, picture);
  FigureScript script(page.size);
  for (std::size_t p = 0; p < panels.size(); ++p) {
    for (std::size_t c = 0; c < page.panels[p].curves.size(); ++c) {
      add_data(script, fmt::format("$curve_{}_{}", p, c), page.panels[p].curves[c], page.frequency,
               page.panels[p]);
    }
  }
  script.add("set multiplot");
  script.add("{}\nunset key", axes_style);
  script.set_axis('x', page.frequencies, page.frequency);
  script.add_caption(page.caption, page.left, page.panels.back().bottom - 2.7 * page.line);
  for (std::size_t p = 0; p < panels.size(); ++p) add_spectrum_panel(script, page, p);
  script.add("unset multiplot");
  draw_figure(figure, script.text(), page.size);
}

}  // namespace stridor
