#include "solvers/transient/simulation.hpp"

#include <fmt/format.h>

#include <optional>
#include <utility>

#include "solvers/transient/contact_actions.hpp"
#include "solvers/transient/simulation_implementation.hpp"

namespace stridor {
namespace {

/// The sum of the squares of all motions of a body, in SI units, from which on the numbers have run
/// away.
constexpr double absurd_motion = 1e30;
/// Steps between looks at the motion of the bodies: a thousandth of the cost of a step.
constexpr std::int64_t health_interval = 1024;

}  // namespace

Simulation::~Simulation() = default;
Simulation::Simulation(Simulation&&) noexcept = default;
Simulation& Simulation::operator=(Simulation&&) noexcept = default;

StepOutcome Simulation::step() {
  Implementation& run = *implementation_;
  if (!run.ledger) {
    run.advance();
    return run.finish_step();
  }
  const StepOutcome outcome = run.advance_on_account();
  return outcome == StepOutcome::done ? run.solve() : outcome;
}

StepOutcome Simulation::step_until(std::int64_t target) {
  Implementation& run = *implementation_;
  StepOutcome outcome = StepOutcome::done;
  while (outcome == StepOutcome::done && run.clock.index < target) outcome = step();
  if (outcome == StepOutcome::done && run.clock.index >= run.next_health_check)
    outcome = run.check_health();
  return outcome;
}

StepOutcome Simulation::Implementation::advance_on_account() {
  const double acting_at = clock.now();
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const auto body = static_cast<int>(b);
    bodies[b]->predict_step(forces[b].data(), ledger->position(body), ledger->increment(body));
  }
  advance();
  const StepOutcome outcome = arrive();
  // The results of the contacts are kept until they are solved anew.
  for (std::size_t i = 0; i < records.size(); ++i) {
    actions[i] = action(static_cast<int>(i));
    slip_velocities[i] = records[i]->slip_velocity;
  }
  ledger->add(acting_at, actions, slip_velocities);
  return outcome;
}

ContactAction Simulation::Implementation::action(int contact) const {
  const RunningLine* const on_line = line(contact);
  return on_line != nullptr ? action_of(*on_line) : action_of(*on_face(contact), clock);
}

StepOutcome Simulation::Implementation::check_health() {
  next_health_check = clock.index + health_interval;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const Propagator::Motion motion = bodies[b]->motion(forces[b].data());
    const double size = motion.displacement.squaredNorm() + motion.velocity.squaredNorm();
    if (size < absurd_motion) continue;
    failure = divergence_of(names[b], size, clock);
    return StepOutcome::diverged;
  }
  return StepOutcome::done;
}

std::int64_t Simulation::step_index() const {
  return implementation_->clock.index;
}
double Simulation::time() const {
  return implementation_->clock.now();
}
double Simulation::step_size() const {
  return implementation_->clock.step;
}

double Simulation::displacement(int body, int row) const {
  return implementation_->bodies[static_cast<std::size_t>(body)]->displacement(row);
}

Propagator::Motion Simulation::motion(int body) const {
  const auto b = static_cast<std::size_t>(body);
  return implementation_->bodies[b]->motion(implementation_->forces[b].data());
}

Propagator::Motion Simulation::reduced_motion(int body) const {
  const auto b = static_cast<std::size_t>(body);
  Propagator::Motion motion = this->motion(body);
  const Eigen::MatrixXd& shapes = implementation_->shapes[b];
  if (shapes.rows() == 0) return motion;
  motion.displacement = shapes * motion.displacement;
  motion.velocity = shapes * motion.velocity;
  const Eigen::VectorXd residual = implementation_->bodies[b]->residual_displacement();
  if (residual.size() > 0) motion.displacement += residual;
  return motion;
}

double Simulation::drive_displacement(int drive) const {
  return implementation_->driven_by[static_cast<std::size_t>(drive)].displacement(time());
}

int Simulation::num_contacts() const {
  return static_cast<int>(implementation_->records.size());
}

double Simulation::contact_force(int contact) const {
  return implementation_->records[static_cast<std::size_t>(contact)]->force;
}

double Simulation::friction_force(int contact) const {
  return implementation_->records[static_cast<std::size_t>(contact)]->friction_force;
}

ContactState Simulation::contact_state(int contact) const {
  return implementation_->records[static_cast<std::size_t>(contact)]->state;
}

double Simulation::contact_area(int contact) const {
  const RunningLine* const on_line = implementation_->line(contact);
  if (on_line == nullptr) return 0.0;
  const RunningLine& of = *on_line;
  const std::optional<SubstrateContact>& substrate = of.point().substrate;
  return substrate ? substrate->area(-contact_place(contact).gap, of.slip_velocity) : 0.0;
}

ContactAction Simulation::contact_action(int contact) const {
  return implementation_->action(contact);
}

double Simulation::slip_velocity(int contact) const {
  return implementation_->records[static_cast<std::size_t>(contact)]->slip_velocity;
}

ContactPlace Simulation::contact_place(int contact) const {
  if (const RunningFace* const face = implementation_->on_face(contact)) {
    const FacePoint& kinematics = *face->kinematics;
    return {kinematics.present_gap(time()), kinematics.position()};
  }
  const RunningLine& on_line = *implementation_->line(contact);
  return on_line.sliding.present_place(on_line.driven.displacement(time()));
}

double Simulation::friction_across(int contact) const {
  const RunningFace* const face = implementation_->on_face(contact);
  return face != nullptr ? face->friction_across : 0.0;
}

Eigen::Vector2d Simulation::sliding_velocity(int contact) const {
  const RunningFace* const face = implementation_->on_face(contact);
  return face != nullptr ? face->velocities[0] : Eigen::Vector2d(slip_velocity(contact), 0.0);
}

const ViolationCount& Simulation::violations(int contact) const {
  return implementation_->records[static_cast<std::size_t>(contact)]->violations;
}

ContactStatistics Simulation::statistics(int contact) const {
  const ContactRecord& of = *implementation_->records[static_cast<std::size_t>(contact)];
  ContactStatistics all = of.earlier;
  all.add(of.statistics);
  return all;
}

void Simulation::reset_statistics() {
  for (ContactRecord* const contact : implementation_->records) {
    contact->open_interval.add(contact->statistics);
    contact->statistics = {};
    contact->count();
    contact->earlier = std::exchange(contact->statistics, {});
  }
}

void Simulation::end_interval() {
  for (ContactRecord* const contact : implementation_->records) {
    contact->earlier.add(contact->statistics);
    contact->interval = std::exchange(contact->open_interval, {});
    contact->interval.add(std::exchange(contact->statistics, {}));
  }
}

const ContactStatistics& Simulation::interval_statistics(int contact) const {
  return implementation_->records[static_cast<std::size_t>(contact)]->interval;
}

const EnergyLedger* Simulation::energy() const {
  return implementation_->ledger ? &*implementation_->ledger : nullptr;
}

const std::string& Simulation::failure() const {
  return implementation_->failure.text;
}

Refusal Simulation::refusal() const {
  return implementation_->failure.refusal;
}

}  // namespace stridor
