// Reads the value of one key of a scene: a scalar, a list, or a curve over time.
#pragma once

#include <string>

#include "core/schema.hpp"
#include "io/scene/scene_parameters.hpp"
#include "io/scene/scene_report.hpp"
#include "io/scene/scene_tree.hpp"

namespace stridor {

/// The value of a scalar, list or curve key; monostate where it is wrong, which has been
/// reported.
/// @param path       key path of the value
/// @param parameters evaluate its expressions
Value read_value(const SceneNode& node, const Key& key, const std::string& path,
                 SceneParameters& parameters, SceneReport& report);

}  // namespace stridor
