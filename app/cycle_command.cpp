// stridor cycle: the periodic motion that a scene settles to.
#include <fmt/format.h>

#include <filesystem>
#include <memory>

#include "app/expectations.hpp"
#include "app/sphere_commands.hpp"
#include "app/sphere_motion.hpp"
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
SphereHistory history_of(const SubstrateOscillator& oscillator, const LimitCycle& cycle,
                         const CycleOptions& options) {
  SubstrateMotion motion(oscillator, options.tolerance);
  const bool is_periodic = cycle.status == CycleStatus::periodic;
  if (is_periodic) {
    motion.start({cycle.point.x, cycle.point.y}, {0.0, cycle.point.vertical_velocity});
  } else {
    motion.start(cycle.last_displacement, cycle.last_velocity);
  }
  const double end = is_periodic ? cycle.period : 50.0;
  SphereHistory history;
  for (int k = 0; k <= num_samples_per_period; ++k) {
    if (k > 0) (void)motion.advance(end * k / num_samples_per_period, false);
    history.add(oscillator, motion);
  }
  return history;
}

void print_cycle(const LimitCycle& cycle, const SphereNumbers& numbers) {
  const auto print = [](const char* name, double value, double unit, const char* units) {
    fmt::print("{:<24}{:>16.10g}  ({:.6g} {})\n", name, value, value * unit, units);
  };
  fmt::print("{:<24}{:>16}\n", "status", cycle_status_text(cycle.status));
  if (cycle.status == CycleStatus::periodic) print("period", cycle.period, numbers.time_unit, "s");
  print("x, r.m.s. about mean", cycle.x_rms, numbers.length_unit, "m");
  print("x, mean", cycle.x_mean, numbers.length_unit, "m");
  print("x, smallest", cycle.x_min, numbers.length_unit, "m");
  print("x, largest", cycle.x_max, numbers.length_unit, "m");
  fmt::print("{:<24}{:>16.6f}\n", "part of time sticking", cycle.stick_fraction);
  fmt::print("{:<24}{:>16.6f}\n", "part of time lifted off", cycle.free_fraction);
  for (const std::complex<double>& m : cycle.multipliers)
    fmt::print("{:<24}{:>16.6g} {:+.6g}i\n", "multiplier", m.real(), m.imag());
}

ExitCode cycle(const CycleCommandOptions& options) {
  const Overwrite overwrite = options.common.overwrite();
  if (options.output) check_output(*options.output, overwrite);
  if (options.figure) check_figure(*options.figure, options.common);
  const LoadedSphereScene loaded = load_sphere_scene(options.scene, options.common.sets);
  const SphereNumbers numbers = sphere_numbers(loaded.scene.model.sphere);
  const SubstrateOscillator oscillator = make_sphere(loaded.scene.model);
  const CycleOptions how = cycle_options(loaded.scene);
  std::optional<Activity> following(std::in_place, "following the motion until it repeats");
  const LimitCycle found = find_limit_cycle(
      oscillator, initial_displacement(loaded.scene, oscillator), Eigen::Vector2d::Zero(), how);
  following.reset();
  if (found.status == CycleStatus::diverged) throw NumericalError(found.failure);
  const Json results = cycle_json(found, numbers);
  if (options.output || options.figure) {
    const SphereHistory history = history_of(oscillator, found, how);
    if (options.output) {
      write_column_file(*options.output, overwrite, "limit cycle", history.columns(),
                        sphere_attributes(loaded, options.command_line));
    }
    if (options.figure) {
      plot_history(
          history,
          fmt::format("Motion of the sphere, {}, x r.m.s. {:.6g}. {}, scene {}.",
                      found.status == CycleStatus::periodic
                          ? fmt::format("one period of {:.6g}", found.period)
                          : cycle_status_text(found.status),
                      found.x_rms, std::filesystem::path(options.scene).filename().string(),
                      loaded.hash()),
          *options.figure);
    }
  }
  if (options.common.json) {
    print_json(results);
  } else {
    print_cycle(found, numbers);
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
      "cycle", "Limit cycle of an oscillator on a viscoelastic substrate, with its multipliers");
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
