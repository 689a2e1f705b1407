// Files of bodies, as scenes name them.
#pragma once

#include <string>

#include "io/scene/scene_tree.hpp"
#include "models/body_cache.hpp"
#include "substructures/bodies/body_parameters.hpp"

namespace stridor {

/// Names the files of a body from the root, so that a run file finds them wherever it is.
/// @param key  path of the body in the scene
/// @param tree of the scene
/// @throws FileError
void make_files_absolute(const std::string& key, const SceneNode& tree, BodyParameters& body);

/// Gives a body what its files hold: what the cache has read last for the body of this key, where
/// it named the same. Parameters as make_files_absolute().
/// @throws ConfigError with the key, or the place in a file; FileError
void read_files(const std::string& key, const SceneNode& tree, BodyParameters& body,
                BodyCache& cache);

}  // namespace stridor
