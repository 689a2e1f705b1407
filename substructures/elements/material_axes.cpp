#include "substructures/elements/material_axes.hpp"

#include <Eigen/Geometry>
#include <stdexcept>

namespace stridor {

std::optional<Eigen::Matrix3d> AxisOfRevolution::frame_at(const Eigen::Vector3d& place) const {
  const Eigen::Vector3d from_point = place - point;
  const Eigen::Vector3d radius = from_point - direction.dot(from_point) * direction;
  const double length = radius.norm();
  constexpr double rounding = 1e-12;
  if (!(length > rounding * from_point.norm())) return std::nullopt;
  Eigen::Matrix3d frame;
  frame.col(0) = radius / length;
  frame.col(1) = direction.cross(frame.col(0));
  frame.col(2) = direction;
  return frame;
}

Eigen::Matrix3d axes_from(const Eigen::Vector3d& first, const Eigen::Vector3d& second) {
  const Eigen::Vector3d across = first.cross(second);
  constexpr double least_angle = 1e-6;
  if (!(across.norm() > least_angle * first.norm() * second.norm()))
    throw std::invalid_argument("axes_from: the two vectors are parallel");
  Eigen::Matrix3d axes;
  axes.col(0) = first.normalized();
  axes.col(2) = across.normalized();
  axes.col(1) = axes.col(2).cross(axes.col(0));
  return axes;
}

}  // namespace stridor
