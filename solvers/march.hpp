// A whole run: steps, samples, statistics, and the ways in which it can end.
#pragma once

#include <functional>

#include "solvers/simulation.hpp"

namespace stridor {

enum class MarchEnd {
  finished,  ///< the last step was reached
  stopped,   ///< stop_requested()
  failed,    ///< a step did not end with StepOutcome::done; Simulation::failure() says why
};

struct MarchPlan {
  std::int64_t last_step = 0;
  /// Window of the force extremes, in steps, both ends included; outside it they are not tracked.
  std::int64_t measure_from = 0;
  std::int64_t measure_to = 0;
  /// Called about four times a second of wall time, between steps.
  std::function<void(const Simulation&)> on_progress;
};

/// Extremes of λ of every contact over the window of a plan; empty where no step fell into it.
using ForceExtremes = std::vector<std::optional<std::pair<double, double>>>;

struct MarchResult {
  MarchEnd end = MarchEnd::finished;
  ForceExtremes force_extremes;
};

/// Steps a simulation to the end of the plan, handing it to the sink whenever that is due.
///
/// The samples at the present step are taken first, so a fresh simulation is sampled at t = 0. A
/// simulation that was loaded must come with a sink that was loaded.
/// @throws whatever the sink throws; the simulation stands between two steps then
MarchResult march(Simulation& simulation, SampleSink* sink, const MarchPlan& plan);

}  // namespace stridor
