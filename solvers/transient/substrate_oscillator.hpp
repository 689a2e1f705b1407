// A body of two degrees of freedom on a sliding viscoelastic substrate: rest and small motion.
#pragma once

#include <Eigen/Core>
#include <array>
#include <complex>

#include "coupling/laws/substrate_contact.hpp"
#include "solvers/eigenvalues/pencil.hpp"

namespace stridor {

/// A lumped body with displacements x along and y into a substrate that moves along x:
///
///   ẍ + C ẋ + K x = p + f(y, ẋ − v_d)
///
/// with unit masses and the forces f = (tangential, −normal) of a contact (docs/theory.md, 9.1).
struct SubstrateOscillator {
  Eigen::Matrix2d damping = Eigen::Matrix2d::Zero();    ///< C
  Eigen::Matrix2d stiffness = Eigen::Matrix2d::Zero();  ///< K, symmetric, positive definite
  Eigen::Vector2d load = Eigen::Vector2d::Zero();       ///< p
  double substrate_speed = 0.0;                         ///< v_d > 0
  SubstrateContact contact;
};

/// A state of steady sliding.
struct SubstrateEquilibrium {
  Eigen::Vector2d displacement = Eigen::Vector2d::Zero();
  SubstrateForces forces;
  bool converged = false;
  int evaluations = 0;  ///< of the law
};

/// Unbalanced force where x is at rest for a given y: increasing in y where the equilibrium is the
/// only one.
///
///   g(y) = k_yy y + k_xy x(y) − p_y + F_k(y),   k_xx x(y) = p_x + F_µ(y) − k_xy y
double imbalance(const SubstrateOscillator& oscillator, double indentation);

/// Steady sliding: Newton's method for g(y) = 0 within a bracket that is halved where a step leaves
/// it.
///
/// @param guess an indentation to begin with, > 0; any value is allowed
/// @return not converged where the body is not pressed against the substrate, or numbers overflow
SubstrateEquilibrium find_equilibrium(const SubstrateOscillator& oscillator, double guess = 1.0);

/// ü + C u̇ + K u = 0 about a state of sliding; K is not symmetric, nor is C.
struct SmallMotion {
  Eigen::Matrix2d damping;
  Eigen::Matrix2d stiffness;
};

/// Which terms of the small motion are kept.
enum class SmallMotionTerms {
  all,
  without_damping,  ///< C = 0: the case of PPH (24) to (28)
};

SmallMotion small_motion(const SubstrateOscillator& oscillator,
                         const SubstrateEquilibrium& equilibrium,
                         SmallMotionTerms terms = SmallMotionTerms::all);

/// The same motion for the eigenvalue solvers: the modes of the body without contact, and the
/// contact and the dampers as G and H on the ports x and y.
Pencil make_pencil(const SubstrateOscillator& oscillator, const SmallMotion& motion);

/// Its four eigenvalues in closed form: two quadratic factors of the characteristic polynomial by
/// the resolvent cubic, each root corrected by Newton's method. No allocation.
std::array<std::complex<double>, 4> eigenvalues(const SmallMotion& motion);

/// That with the largest real part, and of two conjugate ones that with Im s >= 0.
std::complex<double> leading_eigenvalue(const SmallMotion& motion);

/// D = 4 k_xy k_yx + (k_xx − k_yy)², PPH (26): without damping, flutter where it is negative.
double flutter_discriminant(const SmallMotion& motion);

/// Margin that is positive where the motion grows and changes its sign where stability does: the
/// largest growth; without damping, where nothing decays, −D or −4 det K, whichever is larger.
double stability_margin(const SmallMotion& motion);

}  // namespace stridor
