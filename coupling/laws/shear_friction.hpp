// Friction in proportion to the area of a contact.
#pragma once

#include "coupling/laws/friction_law_type.hpp"

namespace stridor {

/// τ_0 A, whatever the normal force. @param strength τ_0, Pa
inline FrictionLaw shear_friction(double strength) {
  FrictionLaw law;
  law.shear_strength = strength;
  return law;
}

inline FrictionLawType shear_friction_type() {
  return {
      .name = "shear",
      .doc = "`strength` times the area of a viscoelastic contact",
      .keys = {{"strength",
                {.doc = "τ_0 of the shear law: friction of the interface per area of contact.",
                 .unit = "Pa",
                 .range = Range::non_negative()}}},
      .make = [](const FrictionNumbers& numbers) { return shear_friction(numbers.at("strength")); },
      .needs_area = true};
}

}  // namespace stridor
