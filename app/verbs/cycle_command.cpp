// stridor cycle: the periodic motion that a scene settles to.
#include <fmt/format.h>

#include <filesystem>
#include <memory>

#include "app/results/expectations.hpp"
#include "app/results/file_attributes.hpp"
#include "app/runs/cycle_motion.hpp"
#include "app/runs/step_cycle.hpp"
#include "core/activity.hpp"
#include "core/errors.hpp"
#include "io/figures/gnuplot.hpp"

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
/// Those of bodies are many, of which the largest say whether the cycle is stable.
constexpr int most_multipliers = 4;

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
  const auto print_part = [](const char* name, const Json& value) {
    if (!value.is_null()) fmt::print("{:<24}{:>16.6f}\n", name, value.get<double>());
  };
  fmt::print("{:<24}{:>16}\n", "status", results["status"].get<std::string>());
  if (results.contains("observed"))
    fmt::print("{:<24}{}\n", "x is", results["observed"].get<std::string>());
  print("period", results["period"], "s");
  const Json& x = results["x"];
  print("x, r.m.s. about mean", x["rms"], "m");
  print("x, mean", x["mean"], "m");
  print("x, smallest", x["min"], "m");
  print("x, largest", x["max"], "m");
  print_part("part of time sticking", results["stick_fraction"]);
  print_part("part of time lifted off", results["free_fraction"]);
  int printed = 0;
  for (const Json& m : results["multipliers"]) {
    if (printed++ == most_multipliers) break;
    fmt::print("{:<24}{:>16.6g} {:+.6g}i\n", "multiplier", m[0].get<double>(), m[1].get<double>());
  }
  if (const std::size_t all = results["multipliers"].size(); all > most_multipliers)
    fmt::print("{:<24}{:>16}\n", "smaller multipliers", all - most_multipliers);
}

std::string caption_of(const CycleCommandOptions& options, const LoadedScene& loaded,
                       const Json& results, const char* what) {
  return fmt::format("{}, {}, x r.m.s. {}. {}, scene {}.", what,
                     results["period"].is_null()
                         ? results["status"].get<std::string>()
                         : fmt::format("one period of {:.6g} s", results["period"].get<double>()),
                     results["x"]["rms"].is_null()
                         ? "none"
                         : fmt::format("{:.6g} m", results["x"]["rms"].get<double>()),
                     std::filesystem::path(options.scene).filename().string(), loaded.hash());
}

/// One period with what is said of it.
void write_cycle(const CycleCommandOptions& options, const LoadedScene& loaded,
                 std::vector<Column> columns, const Json& results) {
  for (Column& column : multiplier_columns(results)) columns.push_back(std::move(column));
  Attributes attributes = source_attributes(loaded, options.command_line);
  append_results(results, attributes);
  write_column_file(*options.output, options.common.overwrite(), "limit cycle", columns,
                    attributes);
}

/// One mass on a half-space, from event to event.
Json follow_events(const CycleCommandOptions& options, const LoadedScene& loaded, Model& model) {
  const CycleScene scene = make_cycle_scene(loaded, model);
  std::optional<Activity> following(std::in_place, "following the motion until it repeats");
  const LimitCycle found = find_limit_cycle(scene.oscillator.oscillator, scene.displacement,
                                            scene.velocity, scene.options);
  following.reset();
  if (found.status == CycleStatus::diverged)
    throw NumericalError(Refusal::no_convergence, cycle_failure(found, scene.oscillator));
  const Json results = cycle_json(found, scene.oscillator);
  if (!options.output && !options.figure) return results;
  const CycleHistory history = history_of(scene, found);
  if (options.output) write_cycle(options, loaded, history.columns(), results);
  if (options.figure)
    plot_history(history, caption_of(options, loaded, results, "Motion of the mass"),
                 *options.figure);
  return results;
}

/// Any other system, by the steps of a run.
Json follow_steps(const CycleCommandOptions& options, const LoadedScene& loaded, Model& model) {
  std::optional<Activity> following(std::in_place, "following the motion until it repeats");
  const PeriodicMotion found = find_scene_cycle(loaded, model);
  following.reset();
  if (found.status == CycleStatus::diverged) throw NumericalError(found.refusal, found.failure);
  const Json results = step_cycle_json(found);
  if (!options.output && !options.figure) return results;
  const TimeParameters& time = *loaded.scene.time;
  const std::vector<Column> columns = step_cycle_columns(found, time);
  if (options.output) write_cycle(options, loaded, columns, results);
  if (options.figure)
    plot_step_cycle(found, columns, caption_of(options, loaded, results, "Motion of the slave"),
                    *options.figure);
  return results;
}

ExitCode cycle(const CycleCommandOptions& options) {
  if (options.output) check_output(*options.output, options.common.overwrite());
  if (options.figure) check_figure(*options.figure, options.common);
  const LoadedScene loaded = load_scene(options.scene, options.common.sets);
  require_cycle_section(loaded);
  Model model = build_model(loaded);
  const Json results = as_oscillator(model.system) ? follow_events(options, loaded, model)
                                                   : follow_steps(options, loaded, model);
  if (options.common.json) {
    print_json(results);
  } else {
    print_cycle(results);
    if (results.contains("law_exceeded")) print_law_exceeded(results);
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
  CLI::App* verb =
      program.add_subcommand("cycle", "Limit cycle of bodies in contact, with its multipliers");
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
