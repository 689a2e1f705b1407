// Friction laws: pure functions of the sliding speed.
#pragma once

#include <cmath>

namespace stridor {

/// Coulomb friction whose coefficient may depend on the sliding speed (docs/theory.md, 2.4).
///
///   constant         μ(v) = μ_d
///   static_dynamic   μ(v) = μ_d while sliding, μ_s at rest
///   stribeck         μ(v) = μ_d + (μ_s − μ_d) exp(−|v|/v_d)
///
/// A sticking contact holds up to μ_s λ_n. For a constant law μ_s = μ_d.
struct FrictionLaw {
  enum class Kind { constant, static_dynamic, stribeck };

  Kind kind = Kind::constant;
  double static_coefficient = 0.0;   ///< μ_s ≥ 0
  double dynamic_coefficient = 0.0;  ///< μ_d ≥ 0
  double decay_velocity = 1.0;       ///< v_d > 0, m/s; of stribeck only
};

inline FrictionLaw constant_friction(double coefficient) {
  return {FrictionLaw::Kind::constant, coefficient, coefficient, 1.0};
}

/// μ while sliding at a velocity of either sign, m/s.
inline double sliding_friction(const FrictionLaw& law, double velocity) {
  if (law.kind != FrictionLaw::Kind::stribeck) return law.dynamic_coefficient;
  return law.dynamic_coefficient + (law.static_coefficient - law.dynamic_coefficient) *
                                       std::exp(-std::abs(velocity) / law.decay_velocity);
}

/// dμ/d|v| while sliding, s/m.
inline double sliding_friction_slope(const FrictionLaw& law, double velocity) {
  if (law.kind != FrictionLaw::Kind::stribeck) return 0.0;
  return -(law.static_coefficient - law.dynamic_coefficient) / law.decay_velocity *
         std::exp(-std::abs(velocity) / law.decay_velocity);
}

}  // namespace stridor
