// Integration points of elements and of their sides.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "substructures/elements/mesh.hpp"
#include "substructures/elements/shape_functions.hpp"

namespace stridor {

/// A point in natural coordinates with its weight; the weights of an element sum to natural_size().
struct IntegrationPoint {
  Eigen::Vector3d place;
  double weight;
};

/// How the stiffness of an element is integrated.
enum class Integration : std::uint8_t {
  full,
  /// 2 Gauss points in every direction in quad8 and hex20, which makes them softer in bending and
  /// leaves motions without strain in a single element (one in quad8, six in hex20); as `full` in
  /// all other shapes.
  reduced,
};

/// Points for the stiffness:
///
/// | shape | full | reduced |
/// |---|---|---|
/// | tri3, tet4 | 1 | 1 |
/// | tri6, tet10 | 3, 4 | 3, 4 |
/// | quad4, hex8 | 4, 8 | 4, 8 |
/// | quad8, hex20 | 9, 27 | 4, 8 |
/// | wedge6 | 3 x 2 | 3 x 2 |
/// | wedge15 | 3 x 3 | 3 x 3 |
///
/// Exact for the products of derivatives where the Jacobian is constant, except the reduced ones
/// and wedge15, whose corner functions have terms of one degree more in the triangle.
const std::vector<IntegrationPoint>& stiffness_points(ElementShape shape, Integration integration);

/// Points for the mass: exact for products of shape functions where the Jacobian is constant, with
/// positive weights (tri6 6, tet10 15, quad8 9, hex20 27, wedge15 6 x 3).
const std::vector<IntegrationPoint>& mass_points(ElementShape shape);

/// Points for loads on sides and their areas: exact for shape functions times the area element of
/// plane sides (line2 2, line3 3, tri3 3, tri6 6, quad4 4, quad8 9).
const std::vector<IntegrationPoint>& side_points(SideShape shape);

}  // namespace stridor
