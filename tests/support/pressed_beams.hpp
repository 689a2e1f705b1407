// A short beam laid flat on a cantilever and pressed on it over an edge of many nodes.
#pragma once

#include "models/model.hpp"
#include "substructures/bodies/beam.hpp"

namespace stridor::test {

/// N. Rotations are of the order 1e-7, so that film, on the deformed surface, gives the forces of
/// the undeformed one.
inline constexpr double pressed_beams_load = -1e-6;

/// Soft, stocky and strongly damped, so that few steps lead to rest. The guided end of the upper
/// beam stands at 83.7 mm, its 21 lower nodes reach from there back to 38.7 mm, none of them on a
/// node below. The drive is frozen: the beams stay and friction acts as in forward sliding.
inline ModelParameters pressed_beams(double friction, ContactAssumption assumption) {
  BeamParameters lower;
  lower.length = 0.100;
  lower.thickness = 0.040;
  lower.width = 0.010;
  lower.material = {1e6, 0.3, 1000.0};
  lower.mesh = {10, 1};
  lower.damping.alpha = 200.0;
  lower.damping.beta = 1e-5;
  lower.supports = {Support::clamped, Support::free};
  lower.reduction = {4};
  BeamParameters upper = lower;
  upper.length = 0.045;
  upper.thickness = 0.020;
  upper.material.youngs_modulus = 2e5;
  upper.supports = {Support::free, Support::guided};

  ModelParameters model;
  model.substructures["lower"] = lower;
  model.substructures["upper"] = upper;
  ContactParameters contact;
  contact.slave = {"upper.bottom"};
  contact.master = "lower.top";
  contact.assumption = assumption;
  contact.on_violation = OnViolation::unilateral;
  contact.armed_from = 0.0;
  contact.start = 0.0837;
  contact.sliding = SlidingMode::frozen;
  contact.friction.emplace().numbers["coefficient"] = friction;
  model.contact = contact;
  model.drive.emplace().velocity = TimeCurve(1.0);
  model.drive->load = TimeCurve(pressed_beams_load);
  return model;
}

inline constexpr double pressed_beams_step = 6.9e-5;      ///< s; 0.3 % below the limit
inline constexpr std::int64_t pressed_beams_rest = 3000;  ///< steps after which they rest

}  // namespace stridor::test
