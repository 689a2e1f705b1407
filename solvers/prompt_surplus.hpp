// What keeps the contacts stable whose bodies answer at once.
#pragma once

#include <optional>

#include "coupling/system.hpp"
#include "solvers/time_parameters.hpp"

namespace stridor {

/// How much more than the scheme says the bodies answer at once: the least δ with which the
/// contacts of a system are stable (docs/theory.md, 3.5), 4 P − W positive definite, with a margin,
/// at every node of the master that the slave passes until time.end, where P is the flexibility
/// with which the bodies answer at once and W that of the next step.
/// @param system with the modes that time.retain keeps
/// @return nothing where bodies do not answer at once: the central difference with all modes
std::optional<double> prompt_surplus(const System& system, const TimeParameters& time);

}  // namespace stridor
