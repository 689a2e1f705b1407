#include "tests/support/substrate_stepper.hpp"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>

#include "solvers/contact/substrate_step.hpp"

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
  failure_.clear();
  displacement_ = displacement;
  velocity_ = velocity;
}

void SubstrateStepper::find_forces() {
  const SlipAnswer slip{free_slip_, propagator_->compliance(0, 0) / step_,
                        -propagator_->compliance(0, 1) / step_};
  const SubstrateStep found = solve_substrate_step(oscillator_->contact, propagator_->current(1),
                                                   last_slip_, slip, oscillator_->substrate_speed);
  normal_ = found.normal;
  tangential_ = found.tangential;
  stiffness_ = found.stiffness;
  mode_ = found.state == ContactState::open    ? SubstrateMode::free
          : found.state == ContactState::stick ? SubstrateMode::stick
          : found.direction > 0.0              ? SubstrateMode::slip_forward
                                               : SubstrateMode::slip_back;
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
  return check_motion();
}

bool SubstrateStepper::check_motion() {
  const SubstrateContact& contact = oscillator_->contact;
  const double y = displacement_.y();
  const double stiffness_in_step = stiffness_ * propagator_->compliance(1, 1);
  if (overshoots(stiffness_, propagator_->compliance(1, 1))) {
    failure_ = fmt::format(
        "the substrate is too stiff for the step: at an indentation of {:.3g} of the radius its "
        "force undoes {:.3g} times a change of indentation in one step, and more than 4 times "
        "makes it grow; try a shorter time.step, about {:.1g}",
        y / contact.indentation_unit, stiffness_in_step, step_ / std::sqrt(stiffness_in_step));
  } else if (!std::isfinite(propagator_->current(0)) || !std::isfinite(propagator_->current(1))) {
    failure_ = "the motion has grown beyond all bounds; try a shorter time.step";
  }
  return failure_.empty();
}

}  // namespace stridor
