// Sliding contact of a pad on a face of a spinning plate: rows and what linearisation adds.
#pragma once

#include <Eigen/Core>

#include "substructures/annular_plate.hpp"

namespace stridor {

/// One point of contact at rest in space, on a face of a plate that turns towards +φ.
///
/// Rows act on the coordinates of the whole system, n of them. A point of the face lies half the
/// thickness away from the mid-surface, so that it moves by −s (h/2) ∇w in the plane: this lever is
/// the whole part of the disc in friction.
struct FaceContact {
  PlateRows plate;              ///< at the contact, on all coordinates
  Eigen::VectorXd pad_r;        ///< displacement of the pad's point along r, n
  Eigen::VectorXd pad_phi;      ///< along φ
  Eigen::VectorXd pad_z;        ///< along the axis
  double radius = 0.0;          ///< r, m
  double half_thickness = 0.0;  ///< h/2, m
  int side = 1;                 ///< s: +1 on the face of larger z, −1 on the other

  /// Row of the gap: s (p_z − w).
  Eigen::VectorXd gap() const;
  /// Row of the sliding direction, along which friction drives the pad: s (h/2) w_φ/r + p_φ.
  Eigen::VectorXd friction() const;
  /// Row of the sliding across: s (h/2) w_r + p_r.
  Eigen::VectorXd across() const;
};

/// What the contact forces of the sliding state add where they turn or shift with the motion
/// (docs/theory.md, 10.2), as matrices on the left-hand side of the equations of motion.
///
/// The normal force N₀ follows the slope of the face and the place of the pad:
///
///   N₀ (h/2)(g_r g_rᵀ + g_φ g_φᵀ) + N₀ s (g_r p_rᵀ + g_φ p_φᵀ + p_r g_rᵀ + p_φ g_φᵀ),
///   g_r = w_r,  g_φ = w_φ/r
Eigen::MatrixXd normal_preload_stiffness(const FaceContact& contact, double normal_force);

/// The same of the friction force R₀ = μ N₀ along the sliding direction:
///
///   R₀ (w − p_z) g_φᵀ − R₀ s (h/2) [H_rφ (p_r + s (h/2) g_r)ᵀ + H_φφ (p_φ + s (h/2) g_φ)ᵀ],
///   H_rφ = w_rφ/r − w_φ/r²,  H_φφ = w_φφ/r² + w_r/r
Eigen::MatrixXd friction_preload_stiffness(const FaceContact& contact, double friction_force);

/// Friction turns against velocities across the sliding direction: (R₀/(Ω r)) a aᵀ, a = across().
/// @param speed Ω, rad/s, > 0
Eigen::MatrixXd friction_damping(const FaceContact& contact, double friction_force, double speed);

/// The part of the velocity across that comes with the rotation: R₀ a (p_φ/r + s (h/2) w_rφ/r)ᵀ.
Eigen::MatrixXd friction_turning_stiffness(const FaceContact& contact, double friction_force);

}  // namespace stridor
