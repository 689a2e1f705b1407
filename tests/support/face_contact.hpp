// Sliding contact of a pad on a face of a spinning plate: rows, how they turn, and the law.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "substructures/bodies/annular_plate.hpp"
#include "substructures/matrices/linear_system.hpp"

namespace stridor {

/// One point of contact at rest in space, on a face of a plate that turns towards +φ.
///
/// Rows act on the coordinates of the whole system, n of them. A point of the face lies half the
/// thickness away from the mid-surface, so that it moves by −s (h/2) ∇w in the plane: this lever is
/// the whole part of the disc in friction.
///
/// The contact moves with its pad over the face, whose slope changes: to second order in
/// displacements the gap is n q + ½ qᵀ A q, and the generalised forces per unit of normal force and
/// of friction are n + A q and b + B q (docs/theory.md, 10.2):
///
///   A = −(h/2)(g_r g_rᵀ + g_φ g_φᵀ) − s (g_r p_rᵀ + g_φ p_φᵀ + p_r g_rᵀ + p_φ g_φᵀ),
///   B = (p_z − w) g_φᵀ + s (h/2)(H_rφ aᵀ + H_φφ bᵀ),
///   g_r = w_r,  g_φ = w_φ/r,  H_rφ = w_rφ/r − w_φ/r²,  H_φφ = w_φφ/r² + w_r/r
struct FaceContact {
  PlateRows plate;              ///< at the contact, on all coordinates
  Eigen::VectorXd pad_r;        ///< displacement of the pad's point along r, n
  Eigen::VectorXd pad_phi;      ///< along φ
  Eigen::VectorXd pad_z;        ///< along the axis
  double radius = 0.0;          ///< r, m
  double half_thickness = 0.0;  ///< h/2, m
  int side = 1;                 ///< s: +1 on the face of larger z, −1 on the other

  /// n, row of the gap: s (p_z − w).
  Eigen::VectorXd gap() const;
  /// b, row of the sliding direction, along which friction drives the pad: s (h/2) w_φ/r + p_φ.
  Eigen::VectorXd friction() const;
  /// a, row of the sliding across: s (h/2) w_r + p_r.
  Eigen::VectorXd across() const;
  /// c, row of the velocity across that comes with the rotation, over Ω r: p_φ/r + s (h/2) w_rφ/r.
  Eigen::VectorXd turning() const;

  /// A = F K_A and B = F K_B: the forces F that bend, n x 7, and how they depend on q, 7 x n.
  static constexpr Eigen::Index num_bending = 7;
  Eigen::MatrixXd bending_forces() const;
  Eigen::MatrixXd normal_bending() const;
  Eigen::MatrixXd friction_bending() const;
};

/// Action of the contacts on the faces of a plate.
struct FaceContactLaw {
  double friction = 0.0;          ///< μ, >= 0
  std::optional<double> penalty;  ///< k_C of each, N/m, > 0; rigid where absent
  double speed = 0.0;             ///< Ω, rad/s, >= 0
  bool friction_turns = false;    ///< against the whole sliding velocity, not along φ; Ω > 0
  bool forces_bend = false;       ///< as A and B have it; else they keep to n and b
};

/// One contact in a sliding state.
struct FaceContactPoint {
  bool is_closed = true;
  double force = 0.0;                   ///< λ₀, N, >= 0
  double gap = 0.0;                     ///< m; 0 or −λ₀/k_C where closed
  Eigen::Vector2d velocity{0.0, 0.0};   ///< of the face against the pad, along and across, m/s
  Eigen::Vector2d direction{1.0, 0.0};  ///< d, of friction: along and across
  Eigen::VectorXd normal, along;        ///< n + A q₀ and b + B q₀
};

/// Bodies at rest in space against a plate that turns, about which motion is small.
struct FaceSlidingState {
  Eigen::VectorXd displacement;  ///< q₀ of all coordinates
  std::vector<FaceContactPoint> contacts;
};

/// Gap, rows and friction of a contact between bodies at rest. It is closed as long as the caller
/// does not say otherwise.
/// @param displacement q₀
/// @param normal_force λ₀, N
FaceContactPoint face_contact_point(const FaceContact& contact, const FaceContactLaw& law,
                                    const Eigen::VectorXd& displacement, double normal_force);

/// The sliding state of prescribed forces, about undeformed bodies.
/// @param normal_force of each contact, N, >= 0
FaceSlidingState prescribed_sliding_state(const std::vector<FaceContact>& contacts,
                                          const FaceContactLaw& law, double normal_force);

/// Generalised force of a contact per unit of its normal force, at rest:
/// n + A q₀ + μ (d₁ (b + B q₀) + d₂ a).
Eigen::VectorXd unit_force(const FaceContact& contact, const FaceContactLaw& law,
                           const FaceContactPoint& point);

/// Derivative of friction along and across with respect to velocity along and across:
/// μ λ₀ (1 − d dᵀ)/|v|, N s/m; zero where friction does not turn.
Eigen::Matrix2d turning_resistance(const FaceContactLaw& law, const FaceContactPoint& point);

/// Small motion of bodies about a sliding state (docs/theory.md, 10.2, 10.3).
///
///   Q + Σ [−λ₀ A − μ λ₀ d₁ B + T D (0, Ω r c)ᵀ],  P + Σ T D (b, a)ᵀ,  T = (b + B q₀, a)
///
/// over the closed contacts, D = turning_resistance(). They are constraints with the rows n + A q₀
/// and unit_force(), or springs with a penalty.
///
/// @param bodies without contact; its own constraints are ignored
LinearSystem linearise(const LinearSystem& bodies, const std::vector<FaceContact>& contacts,
                       const FaceContactLaw& law, const FaceSlidingState& state);

}  // namespace stridor
