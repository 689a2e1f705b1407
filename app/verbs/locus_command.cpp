// stridor locus: eigenvalues of a scene along one of its keys.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <filesystem>
#include <memory>
#include <numbers>

#include "app/stability/axis_units.hpp"
#include "app/stability/eigenvalue_report.hpp"
#include "app/stability/family_locus.hpp"
#include "app/stability/kept_locus.hpp"
#include "app/stability/locus_curves.hpp"
#include "app/stability/locus_progress.hpp"
#include "app/stability/stability.hpp"
#include "app/stability/verdict.hpp"
#include "core/errors.hpp"
#include "io/figures/gnuplot.hpp"
#include "io/figures/locus_plot.hpp"

namespace stridor {
namespace {

struct LocusCommandOptions {
  StabilityOptions stability;
  RangeOptions range;
  std::optional<std::string> output;
  std::optional<std::string> figure;
  std::optional<std::string> history;
  std::string command_line;
};

Json complex_list(const std::vector<std::complex<double>>& eigenvalues) {
  Json list = Json::array();
  for (const std::complex<double>& s : eigenvalues) list.push_back({s.real(), s.imag()});
  return list;
}

/// The eigenvalue of a window where it grows most, 1/s.
std::complex<double> fastest_of(const UnstableWindow& window) {
  return {window.growth_max, 2.0 * std::numbers::pi * window.frequency};
}

/// @param trusted up to where the model answers, in the unit of the frequencies
Json windows_json(const std::vector<TimedWindow>& windows, double trusted) {
  Json list = Json::array();
  for (const TimedWindow& one : windows) {
    list.push_back({{"from", one.window.from},
                    {"to", one.window.to},
                    {"frequency", one.window.frequency},
                    {"growth_max", one.window.growth_max},
                    {"growth_integral", number(one.window.growth_integral)},
                    {"value_max", one.window.value_max},
                    {"from_time", number(one.from_time)},
                    {"to_time", number(one.to_time)},
                    {"gain", number(one.gain)},
                    {"oscillates", one.window.frequency > 0.0},
                    {"resolved", is_resolved(fastest_of(one.window), trusted)}});
  }
  return list;
}

/// @param trusted up to where the model answers, in the unit of the frequencies
void print_windows(const std::vector<TimedWindow>& windows, const NumericKey& key, double trusted) {
  if (windows.empty()) {
    fmt::print("no eigenvalue grows\n");
    return;
  }
  bool has_real = false, has_unresolved = false;
  fmt::print("{:>12}  {:>12}  {:>14}  {:>12}  {:>8}  {:>19}\n", "from", "to", "frequency (Hz)",
             "growth (1/s)", "gain", "time (s)");
  for (const TimedWindow& one : windows) {
    const UnstableWindow& window = one.window;
    const bool is_real = window.frequency == 0.0;
    const bool is_fast = !is_resolved(fastest_of(window), trusted);
    has_real = has_real || is_real;
    has_unresolved = has_unresolved || is_fast;
    fmt::print("{:>12.8g}  {:>12.8g}  {:>14}  {:>12.4f}", window.from, window.to,
               is_real ? std::string("none") : fmt::format("{:.2f}", window.frequency),
               window.growth_max);
    if (std::isfinite(one.from_time) && std::isfinite(one.to_time))
      fmt::print("  {:>8}  {:>8.4f} to {:.4f}",
                 is_fast ? std::string("-") : fmt::format("{:.3f}", one.gain), one.from_time,
                 one.to_time);
    fmt::print("{}\n", is_fast ? "  (above what the reduction resolves)" : "");
  }
  fmt::print("unstable windows of {}{}\n", key.path,
             key.unit.empty() ? "" : fmt::format(" ({})", printed_units(key)));
  if (has_real)
    fmt::print(
        "frequency none: a real eigenvalue; sliding is left without oscillation, by divergence or "
        "by "
        "friction that falls with the sliding velocity\n");
  if (has_unresolved)
    fmt::print(
        "no gain where the reduction does not resolve the growth: more modes change its rate\n");
}

void check_outputs(const LocusCommandOptions& options) {
  if (options.output) check_output(*options.output, options.stability.common.overwrite());
  for (const auto& figure : {options.figure, options.history}) {
    if (figure) check_figure(*figure, options.stability.common);
  }
}

/// The locus found, and the texts that the outputs share.
struct FoundLocus {
  const LocusCommandOptions& options;
  const StabilityScene& scene;
  const KeyRange& range;
  Locus locus;
  std::vector<TimedWindow> windows;
  double trusted = 0.0;  ///< up to where the model answers, Hz
  double highest = 0.0;  ///< up to where the verdict holds, Hz
};

LocusPicture picture_of(const FoundLocus& found) {
  const StabilityOptions& stability = found.options.stability;
  const KeyRange& range = found.range;
  const Locus& locus = found.locus;
  const LoadedScene& loaded = found.scene.loaded();
  LocusPicture picture;
  const AxisUnit unit =
      axis_unit(range.key, {found.options.range.from, found.options.range.to}, &loaded.tree);
  picture.parameter = range.key.path;
  picture.units = unit.name;
  picture.curves = curves_of(locus, highest_frequency(locus));
  for (LocusCurve& curve : picture.curves) curve.parameter = unit.numbers(curve.parameter);
  for (const UnstableWindow& window : locus.unstable) {
    picture.windows.push_back(
        {unit.number(window.from), unit.number(window.to), window.frequency, window.growth_max});
  }
  picture.caption = fmt::format(
      "The {}{}, {} from {} to {}; {}, scene {}.", stability.window_words(),
      found.scene.about_text(stability), range.key.path, unit.number(range.values.front()),
      fmt::format("{:g}{}", unit.number(range.values.back()),
                  unit.name == "1" ? "" : " " + unit.name),
      std::filesystem::path(stability.scene).filename().string(), loaded.hash());
  return picture;
}

Json locus_json(const FoundLocus& found) {
  const StabilityOptions& stability = found.options.stability;
  Json object = {{"parameter", found.range.key.path},
                 {"units", printed_units(found.range.key)},
                 {"about", stability.about},
                 {"method", found.locus.method},
                 {"values", found.range.values},
                 {"eigenvalues", Json::array()},
                 {"unstable", windows_json(found.windows, found.trusted)},
                 {"window", {0.0, number(found.highest)}},
                 {"unverified", found.locus.unverified},
                 {"unresolved", found.locus.unresolved},
                 {"file", found.options.output ? Json(*found.options.output) : Json(nullptr)}};
  for (const auto& list : found.locus.eigenvalues)
    object["eigenvalues"].push_back(complex_list(list));
  return object;
}

ExitCode locus(LocusCommandOptions options) {
  check_outputs(options);
  StabilityOptions& stability = options.stability;
  const StabilityScene scene = load_stability_scene(stability);
  const KeyRange range = make_range(scene, options.range);
  const auto family = scene.family({range.key}, stability.geometry());
  const double first = range.values.front();
  std::optional<LocusProgress> progress(std::in_place, "locus", *family, range);
  FoundLocus found{options, scene, range, {}, {}};
  found.locus =
      locus_along(*family, range.key, 0, {first}, range.values, stability.locus_options());
  progress.reset();
  // Before anything is written: an empty locus is no loss.
  if ((options.figure || options.history) &&
      std::ranges::all_of(found.locus.eigenvalues, [](const auto& all) { return all.empty(); }))
    throw ConfigError(Refusal::wrong_value, stability.below ? "--below" : "scene",
                      "there is no eigenvalue to draw; ask for a higher frequency");
  found.trusted = trusted_along(*family, range.values);
  found.highest = verdict_limit(found.locus, stability.window(), found.trusted);

  found.windows = timed_windows(found.locus, range.key, scene, *family);
  if (options.output)
    write_locus(*options.output, found.locus, found.windows,
                {scene, stability, range.key, options.command_line, found.trusted});
  if (options.figure || options.history) {
    const LocusPicture picture = picture_of(found);
    if (options.figure) plot_locus(picture, *options.figure);
    if (options.history) plot_locus_histories(picture, *options.history);
  }

  if (stability.common.json) {
    print_json(locus_json(found));
    return ExitCode::done;
  }
  print_windows(found.windows, range.key, found.trusted);
  fmt::print("{}{}\n", window_text(found.highest), limit_text(found.highest, found.trusted));
  print_resolution(found.locus, range.key);
  for (const auto& file : {options.output, options.figure, options.history})
    if (file) fmt::print("{}\n", *file);
  return ExitCode::done;
}

}  // namespace

void add_locus_command(CLI::App& program, Action& action, const std::string& command_line) {
  auto options = std::make_shared<LocusCommandOptions>();
  options->command_line = command_line;
  CLI::App* verb = program.add_subcommand("locus", "Eigenvalues along one key of a scene");
  add_stability_options(*verb, options->stability);
  add_range_options(*verb, options->range);
  verb->add_option("-o,--output", options->output,
                   "File to write (HDF5), as `spectrogram --predict` reads it");
  verb->add_option("--figure", options->figure,
                   "Picture of frequency against growth rate: .png, .svg or .pdf");
  verb->add_option("--history", options->history,
                   "Picture of growth rate and frequency against the parameter");
  add_force_option(*verb, options->stability.common);
  verb->callback([options, &action] { action = [options] { return locus(*options); }; });
}

}  // namespace stridor
