// Axes of materials that are not alike in all directions.
#pragma once

#include <Eigen/Core>
#include <optional>

namespace stridor {

/// A line that a cylindrical frame is about.
struct AxisOfRevolution {
  Eigen::Vector3d point = Eigen::Vector3d::Zero();       ///< of the line, m
  Eigen::Vector3d direction = Eigen::Vector3d::UnitZ();  ///< of length 1

  /// Radial, tangential and axial unit vectors at a place, as columns: a rotation.
  /// @return nothing on the axis itself
  std::optional<Eigen::Matrix3d> frame_at(const Eigen::Vector3d& place) const;
};

/// Rotation with axes 1, 2, 3 as columns: 1 along `first`, 2 in the plane of both on the side of
/// `second`, 3 across.
/// @throws std::invalid_argument if they are parallel or one of them is zero
Eigen::Matrix3d axes_from(const Eigen::Vector3d& first, const Eigen::Vector3d& second);

}  // namespace stridor
