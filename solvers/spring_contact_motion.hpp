// Motion of bodies on the faces of a spinning plate with springs between them.
#pragma once

#include "solvers/exponential_propagator.hpp"
#include "solvers/face_contact_motion.hpp"
#include "solvers/face_contact_solver.hpp"

namespace stridor {

/// Contacts with a penalty: M ẍ + P ẋ + Q x = ρ, where P and Q hold the contacts as linear about
/// the sliding state and ρ what they do besides (docs/theory.md, 10.6).
///
/// The linear part is propagated exactly (ExponentialPropagator), so that small motion grows as the
/// eigenvalues say at any step. ρ is linear over a step; at its end the laws hold exactly, with the
/// gap and velocity then. Order 2 in the step where the contacts are not linear.
class SpringContactMotion final : public FaceContactMotion {
 public:
  /// @param bodies without contact
  /// @param law    with a penalty, and a speed > 0
  /// @param state  about which motion is linear
  /// @param step   h, s, > 0
  /// @throws std::invalid_argument without a penalty or speed, or if the step is too long for the
  /// stiffness of the contacts, about half a period of a mass on one of them; as
  /// ExponentialPropagator
  SpringContactMotion(const LinearSystem& bodies, std::vector<FaceContact> contacts,
                      const FaceContactLaw& law, const FaceSlidingState& state, double step);

  void start(const Eigen::VectorXd& displacement, const Eigen::VectorXd& velocity) override;
  bool step() override;
  const Eigen::VectorXd& displacement() const override { return q_; }
  Eigen::VectorXd velocity() const override { return v_; }
  int num_contacts() const override { return rows_.num_contacts(); }
  FaceContactState contact(int index) const override;
  void save(State& state, const std::string& prefix) const override;
  void load(const State& state, const std::string& prefix) override;

 private:
  Eigen::VectorXd relative(const Eigen::VectorXd& q, const Eigen::VectorXd& v) const;
  Eigen::VectorXd linear_forces(const Eigen::VectorXd& relative) const;
  bool solve(const Eigen::VectorXd& predicted);
  void bend(const Eigen::VectorXd& displacement);

  std::vector<FaceContact> contacts_;
  FaceContactLaw law_;
  FaceContactRows rows_;
  ExponentialPropagator propagator_;
  FaceContactSolver solver_;
  Eigen::MatrixXd linear_;          ///< of the linear forces on gap and velocities, 3k x 3k
  Eigen::MatrixXd answer_;          ///< (x, ẋ) at the end of a step per force there, 2n x 3k
  FaceContactAnswer at_end_;        ///< linear forces answering
  Eigen::MatrixXd answering_;       ///< (1 + W L)⁻¹
  Eigen::MatrixXd bare_;            ///< W
  Eigen::MatrixXd bending_answer_;  ///< 2n x 7k
  Eigen::MatrixXd bending_bare_;    ///< 3k x 7k
  Eigen::VectorXd q_, v_, forces_, relative_, remainder_;
  Eigen::VectorXd bending_;      ///< what acts on the bending inputs besides the linear part, 7k
  Eigen::VectorXd gap_bending_;  ///< ½ xᵀ A x of every contact, m
};

}  // namespace stridor
