// Kinematics of one sliding contact with its derivatives.
#pragma once

#include <Eigen/Core>
#include <array>

#include "coupling/kinematics/tangent_kinematics.hpp"
#include "coupling/system/system.hpp"

namespace stridor {

/// A contact with positions as seen from the undeformed T1 of its segment, where the rounding of a
/// position far from the origin does not drown the gap.
struct ContactPositions {
  ContactAssumption assumption = ContactAssumption::subs_b;
  Eigen::Vector2d slave = Eigen::Vector2d::Zero();  ///< displaced by drive and deformation, m
  SurfacePiece master;                              ///< deformed, m
  SurfacePiece undeformed;                          ///< m
  /// Of the slave displaced by the drive alone, on the undeformed segment.
  Projection prescribed;
  const Roughness* roughness = nullptr;          ///< not owned; null where there is none
  std::array<double, max_stencil> arc_length{};  ///< of the nodes of the stencil, m
  double driven_velocity = 0.0;  ///< of the slave against the master in +x, by the drive alone, m/s
};

inline constexpr int max_contact_ports = max_tangent_ports;
/// Slave x, y and the nodes of the stencil x, y each.
using PortVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, max_contact_ports, 1>;
using PortMatrix =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, max_contact_ports, max_contact_ports>;

/// Parts of the derivative of a contact, each of which can be left out to see its effect.
struct LinearisationTerms {
  bool turning_normal = true;    ///< the normal force turns with the surface
  bool turning_friction = true;  ///< the friction force turns with the surface
  bool shift = true;             ///< the force moves along the segment with ξ
  bool slope = true;  ///< Subs-c: the gap changes as ξ moves along a surface that is not parallel
                      ///< to the undeformed one
  bool roughness = true;       ///< the gap changes as ξ moves along the slope of the roughness
  bool friction_slope = true;  ///< μ changes with the sliding velocity
  // Of contacts with two tangents.
  bool friction = true;  ///< friction varies with the normal force; without it there is none
  bool friction_damping = true;  ///< friction turns with the sliding velocity, not along φ
  bool geometric = true;         ///< forces turn and shift with the motion
};

/// One sliding contact and its derivatives with respect to the displacements z of its ports
/// (docs/theory.md, 6.2).
struct ContactLinearisation {
  Projection projection;
  double gap = 0.0;             ///< m
  double slip_velocity = 0.0;   ///< v_r for ż = 0, m/s
  double direction = 1.0;       ///< χ
  double friction = 0.0;        ///< μ(v_r)
  double friction_slope = 0.0;  ///< dμ/dv_r, s/m
  /// −∂gap/∂z; the row of B_C but for the slopes of Subs-c and of the roughness.
  PortVector gap_row;
  PortVector shift_row;          ///< ∂ξ/∂z, 1/m
  PortVector tangent_row;        ///< ∂v_r/∂ż
  PortVector force_row;          ///< row of B_E
  PortMatrix force_by_position;  ///< ∂(row of B_E)ᵀ/∂z, 1/m
  PortMatrix force_by_velocity;  ///< ∂(row of B_E)ᵀ/∂ż, s/m
  // With two tangents.
  Eigen::Vector2d velocity = Eigen::Vector2d::Zero();  ///< v of TangentKinematics for ż = 0, m/s
  Eigen::Vector2d sliding_direction{1.0, 0.0};         ///< d = v/|v|
};

/// Gap, rows and derivatives of a sliding contact under its assumption.
///
/// Exact derivatives of the kinematics that `Simulation` marches with, away from v_r = 0.
/// @param positions       where it is
/// @param law             friction law
/// @param friction_factor on the law, >= 0
/// @param terms           which parts of the derivatives are wanted; gap, rows of B_C and B_E and
///                        friction do not depend on it
ContactLinearisation linearise_contact(const ContactPositions& positions, const FrictionLaw& law,
                                       double friction_factor,
                                       const LinearisationTerms& terms = {});

/// Gap, rows and derivatives of a sliding contact with two tangents, with d = v/|v|
/// (docs/theory.md, 10.8):
///
///   row of B_E   −(N + μ F d)
///   by y         −∂N/∂y − μ Σ d_i ∂F_i/∂y + F D (−∂v/∂y)ᵀ,   by ẏ   F D Tᵀ,
///   D = μ (1 − d dᵀ)/|v| + μ' d dᵀ
///
/// @param num_ports those of them that the slave has: one less where it does not move along z
/// @param terms     `friction`, `friction_damping` and `geometric` of the gap and the rows as well
/// @throws std::invalid_argument with friction that turns where nothing slides: it does so without
///         bound
ContactLinearisation linearise_face(const TangentKinematics& kinematics, Eigen::Index num_ports,
                                    const FrictionLaw& law, double friction_factor,
                                    const LinearisationTerms& terms = {});

/// Lets a contact feel the roughness of its master.
/// @param segment of the master that the positions belong to
void set_roughness(ContactPositions& positions, const MasterSurface& surface, int segment);

}  // namespace stridor
