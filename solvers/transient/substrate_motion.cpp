#include "solvers/transient/substrate_motion.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace stridor {
namespace {

/// No step is longer than this part of the time unit, in which no motion turns twice.
constexpr double longest = 0.5;

}  // namespace

SubstrateMotion::SubstrateMotion(const SubstrateOscillator& oscillator, double tolerance)
    : oscillator_(&oscillator), tolerance_(tolerance) {
  if (!(tolerance > 0.0)) throw std::invalid_argument("SubstrateMotion: tolerance not positive");
  const SubstrateEquilibrium rest =
      find_equilibrium(oscillator, 1e-2 * oscillator.contact.indentation_unit);
  if (!rest.converged) throw std::invalid_argument("SubstrateMotion: there is no equilibrium");
  const double y = rest.displacement.y();
  const double rate = std::sqrt(oscillator.stiffness(1, 1) + rest.forces.normal.by_indentation);
  size_ = {y + std::abs(rest.displacement.x()), y, oscillator.substrate_speed + y, y * rate};
  start(rest.displacement, Eigen::Vector2d::Zero());
}

void SubstrateMotion::start(const Eigen::Vector2d& displacement, const Eigen::Vector2d& velocity) {
  time_ = 0.0;
  step_ = 0.01;
  failure_.clear();
  state_ = {displacement.x(), displacement.y(), velocity.x(), velocity.y(), 0.0, 0.0};
  restart_statistics();
  if (state_[Y] > 0.0) {
    enter_contact();
  } else {
    mode_ = SubstrateMode::free;
  }
  renew();
}

void SubstrateMotion::restart_statistics() {
  state_[SUM] = 0.0;
  state_[SQUARES] = 0.0;
  statistics_ = {};
  statistics_.from = time_;
  statistics_.smallest_x = statistics_.largest_x = state_[X];
  statistics_.largest_y = state_[Y];
}

void SubstrateMotion::enter_contact() {
  const double slip = state_[VX] - oscillator_->substrate_speed;
  if (slip == 0.0) {
    settle_at_rest_of_slip();
  } else {
    mode_ = slip > 0.0 ? SubstrateMode::slip_forward : SubstrateMode::slip_back;
  }
}

/// Stick, or slip to the side to which the friction that sticking would take is too large.
void SubstrateMotion::settle_at_rest_of_slip() {
  state_[VX] = oscillator_->substrate_speed;
  const double required = required_friction(state_);
  const double strength = oscillator_->contact.static_strength(state_[Y]).value;
  if (std::abs(required) <= strength) {
    mode_ = SubstrateMode::stick;
  } else {
    mode_ = required > 0.0 ? SubstrateMode::slip_back : SubstrateMode::slip_forward;
  }
}

SubstrateForces SubstrateMotion::forces() const {
  if (mode_ == SubstrateMode::free) return {};
  const bool sticks = mode_ == SubstrateMode::stick;
  const double direction = mode_ == SubstrateMode::slip_back ? -1.0 : 1.0;
  const double slip = sticks ? 0.0 : state_[VX] - oscillator_->substrate_speed;
  SubstrateForces forces = oscillator_->contact.at(state_[Y], slip, direction);
  if (sticks) forces.tangential = {required_friction(state_), 0.0, 0.0};
  return forces;
}

void SubstrateMotion::evaluate(const State& s, State& slope) {
  ++statistics_.evaluations;
  const Eigen::Matrix2d& c = oscillator_->damping;
  const Eigen::Matrix2d& k = oscillator_->stiffness;
  double normal = 0.0;
  double tangential = 0.0;
  if (mode_ == SubstrateMode::stick) {
    normal = oscillator_->contact.at(s[Y], 0.0, 1.0).normal.value;
  } else if (mode_ != SubstrateMode::free) {
    const double direction = mode_ == SubstrateMode::slip_forward ? 1.0 : -1.0;
    const SubstrateForces forces =
        oscillator_->contact.at(s[Y], s[VX] - oscillator_->substrate_speed, direction);
    normal = forces.normal.value;
    tangential = forces.tangential.value;
  }
  slope[X] = s[VX];
  slope[Y] = s[VY];
  slope[VX] = mode_ == SubstrateMode::stick ? 0.0 : tangential - required_friction(s);
  slope[VY] = oscillator_->load.y() - normal - c(1, 0) * s[VX] - c(1, 1) * s[VY] - k(1, 0) * s[X] -
              k(1, 1) * s[Y];
  slope[SUM] = s[X];
  slope[SQUARES] = s[X] * s[X];
}

/// After a change of mode or state.
void SubstrateMotion::renew() {
  evaluate(state_, slope_);
  for (std::size_t e = 0; e < num_events; ++e) {
    armed_[e] = is_possible(static_cast<Event>(e)) &&
                event_value(static_cast<Event>(e), state_, slope_).value > 0.0;
  }
}

void SubstrateMotion::apply(Event event) {
  if (event != Event::turn) ++statistics_.events;
  switch (event) {
    case Event::slip_ends:
      settle_at_rest_of_slip();
      break;
    case Event::strength_reached:
      mode_ =
          required_friction(state_) > 0.0 ? SubstrateMode::slip_back : SubstrateMode::slip_forward;
      break;
    case Event::lift_off:
      state_[Y] = 0.0;
      mode_ = SubstrateMode::free;
      break;
    case Event::touch_down:
      state_[Y] = 0.0;
      enter_contact();
      break;
    case Event::turn:
      state_[VX] = 0.0;
      break;
  }
  if (event != Event::turn) step_ *= 0.25;
  renew();
}

void SubstrateMotion::accept(double length) {
  const State& end = trial_.end();
  if (mode_ == SubstrateMode::stick) statistics_.stick_time += length;
  if (mode_ == SubstrateMode::free) statistics_.free_time += length;
  // x is extreme where ẋ vanishes; between the ends as the polynomial through x, ẋ and ẍ has it.
  const double v0 = state_[VX];
  const double v1 = end[VX];
  if (v0 * v1 < 0.0) {
    double low = 0.0;
    double high = 1.0;
    const double b0 = slope_[VX] * length;
    const double b1 = end_slope_[VX] * length;
    const double rise = (end[X] - state_[X]) / length - v0 - 0.5 * b0;
    const double fall = v1 - v0 - b0;
    const double turn = b1 - b0;
    const double c3 = 10.0 * rise - 4.0 * fall + 0.5 * turn;
    const double c4 = -15.0 * rise + 7.0 * fall - turn;
    const double c5 = 6.0 * rise - 3.0 * fall + 0.5 * turn;
    const auto speed = [&](double t) {
      return v0 + t * (b0 + t * (3.0 * c3 + t * (4.0 * c4 + t * 5.0 * c5)));
    };
    for (int i = 0; i < 50; ++i) {
      const double middle = 0.5 * (low + high);
      ((speed(middle) > 0.0) == (v0 > 0.0) ? low : high) = middle;
    }
    const double t = low;
    const double x = state_[X] + length * t * (v0 + t * (0.5 * b0 + t * (c3 + t * (c4 + t * c5))));
    statistics_.smallest_x = std::min(statistics_.smallest_x, x);
    statistics_.largest_x = std::max(statistics_.largest_x, x);
  }
  ++statistics_.steps;
  time_ += length;
  state_ = end;
  slope_ = end_slope_;
  statistics_.smallest_x = std::min(statistics_.smallest_x, state_[X]);
  statistics_.largest_x = std::max(statistics_.largest_x, state_[X]);
  statistics_.largest_y = std::max(statistics_.largest_y, state_[Y]);
}

/// One step that is accurate enough, cut at the first event in it. @return false where it fails
bool SubstrateMotion::take_step(double end, bool stops_at_turns, Event& event, bool& has_event) {
  const auto f = [this](const State& s, State& slope) { evaluate(s, slope); };
  has_event = false;
  const double rounding = 4.0 * std::numeric_limits<double>::epsilon() * std::max(1.0, time_);
  double length = std::min({step_, longest, end - time_});
  for (int i = 0; i < 200; ++i) {
    trial_.take(state_, slope_, length, f);
    std::array<double, 4> scale{};
    for (std::size_t k = 0; k < 4; ++k)
      scale[k] = tolerance_ * (size_[k] + std::max(std::abs(state_[k]), std::abs(trial_.end()[k])));
    const double error = trial_.error(scale);
    const double factor = step_factor(error);
    if (!(error <= 1.0)) {
      length *= std::min(factor, 0.9);
      if (!(length > rounding)) return false;
      continue;
    }
    evaluate(trial_.end(), end_slope_);
    const Scan scan = scan_events(length, stops_at_turns);
    event = scan.event;
    if (scan.shorter < length && scan.shorter < scan.first) {
      length = scan.shorter;
      if (!(length > rounding)) return false;
      continue;
    }
    if (std::isfinite(scan.first)) {
      has_event = true;
      trial_.take(state_, slope_, scan.first, f);
      evaluate(trial_.end(), end_slope_);
      step_ = std::min(longest, length * factor);
      accept(scan.first);
      return true;
    }
    for (std::size_t e = 0; e < num_events; ++e) {
      const auto kind = static_cast<Event>(e);
      if (is_possible(kind) && !armed_[e])
        armed_[e] = event_value(kind, trial_.end(), end_slope_).value > 0.0;
    }
    // A step cut short by the end says nothing of the next.
    if (length < step_ && length == end - time_) {
      step_ = std::max(step_, length * factor);
    } else {
      step_ = length * factor;
    }
    accept(length);
    return true;
  }
  return false;
}

/// @return false where the body runs away
bool SubstrateMotion::check_motion() {
  constexpr double largest = 1e12;
  for (std::size_t k = 0; k <= VY; ++k) {
    if (std::abs(state_[k]) < largest * (1.0 + size_[0])) continue;
    failure_ =
        "the motion has grown beyond all bounds; try an initial state nearer to the equilibrium";
    return false;
  }
  return true;
}

SubstrateMotion::Stop SubstrateMotion::advance(double end, bool stops_at_turns) {
  // Turns are armed by where the motion is now.
  armed_[static_cast<std::size_t>(Event::turn)] = mode_ == SubstrateMode::stick || state_[VX] > 0.0;
  while (time_ < end) {
    Event event{};
    bool has_event = false;
    if (!take_step(end, stops_at_turns, event, has_event)) {
      failure_ = "the steps have become too small for the time; try a larger time.tolerance";
      return Stop::failed;
    }
    if (!check_motion()) return Stop::failed;
    if (!has_event) continue;
    apply(event);
    if (event == Event::turn) return Stop::turn;
  }
  return Stop::end;
}

}  // namespace stridor
