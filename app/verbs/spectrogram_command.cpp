// stridor spectrogram: amplitude over time and frequency of one channel of a run file.
#include <fmt/format.h>

#include <cmath>
#include <filesystem>

#include "app/results/pictures.hpp"
#include "app/results/universal_file.hpp"
#include "app/stability/prediction.hpp"
#include "core/activity.hpp"
#include "core/errors.hpp"
#include "core/version.hpp"
#include "io/figures/axes.hpp"
#include "io/figures/spectrogram_plot.hpp"
#include "io/results/spectrogram_file.hpp"

namespace stridor {
namespace {

namespace fs = std::filesystem;

/// Amplitudes of a spectrogram held in memory, 2 GB.
constexpr double most_amplitudes = 2.5e8;

std::string shown_series(const PictureOptions& options, const RecordedStretch& run,
                         const std::optional<SpectrogramSection>& section) {
  if (options.channels.size() > 1)
    throw ConfigError(Refusal::wrong_value, "--channel",
                      "a spectrogram shows one channel; give the option once");
  if (!options.channels.empty()) return find_series(run, options.channels.front(), "--channel");
  if (section && section->channel)
    return find_series(run, *section->channel, "spectrogram.channel");
  if (const auto series = acceleration_channel(run.file)) return *series;
  std::vector<std::string> names;
  for (const std::string& series : run.file.series_names()) names.push_back(channel_name(series));
  throw ConfigError(Refusal::not_recorded, "--channel",
                    fmt::format("{} has no acceleration; name one of its channels: {}", run.path,
                                fmt::join(names, ", ")));
}

void check_size(const SpectrogramParameters& parameters, const RecordedStretch& run) {
  const double length = static_cast<double>(parameters.length);
  const double pieces = static_cast<double>(run.samples.size()) /
                        std::max(1.0, std::round(length * (1.0 - parameters.overlap)));
  if (pieces * (0.5 * length + 1.0) <= most_amplitudes) return;
  throw ConfigError(Refusal::too_large, "--overlap",
                    fmt::format("{} pieces of {} lines do not fit into memory; lower the overlap, "
                                "or choose a shorter stretch with --from, --to",
                                std::llround(pieces), parameters.length / 2 + 1));
}

std::vector<SpectrogramMark> burst_marks(const std::vector<NumberedBurst>& bursts) {
  std::vector<SpectrogramMark> marks;
  marks.reserve(bursts.size());
  for (const auto& [number, burst] : bursts) {
    marks.push_back({burst.start, burst.end, burst.frequency,
                     fmt::format("{}: {}", number, quantity_text(burst.frequency, "Hz")),
                     std::to_string(number), MarkStyle::found});
  }
  return marks;
}

/// The channel in which bursts are sought.
std::string acceleration_name(const RunFileReader& file) {
  const auto series = acceleration_channel(file);
  return series ? channel_name(*series) : "the run";
}

/// Bursts are sought in one channel, whichever is shown.
void check_band(const PictureOptions& options, const RecordedStretch& run,
                const std::string& series) {
  const auto searched = acceleration_channel(run.file);
  if (!options.band || !searched || searched == series) return;
  throw ConfigError(Refusal::contradiction, "--band",
                    fmt::format("seeks bursts in {}, but the spectrogram is that of {}; "
                                "leave one of --band and --channel away",
                                acceleration_name(run.file), channel_name(series)));
}

Attributes data_attributes(const Json& settings, const RecordedStretch& run,
                           const std::string& command_line) {
  const RunFileHeader& header = run.file.header();
  Attributes attributes{{"command", command_line},
                        {"version", std::string(version)},
                        {"commit", std::string(commit)},
                        {"date", utc_now()},
                        {"run_file", run.path},
                        {"run_command", header.command},
                        {"run_version", header.version},
                        {"run_commit", header.commit},
                        {"scene", scene_of_command(header.command)},
                        {"scene_hash", header.scene_hash},
                        {"scene_resolved", header.scene_resolved},
                        {"interval", run.interval}};
  for (const auto& [name, value] : settings.items()) {
    if (value.is_number()) attributes.emplace_back(name, value.get<double>());
    if (value.is_string()) attributes.emplace_back(name, value.get<std::string>());
  }
  return attributes;
}

/// A spectrogram with its marks and its caption.
struct DrawnSpectrogram {
  std::string series;
  PieceSettings pieces;
  SpectrogramPicture picture;
  std::vector<NumberedBurst> bursts;
  std::vector<TimedWindow> windows;  ///< of --predict
  std::vector<PredictedBurst> predictions;
  double highest = 0.0;  ///< amplitude
};

/// The picture but for its numbers.
void describe(const PictureOptions& options, const RecordedStretch& run, DrawnSpectrogram& drawn) {
  SpectrogramPicture& picture = drawn.picture;
  picture.title = channel_name(drawn.series);
  picture.units = run.file.units(drawn.series);
  picture.max_frequency = drawn.pieces.max_frequency;
  picture.reference = settle_reference(options, picture.units);
  if (options.range) picture.range = option_value("--range", *options.range, "", Range::positive());
  picture.mean_lines = main_lobe_lines(drawn.pieces.parameters.window);
  drawn.bursts = bursts_in(run, options);
  picture.marks = burst_marks(drawn.bursts);
  picture.caption =
      fmt::format("Peak amplitudes: {}. {}{}.", pieces_text(drawn.pieces.parameters, run.interval),
                  filters_text(run.file, {drawn.series}), source_text(run));
  if (!drawn.bursts.empty()) {
    picture.caption +=
        fmt::format(" Dashed: bursts in {}{}, frequency at the steepest rise.",
                    acceleration_name(run.file), options.band ? ", band " + *options.band : "");
  }
  if (!options.predict) return;
  drawn.predictions = match_bursts(drawn.windows, drawn.bursts);
  for (SpectrogramMark& mark : predicted_marks(drawn.predictions))
    picture.marks.push_back(std::move(mark));
  picture.caption += fmt::format(" Dotted: unstable windows of {}.",
                                 fs::path(*options.predict).filename().string());
}

Json settings_json(const RecordedStretch& run, const DrawnSpectrogram& drawn) {
  const SpectrogramParameters& parameters = drawn.pieces.parameters;
  return {{"channel", drawn.picture.title},
          {"units", drawn.picture.units},
          {"window", window_name(parameters.window)},
          {"length", static_cast<double>(parameters.length) * run.interval},
          {"length_samples", parameters.length},
          {"overlap", parameters.overlap},
          {"from", run.first_time()},
          {"to", run.last_time()}};
}

void print_drawn(const PictureOptions& options, const RecordedStretch& run,
                 const DrawnSpectrogram& drawn, const Spectrogram& spectrogram,
                 const Json& settings) {
  if (options.common.json) {
    const SpectrogramPicture& picture = drawn.picture;
    Json object = {{"figure", options.output},
                   {"data", options.data ? Json(*options.data) : Json(nullptr)}};
    object.update(settings);
    object["max_frequency"] = picture.max_frequency;
    object["reference"] = picture.reference;
    object["range"] = picture.range;
    object["pieces"] = spectrogram.times.size();
    object["line_spacing"] = spectrogram.frequencies[1];
    object["highest_amplitude"] = drawn.highest;
    object["highest_level"] =
        drawn.highest > 0.0 ? number(decibels(drawn.highest, picture.reference)) : Json(nullptr);
    object["bursts"] = drawn.bursts.size();
    if (options.predict) {
      object["prediction"] = prediction_json(drawn.predictions);
      object["unexplained"] = unexplained(drawn.predictions, drawn.bursts);
    }
    print_json(object);
    return;
  }
  fmt::print("{}\n", options.output);
  if (options.data) fmt::print("{}\n", *options.data);
  if (options.band && drawn.bursts.empty())
    fmt::print("no bursts of {} in the band {}\n", acceleration_name(run.file), *options.band);
  if (!options.predict) return;
  print_prediction(drawn.predictions);
  const std::vector<std::size_t> others = unexplained(drawn.predictions, drawn.bursts);
  if (!others.empty()) fmt::print("{}\n", unexplained_text(others));
}

}  // namespace

ExitCode draw_spectrogram(const PictureOptions& options) {
  check_figure(options.output, options.common);
  if (options.data && is_universal(*options.data))
    throw ConfigError(
        Refusal::wrong_value, "--data",
        fmt::format("'{}' is named like a universal file, which holds no spectrograms; "
                    "name it .h5 (HDF5)",
                    *options.data));
  check_data_file(options);
  const RecordedStretch run = open_stretch(options);
  const RecordedSettings scene = recorded_settings(run.file, run.path);
  DrawnSpectrogram drawn;
  drawn.series = spectral_series(run.file, shown_series(options, run, scene.spectrogram));
  if (options.predict) {
    const RunFileHeader& header = run.file.header();
    // Where no band of the scene says where bursts are sought no locus looks too low.
    const std::vector<double>& band = scene.measure.band;
    drawn.windows = read_predictions(*options.predict, {header.scene_hash, header.scene_resolved},
                                     band.empty() || options.band ? 0.0 : band.back());
  }
  check_band(options, run, drawn.series);
  drawn.pieces = settle_pieces(
      options, run, scene, scene.spectrogram,
      [&](double highest) { return std::sqrt(run.duration() / highest); }, 0.75);
  check_size(drawn.pieces.parameters, run);
  describe(options, run, drawn);

  std::optional<Activity> transforming(std::in_place, "transforming the pieces");
  const Spectrogram spectrogram = make_spectrogram(run.finite_values(drawn.series), run.interval,
                                                   drawn.pieces.parameters, run.first_time());
  drawn.highest =
      highest_amplitude(spectrogram, drawn.picture.max_frequency, drawn.picture.mean_lines);
  transforming.reset();
  const Json settings = settings_json(run, drawn);
  if (options.data) {
    write_spectrogram_file(*options.data, options.common.overwrite(), spectrogram,
                           drawn.picture.units,
                           data_attributes(settings, run, options.command_line));
  }
  plot_spectrogram(spectrogram, drawn.picture, options.output);
  print_drawn(options, run, drawn, spectrogram, settings);
  return ExitCode::done;
}

void add_spectrogram_command(CLI::App& program, Action& action, const std::string& command_line) {
  auto options = std::make_shared<PictureOptions>();
  options->command_line = command_line;
  CLI::App* verb =
      program.add_subcommand("spectrogram", "Amplitude over time and frequency of one channel");
  verb->add_option("file", options->file, "Run file (HDF5)")->required();
  verb->add_option("-o,--output", options->output,
                   "Figure to write: .png, .svg or .pdf; default: FILE_spectrogram.png");
  verb->add_option("--channel", options->channels,
                   "Channel to show; default: the acceleration in which bursts are sought")
      ->take_all()
      ->allow_extra_args(false);
  verb->add_option("--predict", options->predict,
                   "Locus file (`locus -o`) whose unstable windows are marked and set beside the "
                   "bursts");
  add_spectrum_options(*verb, *options);
  verb->add_option("--data", options->data, "Write the spectrogram also as numbers (HDF5)");
  add_picture_options(*verb, *options);
  verb->callback([options, &action] {
    if (options->output.empty()) {
      fs::path figure = options->file;
      figure.replace_filename(figure.stem().string() + "_spectrogram.png");
      options->output = figure.string();
    }
    action = [options] { return draw_spectrogram(*options); };
  });
}

}  // namespace stridor
