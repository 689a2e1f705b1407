#include "solvers/transient/sliding_oscillator.hpp"

#include <fmt/format.h>

#include <Eigen/LU>
#include <cmath>
#include <utility>

namespace stridor {
namespace {

/// Rounding of products of matrices.
constexpr double rounding = 1e-12;

/// Bodies with unknowns.
int num_moving_bodies(const System& system, int& last) {
  int count = 0;
  for (std::size_t b = 0; b < system.bodies.size(); ++b) {
    if (system.bodies[b].reduced.size() == 0) continue;
    last = static_cast<int>(b);
    ++count;
  }
  return count;
}

/// What bodies and contacts are there; empty where they may be an oscillator.
std::string fault_of_parts(const System& system, int& body) {
  const int count = num_moving_bodies(system, body);
  if (count != 1) return fmt::format("it has {} bodies that move", count);
  if (system.contacts.size() != 1)
    return fmt::format("it has {} contact points", system.contacts.size());
  const ContactPoint& contact = system.contacts.front();
  const SystemBody& slave = system.bodies[static_cast<std::size_t>(body)];
  if (!contact.substrate) return "its contact has no viscoelastic half_space";
  if (contact.face || contact.slave_body != body || !system.surface_of(contact).is_endless)
    return "its contact is not that of the body on a half_space";
  if (slave.reduced.size() != 2)
    return fmt::format("its body '{}' has {} unknowns", slave.name, slave.reduced.size());
  return "";
}

/// What changes over time, or does not move; empty where nothing is wrong.
std::string fault_of_drive(const System& system, const SlidingMass& mass) {
  const SystemBody& body = system.bodies[static_cast<std::size_t>(mass.body)];
  if (system.driven_motion(system.contacts.front()).is_frozen()) return "its contact is frozen";
  if (system.drives_constant_from() > 0.0)
    return "its drive is not constant from the start (drive.ramp: 0, numbers without a table)";
  if (body.modal.damping.constant_from() > 0.0) return "its damping changes over time";
  if (mass.speed == 0.0)
    return "its half_space does not move against it (drive.velocity, drive.moves)";
  return "";
}

}  // namespace

std::optional<SlidingMass> as_sliding_mass(const System& system, std::string* why) {
  const auto refuse = [&](const std::string& text) {
    if (why != nullptr) *why = text;
    return std::nullopt;
  };
  SlidingMass made;
  if (const std::string fault = fault_of_parts(system, made.body); !fault.empty())
    return refuse(fault);
  const ContactPoint& contact = system.contacts.front();
  const SystemBody& body = system.bodies[static_cast<std::size_t>(made.body)];
  const ReducedBody& reduced = body.reduced;
  made.to_contact.row(0) = reduced.rows.row(contact.slave_rows.x);
  made.to_contact.row(1) = reduced.rows.row(contact.slave_rows.y);
  if (!(std::abs(made.to_contact.determinant()) > rounding * made.to_contact.squaredNorm()))
    return refuse("its slave point does not move in x and y");
  made.to_body = made.to_contact.inverse();
  const auto at_contact = [&](const Eigen::MatrixXd& matrix) -> Eigen::Matrix2d {
    return made.to_body.transpose() * matrix * made.to_body;
  };
  const Eigen::Matrix2d mass = at_contact(reduced.mass);
  made.mass = mass(0, 0);
  if (!mass.isApprox(made.mass * Eigen::Matrix2d::Identity(), rounding))
    return refuse("its mass is not the same in x and y");
  made.stiffness = at_contact(reduced.stiffness);
  if (!(made.stiffness(0, 0) > 0.0)) return refuse("no spring holds it in x");
  made.damping = at_contact(body.modal.damping.alpha * reduced.mass +
                            body.modal.damping.beta * reduced.stiffness);
  if (!reduced.coupled.is_empty()) {
    if (!reduced.coupled.position.isZero(0.0)) return refuse("its body has circulatory terms");
    made.damping += at_contact(reduced.coupled.velocity);
  }
  const auto direction_of = [&](const BodyLoad& load) -> Eigen::Vector2d {
    return made.to_body.transpose() * reduced.rows.row(load.row).transpose();
  };
  if (body.loads.size() == 1) {
    made.load = body.loads.front().size(system.drives, 0.0);
    made.load_direction = direction_of(body.loads.front());
  } else if (!body.loads.empty()) {
    made.load = 1.0;
    for (const BodyLoad& load : body.loads)
      made.load_direction += load.size(system.drives, 0.0) * direction_of(load);
  }
  const auto speed_of = [&](int index) {
    const Drive* const drive = system.drive_of(index);
    return drive == nullptr ? 0.0 : drive->velocity.value(0.0);
  };
  made.base_speed = speed_of(made.body);
  made.speed = speed_of(system.surface_of(contact).body) - made.base_speed;
  made.contact = *contact.substrate;
  if (const std::string fault = fault_of_drive(system, made); !fault.empty()) return refuse(fault);
  return made;
}

SlidingOscillator scaled(SlidingMass mass) {
  SlidingOscillator made;
  const double stiffness = mass.stiffness(0, 0);
  const Eigen::Vector2d load = mass.load * mass.load_direction;
  made.time = std::sqrt(mass.mass / stiffness);
  made.length = load.isZero(0.0) ? mass.contact.indentation_unit : load.norm() / stiffness;
  made.force = stiffness * made.length;
  made.direction = mass.speed > 0.0 ? 1.0 : -1.0;
  const Eigen::DiagonalMatrix<double, 2> axes(made.direction, -1.0);
  SubstrateOscillator& oscillator = made.oscillator;
  oscillator.stiffness = axes * mass.stiffness * axes;
  oscillator.stiffness /= stiffness;
  oscillator.damping = axes * mass.damping * axes;
  oscillator.damping *= made.time / mass.mass;
  oscillator.load = axes * load;
  oscillator.load /= made.force;
  const double velocity = made.velocity_unit();
  oscillator.substrate_speed = std::abs(mass.speed) / velocity;
  SubstrateContact& contact = oscillator.contact;
  contact = mass.contact;
  contact.indentation_unit /= made.length;
  contact.speed_unit /= velocity;
  contact.force_unit /= made.force;
  contact.shear /= made.force;
  contact.load /= made.force;
  contact.interface_friction.velocity_unit *= velocity;
  contact.sign.speed /= velocity;
  made.mass = std::move(mass);
  return made;
}

std::optional<SlidingOscillator> as_oscillator(const System& system, std::string* why) {
  std::optional<SlidingMass> mass = as_sliding_mass(system, why);
  if (!mass) return std::nullopt;
  return scaled(*std::move(mass));
}

namespace {

Eigen::Vector2d start_of(const Eigen::VectorXd& motion, const SlidingMass& mass) {
  if (motion.size() == 0) return Eigen::Vector2d::Zero();
  return mass.to_contact * motion;
}

}  // namespace

Eigen::Vector2d SlidingOscillator::initial_displacement(const System& system) const {
  const SystemBody& body = system.bodies[static_cast<std::size_t>(mass.body)];
  return from_si(start_of(body.initial_displacement, mass), length);
}

Eigen::Vector2d SlidingOscillator::initial_velocity(const System& system) const {
  const SystemBody& body = system.bodies[static_cast<std::size_t>(mass.body)];
  return from_si(start_of(body.initial_velocity, mass), velocity_unit());
}

}  // namespace stridor
