// What of a scene can be computed but is hardly meant.
#pragma once

#include <vector>

#include "core/schema.hpp"
#include "io/scene/scene.hpp"

namespace stridor {

/// Numbers written without a unit that are of another order of magnitude than vibrating bodies
/// have, of which a unit was probably left out, and parameters that no expression uses.
/// @param tree as it was read into the object
std::vector<Problem> key_warnings(const Schema& schema, const void* object, const SceneNode& tree);

/// key_warnings() of a scene of bodies in contact, a window of the statistics that begins after
/// the end of the run, paths that lead off the end of a master within the run (of the undeformed
/// bodies), and channels of points that supports hold.
std::vector<Problem> scene_warnings(const LoadedScene& loaded, const Model& model);

}  // namespace stridor
