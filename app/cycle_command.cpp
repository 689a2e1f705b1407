// stridor cycle: the periodic motion that a scene settles to.
#include <fmt/format.h>

#include <filesystem>
#include <memory>

#include "app/cycle_motion.hpp"
#include "app/expectations.hpp"
#include "core/activity.hpp"
#include "core/errors.hpp"
#include "io/gnuplot.hpp"

namespace stridor {
namespace {

struct CycleCommandOptions {
  CommonOptions common;
  std::string scene;
  std::optional<std::string> output;
  std::optional<std::string> figure;
  bool verify = false;
  std::string command_line;
};

constexpr int num_samples_per_period = 1000;

/// One period from the turn where x is largest; where there is none, as much as a few loops take.
CycleHistory history_of(const CycleScene& scene, const LimitCycle& cycle) {
  SubstrateMotion motion(scene.oscillator.oscillator, scene.options.tolerance);
  const bool is_periodic = cycle.status == CycleStatus::periodic;
  if (is_periodic) {
    motion.start({cycle.point.x, cycle.point.y}, {0.0, cycle.point.vertical_velocity});
  } else {
    motion.start(cycle.last_displacement, cycle.last_velocity);
  }
  const double end = is_periodic ? cycle.period : 50.0;
  CycleHistory history;
  for (int k = 0; k <= num_samples_per_period; ++k) {
    if (k > 0) (void)motion.advance(end * k / num_samples_per_period, false);
    history.add(scene.oscillator, motion);
  }
  return history;
}

void print_cycle(const Json& results) {
  const auto print = [](const char* name, const Json& value, const char* units) {
    if (!value.is_null()) fmt::print("{:<24}{:>16.10g} {}\n", name, value.get<double>(), units);
  };
  fmt::print("{:<24}{:>16}\n", "status", results["status"].get<std::string>());
  print("period", results["period"], "s");
  const Json& x = results["x"];
  print("x, r.m.s. about mean", x["rms"], "m");
  print("x, mean", x["mean"], "m");
  print("x, smallest", x["min"], "m");
  print("x, largest", x["max"], "m");
  fmt::print("{:<24}{:>16.6f}\n", "part of time sticking", results["stick_fraction"].get<double>());
  fmt::print("{:<24}{:>16.6f}\n", "part of time lifted off",
             results["free_fraction"].get<double>());
  for (const Json& m : results["multipliers"]) {
    fmt::print("{:<24}{:>16.6g} {:+.6g}i\n", "multiplier", m[0].get<double>(), m[1].get<double>());
  }
}

void write_history(const CycleCommandOptions& options, const LoadedScene& loaded,
                   const CycleScene& scene, const LimitCycle& found) {
  const CycleHistory history = history_of(scene, found);
  if (options.output) {
    write_column_file(*options.output, options.common.overwrite(), "limit cycle", history.columns(),
                      cycle_attributes(loaded, options.command_line));
  }
  if (!options.figure) return;
  const SlidingOscillator& units = scene.oscillator;
  plot_history(history,
               fmt::format("Motion of the mass, {}, x r.m.s. {:.6g} m. {}, scene {}.",
                           found.status == CycleStatus::periodic
                               ? fmt::format("one period of {:.6g} s", units.time * found.period)
                               : cycle_status_text(found.status),
                           units.length * found.x_rms,
                           std::filesystem::path(options.scene).filename().string(), loaded.hash()),
               *options.figure);
}

ExitCode cycle(const CycleCommandOptions& options) {
  if (options.output) check_output(*options.output, options.common.overwrite());
  if (options.figure) check_figure(*options.figure, options.common);
  const LoadedScene loaded = load_scene(options.scene, options.common.sets);
  Model model = build_model(loaded);
  const CycleScene scene = make_cycle_scene(loaded, model);
  std::optional<Activity> following(std::in_place, "following the motion until it repeats");
  const LimitCycle found = find_limit_cycle(scene.oscillator.oscillator, scene.displacement,
                                            scene.velocity, scene.options);
  following.reset();
  if (found.status == CycleStatus::diverged)
    throw NumericalError(cycle_failure(found, scene.oscillator));
  const Json results = cycle_json(found, scene.oscillator);
  if (options.output || options.figure) write_history(options, loaded, scene, found);
  if (options.common.json) {
    print_json(results);
  } else {
    print_cycle(results);
    print_law_exceeded(results);
    for (const auto& file : {options.output, options.figure})
      if (file) fmt::print("{}\n", *file);
  }
  std::fflush(stdout);
  if (options.verify) check_expectations(loaded.scene.expect, results);
  return ExitCode::done;
}

}  // namespace

void add_cycle_command(CLI::App& program, Action& action, const std::string& command_line) {
  auto options = std::make_shared<CycleCommandOptions>();
  options->command_line = command_line;
  CLI::App* verb = program.add_subcommand(
      "cycle", "Limit cycle of one mass on a sliding half-space, with its multipliers");
  verb->add_option("scene", options->scene, "Scene file (YAML)")->required();
  verb->add_option("-o,--output", options->output, "File for one period (HDF5)");
  verb->add_option("--figure", options->figure, "Picture of one period: .png, .svg or .pdf");
  verb->add_flag("--verify", options->verify,
                 "Compare the results with the scene's `expect` block; exit 3 where they differ");
  add_scene_options(*verb, options->common);
  add_json_option(*verb, options->common);
  add_force_option(*verb, options->common);
  verb->callback([options, &action] { action = [options] { return cycle(*options); }; });
}

}  // namespace stridor
