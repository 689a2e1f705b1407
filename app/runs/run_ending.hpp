// Ending of a run of any kind of scene, and its report.
#pragma once

#include <fmt/format.h>

#include <cstdio>
#include <string>
#include <vector>

#include "app/results/expectations.hpp"
#include "app/runs/run_keeping.hpp"
#include "app/terminal/progress.hpp"
#include "core/errors.hpp"
#include "solvers/transient/march.hpp"

namespace stridor {

/// Runs to the end, or as far as it gets, and reports the ending.
///
/// @tparam Run  has keeper(), run_to_end(), write_checkpoint(), finish(), time(), failure() and
/// refusal()
/// @param end   of the run, in units of its time()
/// @param print prints the results where they are not asked for as JSON
/// @throws Interrupted if the run was stopped, NumericalError if it failed or does not meet its
///         expectations, FileError
template <class Run, class Print>
ExitCode run_and_report(Run& run, double end, const std::string& file, const RunEnding& ending,
                        const std::vector<Expectation>& expectations, Print&& print) {
  Progress progress("run");
  run.keeper().on_progress(
      [&](double fraction, const std::string& detail) { progress.report(fraction, detail); });
  run.keeper().limit_wall_time(ending.max_wall);
  const MarchEnd how = run.run_to_end();
  progress.finish();
  if (how == MarchEnd::stopped) run.write_checkpoint();
  const Json results = run.finish();
  if (ending.json) {
    print_json(results);
  } else {
    print(results);
  }
  std::fflush(stdout);
  if (how == MarchEnd::stopped) throw_interrupted(run.time(), end, file);
  if (how == MarchEnd::failed) {
    throw NumericalError(run.refusal(),
                         fmt::format("{}\n{} holds everything up to then", run.failure(), file));
  }
  if (ending.verify) check_expectations(expectations, results);
  return ExitCode::done;
}

}  // namespace stridor
