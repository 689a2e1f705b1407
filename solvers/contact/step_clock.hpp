// The instants between which a simulation steps.
#pragma once

#include <cstdint>

#include "solvers/contact/face_point.hpp"

namespace stridor {

/// The present step of a simulation, from t_n = n h to t_{n+1}, and the instant at which its
/// contacts are to be closed (docs/theory.md, 3.5): t_n where forces move bodies at once, t_{n+1}
/// elsewhere.
struct StepClock {
  double step = 0.0;             ///< h, s
  std::int64_t index = 0;        ///< n
  bool has_feedthrough = false;  ///< bodies have direct feedthrough (Propagator::has_feedthrough)
  bool is_predicting_start = false;

  double time(std::int64_t at_index) const { return static_cast<double>(at_index) * step; }
  double now() const { return time(index); }
  /// Whether direct feedthrough acts in this step.
  bool is_fed_through() const { return has_feedthrough && !is_predicting_start; }
  /// Step at which gap and slip satisfy the contact conditions.
  std::int64_t sought_index() const { return index + (is_fed_through() ? 0 : 1); }
  /// The same for contacts with two tangents.
  FaceInstant instant(double sought) const { return {now(), sought, step, is_fed_through()}; }
};

}  // namespace stridor
