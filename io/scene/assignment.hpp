// A `--set key.path=value` of the command line, which changes one value of a scene.
#pragma once

#include <string>

#include "io/scene/scene_tree.hpp"

namespace stridor {

/// Applies one `--set key.path=value` to the tree.
///
/// The value is read as YAML (a scalar, or a list or map in one line) and replaces the old one;
/// maps missing on the way are made. A number in the path counts the entries of a list from 0.
///
/// @param root       map at the top; unchanged where this throws
/// @param assignment "key.path=value"
/// @throws ConfigError, with the source "--set key.path=value", if there is no '=', no key or no
/// value,
///         if it passes SceneLimits, if the value is not YAML, or if the path leads through a
///         single value, through a name in a list or past the end of a list
void set_value(SceneNode& root, const std::string& assignment);

}  // namespace stridor
