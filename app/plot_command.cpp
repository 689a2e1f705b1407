// stridor plot: pictures of a run file.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <limits>

#include "app/command.hpp"
#include "core/errors.hpp"
#include "core/suggestion.hpp"
#include "io/history_plot.hpp"
#include "io/run_file.hpp"

namespace stridor {
namespace {

struct PlotOptions {
  CommonOptions common;
  std::string file;
  std::string kind = "history";
  std::string output;
  std::vector<std::string> channels;
  double from = -std::numeric_limits<double>::infinity();
  double to = std::numeric_limits<double>::infinity();
};

/// "/channels/cantilever.free_end.y.acceleration" as the user wrote it, "/contact/contact/force" as
/// "contact.force".
std::string channel_name(const std::string& path) {
  if (path.rfind("/channels/", 0) == 0) return path.substr(10);
  std::string name = path.substr(path.find('/', 1) + 1);
  std::replace(name.begin(), name.end(), '/', '.');
  return name;
}

std::vector<std::string> wanted_series(const PlotOptions& options, const RunFileReader& file) {
  const std::vector<std::string> all = file.series_names();
  if (options.channels.empty()) return all;
  std::vector<std::string> names;
  for (const std::string& path : all) names.push_back(channel_name(path));
  std::vector<std::string> wanted;
  for (const std::string& channel : options.channels) {
    const auto found = std::find(names.begin(), names.end(), channel);
    if (found == names.end()) {
      throw ConfigError("--channel",
                        fmt::format("{} has no channel '{}'{} (it has: {})", options.file, channel,
                                    did_you_mean(channel, names), fmt::join(names, ", ")));
    }
    wanted.push_back(all[static_cast<std::size_t>(found - names.begin())]);
  }
  return wanted;
}

ExitCode plot(const PlotOptions& options) {
  check_figure_name(options.output);
  if (!options.common.force && std::filesystem::exists(options.output)) {
    throw FileError(options.output, "", "exists; use --force to overwrite it");
  }
  const RunFileReader file(options.file);
  std::vector<Panel> panels;
  for (const std::string& path : wanted_series(options, file)) {
    Curve curve;
    const std::vector<double> values = file.series(path);
    for (std::size_t i = 0; i < values.size(); ++i) {
      const double time = file.times()[i];
      if (time < options.from || time > options.to) continue;
      curve.times.push_back(time);
      curve.values.push_back(values[i]);
    }
    const std::string name = channel_name(path);
    const std::size_t dot = name.rfind('.');
    std::string quantity = name.substr(dot + 1);
    std::replace(quantity.begin(), quantity.end(), '_', ' ');
    panels.push_back({name.substr(0, dot), quantity, file.units(path), {std::move(curve)}});
  }
  if (panels.empty())
    throw ConfigError(
        "", options.file + " holds no series to plot; name channels under `record` in the scene");
  plot_histories(panels, options.output, "");
  if (options.common.json) {
    fmt::print("{}\n", Json{{"figure", options.output}, {"panels", panels.size()}}.dump(2));
  } else {
    fmt::print("{}\n", options.output);
  }
  return ExitCode::done;
}

}  // namespace

void add_plot_command(CLI::App& program, Action& action) {
  auto options = std::make_shared<PlotOptions>();
  CLI::App* verb = program.add_subcommand("plot", "Pictures of a run file");
  verb->add_option("file", options->file, "Run file (HDF5)")->required();
  verb->add_option("--kind", options->kind, "What to draw")
      ->check(CLI::IsMember({"history"}))
      ->required();
  verb->add_option("-o,--output", options->output, "Figure to write: .png, .svg or .pdf")
      ->required();
  verb->add_option("--channel", options->channels, "Channel to draw (repeatable); default: all")
      ->take_all()
      ->allow_extra_args(false);
  verb->add_option("--from", options->from, "Start of the time axis, s");
  verb->add_option("--to", options->to, "End of the time axis, s");
  add_json_option(*verb, options->common);
  add_force_option(*verb, options->common);
  verb->callback([options, &action] { action = [options] { return plot(*options); }; });
}

}  // namespace stridor
