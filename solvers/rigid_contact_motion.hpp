// Motion of bodies in rigid contact with the faces of a spinning plate.
#pragma once

#include "solvers/exponential_propagator.hpp"
#include "solvers/face_contact_motion.hpp"
#include "solvers/face_contact_solver.hpp"
#include "solvers/port_rows.hpp"

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
  Eigen::VectorXd displacement() const override;
  /// At t_n, between that before the impulse and that after it.
  Eigen::VectorXd velocity() const override;
  int num_contacts() const override { return ports_.num_contacts(); }
  FaceContactState contact(int index) const override;
  double moved(int contact, FacePort port) const override {
    return ports_.at(contact, port, y_.data());
  }
  void save(State& state, const std::string& prefix) const override;
  void load(const State& state, const std::string& prefix) override;

 private:
  using Compliance = FaceContactAnswer::Compliance;
  /// What contacts see at the end of a step under forces at its beginning.
  class Answer;

  Eigen::MatrixXd linear_step(const FaceSlidingState& state, const Eigen::MatrixXd& after) const;
  void check_growth(const LinearSystem& bodies, const FaceSlidingState& state, double step,
                    const Eigen::MatrixXd& after) const;
  bool solve(double share);
  void point_forces();
  void port_forces(const double* forces, double* ports) const;
  Eigen::VectorXd slip_lag() const;
  Eigen::VectorXd half_impulse() const;

  std::vector<FaceContact> contacts_;
  FaceContactLaw law_;
  FaceContactPorts ports_;
  ExponentialPropagator propagator_;
  FaceContactSolver solver_;
  PortRows rows_;  ///< of the ports on z
  /// Gap and mean velocities on y at the end of a step, the latter on y at its beginning.
  std::vector<FaceContactPorts::LocalRows> mean_, now_;
  Eigen::VectorXd preload_ports_;  ///< forces of the sliding state
  PaddedMatrix port_answer_;       ///< y at t_{n+1} per force on the ports at t_n
  GroupDiagonal z_answer_, v_answer_;  ///< (z, ż) at t_{n+1} per force on z at t_n
  GroupDiagonal impulse_;              ///< h M⁻¹ of z
  Compliance compliance_;              ///< of gap and mean velocities, 3k x 3k

  Eigen::VectorXd z_, v_;            ///< at t_n, before the impulse
  Eigen::VectorXd y_;                ///< ports at t_n
  Eigen::VectorXd forces_;           ///< f_n
  Eigen::VectorXd next_z_, next_v_;  ///< at t_{n+1}
  Eigen::VectorXd next_y_;
  Eigen::VectorXd ahead_;   ///< gap at t_{n+1} and mean velocities until then, 3k
  Eigen::VectorXd before_;  ///< gap at t_n and mean velocities since t_{n-1}, 3k
  Eigen::VectorXd slip_;    ///< gap at t_{n+1} and velocities at t_n, 3k
  /// Unit forces in the directions that contacts have at t_n.
  std::vector<FaceContactPorts::LocalColumns> directions_;
  Eigen::VectorXd port_force_, modal_force_;
  bool has_converged_ = true;
};

}  // namespace stridor
