// stridor threshold: values of a key at which a scene becomes stable or unstable.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <memory>
#include <numbers>
#include <optional>

#include "app/stability/family_locus.hpp"
#include "app/stability/kept_locus.hpp"
#include "app/stability/locus_progress.hpp"
#include "app/stability/stability.hpp"
#include "app/stability/verdict.hpp"
#include "core/activity.hpp"
#include "io/hdf5/part_file.hpp"

namespace stridor {
namespace {

struct ThresholdOptions {
  StabilityOptions stability;
  RangeOptions range;
  std::optional<std::string> output;
  std::string command_line;
};

/// Values of the scan for roots, besides the values asked for.
constexpr int scanned = 4001;

/// Values from one end of a range to the other, at equal distances and, where both ends are
/// positive, at equal ratios as well.
std::vector<double> scan_values(const KeyRange& range) {
  const double from = range.values.front();
  const double to = range.values.back();
  std::vector<double> values = range.values;
  for (const Spacing spacing : {Spacing::linear, Spacing::logarithmic}) {
    if (spacing == Spacing::logarithmic && !(from > 0.0)) continue;
    const std::vector<double> more = spaced_values(range.key, from, to, scanned, spacing);
    values.insert(values.end(), more.begin(), more.end());
  }
  std::sort(values.begin(), values.end());
  values.erase(std::unique(values.begin(), values.end()), values.end());
  return values;
}

/// Every sign change of a margin that is cheap to compute.
ExitCode threshold(const ThresholdOptions& options, const KeyRange& range, GrowthField& field) {
  const auto margin = [&](double value) { return field.margin(value, 0.0); };
  const std::vector<double> values = scan_values(range);
  std::optional<Activity> looking(std::in_place, "looking for changes of sign");
  const std::vector<double> roots = sign_changes(margin, values);
  looking.reset();
  const bool starts_unstable = margin(range.values.front()) > 0.0;
  Json object = {{"parameter", range.key.path},
                 {"from", range.values.front()},
                 {"to", range.values.back()},
                 {"window", {0.0, nullptr}},
                 {"roots", Json::array()},
                 {"file", options.output ? Json(*options.output) : Json(nullptr)}};
  bool is_unstable = starts_unstable;
  for (const double root : roots) {
    is_unstable = !is_unstable;
    const char* beyond = is_unstable ? "unstable" : "stable";
    const double frequency = field.leading(root, 0.0).imag() / (2.0 * std::numbers::pi);
    object["roots"].push_back({{"value", root}, {"frequency", frequency}, {"beyond", beyond}});
    if (!options.stability.common.json)
      fmt::print("{:<40}  {:>12.6g} Hz  {} beyond\n", value_text(range.key, root), frequency,
                 beyond);
  }
  if (options.stability.common.json) {
    print_json(object);
  } else if (roots.empty()) {
    fmt::print("{} everywhere between {} and {}, by {} values and the extrema between them\n",
               starts_unstable ? "unstable" : "stable", value_text(range.key, range.values.front()),
               value_text(range.key, range.values.back()), values.size());
  }
  if (options.output && !options.stability.common.json) fmt::print("{}\n", *options.output);
  return ExitCode::done;
}

/// Along the values asked for, into the file where one is.
Locus followed_locus(const ThresholdOptions& options, const StabilityScene& scene,
                     const KeyRange& range, StabilityFamily& family) {
  std::optional<LocusProgress> progress(std::in_place, "threshold", family, range);
  Locus locus = locus_along(family, range.key, 0, {range.values.front()}, range.values,
                            options.stability.locus_options());
  progress.reset();
  if (options.output)
    write_locus(*options.output, locus, timed_windows(locus, range.key, scene, family),
                {scene, options.stability, range.key, options.command_line,
                 trusted_along(family, range.values)});
  return locus;
}

ExitCode threshold(ThresholdOptions options) {
  StabilityOptions& stability = options.stability;
  if (options.output) check_output(*options.output, stability.common.overwrite());
  const StabilityScene scene = load_stability_scene(stability);
  const KeyRange range = make_range(scene, options.range);
  const auto family = scene.family({range.key}, stability.geometry());
  if (const auto field = scene.growth_field({range.key})) {
    if (options.output) followed_locus(options, scene, range, *family);
    return threshold(options, range, *field);
  }
  const Locus locus = followed_locus(options, scene, range, *family);
  const std::vector<StabilityChange> changes = stability_changes(locus);
  const double trusted = trusted_along(*family, range.values);
  const double highest = verdict_limit(locus, stability.window(), trusted);

  if (stability.common.json) {
    Json object = {{"parameter", range.key.path},
                   {"about", stability.about},
                   {"method", locus.method},
                   {"from", range.values.front()},
                   {"to", range.values.back()},
                   {"roots", Json::array()},
                   {"crossings", Json::array()},
                   {"window", {0.0, number(highest)}},
                   {"unverified", locus.unverified},
                   {"unresolved", locus.unresolved},
                   {"file", options.output ? Json(*options.output) : Json(nullptr)}};
    for (const StabilityChange& change : changes) {
      object["roots"].push_back({{"value", change.value},
                                 {"frequency", change.frequency},
                                 {"beyond", change.is_unstable_beyond ? "unstable" : "stable"}});
    }
    for (const Crossing& crossing : locus.crossings) {
      object["crossings"].push_back({{"value", crossing.value},
                                     {"frequency", crossing.frequency},
                                     {"direction", crossing.direction}});
    }
    print_json(object);
    return ExitCode::done;
  }
  for (const StabilityChange& change : changes) {
    fmt::print("{:<40}  {:>12.3f} Hz  {} beyond\n", value_text(range.key, change.value),
               change.frequency, change.is_unstable_beyond ? "unstable" : "stable");
  }
  if (changes.empty()) {
    fmt::print("{} {} between {} and {}\n", locus.unstable.empty() ? "stable" : "unstable",
               reach_text(locus), value_text(range.key, range.values.front()),
               value_text(range.key, range.values.back()));
  }
  fmt::print("{}{}\n", window_text(highest), limit_text(highest, trusted));
  print_resolution(locus, range.key);
  if (options.output) fmt::print("{}\n", *options.output);
  return ExitCode::done;
}

}  // namespace

void add_threshold_command(CLI::App& program, Action& action, const std::string& command_line) {
  auto options = std::make_shared<ThresholdOptions>();
  options->command_line = command_line;
  CLI::App* verb = program.add_subcommand(
      "threshold", "Values of a key at which the sliding state becomes stable or unstable");
  add_stability_options(*verb, options->stability);
  add_range_options(*verb, options->range);
  verb->add_option("-o,--output", options->output,
                   "File to write (HDF5): the locus along the key, as `locus` writes it");
  add_force_option(*verb, options->stability.common);
  verb->callback([options, &action] { action = [options] { return threshold(*options); }; });
}

}  // namespace stridor
