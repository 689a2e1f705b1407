// Shape functions of the elements of a mesh and of their sides.
#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "substructures/elements/mesh.hpp"

namespace stridor {

/// Shapes of the sides of elements: edges of planar ones, faces of volumes.
enum class SideShape : std::uint8_t { line2, line3, tri3, tri6, quad4, quad8 };

/// @throws std::invalid_argument for numbers of nodes that no side has
SideShape shape_of(const SideNodes& side);
/// Dimension of a side: 1 or 2.
int dimension_of(SideShape shape);
int num_nodes_of(SideShape shape);

/// Shape functions N of all nodes at one point, with one column of derivatives per natural
/// coordinate.
///
/// Natural coordinates (ξ, η, ζ) are within [−1, 1] in lines, quadrilaterals and hexahedra; not
/// negative, with a sum of at most 1, in triangles and tetrahedra, whose corners are the origin and
/// the unit points; those of a triangle and of a line ζ in wedges. Functions of elements with
/// nodes in the middles of edges are the serendipity ones.
struct ShapeFunctions {
  Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 20, 1> values;
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 20, 3> derivatives;
};
/// @param point natural coordinates; those beyond the dimension do not matter
ShapeFunctions shape_functions(ElementShape shape, const Eigen::Vector3d& point);
ShapeFunctions shape_functions(SideShape shape, const Eigen::Vector3d& point);

/// Natural coordinates of the nodes, a row each.
Eigen::Matrix<double, Eigen::Dynamic, 3> natural_nodes(ElementShape shape);
Eigen::Matrix<double, Eigen::Dynamic, 3> natural_nodes(SideShape shape);

/// Area or volume of an element in natural coordinates.
double natural_size(ElementShape shape);
double natural_size(SideShape shape);

}  // namespace stridor
