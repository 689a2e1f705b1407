#include "app/results/pictures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <stdexcept>
#include <system_error>

#include "core/errors.hpp"
#include "core/fft_plan.hpp"
#include "core/suggestion.hpp"
#include "core/units.hpp"
#include "io/figures/axes.hpp"
#include "io/figures/gnuplot.hpp"
#include "io/hdf5/output_options.hpp"

namespace stridor {
namespace {

WindowKind window_of(const std::string& text) {
  std::vector<std::string> names;
  for (const auto& [name, kind] : window_names()) {
    if (name == text) return kind;
    names.push_back(name);
  }
  throw ConfigError(Refusal::unknown_name, "--window",
                    fmt::format("there is no window '{}'{} (there are: {})", text,
                                did_you_mean(text, names), fmt::join(names, ", ")));
}

std::string stretch_text(const RecordedStretch& run) {
  return fmt::format("{} between {:g} and {:g} s", run.path, run.first_time(), run.last_time());
}

// Samples per piece.
std::size_t settle_length(const PictureOptions& options, const RecordedStretch& run,
                          const std::optional<SpectrogramSection>& section, double default_length) {
  const std::size_t available = run.samples.size();
  const auto samples = [&](double seconds) {
    return static_cast<std::size_t>(std::max(0.0, std::round(seconds / run.interval)));
  };
  const bool is_on_command_line = options.length.has_value();
  if (!is_on_command_line && !(section && section->length)) {
    return std::min(fast_fft_length(samples(default_length)), available);
  }
  const char* key = is_on_command_line ? "--length" : "spectrogram.length";
  const double seconds = is_on_command_line
                             ? option_value(key, *options.length, "s", Range::positive())
                             : *section->length;
  if (seconds < 1.5 * run.interval) {
    throw ConfigError(Refusal::wrong_value, key,
                      fmt::format("{:g} s is less than two samples, which are {:g} s apart",
                                  seconds, run.interval));
  }
  if (seconds > (static_cast<double>(available) + 0.5) * run.interval) {
    throw ConfigError(Refusal::wrong_value, key,
                      fmt::format("a piece of {:g} s is longer than the {:g} s of {}; give at most "
                                  "--length {:g}, or choose a longer stretch",
                                  seconds, run.duration(), stretch_text(run), run.duration()));
  }
  return samples(seconds);
}

void check_overlap(double overlap, std::size_t length, const char* key) {
  const double samples = static_cast<double>(length);
  if (std::llround(samples * (1.0 - overlap)) < 1) {
    throw ConfigError(Refusal::wrong_value, key,
                      fmt::format("{:g} moves a piece of {} samples on by less than one; "
                                  "allowed: up to {:g}",
                                  overlap, length, 1.0 - 1.0 / samples));
  }
}

}  // namespace

void add_picture_options(CLI::App& verb, PictureOptions& options) {
  verb.add_option("--from", options.from, "Start of the time shown, s or with a unit");
  verb.add_option("--to", options.to, "End of the time shown, s or with a unit");
  add_json_option(verb, options.common);
  add_force_option(verb, options.common);
}

void add_spectrum_options(CLI::App& verb, PictureOptions& options) {
  verb.add_option("--window", options.window, "hann, blackman_harris or rectangular");
  verb.add_option("--length", options.length,
                  "Duration of a piece that is transformed, s or with a unit");
  verb.add_option("--overlap", options.overlap, "Part of a piece that it shares with the next");
  verb.add_option("--max-frequency", options.max_frequency,
                  "End of the frequency axis, Hz or with a unit");
  verb.add_option("--reference", options.reference,
                  "Amplitude of 0 dB, in the unit of the channel or with a unit; default: "
                  "1 µm/s², 1 nm/s, 1 pm, 1 µN (ISO 1683)");
  verb.add_option("--range", options.range, "Levels shown below the highest one, dB");
  add_band_option(verb, options.band);
}

void add_band_option(CLI::App& verb, std::optional<std::string>& band) {
  verb.add_option("--band", band,
                  "Seek bursts anew, in the band LOWER,UPPER (Hz or with units); default: those "
                  "that the run found in measure.band");
}

void check_data_file(const PictureOptions& options) {
  if (!options.data) return;
  namespace fs = std::filesystem;
  std::error_code missing;
  if (fs::equivalent(*options.data, options.file, missing))
    throw ConfigError(Refusal::doubled_name, "--data",
                      fmt::format("'{}' is the run file itself", *options.data));
  if (fs::path(*options.data) == fs::path(options.output))
    throw ConfigError(Refusal::doubled_name, "--data",
                      fmt::format("'{}' is also the figure", *options.data));
  check_output(*options.data, options.common.overwrite());
}

double option_value(const char* option, const std::string& text, const std::string& unit,
                    const Range& allowed) {
  double value = 0.0;
  try {
    value = parse_quantity(text, unit);
  } catch (const QuantityError& error) {
    throw ConfigError(error.refusal(), option, error.what());
  }
  if (!allowed.contains(value)) {
    throw ConfigError(Refusal::wrong_value, option,
                      fmt::format("must be {}{}{}, got '{}'", allowed.text(),
                                  unit.empty() ? "" : " ", unit, text));
  }
  return value;
}

namespace {

/// Those that a run has found; of one that was killed, or is going on, those in what it has
/// recorded.
std::vector<Burst> bursts_of_run(const RunFileReader& file, const std::string& path) {
  if (file.has("/bursts") || !file.results().empty()) return recorded_bursts(file, path);
  const MeasureParameters measure = recorded_settings(file, path).measure;
  const double interval = sampling_interval(file, path);
  if (measure.band.size() != 2 || !(interval > 0.0 && measure.band[1] < 0.5 / interval)) return {};
  return bursts_in_band(file, path, measure, {measure.band[0], measure.band[1]})
      .value_or(std::vector<Burst>());
}

}  // namespace

std::vector<Burst> bursts_of(const RunFileReader& file, const std::string& path,
                             const std::optional<std::string>& band) {
  if (!band) return bursts_of_run(file, path);
  constexpr const char* option = "--band";
  const std::size_t comma = band->find(',');
  if (comma == std::string::npos)
    throw ConfigError(Refusal::wrong_value, option,
                      fmt::format("'{}' is no band; write LOWER,UPPER", *band));
  const Band wanted{option_value(option, band->substr(0, comma), "Hz", Range::positive()),
                    option_value(option, band->substr(comma + 1), "Hz", Range::positive())};
  const double interval = sampling_interval(file, path);
  const double nyquist = interval > 0.0 ? 0.5 / interval : 0.0;
  if (!(wanted.lower < wanted.upper && wanted.upper < nyquist)) {
    throw ConfigError(Refusal::wrong_value, option,
                      fmt::format("{:g} to {:g} Hz must be a lower and an upper frequency "
                                  "below {:g} Hz, half the sampling rate of {}",
                                  wanted.lower, wanted.upper, nyquist, path));
  }
  auto bursts = bursts_in_band(file, path, recorded_settings(file, path).measure, wanted);
  if (!bursts) {
    throw ConfigError(Refusal::not_recorded, option,
                      path +
                          " holds no acceleration in the window of measure.from and "
                          "measure.to, in which bursts are sought");
  }
  return *std::move(bursts);
}

std::vector<double> RecordedStretch::times() const {
  const auto part = samples.of(file.times());
  return {part.begin(), part.end()};
}

std::vector<double> RecordedStretch::values(const std::string& series) const {
  const std::vector<double> all = file.series(series);
  const auto part = samples.of(all);
  return {part.begin(), part.end()};
}

std::vector<double> RecordedStretch::finite_values(const std::string& series) const {
  std::vector<double> part = values(series);
  for (std::size_t i = 0; i < part.size(); ++i) {
    if (std::isfinite(part[i])) continue;
    throw FileError(Refusal::not_recorded, path, series,
                    fmt::format("is not finite at {:g} s; choose another stretch with --from, --to",
                                file.times()[samples.begin + i]));
  }
  return part;
}

RecordedStretch open_stretch(const PictureOptions& options) {
  auto guard = std::make_unique<DamageGuard>(options.file);
  RecordedStretch run{std::move(guard), RunFileReader(options.file), options.file, 0.0, {}};
  const std::vector<double>& times = run.file.times();
  if (times.empty())
    throw FileError(Refusal::not_recorded, run.path, "/time",
                    "is empty, nothing has been recorded");
  run.interval = sampling_interval(run.file, run.path);
  Window window;
  if (options.from) window.from = option_value("--from", *options.from, "s", Range::any());
  if (options.to) window.to = option_value("--to", *options.to, "s", Range::any());
  if (window.from > window.to)
    throw ConfigError(Refusal::wrong_value, "--from",
                      fmt::format("{:g} s is after --to = {:g} s", window.from, window.to));
  // A single sample has no interval; any does to see whether it is inside.
  run.samples =
      samples_in(window, times.front(), run.interval > 0.0 ? run.interval : 1.0, times.size());
  if (run.samples.is_empty()) {
    throw ConfigError(Refusal::not_recorded, options.from ? "--from" : "--to",
                      fmt::format("{} holds no sample there, only from {:g} to {:g} s", run.path,
                                  times.front(), times.back()));
  }
  return run;
}

std::string find_series(const RecordedStretch& run, const std::string& channel, const char* key) {
  std::vector<std::string> names;
  for (const std::string& series : run.file.series_names()) {
    names.push_back(channel_name(series));
    if (names.back() == channel) return series;
  }
  throw ConfigError(Refusal::not_recorded, key,
                    fmt::format("{} has no channel '{}'{} (it has: {})", run.path, channel,
                                did_you_mean(channel, names),
                                names.empty() ? "none; name channels under `record` in the scene"
                                              : fmt::format("{}", fmt::join(names, ", "))));
}

PieceSettings settle_pieces(const PictureOptions& options, const RecordedStretch& run,
                            const RecordedSettings& settings,
                            const std::optional<SpectrogramSection>& section,
                            const std::function<double(double)>& default_length,
                            double default_overlap) {
  if (run.samples.size() < 2) {
    throw ConfigError(Refusal::not_recorded, "",
                      fmt::format("{} holds a single sample; a spectrum needs a longer stretch",
                                  stretch_text(run)));
  }
  PieceSettings result;
  const double nyquist = 0.5 / run.interval;
  if (options.max_frequency) {
    result.max_frequency =
        option_value("--max-frequency", *options.max_frequency, "Hz", Range::positive());
    if (result.max_frequency > nyquist * (1.0 + 1e-9)) {
      throw ConfigError(Refusal::wrong_value, "--max-frequency",
                        fmt::format("{:g} Hz is above {:g} Hz, the highest frequency that samples "
                                    "{:g} s apart resolve",
                                    result.max_frequency, nyquist, run.interval));
    }
  } else if (section && section->max_frequency) {
    result.max_frequency = std::min(*section->max_frequency, nyquist);
  } else if (settings.measure.band.size() == 2) {
    result.max_frequency = std::min(settings.measure.band[1], nyquist);
  } else {
    result.max_frequency = 0.4 / run.interval;  // what the recorder's filter passes
  }

  SpectrogramParameters& parameters = result.parameters;
  parameters.window = options.window ? window_of(*options.window)
                      : section      ? section->window
                                     : WindowKind::hann;
  parameters.length = settle_length(options, run, section, default_length(result.max_frequency));
  parameters.overlap =
      options.overlap ? option_value("--overlap", *options.overlap, "", {0.0, 1.0, false, true})
      : section       ? section->overlap
                      : default_overlap;
  check_overlap(parameters.overlap, parameters.length,
                options.overlap ? "--overlap" : "spectrogram.overlap");
  return result;
}

std::string pieces_text(const SpectrogramParameters& parameters, double interval) {
  const double duration = static_cast<double>(parameters.length) * interval;
  const char* window = parameters.window == WindowKind::hann              ? "Hann"
                       : parameters.window == WindowKind::blackman_harris ? "Blackman-Harris"
                                                                          : "rectangular";
  return fmt::format("{} window of {}, overlap {}, lines {} apart", window,
                     unbroken(quantity_text(duration, "s")),
                     unbroken(fmt::format("{:g} %", 100.0 * parameters.overlap)),
                     unbroken(quantity_text(1.0 / duration, "Hz")));
}

std::string filters_text(const RunFileReader& file, const std::vector<std::string>& series) {
  std::map<std::string, std::vector<std::string>> filtered;  // by what the filter does
  std::vector<std::string> unfiltered;
  for (const std::string& one : series) {
    const std::string note = filter_note(file, one);
    (note.empty() ? unfiltered : filtered[note]).push_back(channel_name(one));
  }
  std::string text;
  for (const auto& [note, names] : filtered) {
    const std::string which =
        names.size() == series.size() ? "" : fmt::format(": {}", fmt::join(names, ", "));
    text += fmt::format("L{} before thinning{}. ", note.substr(1), which);
  }
  if (!filtered.empty() && !unfiltered.empty())
    text += fmt::format("Not filtered: {}. ", fmt::join(unfiltered, ", "));
  return text;
}

std::string source_text(const RecordedStretch& run) {
  return fmt::format("{}, scene {}", std::filesystem::path(run.path).filename().string(),
                     run.file.header().scene_hash);
}

double settle_reference(const PictureOptions& options, const std::string& units) {
  if (!options.reference) return standard_reference(units);
  return option_value("--reference", *options.reference, units == "1" ? "" : units,
                      Range::positive());
}

std::vector<NumberedBurst> bursts_in(const RecordedStretch& run, const PictureOptions& options) {
  std::vector<NumberedBurst> found;
  std::size_t number = 0;
  for (const Burst& burst : bursts_of(run.file, run.path, options.band)) {
    ++number;
    if (burst.end >= run.first_time() && burst.start <= run.last_time())
      found.push_back({number, burst});
  }
  return found;
}

}  // namespace stridor
