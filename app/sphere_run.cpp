#include "app/sphere_run.hpp"

#include <fmt/format.h>

#include <cstdio>

#include "app/expectations.hpp"
#include "app/progress.hpp"
#include "app/sphere_motion.hpp"
#include "app/sphere_transient.hpp"
#include "core/errors.hpp"

namespace stridor {
namespace {

void print_results(const Json& results, const SphereNumbers& numbers, const std::string& file) {
  const auto print = [&](const char* name, const Json& value, double unit, const char* units) {
    if (value.is_null()) {
      fmt::print("{:<24}{:>16}\n", name, "-");
    } else if (unit > 0.0) {
      fmt::print("{:<24}{:>16.10g}  ({:.6g} {})\n", name, value.get<double>(),
                 value.get<double>() * unit, units);
    } else {
      fmt::print("{:<24}{:>16.8g}\n", name, value.get<double>());
    }
  };
  fmt::print("{:<24}{:>16}\n", "status", results["status"].get<std::string>());
  fmt::print("{:<24}{:>16}  ({:.3g} s)\n", "steps", results["steps"].get<std::int64_t>(),
             results["wall_s"].get<double>());
  print("period", results["period"], numbers.time_unit, "s");
  print("x, r.m.s. about mean", results["x"]["rms"], numbers.length_unit, "m");
  print("x, smallest", results["x"]["min"], numbers.length_unit, "m");
  print("x, largest", results["x"]["max"], numbers.length_unit, "m");
  print("part of time sticking", results["stick_fraction"], 0.0, "");
  print("part of time lifted off", results["free_fraction"], 0.0, "");
  print_law_exceeded(results);
  fmt::print("{:<24}{}\n", "run file", file);
}

/// Runs to the end, or as far as it gets, and says how it ended.
ExitCode run_to_end(SphereTransient& transient, const SphereScene& scene, const std::string& file,
                    const RunEnding& ending) {
  Progress progress("run");
  transient.keeper().on_progress(
      [&](double fraction, const std::string& detail) { progress.report(fraction, detail); });
  transient.keeper().limit_wall_time(ending.max_wall);
  const MarchEnd end = transient.run_to_end();
  progress.finish();
  if (end == MarchEnd::stopped) transient.write_checkpoint();
  const Json results = transient.finish();
  if (ending.json) {
    fmt::print("{}\n", results.dump(2));
  } else {
    print_results(results, transient.numbers(), file);
  }
  std::fflush(stdout);
  if (end == MarchEnd::stopped) throw_interrupted(transient.time(), scene.time.end, file);
  if (end == MarchEnd::failed) {
    throw NumericalError(
        fmt::format("{}\n{} holds everything up to then", transient.failure(), file));
  }
  if (ending.verify) check_expectations(scene.expect, results);
  return ExitCode::done;
}

}  // namespace

ExitCode run_sphere(const LoadedSphereScene& loaded, const RunOutput& output,
                    const RunEnding& ending) {
  SphereTransient transient(loaded, output);
  return run_to_end(transient, loaded.scene, output.file, ending);
}

ExitCode resume_sphere(const InterruptedRun& interrupted, const RunEnding& ending) {
  const LoadedSphereScene loaded =
      load_resolved_sphere_scene(interrupted.scene_text, interrupted.file + ":/scene/resolved");
  SphereTransient transient(loaded, interrupted);
  return run_to_end(transient, loaded.scene, interrupted.file, ending);
}

}  // namespace stridor
