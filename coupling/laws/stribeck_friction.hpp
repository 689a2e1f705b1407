// Friction that falls, or rises, with the speed of sliding.
#pragma once

#include <cmath>
#include <memory>

#include "coupling/laws/friction_law_type.hpp"

namespace stridor {

/// μ(v) = μ_d + (μ_s − μ_d) exp(−|v|/v_d).
class StribeckFriction : public SlidingFriction {
 public:
  StribeckFriction(double static_coefficient, double dynamic_coefficient, double decay_velocity)
      : dynamic_(dynamic_coefficient),
        fall_(static_coefficient - dynamic_coefficient),
        decay_(decay_velocity) {}
  double coefficient(double speed) const override {
    return dynamic_ + fall_ * std::exp(-speed / decay_);
  }
  double slope(double speed) const override { return -fall_ / decay_ * std::exp(-speed / decay_); }

 private:
  double dynamic_;
  double fall_;
  double decay_;
};

/// @param decay_velocity v_d > 0, m/s
inline FrictionLaw stribeck_friction(double static_coefficient, double dynamic_coefficient,
                                     double decay_velocity) {
  return {
      static_coefficient, dynamic_coefficient,
      std::make_shared<StribeckFriction>(static_coefficient, dynamic_coefficient, decay_velocity)};
}

inline FrictionLawType stribeck_friction_type() {
  return {.name = "stribeck",
          .doc = "from `static` to `dynamic` as exp(-|v|/decay_velocity)",
          .keys = {static_coefficient_key(),
                   dynamic_coefficient_key(),
                   {"decay_velocity",
                    {.doc = "Sliding velocity over which the Stribeck law falls by 1/e.",
                     .unit = "m s-1",
                     .range = Range::positive()}}},
          .make = [](const FrictionNumbers& numbers) {
            return stribeck_friction(numbers.at("static"), numbers.at("dynamic"),
                                     numbers.at("decay_velocity"));
          }};
}

}  // namespace stridor
