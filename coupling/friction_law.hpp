// Friction laws: pure functions of the sliding speed.
#pragma once

#include <cmath>

#include "coupling/regularised_sign.hpp"

namespace stridor {

/// Coulomb friction whose coefficient may depend on the sliding speed (docs/theory.md, 2.4).
///
///   constant         μ(v) = μ_d
///   static_dynamic   μ(v) = μ_d while sliding, μ_s at rest
///   stribeck         μ(v) = μ_d + (μ_s − μ_d) exp(−|v|/v_d)
///
/// A sticking contact holds up to μ_s λ_n. For a constant law μ_s = μ_d. A regularised law has
/// μ(v) s(|v|/v_ε) in the place of μ(v) and never sticks: it creeps.
struct FrictionLaw {
  enum class Kind { constant, static_dynamic, stribeck };

  Kind kind = Kind::constant;
  double static_coefficient = 0.0;   ///< μ_s ≥ 0
  double dynamic_coefficient = 0.0;  ///< μ_d ≥ 0
  double decay_velocity = 1.0;       ///< v_d > 0, m/s; of stribeck only
  RegularisedSign sign{};            ///< s, in the place of the sign of the slip

  bool is_regularised() const { return !sign.is_set_valued(); }
  bool is_frictionless() const { return static_coefficient == 0.0 && dynamic_coefficient == 0.0; }
};

inline FrictionLaw constant_friction(double coefficient) {
  return {FrictionLaw::Kind::constant, coefficient, coefficient, 1.0};
}

/// μ while sliding at a velocity of either sign, m/s; of a regularised law with its factor s.
inline double sliding_friction(const FrictionLaw& law, double velocity) {
  double friction = law.dynamic_coefficient;
  if (law.kind == FrictionLaw::Kind::stribeck) {
    friction += (law.static_coefficient - law.dynamic_coefficient) *
                std::exp(-std::abs(velocity) / law.decay_velocity);
  }
  return law.is_regularised() ? friction * law.sign.at(std::abs(velocity)).value : friction;
}

/// dμ/d|v| while sliding, s/m, likewise.
inline double sliding_friction_slope(const FrictionLaw& law, double velocity) {
  double slope = 0.0;
  if (law.kind == FrictionLaw::Kind::stribeck) {
    slope = -(law.static_coefficient - law.dynamic_coefficient) / law.decay_velocity *
            std::exp(-std::abs(velocity) / law.decay_velocity);
  }
  if (!law.is_regularised()) return slope;
  FrictionLaw whole = law;
  whole.sign = {};
  const RegularisedSign::Value s = law.sign.at(std::abs(velocity));
  return slope * s.value + sliding_friction(whole, velocity) * s.slope;
}

}  // namespace stridor
