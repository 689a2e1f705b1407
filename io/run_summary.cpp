#include "io/run_summary.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "analysis/bursts.hpp"
#include "analysis/statistics.hpp"
#include "core/errors.hpp"
#include "io/scene_reader.hpp"

namespace stridor {
namespace {

bool ends_with(const std::string& text, const std::string& ending) {
  return text.size() >= ending.size() &&
         text.compare(text.size() - ending.size(), ending.size(), ending) == 0;
}

std::optional<std::string> acceleration_among(const std::vector<std::string>& names) {
  std::optional<std::string> any;
  for (const std::string& name : names) {
    if (ends_with(name, ".free_end.y.acceleration")) return name;
    if (!any && ends_with(name, ".acceleration")) any = name;
  }
  return any;
}

/// Fills `section` where the scene has it.
template <class Section, class Member>
void read_if_present(const SceneNode& scene, const char* name, Member& section) {
  if (const SceneEntry* entry = scene.entry(name)) section = read_as<Section>(entry->value);
}

}  // namespace

std::optional<std::string> acceleration_channel(const RunFileReader& file) {
  return acceleration_among(file.series_names());
}

std::optional<std::string> acceleration_channel(const RecordParameters& record) {
  // A run file lists its channels by name.
  std::vector<std::string> names = record.channels;
  std::sort(names.begin(), names.end());
  return acceleration_among(names);
}

std::optional<AccelerationSummary> summarise_acceleration(const std::string& channel,
                                                          const std::vector<double>& times,
                                                          const std::vector<double>& values,
                                                          const MeasureParameters& measure) {
  if (times.size() < 2) return std::nullopt;
  const double interval = (times.back() - times.front()) / static_cast<double>(times.size() - 1);
  const Window window{measure.from, measure.to.value_or(std::numeric_limits<double>::infinity())};
  const IndexRange range = samples_in(window, times.front(), interval, times.size());
  if (range.is_empty()) return std::nullopt;
  AccelerationSummary summary{channel, peak(range.of(values)), 0.0, std::nullopt};
  if (measure.band.empty()) {
    summary.rms = rms(range.of(values));
  } else {
    const Band band{measure.band[0], measure.band[1]};
    BurstParameters parameters;
    parameters.band = band;
    parameters.measured = window;
    parameters.smoothing = std::max(parameters.smoothing, 1.0 / band.lower);
    Vibration vibration = find_vibration(values, interval, parameters, times.front());
    summary.rms = rms(range.of(vibration.filtered));
    summary.bursts = std::move(vibration.bursts);
  }
  return summary;
}

std::optional<AccelerationSummary> summarise_acceleration(const RunFileReader& file,
                                                          const MeasureParameters& measure) {
  const auto channel = acceleration_channel(file);
  if (!channel) return std::nullopt;
  return summarise_acceleration(channel->substr(channel->rfind('/') + 1), file.times(),
                                file.series(*channel), measure);
}

std::vector<Burst> recorded_bursts(const RunFileReader& file, const std::string& path) {
  if (!file.has("/bursts")) return {};
  constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
  std::vector<Burst> bursts;
  for (const auto& [name, member] :
       {std::pair{"/bursts/start", &Burst::start}, std::pair{"/bursts/end", &Burst::end},
        std::pair{"/bursts/frequency", &Burst::frequency}, std::pair{"/bursts/peak", &Burst::peak},
        std::pair{"/bursts/gain", &Burst::gain}}) {
    const std::vector<double> values = file.static_array(name);
    if (member == &Burst::start) {
      bursts.assign(values.size(), {unknown, unknown, unknown, unknown, unknown, unknown, unknown});
    }
    if (values.size() != bursts.size()) {
      throw FileError(
          path, name,
          fmt::format("has {} entries, but /bursts/start has {}", values.size(), bursts.size()));
    }
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (!std::isfinite(values[i]))
        throw FileError(path, name, fmt::format("is not finite in entry {}", i));
      bursts[i].*member = values[i];
      if (member == &Burst::end && values[i] < bursts[i].start)
        throw FileError(path, name, fmt::format("lies before the start in entry {}", i));
    }
  }
  return bursts;
}

std::optional<std::vector<Burst>> bursts_in_band(const RunFileReader& file, const std::string& path,
                                                 MeasureParameters measure, Band band) {
  if (const auto channel = acceleration_channel(file)) {
    for (const double value : file.series(*channel))
      if (!std::isfinite(value)) throw FileError(path, *channel, "is not finite everywhere");
  }
  measure.band = {band.lower, band.upper};
  const auto summary = summarise_acceleration(file, measure);
  return summary ? summary->bursts : std::nullopt;
}

RecordedSettings recorded_settings(const RunFileReader& file, const std::string& path) {
  RecordedSettings settings;
  try {
    const SceneNode scene = read_scene_text(file.header().scene_resolved, "/scene/resolved");
    read_if_present<MeasureParameters>(scene, "measure", settings.measure);
    read_if_present<SpectrogramSection>(scene, "spectrogram", settings.spectrogram);
  } catch (const ConfigError& error) {
    throw FileError(path, "/scene/resolved",
                    fmt::format("cannot be read as a scene: {}", error.what()));
  }
  return settings;
}

double sampling_interval(const RunFileReader& file, const std::string& path) {
  const std::vector<double>& times = file.times();
  if (times.size() < 2) return 0.0;
  const double interval = (times.back() - times.front()) / static_cast<double>(times.size() - 1);
  for (std::size_t i = 0; i < times.size(); ++i) {
    const double expected = times.front() + static_cast<double>(i) * interval;
    if (!(interval > 0.0 && std::abs(times[i] - expected) <= 1e-3 * interval)) {
      throw FileError(path, "/time",
                      fmt::format("is not equidistant: row {} is {:g} s, expected {:g} s", i,
                                  times[i], expected));
    }
  }
  return interval;
}

}  // namespace stridor
