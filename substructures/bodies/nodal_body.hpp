// Bodies given by their matrices of which it is known which rows are which nodes.
#pragma once

#include <string>

#include "substructures/bodies/matrix_body.hpp"
#include "substructures/bodies/meshed_body.hpp"

namespace stridor {

/// Whether a mesh with elements came beside the matrices.
inline bool has_elements(const NamedMatrices& matrices) {
  return matrices.mesh.num_elements() > 0;
}

/// Directions in which nodes move: that of the mesh; without elements 3 if a row is along z.
int dimension_of(const NamedMatrices& matrices);

/// How the rows of matrices and the nodes of the mesh beside them belong together.
struct NodeRows {
  std::vector<int> rows;       ///< NodalMatrices::rows
  std::vector<int> rotations;  ///< NodalMatrices::rotations
  std::vector<std::int64_t> missing;  ///< nodes of rows that the mesh has not, ascending
  std::size_t num_without = 0;        ///< nodes of the mesh that no row moves
};
NodeRows node_rows(const NamedMatrices& matrices);

/// Symmetric parts, damping and coupled terms of a system, into a body.
void take_system(SparseSystem system, BodyMatrices& body);
/// Outlines that name points.
/// @throws ConfigError for points that are not there
void add_point_surfaces(const TouchedMatrixBodyParameters& parameters, BodyMatrices& body);

/// The mesh of the matrices in metres, turned, with the surfaces that the scene adds.
/// @throws ConfigError
Mesh named_mesh(const TouchedMatrixBodyParameters& parameters);

/// Nodes of a surface, or of a set found by where it is; 0 where there is none.
double num_nodes_named(const TouchedMatrixBodyParameters& parameters, const std::string& name);

/// make_matrix_body() where nodes are known.
BodyMatrices make_nodal_body(const TouchedMatrixBodyParameters& parameters);

}  // namespace stridor
