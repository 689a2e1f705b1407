// The sliding equilibrium of a scene and the small motion about it.
#pragma once

#include <optional>
#include <string>

#include "io/scene/scene_family.hpp"
#include "solvers/equilibrium/linearise.hpp"

namespace stridor {

/// A sliding equilibrium and the small motion about it.
struct SlidingState {
  Equilibrium equilibrium;
  Pencil pencil;
  bool is_on_the_way = false;  ///< the drive puts the scene there, by `equilibrium.state`
  Drive leading_drive{};       ///< of the system
};

/// The state of a member of a family, with what the scene keeps of its terms. In the deformed
/// geometry the contact is at the position on the deformed master that the member specifies; the
/// drive is displaced accordingly.
/// @param what names the member in messages, e.g. "contact.start = 0.05"; empty where there is one
/// @throws NumericalError if there is no equilibrium, or every contact is open
SlidingState sliding_state_of(const SceneFamily::Member& member, ContactGeometry geometry,
                              const KeptTerms& terms, const std::string& what);

/// The pencil with the modes above `time.retain` as residual modes (docs/theory.md, 7.1); all modes
/// where the scene keeps all.
Pencil retained(const Pencil& pencil, const System& system,
                const std::optional<TimeParameters>& time);

/// asked_frequency() of a scene; infinite where it has no `time`.
double asked_frequency(const System& system, const std::optional<TimeParameters>& time);

}  // namespace stridor
