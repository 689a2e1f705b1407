// One coefficient of friction at rest, a smaller one in sliding.
#pragma once

#include "coupling/laws/friction_law_type.hpp"

namespace stridor {

/// μ(v) = μ_d while sliding, μ_s at rest.
inline FrictionLaw static_dynamic_friction(double static_coefficient, double dynamic_coefficient) {
  return {static_coefficient, dynamic_coefficient};
}

inline FrictionLawType static_dynamic_friction_type() {
  return {.name = "static_dynamic",
          .doc = "`static` at rest, `dynamic` in sliding",
          .keys = {static_coefficient_key(), dynamic_coefficient_key()},
          .make =
              [](const FrictionNumbers& numbers) {
                return static_dynamic_friction(numbers.at("static"), numbers.at("dynamic"));
              },
          .check =
              [](const FrictionNumbers& numbers, std::vector<Problem>& problems) {
                if (!numbers.contains("static") || !numbers.contains("dynamic")) return;
                if (numbers.at("static") < numbers.at("dynamic"))
                  problems.push_back(
                      {Refusal::wrong_value, "static", "must not be below `dynamic`"});
              },
          .has_jump = true};
}

}  // namespace stridor
