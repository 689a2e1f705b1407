// Motion of bodies in rigid contact with the faces of a spinning plate.
#pragma once

#include "solvers/exponential_propagator.hpp"
#include "solvers/face_contact_motion.hpp"
#include "solvers/face_contact_solver.hpp"

namespace stridor {

/// Contacts without a penalty (docs/theory.md, 10.9): free motion of the bodies, exact
/// (ExponentialPropagator), between impulses h f_n of the contacts at every t_n,
///
///   (x, ẋ)_{n+1} = e^{Ah} (x_n, ẋ_n⁻ + h M⁻¹ ΔF_n),   ΔF_n = F(x_n) f_n − F(0) f_0
///
/// where f_n is such that no gap is negative at t_{n+1}, and what sticks has not moved until then.
/// Friction that slips is against the velocity at t_n, from the
/// mean ones of the steps around it.
/// What lands does not rebound but as bodies do by themselves. Order 2 in the step while contacts
/// slide, order 1 over impacts.
class RigidContactMotion final : public FaceContactMotion {
 public:
  /// @param bodies without contact, mass symmetric positive definite
  /// @param law    without a penalty, with a speed > 0
  /// @param state  from which motion is counted, and whose forces are balanced
  /// @param step   h, s, > 0
  /// @throws std::invalid_argument with a penalty or without speed; if the step is too long for the
  ///         bodies: contact forces do not close the gaps, about half a period of a mode at the
  ///         contact, or small motion grows in steps as it does not by itself (by a hundredth of
  ///         the lowest frequency); as ExponentialPropagator, linearise() and dense_eigenvalues()
  RigidContactMotion(const LinearSystem& bodies, std::vector<FaceContact> contacts,
                     const FaceContactLaw& law, const FaceSlidingState& state, double step);

  void start(const Eigen::VectorXd& displacement, const Eigen::VectorXd& velocity) override;
  bool step() override;
  const Eigen::VectorXd& displacement() const override { return q_; }
  /// At t_n, between that before the impulse and that after it.
  Eigen::VectorXd velocity() const override;
  int num_contacts() const override { return rows_.num_contacts(); }
  FaceContactState contact(int index) const override;
  void save(State& state, const std::string& prefix) const override;
  void load(const State& state, const std::string& prefix) override;

 private:
  Eigen::MatrixXd linear_step(const FaceSlidingState& state, const Eigen::MatrixXd& after) const;
  void check_growth(const LinearSystem& bodies, const FaceSlidingState& state, double step,
                    const Eigen::MatrixXd& after) const;
  bool solve(double share);
  void bend_compliance(double share);
  Eigen::VectorXd slip_lag() const;
  double largest_force() const;
  Eigen::VectorXd deviation() const;

  std::vector<FaceContact> contacts_;
  FaceContactLaw law_;
  FaceContactRows rows_;
  ExponentialPropagator propagator_;
  FaceContactSolver solver_;
  Eigen::MatrixXd impulse_;         ///< h M⁻¹, n x n
  Eigen::MatrixXd mean_rows_;       ///< of the gap and of mean velocities on x at the end of a step
  Eigen::MatrixXd now_rows_;        ///< of the latter on x at its beginning, 3k x n
  Eigen::MatrixXd answer_;          ///< (x, ẋ) at t_{n+1} per force at t_n, 2n x 3k
  Eigen::MatrixXd seen_;            ///< gap at t_{n+1} and mean velocities until then, 3k x 3k
  Eigen::MatrixXd bending_answer_;  ///< 2n x 7k
  Eigen::MatrixXd bending_seen_;    ///< 3k x 7k
  Eigen::VectorXd preload_answer_;  ///< of the forces of the sliding state, 2n
  Eigen::VectorXd q_, v_;           ///< at t_n, before the impulse
  Eigen::VectorXd forces_;          ///< f_n
  Eigen::VectorXd next_q_, next_v_;  ///< at t_{n+1}
  Eigen::VectorXd ahead_;            ///< gap at t_{n+1} and mean velocities until then, 3k
  Eigen::VectorXd before_;           ///< gap at t_n and mean velocities since t_{n-1}, 3k
  Eigen::VectorXd slip_;             ///< gap at t_{n+1} and velocities at t_n, 3k
  FaceContactAnswer at_end_;
  bool has_converged_ = true;
};

}  // namespace stridor
