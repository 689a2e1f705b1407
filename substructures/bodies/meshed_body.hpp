// A mesh with supports, surfaces, points and springs.
#pragma once

#include "substructures/bodies/mesh_body.hpp"

namespace stridor {

/// The mesh of a body in metres, turned, with the surfaces that its scene adds.
/// @throws ConfigError with key paths below the body; std::invalid_argument if no mesh was read
Mesh named_mesh(const MeshBodyParameters& parameters);

/// Its matrices, with supports, guide, points, springs and loads.
/// @throws as named_mesh()
BodyMatrices make_meshed_body(const MeshBodyParameters& parameters);

}  // namespace stridor
