#include "substructures/elements/side_search.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "substructures/elements/mesh_surfaces.hpp"
#include "substructures/elements/shape_functions.hpp"

namespace stridor {
namespace {

using SidePlaces = Eigen::Matrix<double, Eigen::Dynamic, 3, 0, 8, 3>;

SideShape shape_of_side(const Mesh& mesh, const ElementSide& side) {
  const ShapeFacts& facts = facts_of(mesh.shapes[static_cast<std::size_t>(side.element)]);
  return shape_of(facts.sides[static_cast<std::size_t>(side.side)]);
}

SidePlaces places_of(const Mesh& mesh, const std::vector<int>& nodes) {
  SidePlaces places(static_cast<Eigen::Index>(nodes.size()), 3);
  for (std::size_t i = 0; i < nodes.size(); ++i)
    places.row(static_cast<Eigen::Index>(i)) = mesh.nodes.row(nodes[i]);
  return places;
}

/// How far natural coordinates are outside, as a part of the extent of the side.
double part_beyond(SideShape shape, const Eigen::Vector3d& at) {
  switch (shape) {
    case SideShape::line2:
    case SideShape::line3:
      return std::max(0.0, 0.5 * (std::abs(at.x()) - 1.0));
    case SideShape::tri3:
    case SideShape::tri6:
      return std::max({0.0, -at.x(), -at.y(), at.x() + at.y() - 1.0});
    case SideShape::quad4:
    case SideShape::quad8:
      break;
  }
  return std::max({0.0, 0.5 * (std::abs(at.x()) - 1.0), 0.5 * (std::abs(at.y()) - 1.0)});
}

/// Natural coordinates of the nearest place on a side, beyond its edges too.
std::optional<Eigen::Vector3d> nearest_on(SideShape shape, const SidePlaces& nodes,
                                          const Eigen::Vector3d& place) {
  constexpr int most_steps = 50;
  constexpr double far_outside = 4.0;
  const Eigen::Index d = dimension_of(shape);
  Eigen::Vector3d at = natural_nodes(shape).colwise().mean().transpose();
  for (int step = 0; step < most_steps; ++step) {
    const ShapeFunctions functions = shape_functions(shape, at);
    const Eigen::Vector3d miss = place - nodes.transpose() * functions.values;
    const Eigen::MatrixXd tangents = nodes.transpose() * functions.derivatives;
    const Eigen::VectorXd change =
        (tangents.transpose() * tangents).ldlt().solve(tangents.transpose() * miss);
    if (!change.allFinite()) return std::nullopt;
    at.head(d) += change;
    if (at.cwiseAbs().maxCoeff() > far_outside) return std::nullopt;
    if (change.norm() < 1e-13) break;
  }
  return at;
}

}  // namespace

SideSearch::SideSearch(const Mesh& mesh, const std::vector<ElementSide>& sides)
    : mesh_(mesh), sides_(sides) {
  boxes_.reserve(sides.size());
  for (const ElementSide& side : sides) {
    const SidePlaces places = places_of(mesh, nodes_of(mesh, side));
    Box box{places.colwise().minCoeff().transpose(), places.colwise().maxCoeff().transpose(), 0.0};
    box.size = (box.high - box.low).matrix().norm();
    // Curved sides bulge beyond the box of their nodes.
    box.low -= 0.1 * box.size;
    box.high += 0.1 * box.size;
    boxes_.push_back(box);
  }
}

std::optional<SidePoint> SideSearch::nearest(const Eigen::Vector3d& place,
                                             std::optional<double> reach, double share) const {
  std::optional<SidePoint> best;
  for (std::size_t s = 0; s < sides_.size(); ++s) {
    const Box& box = boxes_[s];
    const double room = reach.value_or(share * box.size);
    if ((place.array() < box.low - room).any() || (place.array() > box.high + room).any()) continue;
    const SideShape shape = shape_of_side(mesh_, sides_[s]);
    const std::vector<int> nodes = nodes_of(mesh_, sides_[s]);
    const SidePlaces places = places_of(mesh_, nodes);
    const auto at = nearest_on(shape, places, place);
    if (!at) continue;
    const ShapeFunctions functions = shape_functions(shape, *at);
    SidePoint point{sides_[s],
                    nodes,
                    {functions.values.begin(), functions.values.end()},
                    places.transpose() * functions.values,
                    0.0,
                    0.0,
                    box.size};
    point.distance = (point.place - place).norm();
    point.beyond = box.size * part_beyond(shape, *at);
    if (point.distance > room || point.beyond > room) continue;
    if (!best || point.distance + point.beyond < best->distance + best->beyond) best = point;
  }
  return best;
}

}  // namespace stridor
