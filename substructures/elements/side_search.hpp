// Places on the sides of elements.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "substructures/elements/mesh.hpp"

namespace stridor {

/// The place on a side that is nearest to another place.
struct SidePoint {
  ElementSide side;
  std::vector<int> nodes;       ///< rows of the mesh
  std::vector<double> weights;  ///< shape functions of these nodes; their sum is 1
  Eigen::Vector3d place = Eigen::Vector3d::Zero();  ///< Σ weight x node, m
  double distance = 0.0;                            ///< from the place that was asked for, m
  double beyond = 0.0;  ///< how far it lies beyond the edge of the side, m; 0 within
  double size = 0.0;    ///< diagonal of the box around the side, m
};

/// Finds nearest places on some sides of a mesh, which must outlive it.
class SideSearch {
 public:
  SideSearch(const Mesh& mesh, const std::vector<ElementSide>& sides);

  /// The nearest place, by Gauss and Newton from the middle of every side that is near.
  /// @param reach of distance and beyond the edge, m; absent: `share` of the size of the side
  /// @return nothing where no side is within reach
  /// Cost: linear in the number of sides.
  std::optional<SidePoint> nearest(const Eigen::Vector3d& place, std::optional<double> reach,
                                   double share) const;

 private:
  struct Box {
    Eigen::Array3d low, high;
    double size = 0.0;
  };
  const Mesh& mesh_;
  const std::vector<ElementSide>& sides_;
  std::vector<Box> boxes_;
};

}  // namespace stridor
