// Quadratic eigenvalue problem of bodies in sliding contact: a modal diagonal with few rows.
#pragma once

#include <Eigen/Core>
#include <complex>
#include <span>

#include "coupling/system/system.hpp"

namespace stridor {

/// Small motion of modal bodies under contact constraints (docs/theory.md, 7.1).
///
///   q̈_i + c_i q̇_i + ω_i² q_i = (Sᵀ f)_i,   y = S q
///   f = −B_Eᵀ δλ − G y − H ẏ,   B_C y = 0
///
/// for the n modes of all bodies, stacked; m ports, whose displacements y are all that the contacts
/// see of the bodies; k constraints with multipliers δλ. An eigenvalue s belongs to the motion
/// q exp(st). There are 2(n − k), unless B_C S Sᵀ B_Eᵀ is singular.
///
/// A sliding contact has the ports of its slave point and of the nodes of its stencil
/// (System::num_contact_ports) and one constraint. Constraints may be added: a sticking contact has
/// two. G and H hold what the contact forces in equilibrium add where they turn or shift with the
/// motion or depend on the sliding velocity; about the undeformed geometry there is nothing to add.
/// The modes of a body with coupled terms are ports too, the last ones, between which G and H hold
/// these terms.
struct Pencil {
  Eigen::VectorXd omega;    ///< ω, n, rad/s, >= 0, in any order
  Eigen::VectorXd damping;  ///< c, n, 1/s; negative feeds energy in
  Eigen::MatrixXd ports;    ///< S, m x n, kg^-1/2

  Eigen::MatrixXd compatibility;    ///< B_C on the ports, k x m
  Eigen::MatrixXd equilibrium;      ///< B_E on the ports, k x m
  /// Gap per force of each constraint, k, m/N: B_C y = c δλ. Empty where all are rigid, as all
  /// functions on eigenvalues want it; see with_springs().
  Eigen::VectorXd compliance;
  Eigen::MatrixXd port_stiffness;   ///< G, m x m, N/m; empty where there is none
  Eigen::MatrixXd port_damping;     ///< H, m x m, N s/m; empty where there is none
  /// The part of G that is left without friction: stiffness of contacts that give way, along their
  /// normal, symmetric, m x m; empty where there is none. Taken by frictionless() and
  /// mode_energy() alone.
  Eigen::MatrixXd normal_stiffness;
  Eigen::Index num_body_ports = 0;  ///< of bodies with coupled terms

  Eigen::Index num_modes() const { return omega.size(); }
  Eigen::Index num_ports() const { return ports.rows(); }
  Eigen::Index num_constraints() const { return compatibility.rows(); }
  /// Finite eigenvalues, with multiplicity, conjugates and real ones counted one by one.
  Eigen::Index num_eigenvalues() const { return 2 * (num_modes() - num_constraints()); }
};

/// @throws std::invalid_argument if sizes do not fit together, a number is not finite, an ω is
///         negative, or there are as many constraints as modes or more
void check_pencil(const Pencil& pencil);

/// Modes of all bodies in their order, with the damping that lasts (α at the end of its schedule),
/// and ports and one constraint per contact of the system. The rows are zero until place_contact()
/// or place_undeformed() fills them; G and H hold the coupled terms of the bodies, and are empty
/// where there are none.
Pencil make_modal_pencil(const System& system);

/// The same motion with the constraints that give way as springs on the ports, G += B_Eᵀ B_C/c, of
/// which B_Cᵀ B_C/c is left without friction, and the rigid ones alone as constraints.
Pencil with_springs(const Pencil& pencil);

/// Takes what the contact forces in equilibrium add out of G and H; what is left are the coupled
/// terms of bodies.
void drop_contact_terms(Pencil& pencil);

/// Takes all damping of the bodies out; gyroscopic terms stay.
void drop_structural_damping(Pencil& pencil);
/// Takes all damping that contacts bring out of H.
void drop_contact_damping(Pencil& pencil);

/// First port of a contact in the pencil of its system.
Eigen::Index first_contact_port(const System& system, int contact);

/// Fills in ports and constraint of one contact.
///
/// @param pencil  of make_modal_pencil()
/// @param contact index into System::contacts: ports from first_contact_port(), constraint
/// `contact`
/// @param segment of its master surface
/// @param rows    of B_C and B_E
void place_contact(Pencil& pencil, const System& system, int contact, int segment,
                   const ContactRows& rows);

/// The same of a contact on a face, with its rows on the ports of the contact.
void place_face(Pencil& pencil, const System& system, int contact, int facet,
                const Eigen::VectorXd& compatibility, const Eigen::VectorXd& equilibrium);

/// Fills in every contact as it slides on the undeformed master: B_C and B_E with the normal of the
/// undeformed surface, no G and H.
///
/// @param drive_displacement of the bodies that follow the drive, in +x, m
/// @param friction           μ of every contact, >= 0
/// @param direction          χ of every contact, ±1: sign of the sliding velocity of the slave
///                           along the master; on a face it is that of the spin, along +φ
/// @throws std::invalid_argument if a slave point is beyond the end of its master
/// Linear in `drive_displacement` between two nodes of a polyline, cubic between those of a smooth
/// master.
void place_undeformed(Pencil& pencil, const System& system, double drive_displacement,
                      double friction, double direction);

/// The contacts as the modes feel them: what the small problem on the contacts is made of
/// (docs/theory.md, 7.1).
///
/// G y + H ẏ depends on r ≤ m combinations z = V y of the ports only; with G = P_G V and H = P_H V
///
///   d_i q_i = −(b_E,iᵀ δλ + (p_G,i + s p_H,i)ᵀ z),   Σ b_C,i q_i = 0,   Σ v_i q_i = z
struct ModalRows {
  Eigen::Index num_constraints = 0;  ///< k
  Eigen::Index rank = 0;             ///< r
  Eigen::MatrixXd outputs;           ///< (k + r) x n: b_C and v
  Eigen::MatrixXd inputs;            ///< (k + 2r) x n: b_E, p_G and p_H
};

ModalRows modal_rows(const Pencil& pencil);

/// One eigenvalue.
struct Eigenvalue {
  std::complex<double> s;  ///< 1/s; the imaginary part is a circular frequency
  double residual = 0.0;   ///< relative_residual() of the pair (eigenvector.hpp)

  double growth() const { return s.real(); }  ///< 1/s
  double frequency() const;                   ///< Hz
};

}  // namespace stridor
