// Periodic motion of a body on a sliding substrate: settled, then solved for.
#pragma once

#include <complex>
#include <optional>
#include <string>
#include <vector>

#include "solvers/transient/substrate_motion.hpp"

namespace stridor {

struct CycleOptions {
  double settle = 2000.0;    ///< time before a cycle is sought
  double tolerance = 1e-12;  ///< of the integrator
  int most_loops = 12;       ///< turns per period
};

enum class CycleStatus {
  periodic,   ///< found
  at_rest,    ///< the motion has died down to the equilibrium
  irregular,  ///< it does not repeat itself; the statistics are over the last tenth of the time
  diverged,   ///< grew without bound, or the integrator failed: all numbers are NaN
  sticking,   ///< it moves with the substrate for longer than is looked for a turn
  settling,   ///< its turns still shrink or grow, each one of them: more time is needed
};
std::string cycle_status_text(CycleStatus status);

/// A displacement at the turn where it is largest; ẋ = 0 there.
struct TurningPoint {
  double x = 0.0;
  double y = 0.0;
  double vertical_velocity = 0.0;
};

struct LimitCycle {
  CycleStatus status = CycleStatus::diverged;
  /// Cause and remedy of the failure; empty unless `diverged`.
  std::string failure;
  double failure_time = 0.0;  ///< when, in units of the oscillator
  double period = 0.0;        ///< 0 where not periodic
  int loops = 0;              ///< turns per period
  double x_min = 0.0;
  double x_max = 0.0;
  double x_mean = 0.0;
  double x_rms = 0.0;  ///< about the mean
  double y_max = 0.0;
  double stick_fraction = 0.0;  ///< of the time
  double free_fraction = 0.0;
  TurningPoint point;     ///< on the cycle
  double residual = 0.0;  ///< remainder of P(z) − z, over the size of the motion
  int newton_steps = 0;
  /// Of the return map of (x, y, ẏ) at turns, largest first; stable where all are below 1.
  std::vector<std::complex<double>> multipliers;
  /// Initial state of a motion that continues from here.
  Eigen::Vector2d last_displacement = Eigen::Vector2d::Zero();
  Eigen::Vector2d last_velocity = Eigen::Vector2d::Zero();
};

/// Lets a motion settle from a state and finds the cycle that it has come to.
///
/// The turns of the settled motion say after how many of them it repeats itself, to 1e-3 of its
/// size; the fixed point of the return map z = (x, y, ẏ) → P(z) at turns is then found by Newton's
/// method with its Jacobian by central differences, whose eigenvalues are the multipliers.
LimitCycle find_limit_cycle(const SubstrateOscillator& oscillator,
                            const Eigen::Vector2d& displacement, const Eigen::Vector2d& velocity,
                            const CycleOptions& options = {});

}  // namespace stridor
