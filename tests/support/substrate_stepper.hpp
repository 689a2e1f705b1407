// Fixed steps of a body on a sliding substrate, with the propagators of all bodies.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>

#include "solvers/integrators/make_propagator.hpp"
#include "solvers/transient/substrate_motion.hpp"
#include "solvers/transient/substrate_oscillator.hpp"

namespace stridor {

/// Marches a SubstrateOscillator with a two-step scheme u_{n+1} = u*_{n+1} + W f_n (propagator.hpp;
/// docs/theory.md, 9.4). The contact force at t_n and the motion that it makes are found together,
/// from y_n and the slip of the step to come,
///
///   w_{n+1} = (x_{n+1} − x_n)/h − v_d,   x_{n+1} = x*_{n+1} + W_xx f_x + W_xy f_y:
///
/// sticking, w_{n+1} = 0, where the friction for that is below the static strength; else slip to
/// the side to which it is too large, with the law at the mean (w_n + w_{n+1})/2, by Newton's
/// method in a bracket. (With the mean in place of w_{n+1} for sticking as well, even and odd steps
/// would stick apart from each other.)
class SubstrateStepper {
 public:
  /// @param oscillator must live longer
  /// @param step       h > 0
  /// @throws std::invalid_argument if the step is not positive
  SubstrateStepper(const SubstrateOscillator& oscillator, Integrator integrator, double step);

  void start(const Eigen::Vector2d& displacement, const Eigen::Vector2d& velocity);

  /// Goes from t_n to t_{n+1}. @return false where that fails, see failure()
  bool advance();

  /// Cause and remedy of the failure in the last step; empty if there was none.
  const std::string& failure() const { return failure_; }

  std::int64_t steps() const { return steps_; }
  double time() const { return static_cast<double>(steps_) * step_; }
  /// Of the step made last: u_n and (u_{n+1} − u_{n−1})/(2h), and how the body touched at t_n.
  Eigen::Vector2d displacement() const { return displacement_; }
  Eigen::Vector2d velocity() const { return velocity_; }
  SubstrateMode mode() const { return mode_; }
  double normal_force() const { return normal_; }
  double tangential_force() const { return tangential_; }

  /// Largest stable step of the body by itself; infinite for exact propagation.
  double step_limit() const { return step_limit_; }

 private:
  /// w_{n+1} under forces of the contact.
  void find_forces();
  /// @return false where the body runs away
  bool check_motion();

  const SubstrateOscillator* oscillator_;
  SystemBody body_;
  TimeParameters time_;
  double step_ = 0.0;
  double step_limit_ = 0.0;
  double extra_damping_ = 0.0;  ///< of y beyond that of x, which the propagator has
  std::unique_ptr<Propagator> propagator_;
  std::int64_t steps_ = 0;
  double free_slip_ = 0.0;        ///< w_{n+1} without the contact
  double last_slip_ = 0.0;        ///< w_n
  std::array<double, 2> load_{};  ///< without the contact
  Eigen::Vector2d displacement_ = Eigen::Vector2d::Zero();
  Eigen::Vector2d velocity_ = Eigen::Vector2d::Zero();
  double normal_ = 0.0;
  double tangential_ = 0.0;
  double stiffness_ = 0.0;  ///< of the contact, by y
  std::string failure_;
  SubstrateMode mode_ = SubstrateMode::slip_back;
};

}  // namespace stridor
