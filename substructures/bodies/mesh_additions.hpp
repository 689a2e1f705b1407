// Points, masses, springs and loads of a body from a mesh.
#pragma once

#include "substructures/bodies/mesh_constraints.hpp"
#include "substructures/bodies/named_mesh.hpp"
#include "substructures/matrices/body_matrices.hpp"

namespace stridor {

/// Adds to a body of which nodes, matrices and constraints are there: points, rigid regions as
/// points, rigid masses, even loads on all surfaces and those of the scene, springs and dampers.
/// @throws ConfigError with key paths below the body
void add_to_mesh_body(const MeshBodyParameters& parameters, const NamedMesh& mesh,
                      const MeshConstraints& constraints, BodyMatrices& body);

}  // namespace stridor
