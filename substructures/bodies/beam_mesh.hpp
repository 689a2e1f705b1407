// The elements of a beam's mesh, for figures.
#pragma once

#include <array>
#include <vector>

#include "substructures/bodies/beam.hpp"

namespace stridor {

/// Nodes of every element of the mesh that make_beam() makes: four corners, the body on the left
/// from each to the next, then the middles of the four sides, beginning with that between the first
/// two corners. Made when asked for; a body does not keep them.
std::vector<std::array<int, 8>> beam_elements(const MeshParameters& mesh);

}  // namespace stridor
