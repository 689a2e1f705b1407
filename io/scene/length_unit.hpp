// The unit in which a scene gives its lengths.
#pragma once

#include <string>

#include "io/scene/scene_tree.hpp"

namespace stridor {

struct LengthUnit {
  std::string name = "m";
  double metres = 1.0;
};

/// The unit that most lengths of a scene are written in; of as many the larger one, and metres where
/// none has a unit.
LengthUnit length_unit_of(const SceneNode& scene);

}  // namespace stridor
