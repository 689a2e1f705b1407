// One step of a body whose modes are coupled, as matrices.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>

#include "substructures/reduction/modal_body.hpp"

namespace stridor {

/// One step of r̈ + V ṙ + Q r = p, x = (r, v) (docs/theory.md, 3.8):
///
///   x_{n+1} = e^{Ah} (x_n + J f_n + (0, h K⁻¹ p)),   q_n = r_n + G f_n
///
/// J and G are those of the modes by themselves (exact_propagation()) where nothing is coupled.
/// Gyroscopic terms enter both such that, without damping, the step under the forces of frictionless
/// contacts keeps the symplectic form of the body. The response to a constant force is the static
/// one, whatever is coupled.
struct CoupledStep {
  /// Largest |s| h of the free motions of a body, with its damping and without: beyond it, impulses
  /// once a step no longer represent forces.
  static constexpr double largest_turn = 2.0;
  /// Largest δ that is taken: no motion without damping that turns by largest_turn or less needs
  /// more, and with more the impulse of the fastest would change its sign, 1 − δ (|s| h)² < 0.
  static constexpr double largest_added = 1.0 / (largest_turn * largest_turn);

  Eigen::MatrixXd feedthrough;       ///< G: instantaneous displacement per modal force
  Eigen::MatrixXd position;     ///< Q
  Eigen::MatrixXd free;         ///< e^{Ah}
  Eigen::MatrixXd by_constant;  ///< r_{n+1} per force that is constant from t_n on
  Eigen::MatrixXd by_impulse;   ///< x_{n+1} per load: e^{Ah} (0, h K⁻¹)
  Eigen::MatrixXd by_force;     ///< x_{n+1} per force: e^{Ah} J; by_impulse where G = 0

  /// Share of r_n due to a force that changes its sign with every step, per force and with the
  /// opposite sign: (1 + e^{Ah})⁻¹ e^{Ah} J. Contacts are stable at z = −1 where G exceeds it.
  Eigen::MatrixXd alternating() const;
};

/// @param body    with gyroscopic, circulatory or non-proportional damping terms
/// @param step    h, s
/// @param added δ of exact_propagation(), of which at most largest_added is taken; absent: the
///                body has no direct feedthrough, G = 0
/// @param alpha   α, 1/s
/// @param name    of the body, for messages
/// @throws ConfigError (time.step) if a free motion, or one of the body without its damping and
///         circulatory terms, turns by more than largest_turn in a step
/// Cost: of order 20 (4n)³ operations.
CoupledStep make_coupled_step(const ModalBody& body, double step, std::optional<double> added,
                              double alpha, const std::string& name);

}  // namespace stridor
