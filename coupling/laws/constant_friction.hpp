// One coefficient of friction, at rest and at any speed.
#pragma once

#include "coupling/laws/friction_law_type.hpp"

namespace stridor {

/// constant_friction() of `coefficient`.
inline FrictionLawType constant_friction_type() {
  return {.name = "constant",
          .doc = "`coefficient`",
          .keys = {{"coefficient",
                    {.doc = "Coulomb friction coefficient of the constant law, at most 100; rises "
                            "with drive.ramp.",
                     .range = Range::non_negative()},
                    true}},
          .make = [](const FrictionNumbers& numbers) {
            return constant_friction(numbers.at("coefficient"));
          }};
}

}  // namespace stridor
