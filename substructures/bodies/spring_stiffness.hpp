// Stiffness of springs, and of dampers, in the plane and in space.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "core/schema.hpp"

namespace stridor {

/// Stiffness (or damping) of a spring: a number along its direction, or a matrix.
struct SpringMatrixParameters {
  std::optional<double> along;       ///< N/m, >= 0
  std::optional<double> xx, yy, zz;  ///< N/m, >= 0
  std::optional<double> xy, yz, zx;  ///< N/m

  SpringMatrixParameters() = default;
  SpringMatrixParameters(double number)  // NOLINT(google-explicit-constructor): a number is one
      : along(number) {}

  bool is_given() const { return along || xx || yy || zz || xy || yz || zx; }
  /// The keys with a unit, N/m or that of a damper.
  static const Schema& schema();
};

/// The same of a damper, N s/m.
struct DamperMatrixParameters : SpringMatrixParameters {
  using SpringMatrixParameters::SpringMatrixParameters;
  static const Schema& schema();
};

/// Direction of a spring: an angle in the plane, or a vector.
struct SpringDirectionParameters {
  std::optional<double> angle;  ///< against +x, rad
  std::vector<double> vector;   ///< two or three components, of any length

  SpringDirectionParameters() = default;
  SpringDirectionParameters(double number)  // NOLINT(google-explicit-constructor): a number is one
      : angle(number) {}

  /// Of unit length.
  Eigen::Vector3d unit() const;
  static const Schema& schema();
};

/// The symmetric matrix K of f = −K u: k d dᵀ of a number k along d, else as given.
Eigen::Matrix3d spring_matrix(const SpringMatrixParameters& given, const Eigen::Vector3d& along);

/// The directions along which a matrix of spring_matrix() is seen: d of a number, else those of x, y
/// and z in which it is stiff.
std::vector<Eigen::Vector3d> spring_directions(const SpringMatrixParameters& given,
                                               const Eigen::Vector3d& along);

}  // namespace stridor
