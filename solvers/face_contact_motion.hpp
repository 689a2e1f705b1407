// Motion of bodies that rub on the faces of a spinning plate, with lift-off and stick.
#pragma once

#include <string>
#include <vector>

#include "core/state.hpp"
#include "coupling/face_contact.hpp"
#include "solvers/contact_solver.hpp"
#include "solvers/exponential_propagator.hpp"

namespace stridor {

/// A contact at one instant.
struct FaceContactState {
  double gap = 0.0;             ///< m; negative where it is pressed
  double force = 0.0;           ///< λ, N, >= 0
  double friction_force = 0.0;  ///< along the sliding direction, on the pad, N
  double across_force = 0.0;    ///< across it, N
  double slip_velocity = 0.0;   ///< of the face against the pad, magnitude, m/s
  ContactState state = ContactState::slip;
};

/// Marches M ẍ + P ẋ + Q x = ρ about a sliding state, x = q − q₀, where P and Q hold the contacts
/// as linear about it and ρ what the contacts do besides (docs/theory.md, 10.6).
///
/// The linear part is propagated exactly (ExponentialPropagator), so that small motion grows as the
/// eigenvalues say at any step. ρ is linear over a step; at its end the laws
///
///   λ = max(0, −k_C g),   τ = μ λ v/|v|, or |τ| <= μ λ where v = 0
///
/// hold exactly, with the gap g of FaceContact and v = (Ω r − b q̇, −a q̇ − Ω r c q) the velocity of
/// the face against the pad. They act along n + A q, b + B q and a, each with its force of that
/// instant. They are solved by Gauss and Seidel's sweeps over the contacts, as FiLM does, or by
/// Newton's method where those do not converge, and what bends by repeating that. Order 2 in the
/// step where the contacts are not linear.
class FaceContactMotion {
 public:
  /// @param bodies without contact
  /// @param law    with a penalty, and a speed > 0
  /// @param state  about which motion is linear
  /// @param step   h, s, > 0
  /// @throws std::invalid_argument without a penalty or speed, or if the step is too long for the
  /// stiffness of the contacts, about half a period of a mass on one of them; as
  /// ExponentialPropagator
  FaceContactMotion(const LinearSystem& bodies, std::vector<FaceContact> contacts,
                    const FaceContactLaw& law, const FaceSlidingState& state, double step);

  /// At t = 0, from the sliding state.
  void start(const Eigen::VectorXd& displacement, const Eigen::VectorXd& velocity);
  /// One step. @return whether the contact forces have converged and the motion is finite
  bool step();

  /// x, from the sliding state.
  const Eigen::VectorXd& displacement() const { return q_; }
  const Eigen::VectorXd& velocity() const { return v_; }
  int num_contacts() const { return static_cast<int>(contacts_.size()); }
  FaceContactState contact(int index) const;

  void save(State& state, const std::string& prefix) const;
  /// @throws std::invalid_argument if the state is of another system
  void load(const State& state, const std::string& prefix);

 private:
  Eigen::VectorXd relative(const Eigen::VectorXd& q, const Eigen::VectorXd& v) const;
  Eigen::VectorXd linear_forces(const Eigen::VectorXd& relative) const;
  bool solve(const Eigen::VectorXd& predicted);
  bool sweep();
  bool search();
  Eigen::VectorXd deviation(const Eigen::VectorXd& forces, Eigen::MatrixXd* slope) const;
  double softness(Eigen::Index row) const;
  double gap_at_rest(Eigen::Index row) const;
  void bend(const Eigen::VectorXd& displacement);

  std::vector<FaceContact> contacts_;
  FaceContactLaw law_;
  FaceSlidingState sliding_;
  ExponentialPropagator propagator_;
  Eigen::MatrixXd gap_rows_;        ///< of gap and velocities on x, 3k x n
  Eigen::MatrixXd velocity_rows_;   ///< on ẋ
  Eigen::VectorXd drive_;           ///< velocities of the sliding state
  Eigen::MatrixXd inputs_;          ///< n + A q₀, b + B q₀ and a of every contact, n x 3k
  Eigen::MatrixXd linear_;          ///< of the linear forces on gap and velocities, 3k x 3k
  Eigen::VectorXd preload_;         ///< forces of the sliding state
  Eigen::MatrixXd answer_;          ///< (x, ẋ) at the end of a step per force there, 2n x 3k
  Eigen::MatrixXd compliance_;      ///< gap and velocities per force, linear forces answering
  Eigen::MatrixXd answering_;       ///< (1 + W L)⁻¹
  Eigen::MatrixXd bare_;            ///< W
  Eigen::MatrixXd bending_inputs_;  ///< n x 7k; none without bending
  Eigen::MatrixXd normal_bending_, friction_bending_;  ///< K_A, K_B, 7k x n
  Eigen::MatrixXd bending_answer_, bending_bare_;      ///< 2n x 7k, 3k x 7k
  Eigen::VectorXd q_, v_, forces_, relative_, remainder_;
  Eigen::VectorXd free_;         ///< gap and velocities at the end of a step without forces
  Eigen::VectorXd bending_;      ///< what acts on bending_inputs_ besides the linear part, 7k
  Eigen::VectorXd gap_bending_;  ///< ½ xᵀ A x of every contact, m
};

}  // namespace stridor
