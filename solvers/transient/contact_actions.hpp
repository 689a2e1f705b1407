// Actions of contacts on their bodies in a step, for the energy ledger and pictures.
#pragma once

#include "solvers/contact/face_contacts.hpp"
#include "solvers/contact/line_contacts.hpp"
#include "solvers/transient/energy_ledger.hpp"

namespace stridor {

/// Action of a contact with the forces that were found last.
ContactAction action_of(const RunningLine& contact);
/// @param clock at the end of the step in which it acts
ContactAction action_of(const RunningFace& face, const StepClock& clock);

}  // namespace stridor
