// Periodic motion of bodies in contact, as the steps of a simulation make it: settled, then solved
// for.
#pragma once

#include <complex>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "analysis/cycle_meter.hpp"
#include "analysis/limit_cycle.hpp"
#include "coupling/system/system.hpp"
#include "solvers/integrators/time_parameters.hpp"
#include "solvers/transient/simulation.hpp"

namespace stridor {

/// Reason why the motion of a system cannot repeat itself: a slave point moves along a master of
/// finite length. Nothing where it can.
std::optional<std::string> why_not_periodic(const System& system);

/// A displacement at a contact by which turns and statistics are taken.
struct ObservedMotion {
  int contact = 0;  ///< its slave
  bool is_x = true;
};

/// A motion that has been followed, and the cycle that it has come to.
struct PeriodicMotion {
  CycleStatus status = CycleStatus::diverged;
  std::string failure;  ///< of the simulation; empty unless `diverged`
  Refusal refusal = Refusal::diverged;  ///< its kind
  ObservedMotion observed;
  /// Statistics of the observed displacement, SI: of the cycle, or of the whole turns after
  /// `settle` where none was solved for.
  CycleMeter::Reading seen;
  double period = 0.0;         ///< T, s; 0 where not periodic
  std::int64_t num_steps = 0;  ///< N of a period
  double step = 0.0;           ///< T/N, s
  double residual = 0.0;       ///< what is left of P(z) − z, over the size of the motion
  int newton_steps = 0;
  /// Of the motion around the cycle over one period, largest first, without that along the cycle;
  /// stable where all are below 1. Empty where Newton's method did not converge.
  std::vector<std::complex<double>> multipliers;
  /// Of a cycle, or of a motion that repeats itself without being solved for, which has no
  /// multipliers: the system with drive and friction as they are once they no longer rise, at a
  /// turn of the cycle.
  System at_turn;
};

struct PeriodicMotionOptions {
  double settle = 0.0;  ///< time before a cycle is sought, s
  Eigen::Index most_unknowns =
      1000;  ///< displacements and velocities that Newton's method solves for
};

/// Follows a motion until it repeats itself, and solves for the cycle.
///
/// The settled motion says after how many turns of one displacement it repeats itself (CycleMeter).
/// From there z = (q, q̇) of all bodies at a turn and the period T are found by Newton's method,
///
///   P_T(z) − z = 0,   v(z) = 0,
///
/// with P_T(z) the motion after N steps of T/N, N the period over the step of the scene, v the
/// velocity of the observed displacement, and derivatives by central differences. The eigenvalues
/// of ∂P/∂z are the multipliers. The cycle is that of the discrete motion. Where Newton's method
/// does not converge, as where a start a little aside breaks loose a step earlier, the motion is
/// periodic without multipliers if one period brings it back to 3 % of its size, and irregular
/// otherwise.
///
/// @param system as for Simulation, with its initial state
/// @param time   `end` is not used
/// @throws as Simulation; Interrupted where a stop was requested
PeriodicMotion find_periodic_motion(const System& system, const TimeParameters& time,
                                    const PeriodicMotionOptions& options);

/// The displacement that was observed, m.
double observed_displacement(const PeriodicMotion& cycle, const Simulation& simulation);

/// Calls `visit` at the turn and after each of the N steps of a cycle.
/// @throws NumericalError where a step fails
void follow_cycle(const PeriodicMotion& cycle, const TimeParameters& time,
                  const std::function<void(const Simulation&)>& visit);

}  // namespace stridor
