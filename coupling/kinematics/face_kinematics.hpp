// Kinematics of a point on a face of a spinning body, seen from space.
#pragma once

#include <Eigen/Core>

#include "coupling/kinematics/face_place.hpp"

namespace stridor {

/// Ports of a contact on a face: w, w_r, w_φ, w_rφ and w_φφ of the spinning body at the place, then
/// x, y and z of the slave's point (z is 0 of a slave that does not move along it).
inline constexpr int num_face_rows = 5;
inline constexpr int num_face_ports = num_face_rows + 3;
using FacePorts = Eigen::Matrix<double, num_face_ports, 1>;
using FaceMatrix = Eigen::Matrix<double, num_face_ports, num_face_ports>;

/// Gap, directions of forces and sliding velocity of a contact on a face, in the displacements y of
/// its ports (docs/theory.md, 10.2). To second order in y
///
///   gap g = n y + ½ yᵀ A y,
///   forces along n + A y (normal), b + B y (friction along the circumference), a (along the radius),
///   v = (Ω r − b ẏ, −a ẏ − Ω r c y)   velocity of the face against the slave,
///
///   n = s (p_z − w),  b = p_φ + s (h/2) w_φ/r,  a = p_r + s (h/2) w_r,
///   c = p_φ/r + s (h/2) w_rφ/r,
///   A = −(h/2)(g_r g_rᵀ + g_φ g_φᵀ) − s (g_r p_rᵀ + g_φ p_φᵀ + p_r g_rᵀ + p_φ g_φᵀ),
///   B = (p_z − w) g_φᵀ + s (h/2)(H_rφ aᵀ + H_φφ bᵀ),
///   g_r = w_r,  g_φ = w_φ/r,  H_rφ = w_rφ/r − w_φ/r²,  H_φφ = w_φφ/r² + w_r/r
struct FaceKinematics {
  FacePorts normal;    ///< n
  FacePorts along;     ///< b
  FacePorts across;    ///< a
  FacePorts turning;   ///< c, 1/m
  FaceMatrix normal_bending;    ///< A, 1/m
  FaceMatrix friction_bending;  ///< B, 1/m
  double sliding = 0.0;         ///< Ω r, m/s

  double gap(const FacePorts& y) const { return normal.dot(y) + 0.5 * y.dot(bent_normal(y)); }
  /// n + A y
  FacePorts normal_at(const FacePorts& y) const { return normal + bent_normal(y); }
  /// b + B y
  FacePorts along_at(const FacePorts& y) const { return along + friction_bending.lazyProduct(y); }
  Eigen::Vector2d velocity(const FacePorts& y, const FacePorts& rate) const {
    return {sliding - along.dot(rate), -across.dot(rate) - sliding * turning.dot(y)};
  }
  /// Distance by which the face slides past the slave from y to `next` in a time, m: the velocity
  /// with the mean of both displacements.
  Eigen::Vector2d slip(const FacePorts& y, const FacePorts& next, double time) const {
    const FacePorts moved = next - y;
    return {time * sliding - along.dot(moved),
            -across.dot(moved) - 0.5 * time * sliding * turning.dot(y + next)};
  }

 private:
  FacePorts bent_normal(const FacePorts& y) const { return normal_bending.lazyProduct(y); }
};

FaceKinematics make_face_kinematics(const FacePlace& place);

}  // namespace stridor
