// Limit cycles of bodies in contact, of the steps of a run: results, one period as columns,
// picture.
#pragma once

#include <string>
#include <vector>

#include "analysis/periodic_motion.hpp"
#include "app/terminal/command.hpp"
#include "io/results/column_file.hpp"
#include "io/scene/scene.hpp"

namespace stridor {

/// The motion of a scene that is to repeat itself.
/// @param model is put into its initial state
/// @throws ConfigError with the place of the key where nothing can repeat itself, or sections are
///         missing; as find_periodic_motion(); FileError
PeriodicMotion find_scene_cycle(const LoadedScene& loaded, Model& model);

/// The results of `cycle`, SI.
Json step_cycle_json(const PeriodicMotion& cycle);

/// One period of a cycle, at most 1,000 rows: the displacement observed, and of every contact
/// force, friction force, slip velocity and state.
std::vector<Column> step_cycle_columns(const PeriodicMotion& cycle, const TimeParameters& time);

/// Draws the displacement, and slip velocity and force of its contact, of columns as of
/// step_cycle_columns().
void plot_step_cycle(const PeriodicMotion& cycle, const std::vector<Column>& columns,
                     const std::string& caption, const std::string& figure);

}  // namespace stridor
