#include "app/disc_run.hpp"

#include <fmt/format.h>

#include "app/run_ending.hpp"

namespace stridor {
namespace {

void print_results(const Json& results, const std::string& file) {
  fmt::print("{:<24}{}\n", "status", results["status"].get<std::string>());
  fmt::print("{:<24}{} of {:g} s, {:.3g} s stepping\n", "steps",
             results["steps"].get<std::int64_t>(), results["step"].get<double>(),
             results["wall_s"].get<double>());
  fmt::print("{:<24}{:.6g} Hz, growth {:.6g} 1/s\n", "perturbed mode",
             results["perturbation"]["frequency"].get<double>(),
             results["perturbation"]["growth"].get<double>());
  for (const auto& [name, contact] : results["contacts"].items()) {
    const Json& force = contact["contact_force"];
    if (force["min"].is_null()) continue;
    fmt::print("{:<24}{:.6g} to {:.6g} N in the second half\n", "contact force " + name,
               force["min"].get<double>(), force["max"].get<double>());
  }
  fmt::print("{:<24}{:.4g} m, in the first half {:.4g} m\n", "pads move by",
             results["pad_displacement"]["second_half"].get<double>(),
             results["pad_displacement"]["first_half"].get<double>());
  if (!results["free_fraction"].is_null()) {
    fmt::print("{:<24}{:.4g} % of the time, lifted off {:.4g} %\n", "sticking",
               100.0 * results["stick_fraction"].get<double>(),
               100.0 * results["free_fraction"].get<double>());
  }
  fmt::print("{:<24}{}\n", "run file", file);
}

ExitCode run_to_end(DiscTransient& transient, const LoadedDiscScene& loaded,
                    const std::string& file, const RunEnding& ending) {
  const DiscScene& scene = loaded.scene;
  return run_and_report(transient, scene.time->end, file, ending, scene.expect,
                        [&](const Json& results) { print_results(results, file); });
}

}  // namespace

ExitCode run_disc(const LoadedDiscScene& loaded, const RunOutput& output, const RunEnding& ending) {
  DiscTransient transient(loaded, output);
  return run_to_end(transient, loaded, output.file, ending);
}

ExitCode resume_disc(const InterruptedRun& interrupted, const RunEnding& ending) {
  const LoadedDiscScene loaded =
      load_resolved_disc_scene(interrupted.scene_text, interrupted.file + ":/scene/resolved");
  DiscTransient transient(loaded, interrupted);
  return run_to_end(transient, loaded, interrupted.file, ending);
}

}  // namespace stridor
