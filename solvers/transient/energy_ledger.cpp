#include "solvers/transient/energy_ledger.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/clones.hpp"

namespace stridor {
namespace {

/// A height of the rough surface, or a force, that no step has told yet.
constexpr double not_yet = std::numeric_limits<double>::infinity();

/// Numbers that are worked on together; split by the compiler where the instruction set has shorter
/// vectors. Arrays are padded with zeros to whole blocks.
using Block = double __attribute__((vector_size(64)));
constexpr std::size_t lanes = sizeof(Block) / sizeof(double);

std::size_t padded(std::size_t size) {
  return (size + lanes - 1) / lanes * lanes;
}

/// Pairwise, so that the order does not depend on how the compiler splits the block.
inline __attribute__((always_inline)) double total(const Block& block) {
  return ((block[0] + block[4]) + (block[2] + block[6])) +
         ((block[1] + block[5]) + (block[3] + block[7]));
}

inline __attribute__((always_inline)) const Block& at(const double* values, std::size_t i) {
  return *reinterpret_cast<const Block*>(values + i);
}

/// a · b of aligned arrays of whole blocks.
STRIDOR_CLONES
double dot(const double* a, const double* b, std::size_t size) {
  Block even{};  // two sums: one alone would wait for the latency of every addition
  Block odd{};
  std::size_t i = 0;
  for (; i + 2 * lanes <= size; i += 2 * lanes) {
    even += at(a, i) * at(b, i);
    odd += at(a, i + lanes) * at(b, i + lanes);
  }
  if (i < size) even += at(a, i) * at(b, i);
  return total(even + odd);
}

/// The mean increment, and the forms of EnergyLedger::Forms where M = I and K = diag(ω²).
STRIDOR_CLONES
void modal_forms(const double* square_omega, const double* position, const double* last,
                 const double* next, double* mean, std::size_t size, double* forms) {
  Block kinetic{};
  Block strain{};
  Block mass_damping{};
  Block stiffness_damping{};
  for (std::size_t i = 0; i < size; i += lanes) {
    kinetic += at(next, i) * at(next, i);
    strain += at(square_omega, i) * (at(position, i) * (at(position, i) + at(next, i)));
    const Block half = 0.5 * (at(last, i) + at(next, i));
    *reinterpret_cast<Block*>(mean + i) = half;
    const Block loss = half * at(last, i);
    mass_damping += loss;
    stiffness_damping += at(square_omega, i) * loss;
  }
  forms[0] = total(kinetic);
  forms[1] = total(strain);
  forms[2] = total(mass_damping);
  forms[3] = total(stiffness_damping);
}

void copy_to(const Eigen::VectorXd& vector, AlignedArray& array) {
  std::copy(vector.begin(), vector.end(), array.data());
}

Eigen::Map<Eigen::VectorXd> as_vector(AlignedArray& array, std::size_t size) {
  return {array.data(), static_cast<Eigen::Index>(size)};
}

}  // namespace

EnergyLedger::Body EnergyLedger::make_body(const SystemBody& system_body,
                                           const TimeParameters& time) {
  const ReducedBody& reduced = system_body.reduced;
  const ModalBody& modal = system_body.modal;
  const bool is_modal = time.coordinates == Coordinates::modal;
  Body body;
  body.drive = system_body.drive;
  body.loads = system_body.loads;
  body.damping = is_modal ? modal.damping : reduced.damping;
  body.size = static_cast<std::size_t>(is_modal ? modal.size() : reduced.size());
  body.padded_size = padded(body.size);
  const Eigen::MatrixXd& rows = is_modal ? modal.rows : reduced.rows;
  body.rows = AlignedArray(static_cast<std::size_t>(rows.rows()) * body.padded_size);
  for (Eigen::Index row = 0; row < rows.rows(); ++row) {
    for (Eigen::Index i = 0; i < rows.cols(); ++i) {
      body.rows[static_cast<std::size_t>(row) * body.padded_size + static_cast<std::size_t>(i)] =
          rows(row, i);
    }
  }
  if (system_body.follows_drive()) {
    body.base_inertia = AlignedArray(body.padded_size);
    copy_to(is_modal ? modal.base_inertia : reduced.base_inertia, body.base_inertia);
  }
  if (system_body.held_load.size() > 0) {
    body.held_load = AlignedArray(body.padded_size);
    copy_to(is_modal ? Eigen::VectorXd(modal.shapes.transpose() * system_body.held_load)
                     : system_body.held_load,
            body.held_load);
  }
  for (AlignedArray Body::*array :
       {&Body::position, &Body::increment, &Body::last_increment, &Body::mean_increment}) {
    body.*array = AlignedArray(body.padded_size);
  }
  if (is_modal) {
    body.square_omega = AlignedArray(body.padded_size);
    copy_to(modal.omega.array().square(), body.square_omega);
  } else {
    body.mass = reduced.mass;
    body.stiffness = reduced.stiffness;
    body.product.resize(reduced.size());
  }

  // ΦᵀMΦ = I, so ΦᵀM takes reduced coordinates to modal ones.
  const auto coordinates_of = [&](const Eigen::VectorXd& motion) -> Eigen::VectorXd {
    if (!is_modal) return motion;
    return modal.shapes.transpose() * (reduced.mass * motion);
  };
  if (system_body.initial_velocity.size() > 0)
    copy_to(time.step * coordinates_of(system_body.initial_velocity), body.increment);
  if (system_body.initial_displacement.size() > 0)
    copy_to(coordinates_of(system_body.initial_displacement), body.position);
  for (std::size_t i = 0; i < body.size; ++i) body.position[i] -= body.increment[i];
  return body;
}

EnergyLedger::EnergyLedger(const System& system, const TimeParameters& time)
    : step_(time.step), drives_(system.drives) {
  double kinetic = 0.0;
  double strain = 0.0;
  for (const SystemBody& body : system.bodies) {
    bodies_.push_back(make_body(body, time));
    const Forms forms = forms_of_step(bodies_.back());  // of the step that ends at t = 0
    kinetic += 0.5 * forms.kinetic / (step_ * step_);
    strain += 0.5 * forms.strain;
  }
  for (const ContactPoint& point : system.contacts) {
    if (point.has_two_tangents()) {
      contacts_.push_back({point.slave_body, system.master_of(point), point.slave_rows, {},
                           SurfaceKind::polyline, {}, point.compliance(), not_yet, not_yet,
                           not_yet, not_yet, true});
      continue;
    }
    const MasterSurface& surface = system.surfaces[static_cast<std::size_t>(point.surface)];
    contacts_.push_back({point.slave_body, surface.body, point.slave_rows, surface.rows,
                         surface.kind, system.driven_motion(point), point.compliance(), not_yet,
                         not_yet, not_yet, not_yet, {}});
  }
  initial_ = kinetic + strain;
  enter_stored(kinetic, strain);
}

std::span<double> EnergyLedger::position(int body) {
  Body& of = bodies_[static_cast<std::size_t>(body)];
  return of.position.first(of.size);
}

std::span<double> EnergyLedger::increment(int body) {
  Body& of = bodies_[static_cast<std::size_t>(body)];
  return of.increment.first(of.size);
}

/// Takes the step whose position and increment are in place, and makes its increment the last.
EnergyLedger::Forms EnergyLedger::forms_of_step(Body& body) {
  double forms[4];
  if (body.mass.size() == 0) {
    modal_forms(body.square_omega.data(), body.position.data(), body.last_increment.data(),
                body.increment.data(), body.mean_increment.data(), body.padded_size, forms);
  } else {
    const auto position = as_vector(body.position, body.size);
    const auto next = as_vector(body.increment, body.size);
    const auto last = as_vector(body.last_increment, body.size);
    auto mean = as_vector(body.mean_increment, body.size);
    mean = 0.5 * (last + next);
    body.product.noalias() = body.mass * next;
    forms[0] = next.dot(body.product);
    body.product.noalias() = body.stiffness * position;
    forms[1] = position.dot(body.product) + next.dot(body.product);
    body.product.noalias() = body.mass * mean;
    forms[2] = last.dot(body.product);
    body.product.noalias() = body.stiffness * mean;
    forms[3] = last.dot(body.product);
  }
  std::swap(body.increment, body.last_increment);
  return {forms[0], forms[1], forms[2], forms[3]};
}

/// Of the drive that a body follows, m/s²; 0 where there is none.
double EnergyLedger::acceleration_of(const Body& body, double time) const {
  if (body.drive < 0) return 0.0;
  const Drive& drive = drives_[static_cast<std::size_t>(body.drive)];
  return time >= drive.velocity.constant_from() ? 0.0 : drive.acceleration(time);
}

double EnergyLedger::mean_increment(const Body& body, int row) const {
  return dot(body.rows.data() + static_cast<std::size_t>(row) * body.padded_size,
             body.mean_increment.data(), body.padded_size);
}

/// Of the slave relative to the point of the master under it.
Eigen::Vector2d EnergyLedger::mean_increment(const Contact& contact,
                                             const ContactAction& action) const {
  const auto of = [&](int body, const PointRows& rows) -> Eigen::Vector2d {
    const Body& carrier = bodies_[static_cast<std::size_t>(body)];
    return {mean_increment(carrier, rows.x), mean_increment(carrier, rows.y)};
  };
  const Stencil stencil = make_stencil(
      contact.surface_kind, static_cast<int>(contact.master_rows.size()), action.segment);
  Eigen::Vector2d relative = of(contact.slave_body, contact.slave_rows);
  for (int k = 0; k < stencil.count; ++k) {
    relative -=
        action.projection.weights[static_cast<std::size_t>(k)] *
        of(contact.master_body, contact.master_rows[static_cast<std::size_t>(stencil.first + k)]);
  }
  return relative;
}

void EnergyLedger::add(double time, std::span<const ContactAction> contacts,
                       std::span<const double> slip_velocities) {
  double kinetic = 0.0;
  double strain = 0.0;
  for (Body& body : bodies_) {
    const Forms forms = forms_of_step(body);
    kinetic += 0.5 * forms.kinetic / (step_ * step_);
    strain += 0.5 * forms.strain;
    damping_loss_.add((body.damping.alpha_at(time) * forms.mass_damping +
                       body.damping.beta * forms.stiffness_damping) /
                      step_);
    for (const BodyLoad& load : body.loads)
      load_work_.add(load.size(drives_, time) * mean_increment(body, load.row));
    if (body.held_load.size() > 0) {
      load_work_.add(
          dot(body.held_load.data(), body.mean_increment.data(), body.padded_size));
    }
    const double acceleration = acceleration_of(body, time);
    if (acceleration != 0.0) {
      drive_work_.add(-acceleration *
                      dot(body.base_inertia.data(), body.mean_increment.data(), body.padded_size));
    }
  }
  double given = 0.0;
  for (std::size_t i = 0; i < contacts_.size(); ++i) {
    const ContactAction& action = contacts[i];
    const double raised = roughness_increment(contacts_[i], action.roughness);
    given += stored_increment(contacts_[i], action.force);
    if (action.state == ContactState::open) continue;
    const bool is_on_face = contacts_[i].has_two_tangents;
    given += is_on_face ? enter_face(contacts_[i], action)
                        : enter_contact(contacts_[i], action, step_ * contacts_[i].driven.velocity(time)) -
                              action.force * raised;
    const double power = is_on_face ? -action.friction_force * action.sliding.x() -
                                          action.friction_across * action.sliding.y()
                                    : -action.friction_force * slip_velocities[i];
    if (action.state == ContactState::slip && power > 0.0) {
      ++friction_gain_.steps;
      friction_gain_.largest_power = std::max(friction_gain_.largest_power, power);
      friction_gain_.last_time = time;
    }
  }
  enter_gain(given, time);
  enter_stored(kinetic, strain);
}

/// Mean increment of the height of the rough surface under a contact, m.
/// @param roughness at t_{n+1}
double EnergyLedger::roughness_increment(Contact& contact, double roughness) {
  if (contact.last_roughness == not_yet) contact.last_roughness = roughness;
  if (contact.roughness_before_last == not_yet)
    contact.roughness_before_last = contact.last_roughness;
  const double raised = 0.5 * (roughness - contact.roughness_before_last);
  contact.roughness_before_last = contact.last_roughness;
  contact.last_roughness = roughness;
  return raised;
}

/// Change of the energy in the spring of a penalty, J: (λ_n² − λ_{n−2}²)/(4k), with which its work
/// along the mean increments, −λ_n (λ_n − λ_{n−2})/(2k), is never positive.
/// @param force at t_n
double EnergyLedger::stored_increment(Contact& contact, double force) {
  // What is stored at the start was put there by nobody.
  if (contact.last_force == not_yet) contact.force_before_last = contact.last_force = force;
  const double before = contact.force_before_last;
  contact.force_before_last = contact.last_force;
  contact.last_force = force;
  return 0.25 * contact.compliance * (force - before) * (force + before);
}

/// @param given by the contacts in the step that begins at `time`, J
void EnergyLedger::enter_gain(double given, double time) {
  given_.add(given);
  least_given_ = std::min(least_given_, given_.value());
  const double gain = given_.value() - least_given_;
  if (gain > contact_gain_.energy) contact_gain_ = {gain, time};
}

/// @return contact work of the step, J
double EnergyLedger::enter_face(const Contact& contact, const ContactAction& action) {
  const Body& master = bodies_[static_cast<std::size_t>(contact.master_body)];
  const Body& slave = bodies_[static_cast<std::size_t>(contact.slave_body)];
  TangentPorts moved = TangentPorts::Zero(action.normal.size());
  const int num_rows = action.num_master_rows;
  for (int k = 0; k < num_rows; ++k) {
    if (action.normal[k] != 0.0 || action.along[k] != 0.0 || action.across[k] != 0.0)
      moved[k] = mean_increment(master, action.master_rows[static_cast<std::size_t>(k)]);
  }
  moved[num_rows] = mean_increment(slave, contact.slave_rows.x);
  moved[num_rows + 1] = mean_increment(slave, contact.slave_rows.y);
  if (contact.slave_rows.z >= 0) moved[num_rows + 2] = mean_increment(slave, contact.slave_rows.z);
  const Eigen::Vector2d& drawn = action.drawn;
  friction_loss_.add(action.friction_force * (drawn.x() - action.along.dot(moved)) +
                     action.friction_across * (drawn.y() - action.across.dot(moved)));
  drive_work_.add(action.friction_force * drawn.x() + action.friction_across * drawn.y() -
                  action.force * action.lifted);
  const double work = action.force * (action.normal.dot(moved) + action.lifted);
  contact_work_.add(work);
  return work;
}

/// @param driven displacement of the slave against the master by drives in +x, m
/// @return contact work of the step, J
double EnergyLedger::enter_contact(const Contact& contact, const ContactAction& action,
                                 double driven) {
  const Projection& p = action.projection;
  const Eigen::Vector2d relative = mean_increment(contact, action);
  friction_loss_.add(action.friction_force * (p.tangent.dot(relative) + p.tangent.x() * driven));
  const double opening =
      p.normal.dot(relative) + (contact.driven.is_frozen() ? 0.0 : p.normal.x() * driven);
  const double work = action.force * opening;
  contact_work_.add(work);
  if (contact.driven.is_frozen()) {
    drive_work_.add(action.friction_force * p.tangent.x() * driven);
  } else {
    drive_work_.add(-(action.force * p.normal.x() - action.friction_force * p.tangent.x()) *
                    driven);
  }
  return work;
}

/// Closes the books of a step.
void EnergyLedger::enter_stored(double kinetic, double strain) {
  const double stored = kinetic + strain;
  balance_ = {kinetic,
              strain,
              damping_loss_.value(),
              friction_loss_.value(),
              contact_work_.value(),
              drive_work_.value(),
              load_work_.value(),
              0.0};
  balance_.balance_error = stored - initial_ + balance_.damping_loss + balance_.friction_loss -
                           balance_.contact_work - balance_.drive_work - balance_.load_work;
  largest_stored_ = std::max(largest_stored_, stored);
  // Written so that an error that is no number stays.
  const double error = std::abs(balance_.balance_error);
  if (!(error <= largest_error_)) largest_error_ = error;
}

double EnergyLedger::turned_over() const {
  return largest_stored_ + std::abs(balance_.damping_loss) + std::abs(balance_.friction_loss) +
         std::abs(balance_.contact_work);
}

double EnergyLedger::relative_error() const {
  return largest_error_ == 0.0 ? 0.0 : largest_error_ / turned_over();
}

}  // namespace stridor
