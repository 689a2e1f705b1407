#include "io/figures/assurance_plot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <stdexcept>

#include "io/figures/axes.hpp"

namespace stridor {
namespace {

constexpr std::array<const char*, 5> assurance_colours{"#ffffff", "#cfe0f0", "#86b1d8", "#3b74b4",
                                                       "#0b2f63"};
constexpr std::size_t most_labels = 24;  // along an axis

/// Tick marks at the middles of cells with frequencies as text; of many cells some.
std::string frequency_ticks(const std::vector<double>& frequencies) {
  const std::size_t step = 1 + (frequencies.size() - 1) / most_labels;
  std::string ticks;
  for (std::size_t i = 0; i < frequencies.size(); i += step)
    ticks += fmt::format("{}'{:.5g}' {}", ticks.empty() ? "" : ", ", frequencies[i], i);
  return ticks;
}

void check_assurance(const AssurancePicture& picture) {
  if (picture.assurance.size() == 0) throw std::invalid_argument("plot_assurance: no mode");
  if (picture.computed.size() != static_cast<std::size_t>(picture.assurance.rows()) ||
      picture.measured.size() != static_cast<std::size_t>(picture.assurance.cols())) {
    throw std::invalid_argument("plot_assurance: not as many frequencies as modes");
  }
}

/// Three columns: measured mode, computed mode, value.
std::string assurance_rows(const Eigen::MatrixXd& assurance, double least) {
  std::string rows;
  for (Eigen::Index c = 0; c < assurance.rows(); ++c) {
    for (Eigen::Index m = 0; m < assurance.cols(); ++m)
      if (assurance(c, m) >= least) rows += fmt::format("{} {} {:.4f}\n", m, c, assurance(c, m));
  }
  return rows;
}

}  // namespace

void plot_assurance(const AssurancePicture& picture, const std::string& caption,
                    const std::filesystem::path& figure) {
  check_figure_name(figure);
  check_assurance(picture);
  const Eigen::MatrixXd& assurance = picture.assurance;
  const double longest = static_cast<double>(std::max(assurance.rows(), assurance.cols()));
  const double side = std::clamp(12.0 / longest, 0.05, 1.6);  // of a cell, cm
  const double across = std::max(4.0, side * static_cast<double>(assurance.cols()));
  const double upwards = std::max(3.0, side * static_cast<double>(assurance.rows()));
  constexpr double left = 3.0, below_axis = 3.2;
  FigureSize size;
  size.width = std::max(12.0, left + across + 3.2);
  const std::vector<std::string> lines = wrapped(caption, caption_font, size.width - 0.6);
  const double caption_height = static_cast<double>(lines.size()) * line_height(caption_font) + 0.3;
  const double bottom = caption_height + below_axis;
  size.height = bottom + upwards + 0.6;

  FigureScript script(size);
  script.append("$cells << END_OF_DATA\n" + assurance_rows(assurance, -1.0) + "END_OF_DATA\n");
  const std::string marked = side >= 0.9 ? assurance_rows(assurance, 0.1) : "";
  script.append("$marked << END_OF_DATA\n" + marked + "END_OF_DATA\n");
  script.add_caption(lines, 0.3, caption_height);
  script.add("{}", map_style);
  script.set_palette(assurance_colours);
  script.add("set cbrange [0:1]\nset cbtics 0.2\nset cblabel 'MAC'\nunset key");
  script.set_colour_bar(left + across + 0.5, bottom, 0.45, upwards);
  script.set_margins(left, left + across, bottom, bottom + upwards);
  script.add("set xrange [-0.5:{}]\nset yrange [-0.5:{}]", static_cast<double>(assurance.cols()) - 0.5,
             static_cast<double>(assurance.rows()) - 0.5);
  script.add("set xtics rotate by 90 right ({})\nset ytics ({})", frequency_ticks(picture.measured),
             frequency_ticks(picture.computed));
  script.add("set xlabel 'measured (Hz)'\nset ylabel 'computed (Hz)'");
  // Boxes, as gnuplot 5.4 dies of an image of a single row or column.
  script.add("plot $cells using 1:2:(0.5):(0.5):3 with boxxyerror fillcolor palette fillstyle solid noborder{}",
             marked.empty() ? ""
                            : ", $marked using 1:2:(sprintf('%.2f', $3)):($3 > 0.5 ? 0xffffff : 0x202020) "
                              "with labels font ',9' textcolor rgb variable");
  draw_figure(figure, script.text(), size);
}

}  // namespace stridor
