// Master surfaces in space: facets between nodes, flat or bulged to a smooth shape.
#pragma once

#include <Eigen/Core>
#include <array>
#include <string>
#include <vector>

#include "coupling/kinematics/surface.hpp"
#include "substructures/matrices/facet.hpp"

namespace stridor {

/// Weights of the nodes of a facet at (ξ, η) with their derivatives. A triangle has 1 − ξ − η, ξ and
/// η; a quadrilateral is bilinear over [0, 1]².
struct FacetWeights {
  std::array<double, 4> value{};
  std::array<std::array<double, 4>, 2> slope{};  ///< by ξ and by η
  std::array<double, 4> mixed{};                 ///< by ξ and η; the others vanish
};
FacetWeights facet_weights(int count, double xi, double eta);

/// A place with the directions of a patch there; the place is Σ w_k x_k + bulge.
struct PatchPoint {
  FacetWeights weights;
  Eigen::Vector3d place;                          ///< m
  std::array<Eigen::Vector3d, 2> slopes;          ///< a_ξ, a_η
  std::array<Eigen::Vector3d, 3> curvatures;      ///< by ξξ, ξη, ηη
};

/// A facet wherever its nodes are. The bulge between straight edges and smooth surface is that of the
/// undeformed surface: −Σ c_e over its edges, quadratic along each (docs/theory.md, 2.7).
struct FacetPatch {
  int count = 3;
  std::array<Eigen::Vector3d, 4> nodes;
  std::array<Eigen::Vector3d, 4> bulges;  ///< c of the edge from node k to the next
  bool is_bulged = false;

  PatchPoint at(double xi, double eta) const;
};

/// Place of a point over a facet.
struct FacetPlace {
  int facet = 0;
  double xi = 0.0;
  double eta = 0.0;
};

/// Closest point of a patch, beyond whose edges it is continued: a_ξ·(x − M) = a_η·(x − M) = 0.
/// @param guess ξ and η to begin with; Newton's method, kept within one facet around
Eigen::Vector2d closest_on(const FacetPatch& patch, const Eigen::Vector3d& point,
                           const Eigen::Vector2d& guess);

/// A master surface in space.
struct FacetSurface {
  std::string name;  ///< "<body>.<surface>"
  int body = 0;
  std::vector<std::array<int, 3>> rows;    ///< of the body, of x, y and z of every node
  std::vector<Eigen::Vector3d> positions;  ///< undeformed, global, m
  std::vector<Facet> facets;               ///< of these nodes
  /// Facet beyond each edge, from node k to the next; −1 where the surface ends.
  std::vector<std::array<int, 4>> neighbours;
  std::vector<std::array<Eigen::Vector3d, 4>> bulges;  ///< of the edges; empty: flat facets
  /// Angular velocity with which material passes through a body of revolution that stays in its place,
  /// rad/s, about a point of its axis, m.
  Eigen::Vector3d spin = Eigen::Vector3d::Zero();
  Eigen::Vector3d axis_point = Eigen::Vector3d::Zero();

  int num_nodes() const { return static_cast<int>(positions.size()); }
  /// Most nodes of a facet, 3 or 4.
  int max_nodes() const;
  /// The undeformed facet as seen from its first node, m.
  FacetPatch patch(int facet) const;
  const Eigen::Vector3d& origin(int facet) const {
    return positions[static_cast<std::size_t>(facets[static_cast<std::size_t>(facet)].nodes[0])];
  }
  /// Diagonal of the box around the nodes, m.
  double extent() const;
};

/// Completes a surface of which positions and facets are given.
/// @throws std::invalid_argument for a facet without area, or an edge with more than two facets
void connect_facets(FacetSurface& surface, SurfaceKind kind);

/// Moves from facet to facet towards the one over which a point stands, never over one twice.
class FacetSearch {
 public:
  enum class Step { stay, moved, lost };
  /// @param at place on the present facet; its facet becomes the next one
  Step look(const FacetSurface& surface, FacetPlace& at);

 private:
  bool has_visited(int facet) const;

  std::array<int, 32> visited_{};
  int num_visited_ = 0;
};

/// The facet under a point, of those that have it within their edges the closest one.
/// @param point global, m
/// @return facet −1 where the point is beside the surface
FacetPlace locate_on(const FacetSurface& surface, const Eigen::Vector3d& point);

}  // namespace stridor
