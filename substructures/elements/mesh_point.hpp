// Places within the elements of a mesh.
#pragma once

#include <vector>

#include "substructures/elements/mesh.hpp"

namespace stridor {

/// A place as a sum over nodes, and the node next to it.
struct MeshPoint {
  std::vector<int> nodes;       ///< rows of the mesh; empty where the place is outside
  std::vector<double> weights;  ///< shape functions of these nodes
  int nearest = 0;
  double distance = 0.0;  ///< to the nearest, m
};

/// Finds a place: on a node, or within an element, of which the shape functions are then taken.
/// @param place     m; the third coordinate does not matter in a plane
/// @param tolerance up to which it is on a node, m
/// @throws std::invalid_argument for a mesh without nodes
/// Cost: linear in the size of the mesh.
MeshPoint find_point(const Mesh& mesh, const Eigen::Vector3d& place, double tolerance);

}  // namespace stridor
