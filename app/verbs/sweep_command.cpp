// stridor sweep: transients or limit cycles along one key of a scene.
#include <memory>
#include <thread>

#include "app/runs/sweep.hpp"
#include "core/errors.hpp"

namespace stridor {
namespace {

ExitCode sweep(const SweepOptions& options) {
  if (options.output) check_output(*options.output, options.common.overwrite());
  if (options.figure) check_figure(*options.figure, options.common);
  if (options.range.parameter.empty())
    throw ConfigError(Refusal::missing, "--parameter", "name a key of the scene");
  const LoadedScene loaded = load_scene(options.scene, options.common.sets);
  loaded.require_section("time", "sweep");
  if (loaded.scene.time->is_event_driven()) return sweep_cycles(options, loaded);
  if (options.is_up_and_down) {
    throw ConfigError(Refusal::contradiction, "--up-down",
                      "is for limit cycles (time.integrator: event_driven): every transient starts "
                      "as its scene says");
  }
  return sweep_transients(options, loaded);
}

}  // namespace

void add_sweep_command(CLI::App& program, Action& action, const std::string& command_line) {
  auto options = std::make_shared<SweepOptions>();
  options->command_line = command_line;
  options->range.points = 21;
  options->common.threads = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  CLI::App* verb = program.add_subcommand(
      "sweep",
      "Transients, or limit cycles of the event-driven integrator, along one key of the scene");
  verb->add_option("scene", options->scene, "Scene file (YAML)")->required();
  add_range_options(*verb, options->range);
  verb->add_option("--scale", options->scale, "Spacing of the values: linear (default) or log")
      ->check(CLI::IsMember({"linear", "log"}));
  verb->add_flag("--up-down", options->is_up_and_down,
                 "Go up and then down, every value from the motion at the one before; shows where "
                 "two motions exist");
  verb->add_option("-o,--output", options->output, "File to write (HDF5)");
  verb->add_option("--figure", options->figure, "Picture of the amplitude: .png, .svg or .pdf");
  add_scene_options(*verb, options->common);
  add_json_option(*verb, options->common);
  add_force_option(*verb, options->common);
  verb->callback([options, &action] { action = [options] { return sweep(*options); }; });
}

}  // namespace stridor
