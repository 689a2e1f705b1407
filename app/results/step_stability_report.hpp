// stridor check --stability: whether the steps of a scene are stable all along its path.
#pragma once

#include <vector>

#include "analysis/step_stability.hpp"
#include "app/terminal/command.hpp"
#include "io/scene/scene.hpp"

namespace stridor {

/// Stability of the steps of a scene along its path, with the remedy.
struct StepStabilityReport {
  TimeParameters time;
  double limit = 0.0;  ///< step_limit(), s
  Json matrix_bodies;  ///< matrix_bodies_json()
  std::vector<PathStability> path;
  /// stable_step() where the steps grow most by themselves; empty where they do not, or where none
  /// was found.
  std::optional<double> stable_step;

  bool steps_grow() const;
};

/// @throws ConfigError if a contact has a force law
/// @throws Interrupted on request
StepStabilityReport check_step_stability(const Model& model, const TimeParameters& time,
                                         int num_places);

Json step_stability_json(const StepStabilityReport& report);
/// A row per place, and the conclusions.
void print_step_stability(const StepStabilityReport& report);

}  // namespace stridor
