// How a step of a simulation ends, and the message where it is not well.
#pragma once

#include <string>

#include "core/refusals.hpp"

namespace stridor {

struct RunningFace;
struct RunningLine;
struct StepClock;

/// Outcome of a step. Anything but `done` ends the run: bodies and channels are at the time of the
/// failure, contact forces may be those of the step before.
enum class StepOutcome {
  done,
  master_lost,       ///< a slave point has left the end of its master surface
  pulling,           ///< λ < 0 at an armed contact: the assumption of persistent sliding is lost
  sliding_reversed,  ///< an armed contact slides against the drive: likewise
  jammed,            ///< b_C W b_Eᵀ of a contact is not positive: no contact force closes its gap
  not_converged,     ///< the forces of several contacts have not settled
  diverged,          ///< a contact force is not finite or beyond any use
  sunk,  ///< a slave point is deeper in its substrate than its radius, or has gone through a plate
  overshot,  ///< a substrate is so stiff for the step that indentations grow with each
};

/// The kind of a failure.
Refusal refusal_of(StepOutcome outcome);

/// Why a step has not ended with `done`.
struct StepFailure {
  std::string text;  ///< place, time, size and remedy
  Refusal refusal = Refusal::diverged;
};

/// The failure of a step at t_n by one of its contacts.
StepFailure failure_of(const RunningLine& contact, StepOutcome outcome, const StepClock& clock);
StepFailure failure_of(const RunningFace& face, StepOutcome outcome, const StepClock& clock);
/// The divergence of a body that no contact has shown.
/// @param size sum of the squares of its displacements and velocities
StepFailure divergence_of(const std::string& body, double size, const StepClock& clock);

}  // namespace stridor
