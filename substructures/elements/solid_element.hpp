// Stiffness and consistent mass of one element of a mesh.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <vector>

#include "substructures/elements/elastic_law.hpp"
#include "substructures/elements/mesh.hpp"
#include "substructures/elements/quadrature.hpp"

namespace stridor {

/// What an element is made of.
struct ElementSection {
  ElasticLaw law;
  double density = 0.0;    ///< ρ, kg/m³, > 0
  double thickness = 1.0;  ///< w of planar elements across the plane, m, > 0; of no use in volumes
  Integration integration = Integration::full;
  /// D at a place, m, where the axes of the material turn within the body; empty: that of `law`.
  std::function<ElasticLaw::Matrix(const Eigen::Vector3d& place)> law_at{};
};

/// Sizes of a shape that the compiler knows.
template <ElementShape shape>
struct ElementSizes {
  static constexpr int dimension = shape <= ElementShape::quad8 ? 2 : 3;
  static constexpr int num_nodes = [] {
    constexpr int of_shape[]{3, 6, 4, 8, 4, 10, 8, 20, 6, 15};
    return of_shape[static_cast<int>(shape)];
  }();
  static constexpr int num_dofs = dimension * num_nodes;
};

/// Positions of the nodes of an element, m.
template <ElementShape shape>
using ElementNodes = Eigen::Matrix<double, ElementSizes<shape>::num_nodes,
                                   ElementSizes<shape>::dimension, Eigen::RowMajor>;
/// DoFs interleaved: x of node 0, y of node 0, …, x of node 1, …
template <ElementShape shape>
using ElementStiffness =
    Eigen::Matrix<double, ElementSizes<shape>::num_dofs, ElementSizes<shape>::num_dofs>;
/// ∫ ρ N_a N_b dV between nodes, alike in every direction.
template <ElementShape shape>
using NodalMass =
    Eigen::Matrix<double, ElementSizes<shape>::num_nodes, ElementSizes<shape>::num_nodes>;

/// K = ∫ Bᵀ D B w dA or ∫ Bᵀ D B dV, N/m, exactly symmetric, at stiffness_points().
///
/// hex8 has the incompatible modes of Wilson in the form of Taylor, Beresford and Wilson (1976),
/// condensed: its own bending is right as long as it is a box, and it passes the patch test in any
/// form. All other elements have no more than their shape functions; linear triangles and
/// tetrahedra, quad4 and wedge6 are far too stiff in bending.
///
/// @param label of the element, for messages
/// @throws std::invalid_argument if the Jacobian is not positive at a point, or the law is not for
///   this dimension
template <ElementShape shape>
ElementStiffness<shape> element_stiffness(const ElementNodes<shape>& nodes,
                                          const ElementSection& section, std::int64_t label);

/// Consistent mass at mass_points(), kg: exact where the Jacobian is constant, positive definite.
/// @throws std::invalid_argument if the Jacobian is not positive at a point
template <ElementShape shape>
NodalMass<shape> element_mass(const ElementNodes<shape>& nodes, const ElementSection& section,
                              std::int64_t label);

/// Both, of a shape that is known when the program runs.
struct ElementMatrices {
  Eigen::MatrixXd stiffness;   ///< N/m, DoFs interleaved
  Eigen::MatrixXd nodal_mass;  ///< kg, between nodes
};
/// @param nodes a row each; the third column is not read by planar shapes
/// @throws std::invalid_argument as element_stiffness(), or for another number of nodes
ElementMatrices element_matrices(ElementShape shape, const Mesh::Nodes& nodes,
                                 const ElementSection& section, std::int64_t label);

/// Calls `action.template operator()<shape>()` of a shape that is known when the program runs.
template <class Action>
decltype(auto) with_shape(ElementShape shape, Action&& action) {
  using enum ElementShape;
  switch (shape) {
    case tri3:
      return action.template operator()<tri3>();
    case tri6:
      return action.template operator()<tri6>();
    case quad4:
      return action.template operator()<quad4>();
    case quad8:
      return action.template operator()<quad8>();
    case tet4:
      return action.template operator()<tet4>();
    case tet10:
      return action.template operator()<tet10>();
    case hex8:
      return action.template operator()<hex8>();
    case hex20:
      return action.template operator()<hex20>();
    case wedge6:
      return action.template operator()<wedge6>();
    case wedge15:
      break;
  }
  return action.template operator()<wedge15>();
}

}  // namespace stridor
