// What every contact of a simulation carries, whatever its kinematics.
#pragma once

#include <cstdint>

#include "solvers/simulation.hpp"

namespace stridor {

struct ContactRecord {
  double unilateral_from = 0.0;
  double compliance = 0.0;     ///< ContactPoint::compliance()
  double constant_from = 0.0;  ///< of the rise of its friction
  double rise = 0.0;           ///< from then on

  // State.
  double force = 0.0;           ///< λ_n
  double friction_force = 0.0;  ///< λ_t; on a face along the circumference
  ContactState state = ContactState::open;
  double slip_velocity = 0.0;  ///< on a face along the circumference
  int steady_steps = 0;  ///< closed without a change of state, up to steady_after
  ContactStatistics statistics;     ///< since the last reset or the end of the last interval
  ContactStatistics earlier;        ///< from the last reset up to there
  ContactStatistics open_interval;  ///< of the present interval, up to the last reset
  ContactStatistics interval;       ///< the one that ended last
  ViolationCount violations;

  // Scratch of one step.
  bool looks_ahead = false;  ///< its problem is that of t_{n+1}
  double friction = 0.0;     ///< μ, for messages

  /// Enters the present forces.
  void count() {
    statistics.force_min = std::min(statistics.force_min, force);
    statistics.force_max = std::max(statistics.force_max, force);
    statistics.friction_min = std::min(statistics.friction_min, friction_force);
    statistics.friction_max = std::max(statistics.friction_max, friction_force);
    ++statistics.steps;
    if (state == ContactState::slip) return;
    ++(state == ContactState::stick ? statistics.sticking : statistics.open);
  }
  void forget() {
    statistics = earlier = open_interval = interval = {};
    violations = {};
    state = ContactState::open;
    steady_steps = 0;
  }
  /// Puts a new point of contact on record.
  void begin(const ContactPoint& point) {
    unilateral_from = point.unilateral_from();
    compliance = point.compliance();
    constant_from = point.friction_rise.constant_from();
    rise = point.friction_rise.value(constant_from);
  }
};

}  // namespace stridor
