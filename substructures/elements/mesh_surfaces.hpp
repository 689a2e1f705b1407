// Surfaces of meshes: found by where they are, and put in order.
#pragma once

#include <optional>
#include <vector>

#include "substructures/elements/mesh.hpp"
#include "substructures/matrices/facet.hpp"

namespace stridor {

/// Sides that belong to one element only, ascending: the surface of the body.
std::vector<ElementSide> outer_sides(const Mesh& mesh);

/// Nodes of a side, as rows of the mesh: corners, then the middles of their edges.
std::vector<int> nodes_of(const Mesh& mesh, const ElementSide& side);

/// Nodes of sides, ascending, each once.
std::vector<int> nodes_of(const Mesh& mesh, const std::vector<ElementSide>& sides);

/// Places in space: of a plane, a cylinder, or between two corners of a box, whichever are given.
struct MeshRegion {
  /// Points x with n·x = offset.
  struct Plane {
    Eigen::Vector3d normal = Eigen::Vector3d::UnitX();  ///< n, of any length
    double offset = 0.0;                                ///< along n/|n|, m
  };
  /// Points at a distance from a line.
  struct Cylinder {
    Eigen::Vector3d point = Eigen::Vector3d::Zero();  ///< of the axis, m
    Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();  ///< of any length
    double radius = 0.0;                              ///< m
  };
  struct Box {
    Eigen::Vector3d lowest, highest;  ///< m
  };
  std::optional<Plane> plane;
  std::optional<Cylinder> cylinder;
  std::optional<Box> box;

  /// @param tolerance m
  bool contains(const Eigen::Vector3d& point, double tolerance) const;
};

/// Sides out of some of which all nodes lie in a region.
std::vector<ElementSide> sides_within(const Mesh& mesh, const std::vector<ElementSide>& sides,
                                      const MeshRegion& region, double tolerance);

/// Nodes of edges of a planar mesh in the order in which the body lies on their right-hand side;
/// a closed outline ends with the node it begins with.
/// @throws std::invalid_argument if the edges are not one chain, saying where it ends or branches
std::vector<int> outline_of(const Mesh& mesh, const std::vector<ElementSide>& sides);

/// Facets between the nodes of sides of volumes. A side with nodes in the middle of its edges is divided:
/// into four triangles, or into a quadrilateral between those nodes and a triangle at each corner.
std::vector<Facet> facets_of(const Mesh& mesh, const std::vector<ElementSide>& sides);

/// Diagonal of the box around all nodes, m.
double extent_of(const Mesh& mesh);

}  // namespace stridor
