// What a transient comes to, as the JSON object of `run`.
#pragma once

#include <optional>

#include "app/command.hpp"
#include "io/run_summary.hpp"
#include "io/scene.hpp"
#include "solvers/march.hpp"

namespace stridor {

/// A plan up to a step whose window of statistics is that of `measure`.
MarchPlan measured_plan(const Scene& scene, std::int64_t last_step);

/// The numbers of a run, without those of its cost and its file.
/// @param measured     of the window of `measure`
/// @param acceleration nothing where none was recorded
Json transient_results(const Simulation& simulation, const System& system,
                       const TimeParameters& time, MarchEnd end, const MeasuredContacts& measured,
                       const std::optional<AccelerationSummary>& acceleration);

/// Writes the bursts of such an object in one line each, or that there are none.
void print_bursts(const Json& results);

}  // namespace stridor
