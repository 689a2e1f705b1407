// Results of a transient, as the JSON object of `run`.
#pragma once

#include <optional>
#include <vector>

#include "app/terminal/command.hpp"
#include "io/run_file/run_summary.hpp"
#include "io/scene/scene.hpp"
#include "solvers/transient/march.hpp"

namespace stridor {

/// A plan up to a step whose window of statistics is that of `measure`.
MarchPlan measured_plan(const Scene& scene, std::int64_t last_step);

/// The number, from 1, of the burst of which this one is a harmonic, `of`, and its `order`; null
/// where it is none.
Json harmonic_json(const Burst& burst);

/// A list with an object for every burst.
Json bursts_json(const std::vector<Burst>& bursts);
/// The largest stable step, s; null where there is none.
Json step_limit_json(const System& system, const TimeParameters& time);

/// free_end_acceleration, bursts and lasting_tone; null where there are none.
Json acceleration_json(const std::optional<AccelerationSummary>& acceleration);

/// The numbers of a run, without those of its effort and its file.
/// @param measured     of the window of `measure`
/// @param acceleration nothing where none was recorded
Json transient_results(const Simulation& simulation, const System& system,
                       const TimeParameters& time, MarchEnd end, const MeasuredContacts& measured,
                       const std::optional<AccelerationSummary>& acceleration);

/// Writes the bursts of such an object in one line each, or that there are none, its lasting tone,
/// and how many bursts lie above its `trusted_frequency`, Hz.
void print_bursts(const Json& results);

}  // namespace stridor
