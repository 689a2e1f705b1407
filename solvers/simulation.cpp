#include "solvers/simulation.hpp"

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/errors.hpp"
#include "solvers/make_propagator.hpp"

namespace stridor {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
/// No contact of a computable scene carries this; beyond it the numbers have run away.
constexpr double absurd_force = 1e30;
constexpr const char* persistent_sliding_remedy =
    "the assumption of persistent sliding no longer holds from here on; lower the friction "
    "coefficient, or raise "
    "contact.armed_from if this is start-up";
constexpr int slave_slots = 2;
constexpr int master_slots = 4;

/// b_Cᵀ W b_E over the slots that two rows share.
template <std::size_t n>
double coupling(const std::array<double, n>& row_c, const std::array<double, n>& row_e,
                const double* compliance, std::size_t stride) {
  double sum = 0.0;
  for (std::size_t a = 0; a < n; ++a) {
    double displacement = 0.0;
    for (std::size_t b = 0; b < n; ++b) displacement += compliance[a * stride + b] * row_e[b];
    sum += row_c[a] * displacement;
  }
  return sum;
}

}  // namespace

/// A contact while it runs.
struct RunningContact {
  ContactPoint point;
  int slave_slot = 0;   ///< first of its slots on the slave body
  int master_slot = 0;  ///< first of its slots on the master body
  bool slave_follows_drive = false;
  bool master_follows_drive = false;

  // State: the projection found with the positions predicted for t_{n+1}, and what follows from it.
  int segment = 0;
  Projection projection;
  double direction = 1.0;  ///< χ
  double force = 0.0;      ///< λ_n
  double slip_velocity = 0.0;
  double force_min = infinity;
  double force_max = -infinity;
  ViolationCount violations;

  // Scratch of one step.
  ContactRows rows;
  double friction = 0.0;
};

struct Simulation::Implementation {
  std::vector<MasterSurface> surfaces;
  std::vector<bool> follows_drive;
  std::vector<RayleighDamping> damping;
  Drive drive;
  double step;
  std::int64_t index = 0;
  std::vector<std::unique_ptr<Propagator>> bodies;
  std::vector<RunningContact> contacts;
  std::vector<std::vector<double>> forces;  ///< per body, at its slots
  std::string failure;

  // What no longer changes is not computed again.
  double loads_constant_from = 0.0;
  double drive_constant_from = 0.0;
  double friction_constant_from = 0.0;
  double end_displacement = 0.0;  ///< of the drive at drive_constant_from
  double end_velocity = 0.0;

  // Scratch for several contacts.
  Eigen::MatrixXd delassus;
  Eigen::VectorXd penetration;  ///< B_C U*
  Eigen::PartialPivLU<Eigen::MatrixXd> factor;

  const MasterSurface& surface_of(const RunningContact& contact) const {
    return surfaces[static_cast<std::size_t>(contact.point.surface)];
  }

  double time(std::int64_t at_index) const { return static_cast<double>(at_index) * step; }

  double drive_displacement(double at) const {
    if (at < drive_constant_from) return drive.displacement(at);
    return end_displacement + (drive.is_frozen ? 0.0 : end_velocity * (at - drive_constant_from));
  }

  double sliding_velocity(double at) const {
    return at < drive_constant_from ? drive.velocity.value(at) : end_velocity;
  }

  void set_loads(double at) {
    const double amplitudes[] = {drive.load.value(at), drive.acceleration(at)};
    for (std::size_t b = 0; b < bodies.size(); ++b) {
      if (follows_drive[b]) bodies[b]->set_loads(amplitudes);
    }
  }

  void set_friction(double at) {
    for (RunningContact& contact : contacts) contact.friction = contact.point.friction.value(at);
  }

  void watch_segment(RunningContact& contact, int segment) {
    contact.segment = segment;
    const MasterSurface& surface = surface_of(contact);
    Propagator& master = *bodies[static_cast<std::size_t>(surface.body)];
    for (int end = 0; end < 2; ++end) {
      const PointRows& rows = surface.rows[static_cast<std::size_t>(segment + end)];
      master.watch(contact.master_slot + 2 * end, rows.x);
      master.watch(contact.master_slot + 2 * end + 1, rows.y);
    }
  }

  /// Slave and segment with the displacements given by the slots, as seen from the undeformed T1:
  /// far from the origin the gap would drown in the rounding of the positions.
  struct Place {
    Eigen::Vector2d slave;
    Segment segment;
  };
  template <class SlotDisplacement>
  Place place_of(const RunningContact& contact, double drive_at,
                 SlotDisplacement displacement) const {
    const MasterSurface& surface = surface_of(contact);
    const Propagator& slave = *bodies[static_cast<std::size_t>(contact.point.slave_body)];
    const Propagator& master = *bodies[static_cast<std::size_t>(surface.body)];
    const Segment undeformed = surface.undeformed_segment(contact.segment);
    const auto moved = [&](const Propagator& body, int slot) -> Eigen::Vector2d {
      return {displacement(body, slot), displacement(body, slot + 1)};
    };
    Place place;
    place.slave =
        contact.point.slave_position - undeformed.first + moved(slave, contact.slave_slot);
    place.slave.x() += relative_drive(contact, drive_at);
    place.segment.first = moved(master, contact.master_slot);
    place.segment.second =
        undeformed.second - undeformed.first + moved(master, contact.master_slot + 2);
    return place;
  }
  /// How far the drive has moved the slave against the master in +x, m; or how fast, m/s.
  static double relative_drive(const RunningContact& contact, double drive_at) {
    return (contact.slave_follows_drive ? drive_at : 0.0) -
           (contact.master_follows_drive ? drive_at : 0.0);
  }
  Place predicted_place(const RunningContact& contact, double drive_at) const {
    return place_of(contact, drive_at,
                    [](const Propagator& body, int slot) { return body.predicted(slot); });
  }

  Projection projection_of(const RunningContact& contact, const Place& place,
                           double drive_at) const {
    if (contact.point.assumption == ContactAssumption::subs_b) {
      return project(place.segment, place.slave);
    }
    const Segment undeformed = surface_of(contact).undeformed_segment(contact.segment);
    if (contact.point.assumption == ContactAssumption::subs_c) {
      const Eigen::Vector2d along = undeformed.second - undeformed.first;
      return project_along(place.segment, place.slave, along / along.norm());
    }
    return project(undeformed, contact.point.slave_position +
                                   Eigen::Vector2d(relative_drive(contact, drive_at), 0.0));
  }

  /// Finds the segment under the slave point and the projection on it. Starts from the segment of
  /// the last step and never turns back: on a sagging polyline the projections on two neighbours
  /// can both point at each other. @returns false where the slave has left the end of the surface.
  bool find_projection(RunningContact& contact, double drive_at, Place& place) {
    const int last = surface_of(contact).num_segments() - 1;
    int heading = 0;
    while (true) {
      place = predicted_place(contact, drive_at);
      contact.projection = projection_of(contact, place, drive_at);
      const double xi = contact.projection.xi;
      const int wanted = xi > 1.0 ? 1 : xi < 0.0 ? -1 : 0;
      if (wanted == 0 || wanted == -heading) return true;
      const int next = contact.segment + wanted;
      if (next < 0 || next > last) return false;
      watch_segment(contact, next);
      heading = wanted;
    }
  }

  /// Contact forces at t_n such that B_C U = 0 at t_{n+1}: (B_C W B_Eᵀ) λ = B_C U*.
  StepOutcome solve() {
    const double next_time = time(index + 1);
    const double drive_at = drive_displacement(next_time);
    if (time(index) < friction_constant_from) set_friction(next_time);

    for (std::size_t i = 0; i < contacts.size(); ++i) {
      RunningContact& contact = contacts[i];
      Place place;
      if (!find_projection(contact, drive_at, place)) {
        return fail(contact, StepOutcome::master_lost);
      }
      contact.direction = contact.slip_velocity < 0.0 ? -1.0 : 1.0;
      contact.rows = make_rows(contact.projection, contact.friction, contact.direction);
      const Projection& p = contact.projection;
      penetration[static_cast<Eigen::Index>(i)] =
          p.xi * p.normal.dot(place.segment.second - place.segment.first) -
          p.normal.dot(place.slave - place.segment.first);
    }

    if (contacts.size() == 1) {
      RunningContact& contact = contacts[0];
      const double compliance = contact_compliance(contact, contact);
      if (!(compliance > 0.0))
        return fail(contact, std::isnan(compliance) ? StepOutcome::diverged : StepOutcome::jammed);
      contact.force = penetration[0] / compliance;
    } else if (contacts.size() > 1) {
      for (std::size_t i = 0; i < contacts.size(); ++i) {
        for (std::size_t j = 0; j < contacts.size(); ++j) {
          delassus(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) =
              contact_compliance(contacts[i], contacts[j]);
        }
        if (!(delassus(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(i)) > 0.0)) {
          return fail(contacts[i], StepOutcome::jammed);
        }
      }
      factor.compute(delassus);
      penetration = factor.solve(penetration).eval();
      for (std::size_t i = 0; i < contacts.size(); ++i)
        contacts[i].force = penetration[static_cast<Eigen::Index>(i)];
    }

    StepOutcome outcome = StepOutcome::done;
    for (RunningContact& contact : contacts) {
      if (!(std::abs(contact.force) < absurd_force)) return fail(contact, StepOutcome::diverged);
      contact.force_min = std::min(contact.force_min, contact.force);
      contact.force_max = std::max(contact.force_max, contact.force);
      if (contact.force < 0.0 && !tolerate(contact, contact.violations.negative_force)) {
        outcome = fail(contact, StepOutcome::pulling);
      }
    }
    for (const RunningContact& contact : contacts) {
      double* slave =
          forces[static_cast<std::size_t>(contact.point.slave_body)].data() + contact.slave_slot;
      const auto master_body = surface_of(contact).body;
      double* master = forces[static_cast<std::size_t>(master_body)].data() + contact.master_slot;
      for (std::size_t k = 0; k < slave_slots; ++k)
        slave[k] = -contact.rows.equilibrium.slave[k] * contact.force;
      for (std::size_t k = 0; k < master_slots; ++k)
        master[k] = -contact.rows.equilibrium.master[k] * contact.force;
    }
    return outcome;
  }

  /// b_C,i W b_E,jᵀ: by how much a force at contact j opens the gap of contact i, m/N.
  double contact_compliance(const RunningContact& i, const RunningContact& j) const {
    const int master_i = surface_of(i).body;
    const int master_j = surface_of(j).body;
    const auto shared = [&](int body_i, int slot_i, const auto& row_i, int body_j, int slot_j,
                            const auto& row_j) {
      if (body_i != body_j) return 0.0;
      const Propagator& body = *bodies[static_cast<std::size_t>(body_i)];
      double sum = 0.0;
      for (std::size_t a = 0; a < row_i.size(); ++a) {
        for (std::size_t b = 0; b < row_j.size(); ++b) {
          sum += row_i[a] *
                 body.compliance(slot_i + static_cast<int>(a), slot_j + static_cast<int>(b)) *
                 row_j[b];
        }
      }
      return sum;
    };
    if (&i == &j && i.point.slave_body != master_i) {
      // The common case, without the tests for shared bodies.
      const Propagator& slave = *bodies[static_cast<std::size_t>(i.point.slave_body)];
      const Propagator& master = *bodies[static_cast<std::size_t>(master_i)];
      const auto slave_stride = static_cast<std::size_t>(slave.num_slots());
      const auto master_stride = static_cast<std::size_t>(master.num_slots());
      return coupling(
                 i.rows.compatibility.slave, i.rows.equilibrium.slave,
                 slave.compliances() + static_cast<std::size_t>(i.slave_slot) * (slave_stride + 1),
                 slave_stride) +
             coupling(i.rows.compatibility.master, i.rows.equilibrium.master,
                      master.compliances() +
                          static_cast<std::size_t>(i.master_slot) * (master_stride + 1),
                      master_stride);
    }
    const auto& c = i.rows.compatibility;
    const auto& e = j.rows.equilibrium;
    return shared(i.point.slave_body, i.slave_slot, c.slave, j.point.slave_body, j.slave_slot,
                  e.slave) +
           shared(i.point.slave_body, i.slave_slot, c.slave, master_j, j.master_slot, e.master) +
           shared(master_i, i.master_slot, c.master, j.point.slave_body, j.slave_slot, e.slave) +
           shared(master_i, i.master_slot, c.master, master_j, j.master_slot, e.master);
  }

  /// From t_n to t_{n+1} with the forces that `solve` found.
  StepOutcome advance() {
    const double next_time = time(index + 1);
    if (time(index) < loads_constant_from) set_loads(next_time);
    for (std::size_t b = 0; b < bodies.size(); ++b) {
      if (time(index) < damping[b].constant_from())
        bodies[b]->set_mass_damping(damping[b].alpha_at(next_time));
      bodies[b]->advance(forces[b].data());
    }
    ++index;

    StepOutcome outcome = StepOutcome::done;
    const double drive_velocity = sliding_velocity(next_time);
    for (RunningContact& contact : contacts) {
      const Projection& p = contact.projection;
      const double* c = bodies[static_cast<std::size_t>(contact.point.slave_body)]->increments() +
                        contact.slave_slot;
      const auto master_body = surface_of(contact).body;
      const double* m =
          bodies[static_cast<std::size_t>(master_body)]->increments() + contact.master_slot;
      const double x = c[0] - (1.0 - p.xi) * m[0] - p.xi * m[2];
      const double y = c[1] - (1.0 - p.xi) * m[1] - p.xi * m[3];
      const double driven = relative_drive(contact, drive_velocity) * p.tangent.x();
      contact.slip_velocity = (p.tangent.x() * x + p.tangent.y() * y) / step + driven;
      if (contact.slip_velocity * driven < 0.0 &&
          !tolerate(contact, contact.violations.reversed_sliding)) {
        outcome = fail(contact, StepOutcome::sliding_reversed);
      }
    }
    return outcome;
  }

  /// Counts a violation of persistent sliding; false where the contact is armed.
  bool tolerate(RunningContact& contact, std::int64_t& counter) {
    ++counter;
    contact.violations.last_time = time(index);
    if (time(index) >= contact.point.armed_from) return false;
    ++contact.violations.before_armed;
    return true;
  }

  StepOutcome fail(const RunningContact& contact, StepOutcome outcome) {
    const MasterSurface& surface = surface_of(contact);
    const double position = position_of(contact);
    std::string what;
    std::string remedy;
    switch (outcome) {
      case StepOutcome::master_lost:
        what = fmt::format("the slave point has left the end of the surface {} ({:.6g} m long)",
                           surface.name, surface.arc_length.back());
        remedy =
            "end the run earlier (time.end), start elsewhere (contact.start) or slide more slowly "
            "(drive.velocity)";
        break;
      case StepOutcome::pulling:
        what = fmt::format(
            "the contact force is {:.6g} N: a bilateral contact pulls where real bodies would part",
            contact.force);
        remedy = persistent_sliding_remedy;
        break;
      case StepOutcome::sliding_reversed:
        what = fmt::format(
            "the sliding velocity is {:.6g} m/s, against the drive: real bodies would stick",
            contact.slip_velocity);
        remedy = persistent_sliding_remedy;
        break;
      case StepOutcome::jammed:
        what = fmt::format(
            "no contact force closes the gap (friction coefficient {:.4g}): the contact jams",
            contact.friction);
        remedy = "lower the friction coefficient or change the angle of the bodies";
        break;
      case StepOutcome::diverged:
        what = fmt::format("the contact force is {:.3g} N: the computation has diverged",
                           contact.force);
        remedy = "take a smaller time.step";
        break;
      case StepOutcome::done:
        break;
    }
    failure = fmt::format("{} at t = {:.9g} s (step {}), position {:.6g} m: {}. Remedy: {}.",
                          contact.point.name, time(index), index, position, what, remedy);
    return outcome;
  }

  double position_of(const RunningContact& contact) const {
    const MasterSurface& surface = surface_of(contact);
    const auto s = static_cast<std::size_t>(contact.segment);
    return surface.arc_length[s] +
           contact.projection.xi * (surface.arc_length[s + 1] - surface.arc_length[s]);
  }
};

Simulation::Simulation(const System& system, const TimeParameters& time)
    : implementation_(std::make_unique<Implementation>()) {
  const StepLimit limit = step_limit(system);
  if (!(time.step <= limit.step)) {
    throw ConfigError(
        "time.step",
        fmt::format(
            "{:.6g} s is above the largest stable step {:.6g} s of the central difference, set by "
            "the highest mode of '{}'; take at most that",
            time.step, limit.step, limit.body));
  }
  Implementation& run = *implementation_;
  run.surfaces = system.surfaces;
  run.drive = system.drive;
  run.step = time.step;
  run.drive_constant_from = system.drive.velocity.constant_from();
  run.loads_constant_from = system.drive.constant_from();
  run.end_velocity = system.drive.velocity.value(run.drive_constant_from);
  run.end_displacement = system.drive.displacement(run.drive_constant_from);

  std::vector<int> num_slots(system.bodies.size(), 0);
  for (const ContactPoint& point : system.contacts) {
    RunningContact contact;
    contact.point = point;
    const auto slave = static_cast<std::size_t>(point.slave_body);
    const auto master =
        static_cast<std::size_t>(system.surfaces[static_cast<std::size_t>(point.surface)].body);
    contact.slave_slot = num_slots[slave];
    num_slots[slave] += slave_slots;
    contact.master_slot = num_slots[master];
    num_slots[master] += master_slots;
    contact.slave_follows_drive = system.bodies[slave].follows_drive;
    contact.master_follows_drive = system.bodies[master].follows_drive;
    run.friction_constant_from =
        std::max(run.friction_constant_from, point.friction.constant_from());
    run.contacts.push_back(contact);
  }
  const double loads[] = {system.drive.load.value(0.0), system.drive.acceleration(0.0)};
  for (std::size_t b = 0; b < system.bodies.size(); ++b) {
    const SystemBody& body = system.bodies[b];
    run.bodies.push_back(make_propagator(
        body, time, num_slots[b],
        body.follows_drive ? std::span<const double>(loads) : std::span<const double>()));
    run.follows_drive.push_back(body.follows_drive);
    run.damping.push_back(body.modal.damping);
    run.forces.emplace_back(static_cast<std::size_t>(num_slots[b]), 0.0);
  }
  const auto count = static_cast<Eigen::Index>(run.contacts.size());
  run.delassus = Eigen::MatrixXd::Zero(count, count);
  run.penetration = Eigen::VectorXd::Zero(count);
  run.factor = Eigen::PartialPivLU<Eigen::MatrixXd>(count);
  for (RunningContact& contact : run.contacts) {
    Propagator& slave = *run.bodies[static_cast<std::size_t>(contact.point.slave_body)];
    slave.watch(contact.slave_slot, contact.point.slave_rows.x);
    slave.watch(contact.slave_slot + 1, contact.point.slave_rows.y);
    run.watch_segment(contact, contact.point.first_segment);
  }
  run.set_friction(run.time(1));
  if (run.solve() != StepOutcome::done) throw NumericalError(run.failure);
}

Simulation::~Simulation() = default;
Simulation::Simulation(Simulation&&) noexcept = default;
Simulation& Simulation::operator=(Simulation&&) noexcept = default;

StepOutcome Simulation::step() {
  const StepOutcome outcome = implementation_->advance();
  return outcome == StepOutcome::done ? implementation_->solve() : outcome;
}

StepOutcome Simulation::step_until(std::int64_t target) {
  StepOutcome outcome = StepOutcome::done;
  while (outcome == StepOutcome::done && implementation_->index < target) outcome = step();
  return outcome;
}

std::int64_t Simulation::step_index() const {
  return implementation_->index;
}
double Simulation::time() const {
  return implementation_->time(implementation_->index);
}
double Simulation::step_size() const {
  return implementation_->step;
}

double Simulation::displacement(int body, int row) const {
  return implementation_->bodies[static_cast<std::size_t>(body)]->displacement(row);
}

double Simulation::drive_displacement() const {
  return implementation_->drive_displacement(time());
}

int Simulation::num_contacts() const {
  return static_cast<int>(implementation_->contacts.size());
}

double Simulation::contact_force(int contact) const {
  return implementation_->contacts[static_cast<std::size_t>(contact)].force;
}

double Simulation::slip_velocity(int contact) const {
  return implementation_->contacts[static_cast<std::size_t>(contact)].slip_velocity;
}

ContactPlace Simulation::contact_place(int index) const {
  const Implementation& run = *implementation_;
  const RunningContact& contact = run.contacts[static_cast<std::size_t>(index)];
  const Implementation::Place place =
      run.place_of(contact, drive_displacement(),
                   [](const Propagator& body, int slot) { return body.current(slot); });
  const Projection here = project(place.segment, place.slave);
  const MasterSurface& surface = run.surface_of(contact);
  const auto s = static_cast<std::size_t>(contact.segment);
  return {here.normal.dot(place.slave - place.segment.first),
          surface.arc_length[s] + here.xi * (surface.arc_length[s + 1] - surface.arc_length[s])};
}

const ViolationCount& Simulation::violations(int contact) const {
  return implementation_->contacts[static_cast<std::size_t>(contact)].violations;
}

std::pair<double, double> Simulation::force_extremes(int contact) const {
  const RunningContact& running = implementation_->contacts[static_cast<std::size_t>(contact)];
  return {running.force_min, running.force_max};
}

void Simulation::reset_force_extremes() {
  for (RunningContact& contact : implementation_->contacts) {
    contact.force_min = contact.force_max = contact.force;
  }
}

const std::string& Simulation::failure() const {
  return implementation_->failure;
}

State Simulation::save() const {
  const Implementation& run = *implementation_;
  State state;
  state.put("step", run.step);
  state.put("index", static_cast<double>(run.index));
  for (std::size_t b = 0; b < run.bodies.size(); ++b) {
    const std::string prefix = fmt::format("bodies/{}/", b);
    run.bodies[b]->save(state, prefix);
    state.put(prefix + "forces", run.forces[b]);
  }
  for (std::size_t i = 0; i < run.contacts.size(); ++i) {
    const RunningContact& c = run.contacts[i];
    const double values[] = {static_cast<double>(c.segment),
                             c.projection.xi,
                             c.projection.tangent.x(),
                             c.projection.tangent.y(),
                             c.projection.normal.x(),
                             c.projection.normal.y(),
                             c.direction,
                             c.force,
                             c.slip_velocity,
                             c.force_min,
                             c.force_max,
                             static_cast<double>(c.violations.negative_force),
                             static_cast<double>(c.violations.reversed_sliding),
                             static_cast<double>(c.violations.before_armed),
                             c.violations.last_time};
    state.put(fmt::format("contacts/{}", i), values);
  }
  return state;
}

void Simulation::load(const State& state) {
  Implementation& run = *implementation_;
  if (state.get("step") != run.step)
    throw std::invalid_argument("Simulation::load: the state has another time step");
  run.index = static_cast<std::int64_t>(state.get("index"));
  run.set_loads(run.time(run.index));
  run.set_friction(run.time(run.index + 1));
  for (std::size_t b = 0; b < run.bodies.size(); ++b) {
    const std::string prefix = fmt::format("bodies/{}/", b);
    run.bodies[b]->set_mass_damping(run.damping[b].alpha_at(run.time(run.index)));
    run.bodies[b]->load(state, prefix);
    state.get(prefix + "forces", run.forces[b]);
  }
  for (std::size_t i = 0; i < run.contacts.size(); ++i) {
    RunningContact& c = run.contacts[i];
    double values[15];
    state.get(fmt::format("contacts/{}", i), values);
    c.segment = static_cast<int>(values[0]);
    c.projection = {values[1], {values[2], values[3]}, {values[4], values[5]}};
    c.direction = values[6];
    c.force = values[7];
    c.slip_velocity = values[8];
    c.force_min = values[9];
    c.force_max = values[10];
    c.violations = {static_cast<std::int64_t>(values[11]), static_cast<std::int64_t>(values[12]),
                    static_cast<std::int64_t>(values[13]), values[14]};
  }
}

}  // namespace stridor
