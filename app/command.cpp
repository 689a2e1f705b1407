#include "app/command.hpp"

#include <cmath>

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

Json number(double value) {
  return std::isfinite(value) ? Json(value) : Json(nullptr);
}

}  // namespace stridor
