#include "io/figures/spectrogram_plot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <stdexcept>

#include "analysis/statistics.hpp"
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

// From the beginning of the first piece to the end of the last one.
ValueRange times_of(const Spectrogram& spectrogram) {
  if (spectrogram.times.empty() || spectrogram.frequencies.size() < 2)
    refuse_spectrogram("a spectrogram without a column or with a single line");
  const double half_piece = 0.5 / spectrogram.frequencies[1];
  return {spectrogram.times.front() - half_piece, spectrogram.times.back() + half_piece};
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

// The sources that each cell of an axis touches. Source k reaches from edges[k] to edges[k+1].
std::vector<IndexRange> touched(const std::vector<double>& edges, double from, double to,
                                Eigen::Index cells) {
  const std::size_t count = edges.size() - 1;
  const double width = (to - from) / static_cast<double>(cells);
  const double rounding = 1e-9 * width;  // an edge upon an edge touches nothing
  std::vector<IndexRange> ranges;
  std::size_t begin = 0;
  for (Eigen::Index cell = 0; cell < cells; ++cell) {
    const double lower = from + width * static_cast<double>(cell) + rounding;
    const double upper = from + width * static_cast<double>(cell + 1) - rounding;
    while (begin + 1 < count && edges[begin + 1] <= lower) ++begin;
    std::size_t end = begin + 1;
    while (end < count && edges[end] < upper) ++end;
    ranges.push_back({begin, end});
  }
  return ranges;
}

// Half-way between neighbours; the outermost edges are given.
std::vector<double> edges_between(const std::vector<double>& centres, double first, double last) {
  std::vector<double> edges{first};
  for (std::size_t i = 1; i < centres.size(); ++i)
    edges.push_back(0.5 * (centres[i - 1] + centres[i]));
  edges.push_back(last);
  return edges;
}

bool overlap(const PictureBox& a, const PictureBox& b) {
  return a.left < b.right && b.left < a.right && a.bottom < b.top && b.bottom < a.top;
}

PictureBox grown(const PictureBox& box, double margin) {
  return {box.left - margin, box.right + margin, box.bottom - margin, box.top + margin};
}

// What labels and their leaders must keep clear of.
struct Obstacles {
  std::vector<PictureBox> boxes;
  std::vector<PictureBox> texts;
  std::vector<PictureBox> leaders;

  static bool is_hit(const PictureBox& box, const std::vector<PictureBox>& others) {
    return std::any_of(others.begin(), others.end(),
                       [&](const PictureBox& other) { return overlap(box, other); });
  }
};

// From a box to a label above or below it.
PictureBox leader_between(const PictureBox& box, const PictureBox& label) {
  const double x = std::clamp(0.5 * (box.left + box.right), label.left, label.right);
  return label.bottom > box.top ? PictureBox{x, x, box.top, label.bottom}
                                : PictureBox{x, x, label.top, box.bottom};
}

// Puts a label at the first place beside its box that is free and within the map. @return whether
// there is one
bool add_label(MarkPlace& place, const std::string& text, const MapArea& map,
               Obstacles& obstacles) {
  constexpr double gap = 0.08;
  constexpr int num_levels = 6;
  const double width = text_width(text, map.font_size) + 0.15;
  const double height = 0.85 * line_height(map.font_size);
  const PictureBox& box = place.box;
  const double middle = 0.5 * (box.left + box.right);
  const auto within = [&](double left) {
    return std::clamp(left, 0.0, std::max(0.0, map.width - width));
  };
  for (int level = 0; level < num_levels; ++level) {
    const double away = gap + level * (height + gap);
    for (const double bottom : {box.top + away, box.bottom - away - height}) {
      for (const double left :
           {within(middle - 0.5 * width), within(box.left), within(box.right - width)}) {
        const PictureBox label{left, left + width, bottom, bottom + height};
        const PictureBox clearance = grown(label, 0.5 * gap);
        if (label.bottom < 0.0 || label.top > map.height || label.right > map.width + 1e-9)
          continue;
        if (Obstacles::is_hit(clearance, obstacles.boxes) ||
            Obstacles::is_hit(clearance, obstacles.texts) ||
            Obstacles::is_hit(clearance, obstacles.leaders))
          continue;
        if (level > 0) {
          const PictureBox leader = leader_between(box, label);
          if (Obstacles::is_hit(grown(leader, 0.5 * gap), obstacles.texts)) continue;
          place.leader = leader;
          obstacles.leaders.push_back(leader);
        }
        place.text = text;
        place.label = label;
        obstacles.texts.push_back(label);
        return true;
      }
    }
  }
  return false;
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

}  // namespace

AmplitudeRaster rasterise(const Spectrogram& spectrogram, double max_frequency, Eigen::Index rows,
                          Eigen::Index columns) {
  if (spectrogram.times.empty() || spectrogram.frequencies.size() < 2)
    refuse_spectrogram("a spectrogram without a column or with a single line");
  if (rows < 1 || columns < 1) refuse_spectrogram("a raster without cells");
  if (!is_positive(max_frequency)) refuse_spectrogram("the highest frequency must be positive");
  const double spacing = spectrogram.frequencies[1];
  const ValueRange times = times_of(spectrogram);
  const double highest = spectrogram.frequencies.back() + 0.5 * spacing;

  AmplitudeRaster raster;
  raster.from = times.lower;
  raster.to = times.upper;
  raster.max_frequency = std::min(max_frequency, highest);
  const std::vector<IndexRange> lines =
      touched(edges_between(spectrogram.frequencies, -0.5 * spacing, highest), 0.0,
              raster.max_frequency, rows);
  const std::vector<IndexRange> pieces = touched(
      edges_between(spectrogram.times, raster.from, raster.to), raster.from, raster.to, columns);

  raster.amplitude.resize(rows, columns);
  for (Eigen::Index column = 0; column < columns; ++column) {
    const IndexRange& piece = pieces[static_cast<std::size_t>(column)];
    const Eigen::VectorXd largest = spectrogram.amplitude
                                        .middleCols(static_cast<Eigen::Index>(piece.begin),
                                                    static_cast<Eigen::Index>(piece.size()))
                                        .rowwise()
                                        .maxCoeff();
    for (Eigen::Index row = 0; row < rows; ++row) {
      const IndexRange& line = lines[static_cast<std::size_t>(row)];
      raster.amplitude(row, column) = largest
                                          .segment(static_cast<Eigen::Index>(line.begin),
                                                   static_cast<Eigen::Index>(line.size()))
                                          .maxCoeff();
    }
  }
  return raster;
}

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

std::vector<MarkPlace> place_marks(const std::vector<SpectrogramMark>& marks, const MapArea& map) {
  constexpr double least_width = 0.12;  // cm, so that a short stretch remains a box
  std::vector<MarkPlace> places;
  Obstacles obstacles;
  const double across = map.width / (map.to - map.from);
  for (std::size_t i = 0; i < marks.size(); ++i) {
    const SpectrogramMark& mark = marks[i];
    if (!(mark.from <= map.to && mark.to >= map.from && mark.frequency >= 0.0 &&
          mark.frequency <= map.max_frequency)) {
      continue;
    }
    const double middle = (0.5 * (mark.from + mark.to) - map.from) * across;
    const double half = std::max(0.5 * (mark.to - mark.from) * across, 0.5 * least_width);
    const double height = map.height * mark.frequency / map.max_frequency;
    const auto within = [](double x, double limit) { return std::clamp(x, 0.0, limit); };
    const PictureBox box{within(middle - half, map.width), within(middle + half, map.width),
                         within(height - map.half_box, map.height),
                         within(height + map.half_box, map.height)};
    places.push_back({i, box, "", std::nullopt, std::nullopt});
    obstacles.boxes.push_back(box);
  }
  for (MarkPlace& place : places) {
    for (const std::string& text : {marks[place.mark].label, marks[place.mark].short_label}) {
      if (!text.empty() && add_label(place, text, map, obstacles)) break;
    }
  }
  return places;
}

void plot_spectrogram(const Spectrogram& spectrogram, const SpectrogramPicture& picture,
                      const std::filesystem::path& figure) {
  plot_spectrograms({{picture.title, &spectrogram, picture.marks}}, picture, figure);
}

void plot_spectrograms(const std::vector<SpectrogramPanel>& panels,
                       const SpectrogramPicture& picture, const std::filesystem::path& figure) {
  check_figure_name(figure);
  if (panels.empty()) refuse_spectrogram("there is no spectrogram to draw");
  if (!is_positive(picture.max_frequency))
    refuse_spectrogram("the highest frequency must be positive");
  if (!is_positive(picture.reference)) refuse_spectrogram("the reference must be positive");
  if (!is_positive(picture.range)) refuse_spectrogram("the range must be positive");
  double highest = 0.0;
  for (const SpectrogramPanel& panel : panels) {
    highest = std::max(
        highest, highest_amplitude(*panel.spectrogram, picture.max_frequency, picture.mean_lines));
  }
  if (highest <= 0.0) highest = picture.reference;  // all zero: the lowest colour everywhere
  const double highest_level = decibels(highest, picture.reference);
  const double lowest_level = highest_level - picture.range;
  const bool is_stack = panels.size() > 1;
  const AxisScale frequency = frequency_scale(picture.max_frequency, is_stack ? 4 : 8);
  const AxisScale level = axis_scale(lowest_level, highest_level, 6);

  // All lengths in cm.
  FigureSize size;
  const double line = line_height(size.font_size);
  const double character = character_width(size.font_size);
  const double map_height = is_stack ? 3.6 : 7.2;
  constexpr double bar_width = 0.45;
  const double frequency_digits = static_cast<double>(
      fmt::format("{:.{}f}", as_number(picture.max_frequency, frequency), frequency.decimals)
          .size());
  const double left = 1.5 * line + (frequency_digits + 1.3) * character;
  const double right = size.width - (0.35 + bar_width + 5.2 * character + 1.3 * line);
  const bool has_titles = std::any_of(panels.begin(), panels.end(),
                                      [](const auto& panel) { return !panel.title.empty(); });
  const double above = has_titles ? 1.6 * line : 0.5 * line;
  std::vector<MapArea> maps;
  for (const SpectrogramPanel& panel : panels) {
    const ValueRange times = times_of(*panel.spectrogram);
    MapArea map;
    map.width = right - left;
    map.height = map_height;
    map.from = times.lower;
    map.to = times.upper;
    map.max_frequency = picture.max_frequency;
    maps.push_back(map);
  }
  const std::vector<std::string> caption = wrapped(picture.caption + unlabelled_text(panels, maps),
                                                   caption_font, size.width - left - 0.3);
  const double below = 2.7 * line + caption_height(caption);
  const double pitch = above + map_height;
  size.height = static_cast<double>(panels.size()) * pitch + below;

  FigureScript script(size);
  script.set_palette(viridis);
  script.add("set cbrange [{:.12g}:{:.12g}]\nset cbtics {:.12g} format '%.{}f' scale 0.6",
             lowest_level, highest_level, level.step, level.decimals);
  script.add("{}", map_style);
  if (is_stack) script.add("set multiplot");
  for (std::size_t i = 0; i < panels.size(); ++i) {
    const SpectrogramPanel& panel = panels[i];
    const Spectrogram& spectrogram = *panel.spectrogram;
    const bool is_last = i + 1 == panels.size();
    const double bottom = below + static_cast<double>(panels.size() - 1 - i) * pitch;
    const auto num_lines = static_cast<std::size_t>(
        std::count_if(spectrogram.frequencies.begin(), spectrogram.frequencies.end(),
                      [&](double one) { return one <= picture.max_frequency; }));
    const AmplitudeRaster raster =
        rasterise(spectrogram, picture.max_frequency, raster_cells(num_lines, 600),
                  raster_cells(spectrogram.times.size(), 1000));
    const AxisScale time = axis_scale(raster.from, raster.to, 6);
    if (i > 0) script.add("unset label\nunset object\nunset arrow");
    script.append(fmt::format("$map{} << END_OF_DATA\n", i) +
                  map_data(raster.amplitude, lowest_level, picture.range, picture.reference) +
                  "END_OF_DATA\n");
    script.set_margins(left, right, bottom, bottom + map_height);
    script.set_axis('x', {raster.from, raster.to}, time);
    if (!is_last) script.add("set xtics format ''");
    script.set_axis('y', {0.0, picture.max_frequency}, frequency);
    // Texts instead of gnuplot's own labels, which move about with the tick marks.
    script.add_text(panel.title, left, bottom + map_height + 0.65 * line, "left");
    if (i == 0) {
      const double bar_bottom = is_stack ? bottom : below;
      script.set_colour_bar(right + 0.35, bar_bottom, bar_width, map_height);
      const double middle = below + 0.5 * (size.height - above - below);
      script.add_text(axis_label("frequency", "Hz", frequency), 0.7 * line, middle,
                      "center rotate");
      script.add_text(level_label(picture.reference, picture.units), size.width - 0.7 * line,
                      middle, "center rotate");
    } else {
      script.add("unset colorbox");
    }
    if (is_last) {
      script.add_text(axis_label("time", "s", time), 0.5 * (left + right), below - 1.9 * line,
                      "center");
      script.add_caption(caption, left, below - 2.7 * line);
    }
    add_marks(script, panel.marks, maps[i], left, bottom);
    const double cell_time = (raster.to - raster.from) /
                             static_cast<double>(raster.amplitude.cols()) /
                             std::pow(10.0, time.exponent);
    const double cell_frequency = raster.max_frequency /
                                  static_cast<double>(raster.amplitude.rows()) /
                                  std::pow(10.0, frequency.exponent);
    script.add(
        "plot $map{} matrix using ({:.12g} + ($1 + 0.5) * {:.12g}):(($2 + 0.5) * {:.12g}):({:.12g} "
        "+ 0.1 * $3) with image notitle",
        i, as_number(raster.from, time), cell_time, cell_frequency, lowest_level);
  }
  if (is_stack) script.add("unset multiplot");
  draw_figure(figure, script.text(), size);
}

}  // namespace stridor
