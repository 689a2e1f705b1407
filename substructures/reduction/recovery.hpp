// From reduced coordinates back to every node of a body.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "substructures/elements/mesh.hpp"
#include "substructures/matrices/body_matrices.hpp"

namespace stridor {

/// The matrix that gives every DoF of a body from its reduced coordinates, u = T q
/// (docs/theory.md, 1.2). Dense, N x n; a reduction does not keep it.
///
/// @param interface, num_modes as of the reduction that q belongs to
/// @throws as make_craig_bampton()
/// Cost: that of the reduction.
Eigen::MatrixXd recovery_matrix(const BodyMatrices& body, std::span<const int> interface,
                                Eigen::Index num_modes);

/// Undeformed places of all nodes in the body's frame, m.
Eigen::MatrixX3d node_places(const BodyMatrices& body);

/// Displacement of every node, x, y and z; 0 where a node is held.
/// @param dofs of all free DoFs
Eigen::MatrixX3cd node_displacements(const BodyMatrices& body, const Eigen::VectorXcd& dofs);

/// A body in motion: Re(displacement e^{iφ}) about where its nodes are.
struct BodyShape {
  std::string name;
  Eigen::MatrixX3d nodes;                  ///< global, m
  Eigen::MatrixX3cd displacement;          ///< of each node
  std::vector<std::vector<int>> outlines;  ///< nodes in order
  std::vector<DrawnElement> elements;      ///< empty where it is made of none
};

/// Whether any of the bodies has a volume, stands beside the plane z = 0 or moves out of it.
bool is_spatial(std::span<const BodyShape> bodies);

}  // namespace stridor
