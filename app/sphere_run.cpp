#include "app/sphere_run.hpp"

#include <fmt/format.h>

#include "app/run_ending.hpp"
#include "app/sphere_motion.hpp"
#include "app/sphere_transient.hpp"

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

ExitCode run_to_end(SphereTransient& transient, const SphereScene& scene, const std::string& file,
                    const RunEnding& ending) {
  return run_and_report(
      transient, scene.time.end, file, ending, scene.expect,
      [&](const Json& results) { print_results(results, transient.numbers(), file); });
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
