#include "substructures/elements/mesh_point.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>

#include "substructures/elements/shape_functions.hpp"

namespace stridor {
namespace {

/// How far natural coordinates are outside of an element; not positive within.
double excess(ElementShape shape, const Eigen::Vector3d& at) {
  const auto of_line = [](double x) { return std::abs(x) - 1.0; };
  const double of_triangle = std::max({-at.x(), -at.y(), at.x() + at.y() - 1.0});
  switch (shape) {
    case ElementShape::tri3:
    case ElementShape::tri6:
      return of_triangle;
    case ElementShape::quad4:
    case ElementShape::quad8:
      return std::max(of_line(at.x()), of_line(at.y()));
    case ElementShape::tet4:
    case ElementShape::tet10:
      return std::max({-at.x(), -at.y(), -at.z(), at.sum() - 1.0});
    case ElementShape::hex8:
    case ElementShape::hex20:
      return std::max({of_line(at.x()), of_line(at.y()), of_line(at.z())});
    case ElementShape::wedge6:
    case ElementShape::wedge15:
      break;
  }
  return std::max(of_triangle, of_line(at.z()));
}

/// Natural coordinates of a place near an element, by Newton's method.
std::optional<Eigen::Vector3d> natural_place(ElementShape shape, const Eigen::MatrixXd& nodes,
                                             const Eigen::VectorXd& place) {
  constexpr int most_steps = 30;
  constexpr double far_outside = 3.0;
  const Eigen::Index d = nodes.cols();
  Eigen::Vector3d at = natural_nodes(shape).colwise().mean().transpose();
  for (int step = 0; step < most_steps; ++step) {
    const ShapeFunctions shapes = shape_functions(shape, at);
    const Eigen::VectorXd miss = place - nodes.transpose() * shapes.values;
    const Eigen::MatrixXd jacobian = nodes.transpose() * shapes.derivatives;
    const Eigen::VectorXd change = jacobian.partialPivLu().solve(miss);
    if (!change.allFinite()) return std::nullopt;
    at.head(d) += change;
    if (at.cwiseAbs().maxCoeff() > far_outside) return std::nullopt;
    if (change.norm() < 1e-12) return at;
  }
  return std::nullopt;
}

}  // namespace

MeshPoint find_point(const Mesh& mesh, const Eigen::Vector3d& place, double tolerance) {
  if (mesh.num_nodes() == 0) throw std::invalid_argument("find_point: the mesh has no nodes");
  const Eigen::Index d = mesh.dimension();
  const Eigen::RowVectorXd wanted = place.head(d).transpose();
  MeshPoint point;
  Eigen::Index nearest = 0;
  point.distance = std::sqrt(
      (mesh.nodes.leftCols(d).rowwise() - wanted).rowwise().squaredNorm().minCoeff(&nearest));
  point.nearest = static_cast<int>(nearest);
  if (point.distance <= tolerance) {
    point.nodes = {point.nearest};
    point.weights = {1.0};
    return point;
  }
  constexpr double rounding = 1e-9;
  double least = rounding;
  for (std::size_t e = 0; e < mesh.num_elements(); ++e) {
    const std::span<const int> of_element = mesh.nodes_of(e);
    Eigen::MatrixXd nodes(static_cast<Eigen::Index>(of_element.size()), d);
    for (std::size_t a = 0; a < of_element.size(); ++a)
      nodes.row(static_cast<Eigen::Index>(a)) = mesh.nodes.row(of_element[a]).head(d);
    // Curved sides bulge beyond the box of their nodes.
    const Eigen::ArrayXXd low = nodes.colwise().minCoeff().array();
    const Eigen::ArrayXXd high = nodes.colwise().maxCoeff().array();
    const double room = 0.2 * (high - low).maxCoeff();
    if ((wanted.array() < low - room).any() || (wanted.array() > high + room).any()) continue;
    const auto at = natural_place(mesh.shapes[e], nodes, wanted.transpose());
    if (!at || !(excess(mesh.shapes[e], *at) <= least)) continue;
    least = excess(mesh.shapes[e], *at);
    const ShapeFunctions shapes = shape_functions(mesh.shapes[e], *at);
    point.nodes.assign(of_element.begin(), of_element.end());
    point.weights.assign(shapes.values.begin(), shapes.values.end());
  }
  return point;
}

}  // namespace stridor
