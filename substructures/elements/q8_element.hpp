// Plane-stress 8-node serendipity quadrilateral.
#pragma once

#include <Eigen/Core>

namespace stridor {

/// Isotropic linear elastic material in plane stress.
struct ElasticMaterial {
  double youngs_modulus;  ///< E, Pa
  double poissons_ratio;  ///< ν, in (−1, 0.5)
  double density;         ///< ρ, kg/m³
};

/// Corner nodes 0..3 counter-clockwise, then mid-side nodes 4..7 (between 0-1, 1-2, 2-3, 3-0).
using Q8Nodes = Eigen::Matrix<double, 8, 2>;
/// DoFs interleaved: x of node 0, y of node 0, x of node 1, …
using Q8Matrix = Eigen::Matrix<double, 16, 16>;

struct Q8Element {
  Q8Matrix stiffness;  ///< ∫ Bᵀ D B w dA, N/m
  Q8Matrix mass;       ///< ∫ ρ Nᵀ N w dA (consistent), kg
};

/// Stiffness and consistent mass with 3x3 Gauss points (exact for a parallelogram).
///
/// @param nodes    positions, m
/// @param material material
/// @param width    w out of the plane, m
/// @throws std::invalid_argument if the Jacobian is not positive at a Gauss point
Q8Element make_q8_element(const Q8Nodes& nodes, const ElasticMaterial& material, double width);

}  // namespace stridor
