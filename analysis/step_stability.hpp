// Whether the steps of a run are stable, and where along its path they are not.
#pragma once

#include <algorithm>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "solvers/transient/frozen_step.hpp"

namespace stridor {

enum class StepVerdict {
  stable,          ///< nothing grows from step to step
  bodies_grow,     ///< what grows does so in the bodies themselves: an instability of the sliding
  step_grows,      ///< it grows faster than in the bodies: the step is too large
  no_equilibrium,  ///< there is no state of sliding there
};

/// Growth of its own that a step may have before it is said to grow by itself.
struct GrowthTolerance {
  double share = 0.1;  ///< of the growth of a motion: the error of the scheme
  double least = 0.0;  ///< 1/s
  /// Share of the growth of a motion from which on the bodies, with an eigenvalue close to it, are
  /// taken to grow as well, so that the step only makes their growth faster, which does not count;
  /// 1: it always counts.
  double share_of_bodies = 1.0;
};

/// Stability of the steps at one place of the path, with the sliding held.
struct StepStability {
  StepVerdict verdict = StepVerdict::stable;
  double radius = 0.0;  ///< largest |z| of FrozenStep::factors()
  /// ln|z|/h, 1/s, of the motion that grows most by itself, or, where none does, of the largest
  /// |z|.
  double growth = 0.0;
  double frequency = 0.0;  ///< of that motion, |arg z|/(2πh), Hz
  /// Of the same motion of the bodies in contact, Re s, 1/s; nothing where they have none such, or
  /// where nothing grows from step to step.
  std::optional<double> growth_of_bodies;

  /// Growth by the step alone, beyond that of the bodies, 1/s.
  double own_growth() const { return growth - std::max(0.0, growth_of_bodies.value_or(0.0)); }
};

/// Growth from step to step against that of the bodies, exp(h Re s), with the same rows.
///
/// Every motion that grows from step to step stands for a motion of the bodies: for the s of
///
///   z = exp(s h),   or   z − 2 + 1/z = (s h)²   of the central difference,
///
/// or for the eigenvalue nearest to it, at most 0.2 |s| away. Growing eigenvalues are given first,
/// nearest pairs before others, and each answers for one motion only. Rounding makes a radius
/// uncertain by about 1e-10.
/// @param contacts as FrozenStep::factors()
/// @throws NumericalError as FrozenStep::factors() and dense_eigenvalues()
/// Cost: that of FrozenStep::factors(), and, where something grows, of the eigenvalues up to its
/// frequency.
StepStability step_stability(const FrozenStep& step, const Pencil& contacts,
                             const GrowthTolerance& tolerance = {});

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
  std::string failure;  ///< why there is no equilibrium, with its code
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
