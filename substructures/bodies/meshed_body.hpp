// A mesh with supports, surfaces, points and springs.
#pragma once

#include "substructures/bodies/mesh_body.hpp"
#include "substructures/bodies/nodal_matrices.hpp"

namespace stridor {

/// The mesh of a body in metres, turned, with the surfaces that its scene adds.
/// @throws ConfigError with key paths below the body; std::invalid_argument if no mesh was read
Mesh named_mesh(const MeshBodyParameters& parameters);
/// The same where matrices come from elsewhere.
Mesh named_mesh(const MeshBodyParameters& parameters, const NodalMatrices& matrices);

/// Its matrices, with supports, guide, points, springs and loads.
/// @throws as named_mesh()
BodyMatrices make_meshed_body(const MeshBodyParameters& parameters);

/// The same of given matrices, in the frame of the body. Materials, thickness and damping among the
/// parameters are not used; a mesh without elements has nodes only, and its surfaces are node sets.
/// @throws as named_mesh(); std::invalid_argument if sizes do not fit
BodyMatrices make_meshed_body(const MeshBodyParameters& parameters, const NodalMatrices& matrices);

}  // namespace stridor
