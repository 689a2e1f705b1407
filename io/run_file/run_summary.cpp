#include "io/run_file/run_summary.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "analysis/bursts.hpp"
#include "analysis/sample_source.hpp"
#include "analysis/statistics.hpp"
#include "core/errors.hpp"
#include "io/scene/scene_reader.hpp"

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

/// A series of a run file, which must live as long.
class RecordedSamples final : public SampleSource {
 public:
  RecordedSamples(const RunFileReader& file, std::string path)
      : file_(&file), path_(std::move(path)) {}
  std::size_t size() const override { return file_->num_rows(); }
  void read(std::size_t begin, std::span<double> target) const override {
    file_->read(path_, begin, target);
  }

 private:
  const RunFileReader* file_;
  std::string path_;
};

/// Calls `visit(piece)` with a range of samples in turn.
template <class Visit>
void for_each_piece(const SampleSource& samples, IndexRange range, Visit&& visit) {
  constexpr std::size_t at_a_time = std::size_t{1} << 16;
  std::vector<double> piece;
  for (std::size_t i = range.begin; i < range.end; i += piece.size()) {
    piece.resize(std::min(at_a_time, range.end - i));
    samples.read(i, piece);
    visit(std::span<const double>(piece));
  }
}

struct Size {
  double peak = 0.0;
  double rms = 0.0;
};

/// peak() and rms() of a range of samples, which is not empty.
Size size_in(const SampleSource& samples, IndexRange range) {
  Size size;
  double square = 0.0;
  for_each_piece(samples, range, [&](std::span<const double> piece) {
    const double here = peak(piece);
    if (std::isnan(here) || here > size.peak) size.peak = here;
    for (const double x : piece) square += x * x;
  });
  size.rms = std::sqrt(square / static_cast<double>(range.size()));
  return size;
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

std::optional<AccelerationSummary> summarise_acceleration(const std::string& channel, double first,
                                                          double interval,
                                                          const SampleSource& values,
                                                          const MeasureParameters& measure) {
  const Window window{measure.from, measure.to.value_or(std::numeric_limits<double>::infinity())};
  const IndexRange range = samples_in(window, first, interval, values.size());
  if (range.is_empty()) return std::nullopt;
  const Size size = size_in(values, range);
  AccelerationSummary summary{channel, size.peak, size.rms};
  if (!measure.band.empty()) {
    const Band band{measure.band[0], measure.band[1]};
    BurstParameters parameters;
    parameters.band = band;
    parameters.measured = window;
    parameters.smoothing = std::max(parameters.smoothing, 1.0 / band.lower);
    Vibration vibration = find_vibration(values, interval, parameters, first);
    summary.rms = vibration.rms;
    summary.bursts = std::move(vibration.bursts);
    summary.lasting = vibration.lasting;
  }
  return summary;
}

std::optional<AccelerationSummary> summarise_acceleration(const RunFileReader& file,
                                                          const MeasureParameters& measure) {
  const auto channel = acceleration_channel(file);
  const std::size_t count = file.num_rows();
  if (!channel || count < 2) return std::nullopt;
  double first = 0.0;
  double last = 0.0;
  file.read("/time", 0, {&first, 1});
  file.read("/time", count - 1, {&last, 1});
  const double interval = (last - first) / static_cast<double>(count - 1);
  return summarise_acceleration(channel->substr(channel->rfind('/') + 1), first, interval,
                                RecordedSamples(file, *channel), measure);
}

namespace {

/// Index of a burst in a dataset; nothing for −1. @throws FileError where there is no such burst
std::optional<std::size_t> burst_index(double value, std::size_t count, const std::string& path,
                                       const std::string& name) {
  if (value == -1.0) return std::nullopt;
  if (!(value >= 0.0 && value < static_cast<double>(count) && value == std::floor(value)))
    throw FileError(
        Refusal::file_damaged, path, name,
        fmt::format("is {:g} somewhere, expected an index below {} or -1", value, count));
  return static_cast<std::size_t>(value);
}

/// Reads columns that belong together. @throws FileError where they are not of one length
std::vector<std::vector<double>> columns_of(const RunFileReader& file, const std::string& path,
                                            std::span<const std::string> names) {
  std::vector<std::vector<double>> columns;
  for (const std::string& name : names) {
    columns.push_back(file.static_array(name));
    if (columns.back().size() != columns.front().size())
      throw FileError(Refusal::file_damaged, path, name,
                      fmt::format("has {} entries, but {} has {}", columns.back().size(),
                                  names.front(), columns.front().size()));
  }
  return columns;
}

/// Courses and harmonics, which files of earlier versions do not have.
void read_courses(const RunFileReader& file, const std::string& path, std::vector<Burst>& bursts) {
  if (file.has("/bursts/course")) {
    const std::array<std::string, 4> names{"/bursts/course/burst", "/bursts/course/time",
                                           "/bursts/course/frequency", "/bursts/course/level"};
    const auto columns = columns_of(file, path, names);
    for (std::size_t i = 0; i < columns[0].size(); ++i) {
      const auto burst = burst_index(columns[0][i], bursts.size(), path, names[0]);
      if (burst) bursts[*burst].course.push_back({columns[1][i], columns[2][i], columns[3][i]});
    }
  }
  if (file.has("/bursts/harmonic_of")) {
    const std::array<std::string, 3> names{"/bursts/start", "/bursts/harmonic_of", "/bursts/order"};
    const auto columns = columns_of(file, path, names);
    for (std::size_t i = 0; i < bursts.size(); ++i)
      if (const auto of = burst_index(columns[1][i], bursts.size(), path, names[1]))
        bursts[i].harmonic = {*of, static_cast<int>(columns[2][i])};
  }
}

}  // namespace

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
      bursts.assign(values.size(), {unknown, unknown, unknown, unknown, unknown, unknown, unknown, unknown, unknown});
    }
    if (values.size() != bursts.size()) {
      throw FileError(
          Refusal::file_damaged, path, name,
          fmt::format("has {} entries, but /bursts/start has {}", values.size(), bursts.size()));
    }
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (!std::isfinite(values[i]))
        throw FileError(Refusal::file_damaged, path, name,
                        fmt::format("is not finite in entry {}", i));
      bursts[i].*member = values[i];
      if (member == &Burst::end && values[i] < bursts[i].start)
        throw FileError(Refusal::file_damaged, path, name,
                        fmt::format("lies before the start in entry {}", i));
    }
  }
  // Files of earlier versions do not have these.
  for (const auto& [name, member] : {std::pair{"/bursts/start_frequency", &Burst::start_frequency},
                                     std::pair{"/bursts/end_frequency", &Burst::end_frequency}}) {
    if (!file.has(name)) continue;
    const std::vector<double> values = file.static_array(name);
    if (values.size() != bursts.size()) {
      throw FileError(
          Refusal::file_damaged, path, name,
          fmt::format("has {} entries, but /bursts/start has {}", values.size(), bursts.size()));
    }
    for (std::size_t i = 0; i < values.size(); ++i) bursts[i].*member = values[i];
  }
  read_courses(file, path, bursts);
  return bursts;
}

std::optional<std::vector<Burst>> bursts_in_band(const RunFileReader& file, const std::string& path,
                                                 MeasureParameters measure, Band band) {
  if (const auto channel = acceleration_channel(file)) {
    const RecordedSamples samples(file, *channel);
    for_each_piece(samples, {0, samples.size()}, [&](std::span<const double> piece) {
      if (!std::isfinite(peak(piece)))
        throw FileError(Refusal::file_damaged, path, *channel, "is not finite everywhere");
    });
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
    throw FileError(Refusal::file_damaged, path, "/scene/resolved",
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
      throw FileError(Refusal::file_damaged, path, "/time",
                      fmt::format("is not equidistant: row {} is {:g} s, expected {:g} s", i,
                                  times[i], expected));
    }
  }
  return interval;
}

}  // namespace stridor
