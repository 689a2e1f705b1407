// Amplitudes over time and frequency as levels of a picture.
#include <algorithm>
#include <cmath>

#include "analysis/spectrogram.hpp"
#include "app/report/report_section.hpp"

namespace stridor {
namespace {

constexpr std::size_t most_columns = 1600;  ///< of the picture of a spectrogram
constexpr std::size_t most_lines = 640;
constexpr double decibels_per_step = 0.5;

/// Groups of equal size, so that there are at most `most` of them.
std::size_t group_size(std::size_t count, std::size_t most) {
  return std::max<std::size_t>(1, (count + most - 1) / most);
}

/// Levels in steps of half a decibel below the highest one, the largest of a group of amplitudes;
/// 0 stands for all that is lower than 255 steps reach.
std::vector<unsigned char> level_bytes(const Eigen::MatrixXd& amplitude, std::size_t columns,
                                       std::size_t lines, std::size_t columns_together,
                                       std::size_t lines_together, double top) {
  std::vector<unsigned char> bytes(columns * lines);
  const auto rows = static_cast<std::size_t>(amplitude.rows());
  const auto times = static_cast<std::size_t>(amplitude.cols());
  for (std::size_t c = 0; c < columns; ++c) {
    for (std::size_t l = 0; l < lines; ++l) {
      double largest = 0.0;
      for (std::size_t i = c * columns_together; i < std::min(times, (c + 1) * columns_together); ++i)
        for (std::size_t k = l * lines_together; k < std::min(rows, (l + 1) * lines_together); ++k)
          largest = std::max(largest, amplitude(static_cast<Eigen::Index>(k),
                                                static_cast<Eigen::Index>(i)));
      if (largest <= 0.0 || top <= 0.0) continue;
      const double steps = 255.0 + 20.0 * std::log10(largest / top) / decibels_per_step;
      bytes[c * lines + l] = static_cast<unsigned char>(std::clamp(std::round(steps), 0.0, 255.0));
    }
  }
  return bytes;
}

}  // namespace

Json levels_view(const std::vector<double>& times, const std::vector<double>& frequencies,
                 const Eigen::MatrixXd& amplitude, double max_frequency, const std::string& units,
                 ReportPage& page) {
  const auto above = std::upper_bound(frequencies.begin(), frequencies.end(),
                                      max_frequency * (1.0 + 1e-9));
  const std::size_t num_lines =
      std::max<std::size_t>(2, static_cast<std::size_t>(above - frequencies.begin()));
  const Eigen::MatrixXd seen = amplitude.topRows(
      std::min(static_cast<Eigen::Index>(num_lines), amplitude.rows()));
  const std::size_t columns_together = group_size(times.size(), most_columns);
  const std::size_t lines_together = group_size(static_cast<std::size_t>(seen.rows()), most_lines);
  const std::size_t columns = (times.size() + columns_together - 1) / columns_together;
  const std::size_t lines =
      (static_cast<std::size_t>(seen.rows()) + lines_together - 1) / lines_together;
  // Not the mean, which would be the highest line of all.
  const Eigen::Index first_line = std::min<Eigen::Index>(2, seen.rows() - 1);
  const double top = seen.size() > 0 ? seen.bottomRows(seen.rows() - first_line).maxCoeff() : 0.0;
  const double reference = standard_reference(units);
  const double time_step = times.size() > 1 ? times[1] - times[0] : 0.0;
  const double line_step = frequencies.size() > 1 ? frequencies[1] - frequencies[0] : 0.0;
  return {{"type", "spectrogram"},
          {"units", units},
          {"reference", reference},
          {"top", top > 0.0 ? number(decibels(top, reference)) : Json(0.0)},
          {"step", decibels_per_step},
          {"time", {{"from", times.empty() ? 0.0 : times.front() - 0.5 * time_step},
                    {"step", time_step * static_cast<double>(columns_together)},
                    {"count", columns}}},
          {"frequency", {{"from", -0.5 * line_step},
                         {"step", line_step * static_cast<double>(lines_together)},
                         {"count", lines}}},
          {"levels", page.add_bytes(level_bytes(seen, columns, lines, columns_together,
                                                lines_together, top))}};
}

}  // namespace stridor
