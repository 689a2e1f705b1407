// Why a mode of a sliding system grows or decays.
#pragma once

#include <vector>

#include "solvers/eigenvalues/eigenvector.hpp"
#include "solvers/eigenvalues/pencil.hpp"
#include "substructures/matrices/sparse_system.hpp"

namespace stridor {

/// Quotients of one mode with the matrices (docs/theory.md, 7.5; HS (30), (34)).
///
/// The contact forces are eliminated from the equations of motion, which leaves
///
///   q̈ + P C̃ q̇ + P K̃ q = 0,   P = 1 − SᵀB_Eᵀ (B_C S SᵀB_Eᵀ)⁻¹ B_C S,
///   C̃ = diag(c) + SᵀHS,  K̃ = diag(ω²) + SᵀGS
///
/// on the motions that fit B_C: unit mass, and matrices with symmetric and skew parts. For a unit
/// vector q
///
///   q̄ᵀP C̃ q = d + j g,   q̄ᵀP K̃ q = k + j n,   s² + (d + j g) s + k + j n = 0 .
///
/// d > 0 and k d² + n d g − n² > 0 make both roots of that equation stable; an eigenvalue is one of
/// them, so the condition is sufficient for it, not necessary.
struct ModeQuotients {
  double damping = 0.0;      ///< d, 1/s
  double gyroscopic = 0.0;   ///< g, 1/s
  double stiffness = 0.0;    ///< k, 1/s²
  double circulatory = 0.0;  ///< n, 1/s²
  double residual = 0.0;     ///< |s² + (d + j g) s + k + j n|/|s|²

  /// k d² + n d g − n², 1/s⁴.
  double margin() const {
    return stiffness * damping * damping + circulatory * damping * gyroscopic -
           circulatory * circulatory;
  }
};

ModeQuotients mode_quotients(const Pencil& pencil, std::complex<double> s,
                             const Eigen::VectorXcd& right);
/// The same without constraints, for matrices and q with qᴴ M q = 1:
///
///   qᴴ P q = d + j g,   qᴴ Q q = k + j n
ModeQuotients mode_quotients(const SparseSystem& system, std::complex<double> s,
                             const Eigen::VectorXcd& right);

/// Sources and sinks of the energy of a mode, averaged over a period.
///
///   2 Re s E = P_contact − P_damping,   E = (|s|² + q̄ᵀ (diag(ω²) + SᵀNS) q)/4  for |q| = 1
///
/// with the stiffness N of contacts that give way along their normals. P_contact is the work of the
/// other contact forces, of the normal force and of friction, per time; without friction on the
/// undeformed geometry it vanishes.
struct ModeEnergy {
  double from_contact = 0.0;  ///< P_contact/2E, part of the growth rate, 1/s
  double by_damping = 0.0;    ///< −P_damping/2E, likewise; negative where damping takes energy
  double by_coupled = 0.0;    ///< likewise of the gyroscopic, circulatory and damping terms
  double residual = 0.0;      ///< |from_contact + by_damping + by_coupled − Re s|/|s|

  /// Share of the energy that enters or leaves in one period.
  static double per_cycle(double rate, double frequency) { return 2.0 * rate / frequency; }
};

ModeEnergy mode_energy(const Pencil& pencil, std::complex<double> s, const Eigenvector& vector);

/// The same system without friction and damping, and with constant forces of the contacts that do
/// not give way: B_E = B_C, G the stiffness of the others along their normals, no H. Its modes are
/// real and orthonormal.
Pencil frictionless(const Pencil& pencil);

/// A mode of the frictionless system and its share of a vibration.
struct Participation {
  double frequency = 0.0;  ///< Hz
  double share = 0.0;      ///< |φᵀq|², 0 to 1 for |q| = 1; all modes together give 1
};

/// The modes of the frictionless system that a vibration is made of, those of the largest shares
/// first.
/// @param eigenvalues of frictionless(pencil), with positive imaginary part
std::vector<Participation> participations(const Pencil& pencil,
                                          const std::vector<Eigenvalue>& eigenvalues,
                                          const Eigen::VectorXcd& right);

/// The same for the modes φ of the symmetric part of a sparse system, |φᵀ M q|².
/// @param omega  of the modes, rad/s
/// @param modes  mass-normalised, one per column
/// @param right  q with qᴴ M q = 1
std::vector<Participation> participations(const SparseSystem& system, const Eigen::VectorXd& omega,
                                          const Eigen::MatrixXd& modes,
                                          const Eigen::VectorXcd& right);

}  // namespace stridor
