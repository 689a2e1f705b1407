// Added feedthrough that keeps contacts of bodies with direct feedthrough stable.
#pragma once

#include <optional>

#include "coupling/system/system.hpp"
#include "solvers/integrators/time_parameters.hpp"

namespace stridor {

/// Added feedthrough beyond that of the scheme: the least δ with which the contacts of a system are
/// stable (docs/theory.md, 3.5), 4 P − W positive definite, with a margin, at every node of the
/// master that the slave passes until time.end. P is the instantaneous flexibility of the bodies
/// and W that of the next step. The compliance of contacts that are springs on faces is part of P.
/// @return nothing without direct feedthrough: the central difference with all modes
std::optional<double> added_feedthrough(const System& system, const TimeParameters& time);

/// Whether every contact is a spring on a face and bodies answer at once: of these P needs to hold the
/// normals alone, as tangents that stick are sought at t_{n+1} (docs/theory.md, 10.6).
bool has_springs_on_faces(const System& system, const TimeParameters& time);

}  // namespace stridor
