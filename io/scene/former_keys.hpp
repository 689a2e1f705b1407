// Keys of scenes that are no longer read, and what has taken their place.
#pragma once

#include "io/scene/scene_tree.hpp"

namespace stridor {

/// Refuses a scene of `format: 1`, and one with a section that made a kind of its own, `sphere`,
/// `disc`, or `material`, `profile` and `contact_solver`, or with bodies with keys that have moved
/// (docs/format_2.md).
/// @throws ConfigError with a problem for each of them that is written, naming the new one
void refuse_former_keys(const SceneNode& tree);

}  // namespace stridor
