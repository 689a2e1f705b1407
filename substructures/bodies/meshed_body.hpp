// A mesh with supports, surfaces, points and springs.
#pragma once

#include "substructures/bodies/mesh_body.hpp"

namespace stridor {

/// Matrices over displacements of the nodes of a mesh that do not come from its elements.
struct NodalMatrices {
  int dimension = 3;  ///< of the displacements of a node
  SparseMatrix mass, stiffness;
  RayleighDamping damping;
  SparseMatrix velocity, circulatory;  ///< as BodyMatrices has them
  /// Row of displacement `dimension` x node + direction; `BodyMatrices::held` where they have none.
  std::vector<int> rows;
  /// Row of rotation 3 x node + axis likewise; empty where no node turns.
  std::vector<int> rotations;
};

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
