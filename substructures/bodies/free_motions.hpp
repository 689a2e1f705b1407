// Rigid motions that the supports of a body leave free.
#pragma once

#include <vector>

#include "substructures/bodies/mesh_constraints.hpp"

namespace stridor {

/// One DoF for every rigid motion of the mesh that its constraints leave free, as far from each
/// other as the body allows: with these held nothing moves without strain.
std::vector<int> determinate_dofs(const Mesh& mesh, const MeshConstraints& constraints);

}  // namespace stridor
