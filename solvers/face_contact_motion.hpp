// Motion of bodies that rub on the faces of a spinning plate, with lift-off and stick.
#pragma once

#include <string>
#include <vector>

#include "coupling/face_contact.hpp"
#include "solvers/contact_solver.hpp"
#include "solvers/exponential_propagator.hpp"

namespace stridor {

/// Forces of every contact, and how the sliding state about which a system is linear has them.
struct FaceContactLaw {
  double preload = 0.0;         ///< N₀ of each contact, N, >= 0
  double friction = 0.0;        ///< μ, >= 0
  double penalty = 0.0;         ///< k_C, N/m, > 0
  double speed = 0.0;           ///< Ω, rad/s, > 0
  bool friction_turns = false;  ///< against the whole sliding velocity, not its part along φ only
};

/// A contact at one instant.
struct FaceContactState {
  double gap = 0.0;    ///< from where the preload closes it, m; negative where it is pressed
  double force = 0.0;  ///< λ, N, >= 0
  double friction_force = 0.0;  ///< along the sliding direction, on the pad, N
  double across_force = 0.0;    ///< across it, N
  double slip_velocity = 0.0;   ///< of the face against the pad, magnitude, m/s
  ContactState state = ContactState::slip;
};

/// Marches M q̈ + P q̇ + Q q = B ρ, where P and Q hold the contacts as linear about steady sliding
/// and ρ what the contacts do besides (docs/theory.md, 10.6).
///
/// The linear part is propagated exactly (ExponentialPropagator), so that small motion grows as the
/// eigenvalues say at any step. ρ is linear over a step; at its end the laws
///
///   λ = max(0, N₀ − k_C g),   τ = μ λ v/|v|, or |τ| <= μ λ where v = 0
///
/// hold exactly, with v = (Ω r − b q̇, −a q̇ − Ω r c q) the velocity of the face against the pad, b
/// and a the rows of FaceContact along and across, and c that of friction_turning_stiffness(). They
/// are solved by Gauss and Seidel's sweeps over the contacts, as FiLM does. Order 2 in the step
/// where the contacts are not linear. The terms by which the preload's forces turn and shift with
/// the motion keep the preload.
class FaceContactMotion {
 public:
  /// @param system linear about steady sliding, with the contacts as springs of the penalty
  /// @param step   h, s, > 0
  /// @throws std::invalid_argument, NumericalError as ExponentialPropagator
  FaceContactMotion(const LinearSystem& system, std::vector<FaceContact> contacts,
                    const FaceContactLaw& law, double step);

  /// At t = 0, about the sliding state.
  void start(const Eigen::VectorXd& displacement, const Eigen::VectorXd& velocity);
  /// One step. @return whether the contact forces have converged and the motion is finite
  bool step();

  const Eigen::VectorXd& displacement() const { return q_; }
  const Eigen::VectorXd& velocity() const { return v_; }
  int num_contacts() const { return static_cast<int>(contacts_.size()); }
  FaceContactState contact(int index) const;

 private:
  Eigen::VectorXd relative(const Eigen::VectorXd& q, const Eigen::VectorXd& v) const;
  Eigen::VectorXd linear_forces(const Eigen::VectorXd& relative) const;
  bool solve(const Eigen::VectorXd& predicted);

  std::vector<FaceContact> contacts_;
  FaceContactLaw law_;
  ExponentialPropagator propagator_;
  Eigen::MatrixXd gap_rows_;       ///< of gap and velocities on q, 3k x n
  Eigen::MatrixXd velocity_rows_;  ///< on q̇
  Eigen::VectorXd drive_;          ///< what the rotation adds to them
  Eigen::MatrixXd inputs_;         ///< B, n x 3k
  Eigen::MatrixXd linear_;         ///< of the linear forces on gap and velocities, 3k x 3k
  Eigen::VectorXd preload_;        ///< forces of the sliding state
  Eigen::MatrixXd answer_;         ///< (q, q̇) at the end of a step per ρ there, 2n x 3k
  Eigen::MatrixXd compliance_;     ///< gap and velocities per force, linear forces answering
  Eigen::MatrixXd answering_;      ///< (1 + W L)⁻¹
  Eigen::MatrixXd bare_;           ///< W
  Eigen::VectorXd q_, v_, forces_, relative_, remainder_;
};

}  // namespace stridor
