// Points that a scene puts on bodies of any type.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/schema.hpp"

namespace stridor {

struct ModelBody;

/// A place of a scene on one of its bodies.
struct ScenePointParameters {
  std::vector<double> at;           ///< where the scene puts it at rest, m: x, y and perhaps z
  std::string of;                   ///< the body
  std::optional<double> tolerance;  ///< up to which it goes to the nearest node, m
  static const Schema& schema();
};

/// Adds points to bodies that have been placed: on a node, within an element, whose shape functions
/// give the motion, or on the nearest node where that is no further away than the tolerance.
/// @throws ConfigError with key paths below "points" for a body or place that there is not, and for
///         a name that the body has already
void add_scene_points(const std::map<std::string, ScenePointParameters>& points,
                      std::vector<ModelBody>& bodies);

}  // namespace stridor
