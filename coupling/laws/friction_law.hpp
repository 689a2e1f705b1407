// Friction of a contact: pure functions of the sliding speed.
#pragma once

#include <cmath>
#include <memory>

#include "coupling/laws/regularised_sign.hpp"

namespace stridor {

/// μ(|v|) of a law in which the speed of sliding matters.
class SlidingFriction {
 public:
  virtual ~SlidingFriction() = default;
  /// μ at a speed ≥ 0, m/s.
  virtual double coefficient(double speed) const = 0;
  /// dμ/d|v|, s/m.
  virtual double slope(double speed) const = 0;
};

/// Friction as a contact has it (docs/theory.md, 2.4): μ(v) λ_n + τ_0 A, A the area of a contact
/// that has one.
///
/// A sticking contact holds up to μ_s λ_n. A regularised law has μ(v) s(|v|/v_ε) in the place of
/// μ(v) and never sticks: it creeps. What a law is called and which numbers it takes from a scene
/// is said by its FrictionLawType; nothing that computes with it asks.
struct FrictionLaw {
  double static_coefficient = 0.0;   ///< μ_s ≥ 0, at rest
  double dynamic_coefficient = 0.0;  ///< μ_d ≥ 0, in (fast) sliding
  /// μ(|v|) while sliding; null: μ_d at any speed, without a call.
  std::shared_ptr<const SlidingFriction> sliding{};
  double shear_strength = 0.0;  ///< τ_0 ≥ 0, Pa
  RegularisedSign sign{};       ///< s, in the place of the sign of the slip
  double velocity_unit = 1.0;   ///< of the velocities that it is asked for, m/s

  bool is_regularised() const { return !sign.is_set_valued(); }
  /// Whether no friction is in proportion to the normal force.
  bool is_frictionless() const { return static_coefficient == 0.0 && dynamic_coefficient == 0.0; }
};

/// The same coefficient at rest and at any speed.
inline FrictionLaw constant_friction(double coefficient) {
  return {coefficient, coefficient};
}

/// sliding_friction() where the speed matters.
[[gnu::noinline]] inline double sliding_friction_at(const FrictionLaw& law, double speed) {
  const double friction =
      law.sliding ? law.sliding->coefficient(speed * law.velocity_unit) : law.dynamic_coefficient;
  return law.is_regularised() ? friction * law.sign.at(speed).value : friction;
}

/// μ while sliding at a velocity of either sign; of a regularised law with its factor s.
inline double sliding_friction(const FrictionLaw& law, double velocity) {
  // Most laws are constant in sliding, and every step asks.
  if (!law.sliding && !law.is_regularised()) return law.dynamic_coefficient;
  return sliding_friction_at(law, std::abs(velocity));
}

/// dμ/d|v| while sliding, likewise.
inline double sliding_friction_slope(const FrictionLaw& law, double velocity) {
  const double speed = std::abs(velocity) * law.velocity_unit;
  const double slope = law.sliding ? law.velocity_unit * law.sliding->slope(speed) : 0.0;
  if (!law.is_regularised()) return slope;
  const double friction = law.sliding ? law.sliding->coefficient(speed) : law.dynamic_coefficient;
  const RegularisedSign::Value s = law.sign.at(std::abs(velocity));
  return slope * s.value + friction * s.slope;
}

}  // namespace stridor
