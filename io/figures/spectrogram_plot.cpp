#include "io/figures/spectrogram_plot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <stdexcept>

#include "analysis/statistics.hpp"
#include "io/figures/amplitude_raster.hpp"
#include "io/figures/axes.hpp"
#include "io/figures/gnuplot.hpp"

namespace stridor {
namespace {

// Cells of the raster along an axis: 1000 × 600 are finer than print, and four to each piece and
// line show their edges where they should be.
Eigen::Index raster_cells(std::size_t sources, Eigen::Index most) {
  return std::clamp(4 * static_cast<Eigen::Index>(sources), most / 5, most);
}

// Viridis at equal steps: lightness rises evenly, also for the colour-blind and in grey.
constexpr std::array<const char*, 9> viridis{"#440154", "#472d7b", "#3b528b", "#2c728e", "#21918c",
                                             "#28ae80", "#5ec962", "#addc30", "#fde725"};

[[noreturn]] void refuse_spectrogram(const std::string& what) {
  throw std::invalid_argument("spectrogram plot: " + what);
}

bool is_positive(double value) {
  return value > 0.0 && std::isfinite(value);
}

// " Without room for the whole label: 3: 3.5 kHz."; empty where every mark has its whole label.
std::string unlabelled_text(const std::vector<SpectrogramPanel>& panels,
                            const std::vector<MapArea>& maps) {
  std::string names;
  for (std::size_t i = 0; i < panels.size(); ++i) {
    for (const MarkPlace& place : place_marks(panels[i].marks, maps[i])) {
      const std::string& label = panels[i].marks[place.mark].label;
      // A number alone does not say the frequency.
      if (!label.empty() && place.text != label) names += (names.empty() ? "" : ", ") + label;
    }
  }
  return names.empty() ? "" : " Without room for the whole label: " + names + ".";
}

// Tenths of a dB above the lowest colour, a row per frequency.
std::string map_data(const Eigen::MatrixXd& amplitude, double lowest_level, double range,
                     double reference) {
  std::string text;
  auto out = std::back_inserter(text);
  for (Eigen::Index row = 0; row < amplitude.rows(); ++row) {
    for (Eigen::Index column = 0; column < amplitude.cols(); ++column) {
      const double above = decibels(amplitude(row, column), reference) - lowest_level;
      fmt::format_to(out, "{} ", std::lround(10.0 * std::clamp(above, 0.0, range)));
    }
    text += '\n';
  }
  return text;
}

void add_marks(FigureScript& script, const std::vector<SpectrogramMark>& marks, const MapArea& map,
               double left, double bottom) {
  int object = 1;
  int arrow = 1;
  const auto corners = [&](const PictureBox& box) {
    return fmt::format("from screen {:.6f}, screen {:.6f} to screen {:.6f}, screen {:.6f}",
                       script.across(left + box.left), script.up(bottom + box.bottom),
                       script.across(left + box.right), script.up(bottom + box.top));
  };
  for (const MarkPlace& place : place_marks(marks, map)) {
    const SpectrogramMark& mark = marks[place.mark];
    const bool is_found = mark.style == MarkStyle::found;
    const char* colour = is_found ? "#ffffff" : "#ff5a36";
    // A dark line below keeps a light one visible on light colours.
    script.add(
        "set object {} rectangle {} front fillstyle empty border linecolor '#a0000000' linewidth 2",
        object++, corners(place.box));
    script.add(
        "set object {} rectangle {} front fillstyle empty border linecolor '{}' linewidth 1.2 "
        "dashtype {}",
        object++, corners(place.box), colour, is_found ? "(22,12)" : "(6,9)");
    if (!place.label) continue;
    const PictureBox& at = *place.label;
    if (place.leader) {
      script.add("set arrow {} {} nohead front linecolor '{}' linewidth 0.8", arrow++,
                 corners(*place.leader), colour);
    }
    script.add(
        "set object {} rectangle {} front fillcolor '#ffffff' fillstyle transparent solid 0.85 "
        "noborder",
        object++, corners(at));
    script.add_text(
        place.text, left + 0.5 * (at.left + at.right), bottom + 0.5 * (at.bottom + at.top),
        is_found ? "center front textcolor '#000000'" : "center front textcolor '#a02000'",
        map.font_size);
  }
}

void check_spectrograms(const std::vector<SpectrogramPanel>& panels,
                        const SpectrogramPicture& picture) {
  if (panels.empty()) refuse_spectrogram("there is no spectrogram to draw");
  if (!is_positive(picture.max_frequency))
    refuse_spectrogram("the highest frequency must be positive");
  if (!is_positive(picture.reference)) refuse_spectrogram("the reference must be positive");
  if (!is_positive(picture.range)) refuse_spectrogram("the range must be positive");
}

/// The levels that the colours span, dB.
struct LevelRange {
  double lowest = 0.0;
  double highest = 0.0;
};

LevelRange level_range(const std::vector<SpectrogramPanel>& panels,
                       const SpectrogramPicture& picture) {
  double highest = 0.0;
  for (const SpectrogramPanel& panel : panels) {
    highest = std::max(
        highest, highest_amplitude(*panel.spectrogram, picture.max_frequency, picture.mean_lines));
  }
  if (highest <= 0.0) highest = picture.reference;  // all zero: the lowest colour everywhere
  const double highest_level = decibels(highest, picture.reference);
  return {highest_level - picture.range, highest_level};
}

/// Places on the page, cm from its lower left corner.
struct SpectrogramLayout {
  FigureSize size;
  AxisScale frequency;
  double left = 0.0;   ///< of the maps
  double right = 0.0;  ///< likewise
  double above = 0.0;  ///< room above each map
  double below = 0.0;  ///< lower edge of the last one
  std::vector<MapArea> maps;
  std::vector<std::string> caption;

  double line() const { return line_height(size.font_size); }
  double map_height() const { return maps.front().height; }
  /// Lower edge of a map.
  double bottom(std::size_t map) const {
    return below + static_cast<double>(maps.size() - 1 - map) * (above + map_height());
  }
};

constexpr double level_bar_width = 0.45;  // cm

SpectrogramLayout spectrogram_layout(const std::vector<SpectrogramPanel>& panels,
                                     const SpectrogramPicture& picture) {
  const bool is_stack = panels.size() > 1;
  SpectrogramLayout layout;
  layout.frequency = frequency_scale(picture.max_frequency, is_stack ? 4 : 8);
  const double line = layout.line();
  const double character = character_width(layout.size.font_size);
  const double frequency_digits =
      static_cast<double>(fmt::format("{:.{}f}", as_number(picture.max_frequency, layout.frequency),
                                      layout.frequency.decimals)
                              .size());
  layout.left = 1.5 * line + (frequency_digits + 1.3) * character;
  layout.right = layout.size.width - (0.35 + level_bar_width + 5.2 * character + 1.3 * line);
  const bool has_titles = std::any_of(panels.begin(), panels.end(),
                                      [](const auto& panel) { return !panel.title.empty(); });
  layout.above = has_titles ? 1.6 * line : 0.5 * line;
  for (const SpectrogramPanel& panel : panels) {
    const ValueRange times = times_of(*panel.spectrogram);
    MapArea map;
    map.width = layout.right - layout.left;
    map.height = is_stack ? 3.6 : 7.2;
    map.from = times.lower;
    map.to = times.upper;
    map.max_frequency = picture.max_frequency;
    layout.maps.push_back(map);
  }
  layout.caption = wrapped(picture.caption + unlabelled_text(panels, layout.maps), caption_font,
                           layout.size.width - layout.left - 0.3);
  layout.below = 2.7 * line + caption_height(layout.caption);
  const double pitch = layout.above + layout.map_height();
  layout.size.height = static_cast<double>(panels.size()) * pitch + layout.below;
  return layout;
}

/// The bar of colours beside the first map, and the labels of the axes that all maps share.
void add_common_labels(FigureScript& script, const SpectrogramPicture& picture,
                       const SpectrogramLayout& layout) {
  const double line = layout.line();
  script.set_colour_bar(layout.right + 0.35, layout.bottom(0), level_bar_width,
                        layout.map_height());
  const double middle = layout.below + 0.5 * (layout.size.height - layout.above - layout.below);
  script.add_text(axis_label("frequency", "Hz", layout.frequency), 0.7 * line, middle,
                  "center rotate");
  script.add_text(level_label(picture.reference, picture.units), layout.size.width - 0.7 * line,
                  middle, "center rotate");
}

/// Draws one of the spectrograms with its marks.
/// @param i of the panels; the first has what is common to all, the last the axis of time
void add_spectrogram(FigureScript& script, const std::vector<SpectrogramPanel>& panels,
                     std::size_t i, const SpectrogramPicture& picture,
                     const SpectrogramLayout& layout, const LevelRange& levels) {
  const SpectrogramPanel& panel = panels[i];
  const Spectrogram& spectrogram = *panel.spectrogram;
  const AxisScale& frequency = layout.frequency;
  const bool is_last = i + 1 == panels.size();
  const double line = layout.line();
  const double bottom = layout.bottom(i);
  const double top = bottom + layout.map_height();
  const auto num_lines = static_cast<std::size_t>(
      std::count_if(spectrogram.frequencies.begin(), spectrogram.frequencies.end(),
                    [&](double one) { return one <= picture.max_frequency; }));
  const AmplitudeRaster raster =
      rasterise(spectrogram, picture.max_frequency, raster_cells(num_lines, 600),
                raster_cells(spectrogram.times.size(), 1000));
  const AxisScale time = axis_scale(raster.from, raster.to, 6);
  script.append(fmt::format("$map{} << END_OF_DATA\n", i) +
                map_data(raster.amplitude, levels.lowest, picture.range, picture.reference) +
                "END_OF_DATA\n");
  script.set_margins(layout.left, layout.right, bottom, top);
  script.set_axis('x', {raster.from, raster.to}, time);
  if (!is_last) script.add("set xtics format ''");
  script.set_axis('y', {0.0, picture.max_frequency}, frequency);
  // Texts instead of gnuplot's own labels, which move about with the tick marks.
  script.add_text(panel.title, layout.left, top + 0.65 * line, "left");
  if (i == 0) {
    add_common_labels(script, picture, layout);
  } else {
    script.add("unset colorbox");
  }
  if (is_last) {
    script.add_text(axis_label("time", "s", time), 0.5 * (layout.left + layout.right),
                    layout.below - 1.9 * line, "center");
    script.add_caption(layout.caption, layout.left, layout.below - 2.7 * line);
  }
  add_marks(script, panel.marks, layout.maps[i], layout.left, bottom);
  const double cell_time = (raster.to - raster.from) /
                           static_cast<double>(raster.amplitude.cols()) /
                           std::pow(10.0, time.exponent);
  const double cell_frequency = raster.max_frequency /
                                static_cast<double>(raster.amplitude.rows()) /
                                std::pow(10.0, frequency.exponent);
  script.add(
      "plot $map{} matrix using ({:.12g} + ($1 + 0.5) * {:.12g}):(($2 + 0.5) * {:.12g}):({:.12g} "
      "+ 0.1 * $3) with image notitle",
      i, as_number(raster.from, time), cell_time, cell_frequency, levels.lowest);
}

}  // namespace

double highest_amplitude(const Spectrogram& spectrogram, double max_frequency,
                         std::size_t mean_lines) {
  double highest = 0.0;
  double highest_mean = 0.0;
  for (std::size_t k = 0; k < spectrogram.frequencies.size(); ++k) {
    if (spectrogram.frequencies[k] > max_frequency) break;
    double& largest = k < mean_lines ? highest_mean : highest;
    largest = std::max(largest, spectrogram.amplitude.row(static_cast<Eigen::Index>(k)).maxCoeff());
  }
  return highest > 0.0 ? highest : highest_mean;
}

void plot_spectrogram(const Spectrogram& spectrogram, const SpectrogramPicture& picture,
                      const std::filesystem::path& figure) {
  plot_spectrograms({{picture.title, &spectrogram, picture.marks}}, picture, figure);
}

void plot_spectrograms(const std::vector<SpectrogramPanel>& panels,
                       const SpectrogramPicture& picture, const std::filesystem::path& figure) {
  check_figure_name(figure);
  check_spectrograms(panels, picture);
  const LevelRange levels = level_range(panels, picture);
  const SpectrogramLayout layout = spectrogram_layout(panels, picture);
  const AxisScale level = axis_scale(levels.lowest, levels.highest, 6);

  FigureScript script(layout.size);
  script.set_palette(viridis);
  script.add("set cbrange [{:.12g}:{:.12g}]\nset cbtics {:.12g} format '%.{}f' scale 0.6",
             levels.lowest, levels.highest, level.step, level.decimals);
  script.add("{}", map_style);
  const bool is_stack = panels.size() > 1;
  if (is_stack) script.add("set multiplot");
  for (std::size_t i = 0; i < panels.size(); ++i) {
    if (i > 0) script.add("unset label\nunset object\nunset arrow");
    add_spectrogram(script, panels, i, picture, layout, levels);
  }
  if (is_stack) script.add("unset multiplot");
  draw_figure(figure, script.text(), layout.size);
}

}  // namespace stridor
