#include "solvers/substrate_stepper.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>

namespace stridor {

SubstrateStepper::SubstrateStepper(const SubstrateOscillator& oscillator, Integrator integrator,
                                   double step)
    : oscillator_(&oscillator), step_(step) {
  if (!(step > 0.0)) throw std::invalid_argument("SubstrateStepper: step not positive");
  ReducedBody& reduced = body_.reduced;
  reduced.mass = Eigen::Matrix2d::Identity();
  reduced.stiffness = oscillator.stiffness;
  reduced.damping.alpha = oscillator.damping(0, 0);
  reduced.rows = Eigen::Matrix2d::Identity();
  reduced.num_interface = 2;
  body_.modal = make_modal(reduced);
  extra_damping_ = oscillator.damping(1, 1) - oscillator.damping(0, 0);
  time_.integrator = integrator;
  time_.step = step;
  step_limit_ = integrator == Integrator::exact ? std::numeric_limits<double>::infinity()
                                                : central_difference_limit(body_.modal);
  start(Eigen::Vector2d::Zero(), Eigen::Vector2d::Zero());
}

void SubstrateStepper::start(const Eigen::Vector2d& displacement, const Eigen::Vector2d& velocity) {
  propagator_ = make_propagator(body_, time_, std::nullopt, 2, {});
  propagator_->watch(0, 0);
  propagator_->watch(1, 1);
  const double slip = velocity.x() - oscillator_->substrate_speed;
  const SubstrateForces forces =
      oscillator_->contact.at(displacement.y(), slip, slip > 0.0 ? 1.0 : -1.0);
  const std::array<double, 2> at_start{
      oscillator_->load.x() + forces.tangential.value,
      oscillator_->load.y() - forces.normal.value - extra_damping_ * velocity.y()};
  body_.initial_displacement = displacement;
  body_.initial_velocity = velocity;
  start_motion(*propagator_, body_, time_, at_start.data());
  steps_ = 0;
  displacement_ = displacement;
  velocity_ = velocity;
}

double SubstrateStepper::slip(double tangential, double normal) const {
  return free_slip_ +
         (propagator_->compliance(0, 0) * tangential - propagator_->compliance(0, 1) * normal) /
             step_;
}

void SubstrateStepper::find_forces() {
  const double y = propagator_->current(1);
  const SubstrateContact& contact = oscillator_->contact;
  normal_ = 0.0;
  tangential_ = 0.0;
  if (!(y > 0.0)) {
    mode_ = SubstrateMode::free;
    return;
  }
  const double gain = propagator_->compliance(0, 0) / step_;
  const double sticking_normal = contact.at(y, 0.0, 1.0).normal.value;
  const double required = -slip(0.0, sticking_normal) / gain;
  const double strength = contact.static_strength(y).value;
  if (std::abs(required) <= strength) {
    mode_ = SubstrateMode::stick;
    normal_ = sticking_normal;
    tangential_ = required;
    return;
  }
  // Friction of magnitude above zero leaves less slip than none at all does.
  const double direction = required > 0.0 ? -1.0 : 1.0;
  mode_ = direction > 0.0 ? SubstrateMode::slip_forward : SubstrateMode::slip_back;
  double low = 0.0;
  double high = std::numeric_limits<double>::infinity();
  double w = std::abs(slip(-direction * strength, sticking_normal));
  for (int i = 0; i < 100; ++i) {
    const double mean = std::max(0.0, 0.5 * (w + direction * last_slip_));
    const double by_w = mean > 0.0 ? 0.5 : 0.0;
    const SubstrateForces forces = contact.at(y, direction * mean, direction);
    normal_ = forces.normal.value;
    tangential_ = forces.tangential.value;
    const double miss = w - direction * slip(tangential_, normal_);
    const double slope =
        1.0 - by_w * (gain * forces.tangential.by_slip -
                      propagator_->compliance(0, 1) / step_ * forces.normal.by_slip);
    (miss > 0.0 ? high : low) = w;
    double next = w - miss / slope;
    if (!(next > low && next < high)) next = std::isinf(high) ? 2.0 * w : 0.5 * (low + high);
    if (std::abs(next - w) <= 1e-14 * (w + oscillator_->substrate_speed) || next == w) return;
    w = next;
  }
}

bool SubstrateStepper::advance() {
  const double before_x = propagator_->current(0) - propagator_->increment(0);
  const double before_y = propagator_->current(1) - propagator_->increment(1);
  load_ = {oscillator_->load.x(),
           oscillator_->load.y() - extra_damping_ * propagator_->increment(1) / step_};
  free_slip_ = (propagator_->predicted(0) + propagator_->compliance(0, 0) * load_[0] +
                propagator_->compliance(0, 1) * load_[1] - propagator_->current(0)) /
                   step_ -
               oscillator_->substrate_speed;
  last_slip_ = propagator_->increment(0) / step_ - oscillator_->substrate_speed;
  displacement_ = {propagator_->current(0), propagator_->current(1)};
  find_forces();
  const std::array<double, 2> forces{load_[0] + tangential_, load_[1] - normal_};
  propagator_->advance(forces.data());
  ++steps_;
  velocity_ = {(propagator_->current(0) - before_x) / (2.0 * step_),
               (propagator_->current(1) - before_y) / (2.0 * step_)};
  return std::isfinite(propagator_->current(0)) && std::isfinite(propagator_->current(1));
}

}  // namespace stridor
