#include "app/stability/sliding_state.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "core/errors.hpp"
#include "solvers/eigenvalues/residual_modes.hpp"
#include "solvers/integrators/retained_modes.hpp"

namespace stridor {

SlidingState sliding_state_of(const SceneFamily::Member& member, ContactGeometry geometry,
                              const KeptTerms& terms, const std::string& what) {
  const System& system = member.model->system;
  const std::string where = what.empty() ? "" : " at " + what;
  SlidingState state;
  state.leading_drive = system.leading_drive();
  try {
    EquilibriumState asked = stridor::sliding_state(system, member.drive_displacement, geometry);
    asked.terms = contact_terms(terms);
    state.equilibrium = geometry == ContactGeometry::deformed && member.position
                            ? find_equilibrium_at(system, 0, *member.position, asked)
                            : find_equilibrium(system, asked);
  } catch (const NumericalError& error) {
    throw NumericalError(Refusal::no_equilibrium,
                         fmt::format("no sliding equilibrium{}: {}", where, error.what()));
  }
  if (state.equilibrium.status != EquilibriumStatus::converged) {
    throw NumericalError(Refusal::no_equilibrium, fmt::format("no sliding equilibrium{}: {}", where,
                                                              state.equilibrium.failure));
  }
  const auto& contacts = state.equilibrium.contacts;
  if (!contacts.empty() &&
      std::none_of(contacts.begin(), contacts.end(),
                   [](const ContactEquilibrium& contact) { return contact.is_closed; })) {
    throw NumericalError(Refusal::no_equilibrium,
                         fmt::format("every contact is open in equilibrium{}", where));
  }
  state.pencil = linearise(system, state.equilibrium, contact_terms(terms));
  if (!terms.structural_damping) drop_structural_damping(state.pencil);
  if (!terms.friction_damping) drop_contact_damping(state.pencil);
  state.is_on_the_way = member.is_on_the_way;
  return state;
}

Pencil retained(const Pencil& pencil, const System& system,
                const std::optional<TimeParameters>& time) {
  if (!time || !time->retain) return pencil;
  return with_residual_modes(pencil, asked_frequency(system, time));
}

double asked_frequency(const System& system, const std::optional<TimeParameters>& time) {
  return time ? asked_frequency(system, *time) : std::numeric_limits<double>::infinity();
}

}  // namespace stridor
