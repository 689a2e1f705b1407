// What every contact of a simulation carries, whatever its kinematics.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>

#include "coupling/system/system.hpp"
#include "solvers/contact/contact_solver.hpp"

namespace stridor {

/// Position of a slave point on its master.
struct ContactPlace {
  double gap;       ///< distance from the deformed surface along its own normal, m
  double position;  ///< along the undeformed master from its first node, m
};

/// Violations of persistent sliding by one contact, counted in steps; none with FiLM, which does
/// not assume it.
struct ViolationCount {
  std::int64_t negative_force = 0;  ///< λ < 0, or lifted off where the contact is unilateral
  /// Sliding velocity against that of the drive (never while the drive is at rest), or sticking.
  std::int64_t reversed_sliding = 0;
  std::int64_t before_armed = 0;  ///< of the two, those before ContactPoint::armed_from
  double last_time = 0.0;         ///< of the latest one, s

  std::int64_t total() const { return negative_force + reversed_sliding; }
};

/// Statistics of a contact over a stretch of steps.
struct ContactStatistics {
  double force_min = std::numeric_limits<double>::infinity();      ///< of λ, N
  double force_max = -std::numeric_limits<double>::infinity();     ///< of λ, N
  double friction_min = std::numeric_limits<double>::infinity();   ///< of λ_t, N
  double friction_max = -std::numeric_limits<double>::infinity();  ///< of λ_t, N
  std::int64_t steps = 0;
  std::int64_t sticking = 0;  ///< steps that ended in stick
  std::int64_t open = 0;      ///< steps without contact

  /// Adds the statistics of another stretch.
  void add(const ContactStatistics& other) {
    force_min = std::min(force_min, other.force_min);
    force_max = std::max(force_max, other.force_max);
    friction_min = std::min(friction_min, other.friction_min);
    friction_max = std::max(friction_max, other.friction_max);
    steps += other.steps;
    sticking += other.sticking;
    open += other.open;
  }

  /// The same as numbers, for a saved state.
  using Numbers = std::array<double, 7>;
  Numbers numbers() const {
    return {force_min,
            force_max,
            friction_min,
            friction_max,
            static_cast<double>(steps),
            static_cast<double>(sticking),
            static_cast<double>(open)};
  }
  static ContactStatistics of(std::span<const double, std::tuple_size_v<Numbers>> numbers) {
    const auto count = [&](std::size_t k) { return static_cast<std::int64_t>(numbers[k]); };
    return {numbers[0], numbers[1], numbers[2], numbers[3], count(4), count(5), count(6)};
  }
};

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
  bool predicts_ahead = false;  ///< its problem is that of t_{n+1}
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
  /// Counts a violation of persistent sliding.
  void note(std::int64_t& counter, double now) {
    ++counter;
    violations.last_time = now;
  }
  /// The same. @returns false where the contact is armed
  bool tolerate(std::int64_t& counter, double now, double armed_from) {
    note(counter, now);
    if (now >= armed_from) return false;
    ++violations.before_armed;
    return true;
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
