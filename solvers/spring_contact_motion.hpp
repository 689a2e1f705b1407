// Motion of bodies on the faces of a spinning plate with springs between them.
#pragma once

#include "solvers/exponential_propagator.hpp"
#include "solvers/face_contact_motion.hpp"
#include "solvers/face_contact_solver.hpp"
#include "solvers/port_rows.hpp"

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
  Eigen::VectorXd displacement() const override;
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
  /// What contacts see at the end of a step under forces there.
  class Answer;

  void set_turns(const double* y, double* turns) const;
  void add_bending(const double* forces, const double* turns, double* ports) const;
  double gap_bending(int contact, const double* y, const double* turns) const;
  void add_inputs(const Eigen::VectorXd& forces, const Eigen::VectorXd& relative,
                  double* ports) const;
  void set_relative(const Eigen::VectorXd& y, const Eigen::VectorXd& rates,
                    Eigen::VectorXd& relative) const;

  std::vector<FaceContact> contacts_;
  FaceContactLaw law_;
  FaceContactPorts ports_;
  ExponentialPropagator propagator_;
  FaceContactSolver solver_;
  PortRows rows_;  ///< of the ports on z
  /// L, of the linear forces on gap and velocities, 3 x 3 of every contact.
  std::vector<Eigen::Matrix3d> linear_;
  /// A over B of every contact on its ports: by how much its unit forces turn.
  std::vector<PaddedMatrix> bending_;
  Compliance compliance_;        ///< (1 + W L)⁻¹ W, 3k x 3k
  PaddedMatrix answering_;       ///< (1 + W L)⁻¹
  PaddedMatrix force_answer_;    ///< (1 + W L)⁻¹ W
  PaddedMatrix bending_answer_;  ///< the same of forces on the ports, 3k x ports
  PaddedMatrix port_answer_;     ///< y at the end of a step per force on the ports there
  /// (z, ż) at the end of a step per force on the ports that falls to none by then.
  PaddedMatrix z_before_, v_before_;
  PaddedMatrix z_after_, v_after_;  ///< per force on the ports that grows from none

  Eigen::VectorXd z_, v_, next_z_, next_v_;
  Eigen::VectorXd y_;       ///< ports
  Eigen::VectorXd forces_;  ///< 3k
  /// Ports and forces one step before: what they change goes on in the first guess of the next.
  Eigen::VectorXd last_y_, last_forces_;
  Eigen::VectorXd seen_;        ///< gap and velocities, 3k
  Eigen::VectorXd port_force_;  ///< ρ: what acts on the ports besides the linear part

  /// Of a step: at its end without forces there, and as last seen by the contacts.
  struct Scratch {
    Eigen::VectorXd free_y, free_rates, free;
    Eigen::VectorXd guess, change, relative, bending, last_bending, port_force, y;
    Eigen::VectorXd turns;  ///< 16 numbers of every contact, set_turns()
    Eigen::VectorXd gap_bending;
  };
  Scratch scratch_;
};

}  // namespace stridor
