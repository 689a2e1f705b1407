#include "app/command.hpp"

#include <fmt/format.h>

#include <cmath>

#include "core/errors.hpp"
#include "io/gnuplot.hpp"

namespace stridor {

void add_scene_options(CLI::App& verb, CommonOptions& options) {
  verb.add_option("--set", options.sets,
                  "Change a key of the scene: --set key.path=value (repeatable)")
      ->take_all()
      ->allow_extra_args(false)
      ->type_name("KEY=VALUE");
  verb.add_option("--threads", options.threads, "Threads to use; a single run uses one")
      ->check(CLI::Range(1, 1024));
}

void add_json_option(CLI::App& verb, CommonOptions& options) {
  verb.add_flag("--json", options.json, "Print one JSON object on stdout and nothing else there");
}

void add_force_option(CLI::App& verb, CommonOptions& options) {
  verb.add_flag("--force", options.force, "Overwrite the output file if it exists");
}

void check_figure(const std::filesystem::path& figure, const CommonOptions& options) {
  check_figure_name(figure);
  check_replaceable(figure.string(), options.overwrite());
}

Json number(double value) {
  return std::isfinite(value) ? Json(value) : Json(nullptr);
}

std::vector<double> spaced_values(const char* option, const std::vector<double>& range) {
  const double count = range[2];
  if (!(range[0] > 0.0) || !(range[1] > range[0]) || !std::isfinite(range[1]))
    throw ConfigError(option, "needs two positive numbers, the smaller one first");
  if (!(count >= 4.0) || !(count <= 1000.0) || count != std::trunc(count))
    throw ConfigError(option, fmt::format("{:g} points are not a whole number, 4 to 1000", count));
  std::vector<double> values;
  values.reserve(static_cast<std::size_t>(count));
  for (int k = 0; k < static_cast<int>(count); ++k)
    values.push_back(range[0] * std::pow(range[1] / range[0], k / (count - 1.0)));
  return values;
}

}  // namespace stridor
