// Of limit cycles and spectrograms.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "app/report/curves.hpp"
#include "app/report/histories.hpp"
#include "core/errors.hpp"

namespace stridor {
namespace {

/// Size of the largest multiplier; nothing where there are none.
std::optional<double> largest_multiplier(const ResultFile& file) {
  if (!file.has("/multipliers/real")) return std::nullopt;
  const std::vector<double> real = file.read("/multipliers/real");
  const std::vector<double> imaginary = file.read("/multipliers/imaginary");
  if (real.size() != imaginary.size())
    throw FileError(Refusal::file_damaged, file.path(), "/multipliers/imaginary",
                    "is unlike /multipliers/real in length");
  double largest = 0.0;
  for (std::size_t i = 0; i < real.size(); ++i)
    largest = std::max(largest, std::hypot(real[i], imaginary[i]));
  return largest;
}

/// Whether the motion repeats itself, how often, how large it is, and whether it is stable.
Json cycle_verdict(const ResultFile& file) {
  const std::optional<double> period = file.told("period");
  std::string status = file.text("status");
  std::replace(status.begin(), status.end(), '_', ' ');
  // Files of earlier versions do not say.
  if (status.empty()) return verdict("told", "One period.");
  std::string text =
      period ? fmt::format("A period of {}, {}", shown(*period, "s"), shown(1.0 / *period, "Hz"))
             : "No period was found: " + status;
  if (const auto rms = file.told("x.rms"))
    text += fmt::format("; r.m.s. displacement {}", shown(*rms, "m"));
  for (const auto& [name, verb] :
       {std::pair{"stick_fraction", "sticks"}, std::pair{"free_fraction", "is lifted off"}})
    if (const auto part = file.told(name); part && *part > 0.0)
      text += fmt::format("; {} {:.3g} % of the time", verb, 100.0 * *part);
  const std::optional<double> multiplier = largest_multiplier(file);
  if (!period || !multiplier) return verdict("told", text + ".");
  return verdict(
      *multiplier < 1.0 ? "stable" : "unstable",
      text + fmt::format("; a disturbance is multiplied by {:.3g} in a period.", *multiplier));
}

}  // namespace

Json cycle_section(const ResultFile& file, const ReportContext& context) {
  Json section = section_head(file, "limit cycle", "limit cycle");
  const std::vector<double> times = file.read("/time");
  std::vector<std::string> columns;
  for (const ResultArray& array : file.arrays()) {
    if (array.path != "/time" && array.shape.size() == 1 && array.shape.front() == times.size())
      columns.push_back(array.path);
  }
  section["verdict"] = cycle_verdict(file);
  section["views"].push_back(column_histories(file, columns, times, context.page));
  const auto of = [&](const char* end) {
    return std::find_if(columns.begin(), columns.end(),
                        [&](const std::string& path) { return path.ends_with(end); });
  };
  const auto place = of("displacement");
  const auto speed = of("velocity");
  if (place != columns.end() && speed != columns.end()) {
    const auto column = [&](const std::string& path) {
      return CurveColumn{path.substr(path.rfind('/') + 1), file.array(path).units, file.read(path)};
    };
    Json view = curve_of_columns(column(*place), column(*speed), context.page);
    view["title"] = "velocity against displacement";
    view["over_time"] = true;  // a point for each row of the histories
    section["views"].push_back(std::move(view));
  }
  return section;
}

Json spectrogram_section(const ResultFile& file, const ReportContext& context) {
  Json section = section_head(file, "spectrogram", "spectrogram of " + file.text("channel"));
  const std::vector<double> times = file.read("/times");
  const std::vector<double> frequencies = file.read("/frequencies");
  const std::vector<double> amplitude = file.read("/amplitude", 2);
  if (amplitude.size() != times.size() * frequencies.size() || frequencies.empty())
    throw FileError(Refusal::file_damaged, file.path(), "/amplitude",
                    "is unlike /times and /frequencies in extent");
  const Eigen::Map<const Eigen::MatrixXd> levels(amplitude.data(),
                                                 static_cast<Eigen::Index>(frequencies.size()),
                                                 static_cast<Eigen::Index>(times.size()));
  Json view = levels_view(times, frequencies, levels, frequencies.back(),
                          file.array("/amplitude").units, context.page);
  view["channel"] = file.text("channel");
  view["caption"] = "";
  section["verdict"] =
      verdict("told", fmt::format("Levels of {} over time and frequency.", file.text("channel")));
  section["views"].push_back(std::move(view));
  return section;
}

}  // namespace stridor
