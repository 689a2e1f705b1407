// Whether the steps of a run are stable, and where along its path they are not.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "solvers/frozen_step.hpp"

namespace stridor {

enum class StepVerdict {
  stable,          ///< nothing grows from step to step
  bodies_grow,     ///< what grows does so in the bodies themselves: an instability of the sliding
  step_grows,      ///< it grows faster than in the bodies: the step is too large
  no_equilibrium,  ///< there is no state of sliding there
};

/// What the steps do at one place, the sliding held.
struct StepStability {
  StepVerdict verdict = StepVerdict::stable;
  double radius = 0.0;     ///< largest |z| of FrozenStep::factors()
  double growth = 0.0;     ///< ln(radius)/h, 1/s
  double frequency = 0.0;  ///< of that motion, |arg z|/(2πh), Hz
  /// Largest real part of the eigenvalues of the bodies in contact about that frequency, 1/s; not
  /// asked for where the steps are stable, and nothing where there are none.
  std::optional<double> growth_of_bodies;
};

/// Growth from step to step against that of the bodies, exp(h Re s), with the same rows.
///
/// What grows fastest is compared with the eigenvalues at its frequency, or up to π/2 below it, by
/// which the central difference raises frequencies. Rounding makes a radius uncertain by about
/// 1e-10. A tenth of the growth may be the error of the scheme; what is beyond that does not belong
/// to the bodies.
/// @param contacts as FrozenStep::factors()
/// @throws NumericalError as FrozenStep::factors() and dense_eigenvalues()
/// Cost: two dense eigenvalue problems of twice the number of modes.
StepStability step_stability(const FrozenStep& step, const Pencil& contacts);

/// Largest step up to time.step at which nothing grows by itself, s, by bisection to 1e-4; nothing
/// where that is less than a hundredth of time.step.
/// @param system, contacts as step_stability() with FrozenStep of `time`
std::optional<double> stable_step(const System& system, const TimeParameters& time,
                                  const Pencil& contacts);

/// A place on the path of a run.
struct PathStability {
  double drive_displacement = 0.0;  ///< m
  std::vector<double> positions;    ///< of every contact along its undeformed master, m
  StepStability stability;
  Pencil contacts;      ///< rows there
  std::string failure;  ///< why there is no equilibrium
};

/// Stability of the steps at places along the path of a run, in the sliding equilibria there, with
/// friction and load as they are once they no longer rise.
///
/// @param system     with all modes, and at least one contact without a force law
/// @param time       step, integrator, modes kept and end of the run
/// @param num_places ≥ 1, at equal distances of the drive
/// @param on_place   called before each; may throw
std::vector<PathStability> stability_along_path(const System& system, const TimeParameters& time,
                                                int num_places,
                                                const std::function<void(int)>& on_place = {});

}  // namespace stridor
