// stridor threshold: values of a key at which a scene becomes stable or unstable.
#include <fmt/format.h>

#include <memory>

#include "app/stability.hpp"

namespace stridor {
namespace {

struct ThresholdOptions {
  StabilityOptions stability;
  RangeOptions range;
};

ExitCode threshold(const ThresholdOptions& options) {
  const StabilityOptions& stability = options.stability;
  const LoadedScene loaded = load_scene(stability.scene, stability.common.sets);
  const KeyRange range = make_range(loaded.scene, options.range);
  StabilityFamily family(loaded, {range.key}, stability.geometry());
  const Locus locus = locus_along(family, range.key, 0, {range.values.front()}, range.values,
                                  stability.locus_options());
  const std::vector<StabilityChange> changes = stability_changes(locus);

  if (stability.common.json) {
    Json object = {{"parameter", range.key.path}, {"about", stability.about},
                   {"method", stability.method},  {"from", range.values.front()},
                   {"to", range.values.back()},   {"roots", Json::array()},
                   {"crossings", Json::array()},  {"unverified", locus.unverified}};
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
    fmt::print("{}\n", object.dump(2));
    return ExitCode::done;
  }
  for (const StabilityChange& change : changes) {
    fmt::print("{:<40}  {:>12.3f} Hz  {} beyond\n", value_text(range.key, change.value),
               change.frequency, change.is_unstable_beyond ? "unstable" : "stable");
  }
  if (changes.empty()) {
    fmt::print("{} everywhere between {} and {}\n", locus.unstable.empty() ? "stable" : "unstable",
               value_text(range.key, range.values.front()),
               value_text(range.key, range.values.back()));
  }
  return ExitCode::done;
}

}  // namespace

void add_threshold_command(CLI::App& program, Action& action) {
  auto options = std::make_shared<ThresholdOptions>();
  CLI::App* verb = program.add_subcommand(
      "threshold", "Values of a key at which the sliding state becomes stable or unstable");
  add_stability_options(*verb, options->stability);
  add_range_options(*verb, options->range);
  verb->callback([options, &action] { action = [options] { return threshold(*options); }; });
}

}  // namespace stridor
