#include "io/run_summary.hpp"

#include <algorithm>
#include <limits>

#include "analysis/band_pass.hpp"
#include "analysis/statistics.hpp"

namespace stridor {
namespace {

bool ends_with(const std::string& text, const std::string& ending) {
  return text.size() >= ending.size() &&
         text.compare(text.size() - ending.size(), ending.size(), ending) == 0;
}

std::optional<std::string> acceleration_channel(const RunFileReader& file) {
  std::optional<std::string> any;
  for (const std::string& name : file.series_names()) {
    if (ends_with(name, ".free_end.y.acceleration")) return name;
    if (!any && ends_with(name, ".acceleration")) any = name;
  }
  return any;
}

}  // namespace

std::optional<AccelerationSummary> summarise_acceleration(const RunFileReader& file,
                                                          const MeasureParameters& measure) {
  const auto channel = acceleration_channel(file);
  const std::vector<double>& times = file.times();
  if (!channel || times.size() < 2) return std::nullopt;
  const double interval = (times.back() - times.front()) / static_cast<double>(times.size() - 1);
  const Window window{measure.from, measure.to.value_or(std::numeric_limits<double>::infinity())};
  const IndexRange range = samples_in(window, times.front(), interval, times.size());
  if (range.is_empty()) return std::nullopt;
  const std::vector<double> values = file.series(*channel);
  AccelerationSummary summary{channel->substr(channel->rfind('/') + 1), peak(range.of(values)), 0.0,
                              std::nullopt};
  if (measure.band.empty()) {
    summary.rms = rms(range.of(values));
  } else {
    const Band band{measure.band[0], measure.band[1]};
    summary.rms = rms(range.of(band_pass(values, interval, band)));
    BurstParameters parameters;
    parameters.band = band;
    parameters.measured = window;
    parameters.smoothing = std::max(parameters.smoothing, 1.0 / band.lower);
    summary.bursts = find_bursts(values, interval, parameters, times.front());
  }
  return summary;
}

}  // namespace stridor
