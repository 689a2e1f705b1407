// stridor plot: pictures of a run file.
#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "app/results/phase_series.hpp"
#include "app/results/pictures.hpp"
#include "app/results/run_functions.hpp"
#include "app/results/universal_file.hpp"
#include "core/errors.hpp"
#include "io/figures/axes.hpp"
#include "io/figures/history_plot.hpp"
#include "io/figures/phase_plot.hpp"
#include "io/figures/spectrum_plot.hpp"

namespace stridor {
namespace {

struct PlotOptions : PictureOptions {
  std::string kind;
  std::optional<std::string> scale;
  UniversalOptions universal;  ///< form of --data
  bool has_figure() const { return !output.empty(); }
};

/// An option that only some kinds of pictures have.
void refuse_option(const PlotOptions& options, const char* name,
                   const std::optional<std::string>& value) {
  if (value)
    throw ConfigError(Refusal::contradiction, name,
                      fmt::format("means nothing for --kind {}", options.kind));
}

/// Channels of a picture where the user names none.
constexpr std::size_t most_default_channels = 8;

/// Series that a picture shows, and series omitted because they were not asked for.
struct Wanted {
  std::vector<std::string> series;
  std::vector<std::string> left_out;  ///< names of channels

  /// Text of a caption about the rest.
  std::string rest_text() const {
    if (left_out.empty()) return "";
    return fmt::format("{} of {} channels; the others with --channel NAME (stridor info lists them). ",
                       series.size(), series.size() + left_out.size());
  }
};

/// The series asked for; where none was, the most useful ones.
Wanted wanted_series(const PlotOptions& options, const RecordedStretch& run, SeriesUse use) {
  Wanted wanted;
  for (const std::string& channel : options.channels)
    wanted.series.push_back(find_series(run, channel, "--channel"));
  if (options.has_figure() && wanted.series.size() > most_panels) {
    throw ConfigError(Refusal::wrong_value, "--channel",
                      fmt::format("{} channels, but one picture holds at most {}; draw several",
                                  wanted.series.size(), most_panels));
  }
  if (!wanted.series.empty()) return wanted;
  wanted.series = chosen_series(run.file, use, most_default_channels);
  if (wanted.series.empty()) {
    throw ConfigError(Refusal::not_recorded, "",
                      run.path + (run.file.series_names().empty()
                                      ? " holds no series to plot; name channels under `record` "
                                        "in the scene"
                                      : " holds no series that has a spectrum; name one with "
                                        "--channel"));
  }
  for (const std::string& series : series_by_use(run.file, use)) {
    if (std::find(wanted.series.begin(), wanted.series.end(), series) == wanted.series.end())
      wanted.left_out.push_back(channel_name(series));
  }
  return wanted;
}

/// Addition of a kind of picture to the JSON object.
using Drawn = Json;

void note_written(const WrittenFunctions& written, Drawn& drawn) {
  drawn["functions"] = written.count;
  if (!written.remark.empty()) drawn["remark"] = written.remark;
}

Drawn draw_history(const PlotOptions& options, const RecordedStretch& run) {
  const auto acceleration = acceleration_channel(run.file);
  const std::vector<NumberedBurst> bursts = bursts_in(run, options);
  const Wanted wanted = wanted_series(options, run, SeriesUse::history);
  Drawn drawn;
  if (options.data)
    note_written(write_history_functions(*options.data, run, wanted.series, options.universal),
                 drawn);
  drawn["left_out"] = wanted.left_out;
  if (!options.has_figure()) return drawn;
  std::vector<Panel> panels;
  for (const std::string& series : wanted.series) {
    panels.push_back(panel_of(run.file, series, run.samples));
    panels.back().curves.front().values = run.finite_values(series);
    if (series != acceleration || bursts.empty()) continue;
    panels.back().title += "  (shaded: bursts)";
    for (const auto& [number, burst] : bursts)
      panels.back().marks.push_back({burst.start, burst.end, std::to_string(number)});
  }
  plot_histories(panels, options.output, "",
                 wanted.rest_text() + filters_text(run.file, wanted.series) + source_text(run) +
                     ".");
  drawn.update({{"panels", panels.size()}, {"bursts", bursts.size()}});
  return drawn;
}

// ---------------------------------------------------------------- one channel against another

Drawn draw_phase(const PlotOptions& options, const RecordedStretch& run) {
  const auto [across, up] = phase_series(options.channels, run);
  const auto axis = [&](const std::string& series) {
    return PhaseAxis{channel_name(series), run.file.units(series), run.finite_values(series)};
  };
  plot_phase(axis(across), axis(up),
             fmt::format("From {:.6g} s (ring) to {:.6g} s (dot). {}{}{}.", run.first_time(),
                         run.last_time(), resolution_text(axis(up), run.interval),
                         filters_text(run.file, {across, up}), source_text(run)),
             options.output);
  return {{"across", channel_name(across)},
          {"up", channel_name(up)},
          {"from", run.first_time()},
          {"to", run.last_time()}};
}

// ---------------------------------------------------------------- amplitude over frequency

AmplitudeScale amplitude_scale(const PlotOptions& options) {
  if (!options.scale || *options.scale == "db") return AmplitudeScale::level;
  if (*options.scale == "linear") return AmplitudeScale::linear;
  throw ConfigError(Refusal::wrong_value, "--scale",
                    fmt::format("'{}' is neither db nor linear", *options.scale));
}

/// A panel for each unit. @throws ConfigError at --reference where there is more than one
SpectrumPanel& panel_in(std::vector<SpectrumPanel>& panels, const std::string& units,
                        const PlotOptions& options) {
  const auto panel = std::find_if(panels.begin(), panels.end(),
                                  [&](const SpectrumPanel& other) { return other.units == units; });
  if (panel != panels.end()) return *panel;
  if (options.reference && !panels.empty()) {
    throw ConfigError(Refusal::wrong_unit, "--reference",
                      fmt::format("the channels have several units ({}, {}); choose those of "
                                  "one with --channel",
                                  panels.front().units, units));
  }
  return panels.emplace_back(SpectrumPanel{units, settle_reference(options, units), {}});
}

Drawn draw_spectrum(const PlotOptions& options, const RecordedStretch& run) {
  const RecordedSettings scene = recorded_settings(run.file, run.path);
  // An eighth of the stretch: 15 pieces at half overlap, a compromise of lines and scatter.
  const auto [parameters, max_frequency] = settle_pieces(
      options, run, scene, std::nullopt, [&](double) { return run.duration() / 8.0; }, 0.5);
  SpectrumPicture picture;
  picture.scale = amplitude_scale(options);
  picture.max_frequency = max_frequency;
  if (options.range) picture.range = option_value("--range", *options.range, "", Range::positive());
  picture.mean_lines = main_lobe_lines(parameters.window);

  Wanted wanted = wanted_series(options, run, SeriesUse::spectrum);
  std::vector<SpectrumPanel> panels;
  std::vector<std::pair<std::string, Spectrum>> spectra;
  Json channels = Json::array();
  for (std::string& series : wanted.series) {
    series = spectral_series(run.file, series);
    const std::string units = run.file.units(series);
    SpectrumPanel& panel = panel_in(panels, units, options);
    spectra.emplace_back(series,
                         make_spectrum(run.finite_values(series), run.interval, parameters));
    panel.curves.push_back({channel_name(series), spectra.back().second});
    channels.push_back(
        {{"channel", channel_name(series)}, {"units", units}, {"reference", panel.reference}});
  }
  Drawn drawn;
  if (options.data) {
    note_written(
        write_spectrum_functions(*options.data, run, spectra,
                                 {parameters, options.max_frequency ? max_frequency : HUGE_VAL},
                                 options.universal),
        drawn);
  }
  const std::vector<NumberedBurst> bursts = bursts_in(run, options);
  for (const auto& [number, burst] : bursts)
    picture.marks.push_back({burst.frequency, std::to_string(number)});
  const std::size_t num_pieces = panels.front().curves.front().spectrum.num_pieces;
  picture.caption = fmt::format(
      "Peak amplitudes, r.m.s. of {} pieces from {:.6g} to {:.6g} s: {}. {}.", num_pieces,
      run.first_time(), run.last_time(), pieces_text(parameters, run.interval), source_text(run));
  if (!bursts.empty())
    picture.caption += fmt::format(" Dashed: frequencies of the bursts{}.",
                                   options.band ? " in the band " + *options.band : "");
  picture.caption += " " + filters_text(run.file, wanted.series) + wanted.rest_text();
  if (options.has_figure()) plot_spectra(panels, picture, options.output);
  drawn.update({{"channels", channels},
                {"window", window_name(parameters.window)},
                {"length", static_cast<double>(parameters.length) * run.interval},
                {"length_samples", parameters.length},
                {"overlap", parameters.overlap},
                {"pieces", num_pieces},
                {"from", run.first_time()},
                {"to", run.last_time()},
                {"max_frequency",
                 options.has_figure() || options.max_frequency ? Json(max_frequency) : Json()},
                {"scale", picture.scale == AmplitudeScale::level ? "db" : "linear"},
                {"bursts", bursts.size()},
                {"left_out", wanted.left_out}});
  return drawn;
}

// ---------------------------------------------------------------- the verb

/// Refuses a form of --data, or outputs, that the kind of picture does not have.
void check_outputs(const PlotOptions& options) {
  const bool is_of_channels = options.kind == "history" || options.kind == "spectrum";
  if (options.kind == "phase") refuse_option(options, "--data", options.data);
  if (options.universal.is_given() && !(is_of_channels && options.data))
    throw ConfigError(
        Refusal::wrong_value, options.universal.is_binary ? "--binary" : "--single",
        "is the form of universal files; name one with --kind history or spectrum and "
        "--data FILE.uff");
  if (is_of_channels && options.data && !is_universal(*options.data))
    throw ConfigError(
        Refusal::wrong_value, "--data",
        fmt::format("'{}' ends neither in .uff nor in .unv (universal file, dataset 58); the "
                    "samples of the run stand in {} already (HDF5)",
                    *options.data, options.file));
  if (!options.has_figure() && !(is_of_channels && options.data))
    throw ConfigError(Refusal::missing, "--output",
                      fmt::format("is missing: name a figure, .png, .svg or .pdf{}",
                                  is_of_channels ? ", or --data FILE.uff alone" : ""));
  if (!options.has_figure()) {
    for (const auto& [name, value] :
         {std::pair{"--scale", &options.scale}, std::pair{"--reference", &options.reference},
          std::pair{"--range", &options.range}})
      if (*value)
        throw ConfigError(Refusal::contradiction, name, "is of the figure; name one with -o");
  }
  if (is_of_channels) check_data_file(options);
}

void check_options(const PlotOptions& options) {
  const bool is_spectrogram = options.kind == "spectrogram";
  const bool is_spectrum = options.kind == "spectrum";
  if (!is_spectrum) refuse_option(options, "--scale", options.scale);
  if (is_spectrogram || is_spectrum) return;
  refuse_option(options, "--window", options.window);
  refuse_option(options, "--length", options.length);
  refuse_option(options, "--overlap", options.overlap);
  refuse_option(options, "--max-frequency", options.max_frequency);
  refuse_option(options, "--reference", options.reference);
  refuse_option(options, "--range", options.range);
  if (options.kind == "phase") refuse_option(options, "--band", options.band);
}

ExitCode plot(const PlotOptions& options) {
  check_options(options);
  check_outputs(options);
  if (options.kind == "spectrogram") return draw_spectrogram(options);
  if (options.has_figure()) check_figure(options.output, options.common);
  const RecordedStretch run = open_stretch(options);
  const Drawn drawn = options.kind == "history" ? draw_history(options, run)
                      : options.kind == "phase" ? draw_phase(options, run)
                                                : draw_spectrum(options, run);
  if (options.common.json) {
    Json object = {{"figure", options.has_figure() ? Json(options.output) : Json(nullptr)},
                   {"data", options.data ? Json(*options.data) : Json(nullptr)}};
    object.update(drawn);
    print_json(object);
  } else {
    if (options.has_figure()) fmt::print("{}\n", options.output);
    if (options.data) fmt::print("{}\n", *options.data);
    if (const auto remark = drawn.find("remark"); remark != drawn.end())
      fmt::print("{}\n", remark->get<std::string>());
    if (const auto rest = drawn.find("left_out"); rest != drawn.end() && !rest->empty())
      fmt::print(
          "{} more channels are left out; name those wanted with --channel (stridor info "
          "lists them)\n",
          rest->size());
  }
  return ExitCode::done;
}

}  // namespace

void add_plot_command(CLI::App& program, Action& action, const std::string& command_line) {
  auto options = std::make_shared<PlotOptions>();
  options->command_line = command_line;
  CLI::App* verb = program.add_subcommand("plot", "Pictures of a run file");
  verb->add_option("file", options->file, "Run file (HDF5)")->required();
  verb->add_option("--kind", options->kind,
                   "history, spectrogram, phase (one channel against another) or spectrum")
      ->check(CLI::IsMember({"history", "spectrogram", "phase", "spectrum"}))
      ->required();
  verb->add_option("-o,--output", options->output,
                   "Figure to write: .png, .svg or .pdf; with --data it may be left out");
  verb->add_option(
          "--channel", options->channels,
          "Channel to draw or write (repeatable); default: the eight of most use, for a phase plot "
          "the first pair of displacement and velocity")
      ->take_all()
      ->allow_extra_args(false);
  add_spectrum_options(*verb, *options);
  verb->add_option("--scale", options->scale, "Amplitudes of a spectrum: db or linear");
  verb->add_option(
      "--data", options->data,
      "Write numbers too: histories and spectra as a universal file (.uff, .unv: dataset "
      "58), a spectrogram as HDF5");
  add_universal_options(*verb, options->universal);
  add_picture_options(*verb, *options);
  verb->callback([options, &action] { action = [options] { return plot(*options); }; });
}

}  // namespace stridor
