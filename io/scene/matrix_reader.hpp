// Matrices of bodies out of scenes and the files that these name.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "io/scene/scene_tree.hpp"
#include "models/body_cache.hpp"
#include "substructures/bodies/body_parameters.hpp"
#include "substructures/bodies/matrix_body.hpp"

namespace stridor {

/// Reads all matrices of a body.
/// @param key  path of the body in the scene
/// @param tree of the scene
/// @throws ConfigError with the key, or the place in a matrix file; FileError
NamedMatrices read_matrices(const std::string& key, const SceneNode& tree,
                            const MatrixBodyParameters& body);

/// The files that a body names: keys and names as written. None where its type names none.
/// @param key path of the body in the scene
std::vector<std::pair<std::string, std::string>> files_of(const std::string& key,
                                                          const BodyParameters& body);

/// Names the files of a body from the root, so that a run file finds them wherever it is.
/// Parameters as read_matrices().
void make_files_absolute(const std::string& key, const SceneNode& tree, BodyParameters& body);

/// Gives a body the matrices that it names: those that the cache has read last for the body of this
/// key, where they are the same files and rows. Parameters and errors as read_matrices().
void read_files(const std::string& key, const SceneNode& tree, BodyParameters& body,
                BodyCache& cache);

}  // namespace stridor
