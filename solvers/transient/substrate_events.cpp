// Events of a motion on a substrate: when stick, slip and flight end.
#include <algorithm>
#include <cmath>
#include <limits>

#include "solvers/transient/substrate_motion.hpp"

namespace stridor {
namespace {

/// Smallest value of the cubic through two values with their rates, and where in [0, 1].
struct CubicMinimum {
  double at = 0.0;
  double value = 0.0;
};
CubicMinimum cubic_minimum(double f0, double d0, double f1, double d1) {
  // f = f0 + d0 t + b t² + a t³; where its slope vanishes while it rises.
  const double a = d0 + d1 + 2.0 * (f0 - f1);
  const double b = 3.0 * (f1 - f0) - 2.0 * d0 - d1;
  const double root = std::sqrt(std::max(0.0, b * b - 3.0 * a * d0));
  const double at = std::clamp(b >= 0.0 ? -d0 / (b + root) : (root - b) / (3.0 * a), 0.0, 1.0);
  return {at, f0 + at * (d0 + at * (b + at * a))};
}

}  // namespace

double SubstrateMotion::required_friction(const State& s) const {
  const Eigen::Matrix2d& c = oscillator_->damping;
  const Eigen::Matrix2d& k = oscillator_->stiffness;
  return c(0, 0) * s[VX] + c(0, 1) * s[VY] + k(0, 0) * s[X] + k(0, 1) * s[Y] -
         oscillator_->load.x();
}

bool SubstrateMotion::is_possible(Event event) const {
  const bool slips = mode_ == SubstrateMode::slip_back || mode_ == SubstrateMode::slip_forward;
  switch (event) {
    case Event::slip_ends:
      return slips;
    case Event::lift_off:
      return mode_ != SubstrateMode::free;
    case Event::strength_reached:
      return mode_ == SubstrateMode::stick;
    case Event::touch_down:
      return mode_ == SubstrateMode::free;
    case Event::turn:
      return mode_ != SubstrateMode::stick;
  }
  return false;
}

/// Positive until the event, where it falls through zero.
SubstrateMotion::Value SubstrateMotion::event_value(Event event, const State& s,
                                                    const State& slope) const {
  switch (event) {
    case Event::slip_ends: {
      const double direction = mode_ == SubstrateMode::slip_forward ? 1.0 : -1.0;
      return {direction * (s[VX] - oscillator_->substrate_speed), direction * slope[VX]};
    }
    case Event::strength_reached: {
      const SubstrateForces::Force strength = oscillator_->contact.static_strength(s[Y]);
      const double required = required_friction(s);
      const Eigen::Matrix2d& k = oscillator_->stiffness;
      const double rate =
          k(0, 0) * s[VX] + k(0, 1) * s[VY] + oscillator_->damping(0, 1) * slope[VY];
      return {strength.value - std::abs(required),
              strength.by_indentation * s[VY] - std::copysign(rate, required * rate)};
    }
    case Event::lift_off:
      return {s[Y], s[VY]};
    case Event::touch_down:
      return {-s[Y], -s[VY]};
    case Event::turn:
      return {s[VX], slope[VX]};
  }
  return {};
}

/// Length of the step from the present state at whose end the event happens. Leaves that step in
/// trial_ and the slope at its end in end_slope_.
double SubstrateMotion::locate(Event event, double length, const Value& at_start,
                               const Value& at_end) {
  double low = 0.0;
  double high = length;
  // The chord, bent by the rates at both ends: one step of Newton's method on the cubic.
  double at = length * at_start.value / (at_start.value - at_end.value);
  {
    const double t = at / length;
    const double d0 = at_start.rate * length;
    const double d1 = at_end.rate * length;
    const double a = d0 + d1 + 2.0 * (at_start.value - at_end.value);
    const double b = 3.0 * (at_end.value - at_start.value) - 2.0 * d0 - d1;
    const double value = at_start.value + t * (d0 + t * (b + t * a));
    const double rate = d0 + t * (2.0 * b + 3.0 * t * a);
    const double bent = t - value / rate;
    if (bent > 0.0 && bent < 1.0) at = bent * length;
  }
  for (int i = 0; i < 100; ++i) {
    trial_.take(state_, slope_, at, [this](const State& s, State& slope) { evaluate(s, slope); });
    evaluate(trial_.end(), end_slope_);
    const Value here = event_value(event, trial_.end(), end_slope_);
    (here.value > 0.0 ? low : high) = at;
    double next = at - here.value / here.rate;
    if (!(next > low && next < high)) next = 0.5 * (low + high);
    if (here.value == 0.0 || std::abs(next - at) <= 1e-15 * std::max(1e-3, at) || next == at) break;
    at = next;
  }
  return at;
}

/// Events that fall through zero in the step on trial, and those that may have done so and come
/// back.
SubstrateMotion::Scan SubstrateMotion::scan_events(double length, bool stops_at_turns) {
  Scan scan{std::numeric_limits<double>::infinity(), {}, length};
  for (std::size_t e = 0; e < num_events; ++e) {
    const auto kind = static_cast<Event>(e);
    if (!is_possible(kind) || (kind == Event::turn && !stops_at_turns)) continue;
    const Value before = event_value(kind, state_, slope_);
    const Value after = event_value(kind, trial_.end(), end_slope_);
    if (!armed_[e]) {
      // Leaves zero: that must be seen before it may come back. Turns may begin on either side.
      const bool comes_back = kind != Event::turn && after.value < 0.0;
      if (comes_back && length > 1e-9) {
        scan.shorter = std::min(scan.shorter, 0.1 * length);
      } else if (comes_back && length < scan.first) {
        scan.first = length;
        scan.event = kind;
      }
      continue;
    }
    if (after.value > 0.0) {
      if (!(before.rate < 0.0 && after.rate > 0.0)) continue;
      const CubicMinimum least =
          cubic_minimum(before.value, before.rate * length, after.value, after.rate * length);
      if (least.value <= 0.0 && least.at > 1e-3 && least.at < 0.999)
        scan.shorter = std::min(scan.shorter, least.at * length);
      continue;
    }
    // Placing one event leaves its step behind: the values above are of the whole step.
    const Step whole = trial_;
    const State whole_slope = end_slope_;
    const double at = locate(kind, length, before, after);
    trial_ = whole;
    end_slope_ = whole_slope;
    if (at < scan.first) {
      scan.first = at;
      scan.event = kind;
    }
  }
  return scan;
}

}  // namespace stridor
