#include "solvers/simulation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "core/errors.hpp"
#include "solvers/make_propagator.hpp"

namespace stridor {
namespace {

/// No contact of a computable scene carries this; beyond it the numbers have run away.
constexpr double absurd_force = 1e30;
constexpr const char* persistent_sliding_remedy =
    "the assumption of persistent sliding no longer holds from here on; let the contact stick and "
    "lift off (contact.assumption: film, or contact.on_violation: unilateral), lower the friction "
    "coefficient, or raise contact.armed_from if this is start-up";
constexpr int slave_slots = 2;

}  // namespace

/// A contact while it runs.
struct RunningContact {
  ContactPoint point;
  int slave_slot = 0;   ///< first of its slots on the slave body
  int master_slot = 0;  ///< first of its slots on the master body
  bool slave_follows_drive = false;
  bool master_follows_drive = false;
  double unilateral_from = 0.0;
  bool tracks_slip = false;  ///< it is unilateral or may become so

  // State: the projection found with the positions predicted for t_{n+1}, and what follows from it.
  int segment = 0;
  SurfacePiece undeformed;  ///< the segment
  Projection projection;
  Projection acting;            ///< in which λ_n and λ_t act: at t_{n+1} as published, or at t_n
  double force = 0.0;           ///< λ_n
  double friction_force = 0.0;  ///< λ_t
  ContactState state = ContactState::open;
  double slip_velocity = 0.0;
  /// Place on the master, along its undeformed surface, that the slave was over at the end of the
  /// last step; the material point that a sticking contact keeps.
  double anchor = 0.0;
  ContactStatistics statistics;
  ViolationCount violations;

  // Scratch of one step.
  double friction = 0.0;  ///< μ, for messages
  double place = 0.0;     ///< as anchor, for the predicted positions
  double stretch = 1.0;   ///< deformed length of the master along the tangent by undeformed length
};

struct Simulation::Implementation {
  std::vector<MasterSurface> surfaces;
  std::vector<bool> follows_drive;
  std::vector<RayleighDamping> damping;
  Drive drive;
  double step;
  bool has_residual = false;  ///< a body leaves modes out
  Integrator integrator = Integrator::central_difference;
  std::int64_t index = 0;
  std::vector<std::unique_ptr<Propagator>> bodies;
  std::vector<Eigen::MatrixXd> shapes;  ///< of the modes; empty in reduced coordinates
  std::vector<RunningContact> contacts;
  std::vector<std::vector<double>> forces;  ///< per body, at its slots
  std::string failure;

  // What no longer changes is not computed again.
  double loads_constant_from = 0.0;
  double drive_constant_from = 0.0;
  double end_displacement = 0.0;  ///< of the drive at drive_constant_from
  double end_velocity = 0.0;

  std::optional<EnergyLedger> ledger;
  std::vector<ContactAction> actions;   ///< of the ledger's step, per contact
  std::vector<double> slip_velocities;  ///< likewise

  ContactSolver solver{0};
  std::vector<LocalProblem> local;  ///< per contact

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

  void watch_segment(RunningContact& contact, int segment) {
    const MasterSurface& surface = surface_of(contact);
    contact.segment = segment;
    contact.undeformed = surface.undeformed_piece(segment);
    const Stencil& stencil = contact.undeformed.stencil;
    Propagator& master = *bodies[static_cast<std::size_t>(surface.body)];
    for (int k = 0; k < stencil.count; ++k) {
      const PointRows& rows = surface.rows[static_cast<std::size_t>(stencil.first + k)];
      master.watch(contact.master_slot + 2 * k, rows.x);
      master.watch(contact.master_slot + 2 * k + 1, rows.y);
    }
  }

  /// Slave and master with the displacements given by the slots, as seen from the undeformed T1:
  /// far from the origin the gap would drown in the rounding of the positions.
  struct Place {
    Eigen::Vector2d slave;
    SurfacePiece master;

    /// From the point of the master under the slave to the slave.
    Eigen::Vector2d arm(const Projection& projection) const {
      return slave - master.combine(projection.weights);
    }
  };
  template <class SlotDisplacement>
  Place place_of(const RunningContact& contact, double drive_at,
                 SlotDisplacement displacement) const {
    const MasterSurface& surface = surface_of(contact);
    const Propagator& slave = *bodies[static_cast<std::size_t>(contact.point.slave_body)];
    const Propagator& master = *bodies[static_cast<std::size_t>(surface.body)];
    const SurfacePiece& undeformed = contact.undeformed;
    const auto moved = [&](const Propagator& body, int slot) -> Eigen::Vector2d {
      return {displacement(body, slot), displacement(body, slot + 1)};
    };
    Place place;
    place.slave =
        contact.point.slave_position - origin_of(contact) + moved(slave, contact.slave_slot);
    place.slave.x() += relative_drive(contact, drive_at);
    place.master.stencil = undeformed.stencil;
    for (int k = 0; k < undeformed.stencil.count; ++k) {
      const auto node = static_cast<std::size_t>(k);
      place.master.nodes[node] =
          undeformed.nodes[node] + moved(master, contact.master_slot + 2 * k);
    }
    return place;
  }
  /// The undeformed T1.
  const Eigen::Vector2d& origin_of(const RunningContact& contact) const {
    return surface_of(contact).positions[static_cast<std::size_t>(contact.segment)];
  }
  /// How far the drive has moved the slave against the master in +x, m; or how fast, m/s.
  static double relative_drive(const RunningContact& contact, double drive_at) {
    return (contact.slave_follows_drive ? drive_at : 0.0) -
           (contact.master_follows_drive ? drive_at : 0.0);
  }
  /// Place::arm() of the positions predicted without contact forces.
  Eigen::Vector2d unloaded_arm(const RunningContact& contact, double drive_at) const {
    const Propagator& slave = *bodies[static_cast<std::size_t>(contact.point.slave_body)];
    const Propagator& master = *bodies[static_cast<std::size_t>(surface_of(contact).body)];
    const auto moved = [](const Propagator& body, int slot) -> Eigen::Vector2d {
      return {body.predicted(slot), body.predicted(slot + 1)};
    };
    Eigen::Vector2d arm =
        contact.point.slave_position - origin_of(contact) + moved(slave, contact.slave_slot);
    arm.x() += relative_drive(contact, drive_at);
    for (int k = 0; k < contact.undeformed.stencil.count; ++k) {
      const auto node = static_cast<std::size_t>(k);
      arm -= contact.projection.weights[node] *
             (contact.undeformed.nodes[node] + moved(master, contact.master_slot + 2 * k));
    }
    return arm;
  }
  /// Predicted, with what the modes left out are expected to add.
  Place expected_place(const RunningContact& contact, double drive_at) const {
    return place_of(contact, drive_at,
                    [](const Propagator& body, int slot) { return body.expected(slot); });
  }

  Projection projection_of(const RunningContact& contact, const Place& place,
                           double drive_at) const {
    const ContactAssumption assumption = contact.point.assumption;
    const double guess = contact.projection.xi;
    if (assumption == ContactAssumption::subs_b || assumption == ContactAssumption::film) {
      return project(place.master, place.slave, guess);
    }
    if (assumption == ContactAssumption::subs_c) {
      return project_along(place.master, place.slave, contact.undeformed, guess);
    }
    const Eigen::Vector2d driven(relative_drive(contact, drive_at), 0.0);
    return project(contact.undeformed, contact.point.slave_position - origin_of(contact) + driven,
                   guess);
  }

  /// Finds the segment under the slave point and the projection on it. Starts from the segment of
  /// the last step and never turns back: on a sagging polyline the projections on two neighbours
  /// can both point at each other. @returns false where the slave has left the end of the surface.
  bool find_projection(RunningContact& contact, double drive_at, Place& place) {
    const int last = surface_of(contact).num_segments() - 1;
    int heading = 0;
    while (true) {
      place = expected_place(contact, drive_at);
      contact.projection = projection_of(contact, place, drive_at);
      const double xi = contact.projection.xi;
      const int wanted = xi > 1.0 ? 1 : xi < 0.0 ? -1 : 0;
      if (wanted == 0 || wanted == -heading) return true;
      const int next = contact.segment + wanted;
      if (next < 0 || next > last) return surface_of(contact).is_endless;
      watch_segment(contact, next);
      contact.projection.xi -= wanted;
      heading = wanted;
    }
  }

  /// Takes projection, material point and slip velocity from the motion at the present time.
  void stand(RunningContact& contact) {
    const double now = time(index);
    const auto current = [](const Propagator& body, int slot) { return body.current(slot); };
    const Place place = place_of(contact, drive_displacement(now), current);
    contact.projection = projection_of(contact, place, drive_displacement(now));
    contact.anchor = place_along(contact, place);
    update_slip_velocity(contact, sliding_velocity(now));
  }

  /// Where the slave stands along the undeformed master, as far as slip is concerned: the
  /// projection itself; under Subs-a, whose projection is prescribed, that and the displacements
  /// along it.
  double place_along(const RunningContact& contact, const Place& place) const {
    const Projection& p = contact.projection;
    double along = surface_of(contact).arc_at(contact.segment, p.weights);
    if (contact.point.assumption == ContactAssumption::subs_a) along += p.tangent.dot(place.arm(p));
    return along;
  }

  /// Where and in which directions the force at t_n acts: there and then, or, as published, as if
  /// at t_{n+1}. On a new segment the force stands a hair outside its end.
  void find_action(RunningContact& contact, const Projection& here, int segment) {
    if (integrator == Integrator::central_difference) {
      contact.acting = contact.projection;
      return;
    }
    contact.acting = here;
    if (contact.segment == segment) return;
    const auto& arc = surface_of(contact).arc_length;
    const auto length = [&](int of) {
      return arc[static_cast<std::size_t>(of) + 1] - arc[static_cast<std::size_t>(of)];
    };
    const double at = arc[static_cast<std::size_t>(segment)] + here.xi * length(segment);
    contact.acting.xi =
        (at - arc[static_cast<std::size_t>(contact.segment)]) / length(contact.segment);
    contact.acting.weights = weights_at(contact.undeformed.stencil, contact.acting.xi).value;
  }

  /// Poses the problem of one contact for the step to t_{n+1}. @returns false where it has left its
  /// master
  bool pose(RunningContact& contact, LocalProblem& problem, double drive_at, double rise) {
    const int segment = contact.segment;
    Projection here;
    if (integrator != Integrator::central_difference) {
      const double drive_now = drive_displacement(time(index));
      const auto current = [](const Propagator& body, int slot) { return body.current(slot); };
      here = projection_of(contact, place_of(contact, drive_now, current), drive_now);
    }
    Place place;
    if (!find_projection(contact, drive_at, place)) return false;
    find_action(contact, here, segment);
    const Projection& p = contact.projection;
    // Gap and slip are those without the contact forces; what these do to the modes left out is
    // part of the Delassus operator.
    const Eigen::Vector2d arm = place.arm(p);
    const Eigen::Vector2d unloaded = has_residual ? unloaded_arm(contact, drive_at) : arm;
    problem.penetration =
        surface_of(contact).roughness_at(contact.segment, p.weights) - p.normal.dot(unloaded);
    problem.sliding_friction =
        rise * sliding_friction(contact.point.friction, contact.slip_velocity);
    problem.direction = contact.slip_velocity < 0.0 ? -1.0 : 1.0;
    problem.is_unilateral = time(index) >= contact.unilateral_from;
    if (!contact.tracks_slip) return true;
    contact.place = place_along(contact, place);
    const auto slopes = weights_at(contact.undeformed.stencil, p.xi).slope;
    contact.stretch = p.tangent.dot(place.master.combine(slopes)) /
                      surface_of(contact).arc_slope(contact.segment, slopes);
    if (drive.is_frozen) {
      // Held in place, the material of the master slides away below.
      const double velocity =
          0.5 * (sliding_velocity(time(index)) + sliding_velocity(time(index + 1)));
      contact.anchor -= p.tangent.x() * relative_drive(contact, velocity * step);
    }
    problem.slip = (contact.place - contact.anchor) * contact.stretch;
    if (has_residual) problem.slip -= p.tangent.dot(arm - unloaded);
    // A contact that stuck is held by the static limit; one whose sliding would turn round in this
    // step passes through rest on the way.
    const bool may_rest =
        contact.state == ContactState::stick || problem.slip * problem.direction <= 0.0;
    // Never below the friction of sliding, or that would turn the sliding round and drive it.
    problem.sticking_friction = problem.sliding_friction;
    if (may_rest) {
      problem.sticking_friction =
          std::max(problem.sticking_friction, rise * contact.point.friction.static_coefficient);
    }
    return true;
  }

  /// Sets the bodies moving and finds the first contact forces. Where the first step depends on how
  /// long these have acted, both are found in turn.
  void start(const System& system, const TimeParameters& time_parameters) {
    constexpr int most_turns = 100;
    std::vector<std::vector<double>> last;
    for (int turn = 0; turn < most_turns; ++turn) {
      for (std::size_t b = 0; b < bodies.size(); ++b)
        start_motion(*bodies[b], system.bodies[b], time_parameters, forces[b].data());
      for (RunningContact& contact : contacts) {
        contact.statistics = {};
        contact.violations = {};
        contact.state = ContactState::open;
        stand(contact);
      }
      if (solve() != StepOutcome::done) throw NumericalError(failure);
      if (time_parameters.integrator == Integrator::central_difference || forces == last) return;
      last = forces;
    }
  }

  /// Contact forces at t_n: those that make gap and slip at t_{n+1} what the contacts allow.
  StepOutcome solve() {
    const double drive_at = drive_displacement(time(index + 1));
    for (std::size_t i = 0; i < contacts.size(); ++i) {
      RunningContact& contact = contacts[i];
      const double rise = contact.point.friction_rise.value(
          time(integrator == Integrator::central_difference ? index + 1 : index));
      if (!pose(contact, local[i], drive_at, rise)) return fail(contact, StepOutcome::master_lost);
    }
    for (std::size_t i = 0; i < contacts.size(); ++i) {
      for (std::size_t j = 0; j < contacts.size(); ++j) fill_delassus(i, j);
    }
    const ContactAnswer answer = solver.solve(local);
    if (answer.status != ContactStatus::converged) {
      RunningContact& contact = contacts[static_cast<std::size_t>(answer.contact)];
      const LocalProblem& problem = local[static_cast<std::size_t>(answer.contact)];
      contact.friction = problem.sliding_friction;
      contact.force = problem.normal;
      if (!std::isfinite(problem.penetration)) {
        contact.force = problem.penetration;
        return fail(contact, StepOutcome::diverged);
      }
      return fail(contact, answer.status == ContactStatus::jammed ? StepOutcome::jammed
                                                                  : StepOutcome::not_converged);
    }

    StepOutcome outcome = StepOutcome::done;
    for (std::size_t i = 0; i < contacts.size(); ++i) {
      RunningContact& contact = contacts[i];
      contact.force = local[i].normal;
      contact.friction_force = local[i].tangential;
      contact.state = local[i].state;
      if (!(std::abs(contact.force) < absurd_force)) return fail(contact, StepOutcome::diverged);
      count(contact);
      if (contact.tracks_slip) move_anchor(contact, i);
      if (local[i].is_unilateral) {
        note_unilateral(contact);
      } else if (contact.force < 0.0 && !tolerate(contact, contact.violations.negative_force)) {
        outcome = fail(contact, StepOutcome::pulling);
      }
      apply_forces(contact);
    }
    return outcome;
  }

  static void count(RunningContact& contact) {
    ContactStatistics& statistics = contact.statistics;
    statistics.force_min = std::min(statistics.force_min, contact.force);
    statistics.force_max = std::max(statistics.force_max, contact.force);
    ++statistics.steps;
    if (contact.state == ContactState::stick) ++statistics.sticking;
    if (contact.state == ContactState::open) ++statistics.open;
  }

  /// The material point of a contact that does not stick moves with its corrected slip.
  void move_anchor(RunningContact& contact, std::size_t i) {
    if (contact.state == ContactState::stick) return;
    double slip = local[i].slip;
    const auto row = static_cast<Eigen::Index>(2 * i + 1);
    for (std::size_t j = 0; j < contacts.size(); ++j) {
      const auto column = static_cast<Eigen::Index>(2 * j);
      slip -= solver.delassus()(row, column) * local[j].normal +
              solver.delassus()(row, column + 1) * local[j].tangential;
    }
    contact.anchor += slip / contact.stretch;
  }

  /// Counts what persistent sliding would not have allowed, where it had been assumed.
  void note_unilateral(RunningContact& contact) {
    if (contact.point.assumption == ContactAssumption::film) return;
    if (contact.state == ContactState::open) note(contact, contact.violations.negative_force);
    if (contact.state == ContactState::stick) note(contact, contact.violations.reversed_sliding);
  }

  void apply_forces(const RunningContact& contact) {
    const Projection& p = contact.acting;
    const Eigen::Vector2d force = contact.force * p.normal - contact.friction_force * p.tangent;
    double* slave =
        forces[static_cast<std::size_t>(contact.point.slave_body)].data() + contact.slave_slot;
    double* master =
        forces[static_cast<std::size_t>(surface_of(contact).body)].data() + contact.master_slot;
    slave[0] = force.x();
    slave[1] = force.y();
    for (int k = 0; k < contact.undeformed.stencil.count; ++k) {
      const double weight = p.weights[static_cast<std::size_t>(k)];
      master[2 * k] = -weight * force.x();
      master[2 * k + 1] = -weight * force.y();
    }
  }

  /// Displacement of the slave of contact i relative to its master per force (x, y) on the slave of
  /// contact j and against its master.
  Eigen::Matrix2d relative_compliance(const RunningContact& i, const RunningContact& j) const {
    const int master_i = surface_of(i).body;
    const int master_j = surface_of(j).body;
    const auto block = [](const Propagator& body, int slot_a, int slot_b) {
      const auto stride = static_cast<std::size_t>(body.num_slots());
      const double* c = body.compliances() + static_cast<std::size_t>(slot_a) * stride + slot_b;
      Eigen::Matrix2d w;
      w << c[0], c[1], c[stride], c[stride + 1];
      return w;
    };
    const double* const weights_i = i.projection.weights.data();
    const double* const weights_j = j.acting.weights.data();
    const int nodes_i = i.undeformed.stencil.count;
    const int nodes_j = j.undeformed.stencil.count;
    Eigen::Matrix2d w = Eigen::Matrix2d::Zero();
    if (i.point.slave_body == j.point.slave_body) {
      w += block(*bodies[static_cast<std::size_t>(i.point.slave_body)], i.slave_slot, j.slave_slot);
    }
    if (master_i == master_j) {
      const Propagator& master = *bodies[static_cast<std::size_t>(master_i)];
      for (int a = 0; a < nodes_i; ++a) {
        for (int b = 0; b < nodes_j; ++b) {
          w += weights_i[a] * weights_j[b] *
               block(master, i.master_slot + 2 * a, j.master_slot + 2 * b);
        }
      }
    }
    if (i.point.slave_body == master_j) {
      const Propagator& body = *bodies[static_cast<std::size_t>(master_j)];
      for (int b = 0; b < nodes_j; ++b)
        w -= weights_j[b] * block(body, i.slave_slot, j.master_slot + 2 * b);
    }
    if (master_i == j.point.slave_body) {
      const Propagator& body = *bodies[static_cast<std::size_t>(master_i)];
      for (int a = 0; a < nodes_i; ++a)
        w -= weights_i[a] * block(body, i.master_slot + 2 * a, j.slave_slot);
    }
    return w;
  }

  /// Rows n and t of contact i against columns n and t of contact j: b_i W b_jᵀ with b_n = −n and
  /// b_t = t on the slave.
  void fill_delassus(std::size_t i, std::size_t j) {
    const Eigen::Matrix2d w = relative_compliance(contacts[i], contacts[j]);
    const Projection& p = contacts[i].projection;
    const Projection& q = contacts[j].acting;
    const Eigen::Vector2d wn = w * q.normal;
    const Eigen::Vector2d wt = w * q.tangent;
    const auto row = static_cast<Eigen::Index>(2 * i);
    const auto column = static_cast<Eigen::Index>(2 * j);
    Eigen::MatrixXd& delassus = solver.delassus();
    delassus(row, column) = p.normal.dot(wn);
    delassus(row, column + 1) = -p.normal.dot(wt);
    delassus(row + 1, column) = -p.tangent.dot(wn);
    delassus(row + 1, column + 1) = p.tangent.dot(wt);
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
      const double driven = update_slip_velocity(contact, drive_velocity);
      if (contact.slip_velocity * driven < 0.0 && next_time < contact.unilateral_from &&
          !tolerate(contact, contact.violations.reversed_sliding)) {
        outcome = fail(contact, StepOutcome::sliding_reversed);
      }
    }
    return outcome;
  }

  /// `advance` with an entry in the ledger.
  StepOutcome advance_on_account() {
    const double acting_at = time(index);
    for (std::size_t b = 0; b < bodies.size(); ++b) {
      const auto body = static_cast<int>(b);
      bodies[b]->foresee(forces[b].data(), ledger->position(body), ledger->increment(body));
    }
    const StepOutcome outcome = advance();
    // What the contacts have done stands until they are solved anew.
    for (std::size_t i = 0; i < contacts.size(); ++i) {
      actions[i] = action_of(contacts[i]);
      slip_velocities[i] = contacts[i].slip_velocity;
    }
    ledger->add(acting_at, actions, slip_velocities);
    return outcome;
  }

  static ContactAction action_of(const RunningContact& contact) {
    return {contact.segment, contact.acting, contact.force, contact.friction_force, contact.state};
  }

  /// t·(v_C − v_M) from the increments of the last step. @returns the drive's part of it
  double update_slip_velocity(RunningContact& contact, double drive_velocity) const {
    const Projection& p = contact.projection;
    const double* c = bodies[static_cast<std::size_t>(contact.point.slave_body)]->increments() +
                      contact.slave_slot;
    const double* m = bodies[static_cast<std::size_t>(surface_of(contact).body)]->increments() +
                      contact.master_slot;
    double x = c[0];
    double y = c[1];
    for (int k = 0; k < contact.undeformed.stencil.count; ++k) {
      const double weight = p.weights[static_cast<std::size_t>(k)];
      x -= weight * m[2 * k];
      y -= weight * m[2 * k + 1];
    }
    const double driven = relative_drive(contact, drive_velocity) * p.tangent.x();
    contact.slip_velocity = (p.tangent.x() * x + p.tangent.y() * y) / step + driven;
    return driven;
  }

  void note(RunningContact& contact, std::int64_t& counter) {
    ++counter;
    contact.violations.last_time = time(index);
  }

  /// Counts a violation of persistent sliding; false where the contact is armed.
  bool tolerate(RunningContact& contact, std::int64_t& counter) {
    note(contact, counter);
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
      case StepOutcome::not_converged:
        what = fmt::format(
            "the contact forces have not settled in the sweeps allowed (force {:.6g} N)",
            contact.force);
        remedy = "take a smaller time.step, or let time.contact_sweeps be larger";
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
    return surface_of(contact).arc_at(contact.segment, contact.projection.weights);
  }
};

Simulation::Simulation(const System& given, const TimeParameters& time, Accounts accounts)
    : implementation_(std::make_unique<Implementation>()) {
  if (time.coordinates != Coordinates::modal &&
      (time.integrator == Integrator::exact || time.retain)) {
    throw ConfigError("time.coordinates", "integrator: exact and retain take coordinates: modal");
  }
  if (time.integrator == Integrator::exact && accounts == Accounts::energy) {
    throw ConfigError("record.energy",
                      "the energy ledger takes time.integrator: central_difference");
  }
  const System system = retained(given, time);
  const StepLimit limit = step_limit(system);
  if (time.integrator == Integrator::central_difference && !(time.step <= limit.step)) {
    throw ConfigError(
        "time.step",
        fmt::format(
            "{:.6g} s is above the largest stable step {:.6g} s of the central difference, set by "
            "the highest mode of '{}'; take at most that, or integrator: exact, which has no such "
            "limit",
            time.step, limit.step, limit.body));
  }
  Implementation& run = *implementation_;
  run.surfaces = system.surfaces;
  run.drive = system.drive;
  run.step = time.step;
  run.integrator = time.integrator;
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
    num_slots[master] +=
        2 * system.surfaces[static_cast<std::size_t>(point.surface)].stencil_size();
    contact.slave_follows_drive = system.bodies[slave].follows_drive;
    contact.master_follows_drive = system.bodies[master].follows_drive;
    contact.unilateral_from = point.unilateral_from();
    contact.tracks_slip = contact.unilateral_from < std::numeric_limits<double>::infinity();
    run.contacts.push_back(contact);
  }
  const double loads[] = {system.drive.load.value(0.0), system.drive.acceleration(0.0)};
  for (std::size_t b = 0; b < system.bodies.size(); ++b) {
    const SystemBody& body = system.bodies[b];
    run.bodies.push_back(make_propagator(
        body, time, num_slots[b],
        body.follows_drive ? std::span<const double>(loads) : std::span<const double>()));
    const bool is_modal = time.coordinates == Coordinates::modal;
    run.shapes.push_back(is_modal ? body.modal.shapes : Eigen::MatrixXd());
    run.follows_drive.push_back(body.follows_drive);
    run.damping.push_back(body.modal.damping);
    run.has_residual = run.has_residual || body.modal.residual.num_modes > 0;
    run.forces.emplace_back(static_cast<std::size_t>(num_slots[b]), 0.0);
  }
  run.solver = ContactSolver(static_cast<int>(run.contacts.size()),
                             {time.contact_tolerance, static_cast<int>(time.contact_sweeps)});
  run.local.resize(run.contacts.size());
  if (accounts == Accounts::energy) {
    run.ledger.emplace(system, time);
    run.actions.resize(run.contacts.size());
    run.slip_velocities.resize(run.contacts.size());
  }
  for (RunningContact& contact : run.contacts) {
    Propagator& slave = *run.bodies[static_cast<std::size_t>(contact.point.slave_body)];
    slave.watch(contact.slave_slot, contact.point.slave_rows.x);
    slave.watch(contact.slave_slot + 1, contact.point.slave_rows.y);
    run.watch_segment(contact, contact.point.first_segment);
  }
  run.start(system, time);
}

Simulation::~Simulation() = default;
Simulation::Simulation(Simulation&&) noexcept = default;
Simulation& Simulation::operator=(Simulation&&) noexcept = default;

StepOutcome Simulation::step() {
  Implementation& run = *implementation_;
  const StepOutcome outcome = run.ledger ? run.advance_on_account() : run.advance();
  return outcome == StepOutcome::done ? run.solve() : outcome;
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

Propagator::Motion Simulation::motion(int body) const {
  const auto b = static_cast<std::size_t>(body);
  return implementation_->bodies[b]->motion(implementation_->forces[b].data());
}

Propagator::Motion Simulation::reduced_motion(int body) const {
  const auto b = static_cast<std::size_t>(body);
  Propagator::Motion motion = this->motion(body);
  const Eigen::MatrixXd& shapes = implementation_->shapes[b];
  if (shapes.size() == 0) return motion;
  motion.displacement = shapes * motion.displacement;
  motion.velocity = shapes * motion.velocity;
  const Eigen::VectorXd residual = implementation_->bodies[b]->residual_displacement();
  if (residual.size() > 0) motion.displacement += residual;
  return motion;
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

double Simulation::friction_force(int contact) const {
  return implementation_->contacts[static_cast<std::size_t>(contact)].friction_force;
}

ContactState Simulation::contact_state(int contact) const {
  return implementation_->contacts[static_cast<std::size_t>(contact)].state;
}

ContactAction Simulation::contact_action(int contact) const {
  return Implementation::action_of(implementation_->contacts[static_cast<std::size_t>(contact)]);
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
  const Projection here = project(place.master, place.slave, contact.projection.xi);
  const MasterSurface& surface = run.surface_of(contact);
  return {here.normal.dot(place.arm(here)) - surface.roughness_at(contact.segment, here.weights),
          surface.arc_at(contact.segment, here.weights)};
}

const ViolationCount& Simulation::violations(int contact) const {
  return implementation_->contacts[static_cast<std::size_t>(contact)].violations;
}

const ContactStatistics& Simulation::statistics(int contact) const {
  return implementation_->contacts[static_cast<std::size_t>(contact)].statistics;
}

void Simulation::reset_statistics() {
  for (RunningContact& contact : implementation_->contacts) {
    contact.statistics = {};
    Implementation::count(contact);
  }
}

const EnergyLedger* Simulation::energy() const {
  return implementation_->ledger ? &*implementation_->ledger : nullptr;
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
                             c.force,
                             c.friction_force,
                             static_cast<double>(c.state),
                             c.slip_velocity,
                             c.anchor,
                             c.statistics.force_min,
                             c.statistics.force_max,
                             static_cast<double>(c.statistics.steps),
                             static_cast<double>(c.statistics.sticking),
                             static_cast<double>(c.statistics.open),
                             static_cast<double>(c.violations.negative_force),
                             static_cast<double>(c.violations.reversed_sliding),
                             static_cast<double>(c.violations.before_armed),
                             c.violations.last_time};
    state.put(fmt::format("contacts/{}", i), values);
    const double acting[] = {c.acting.xi, c.acting.tangent.x(), c.acting.tangent.y(),
                             c.acting.normal.x(), c.acting.normal.y()};
    state.put(fmt::format("contacts/{}/acting", i), acting);
  }
  if (run.ledger) run.ledger->save(state, "energy/");
  return state;
}

void Simulation::load(const State& state) {
  Implementation& run = *implementation_;
  if (state.get("step") != run.step)
    throw std::invalid_argument("Simulation::load: the state has another time step");
  run.index = static_cast<std::int64_t>(state.get("index"));
  run.set_loads(run.time(run.index));
  for (std::size_t b = 0; b < run.bodies.size(); ++b) {
    const std::string prefix = fmt::format("bodies/{}/", b);
    run.bodies[b]->set_mass_damping(run.damping[b].alpha_at(run.time(run.index)));
    run.bodies[b]->load(state, prefix);
    state.get(prefix + "forces", run.forces[b]);
  }
  for (std::size_t i = 0; i < run.contacts.size(); ++i) {
    RunningContact& c = run.contacts[i];
    double values[20];
    state.get(fmt::format("contacts/{}", i), values);
    const auto count = [&](int k) { return static_cast<std::int64_t>(values[k]); };
    c.segment = static_cast<int>(values[0]);
    c.undeformed = run.surface_of(c).undeformed_piece(c.segment);
    c.projection = {values[1],
                    {values[2], values[3]},
                    {values[4], values[5]},
                    weights_at(c.undeformed.stencil, values[1]).value};
    double acting[5];
    state.get(fmt::format("contacts/{}/acting", i), acting);
    c.acting = {acting[0],
                {acting[1], acting[2]},
                {acting[3], acting[4]},
                weights_at(c.undeformed.stencil, acting[0]).value};
    c.force = values[6];
    c.friction_force = values[7];
    c.state = static_cast<ContactState>(count(8));
    c.slip_velocity = values[9];
    c.anchor = values[10];
    c.statistics = {values[11], values[12], count(13), count(14), count(15)};
    c.violations = {count(16), count(17), count(18), values[19]};
    // The guess that the next step starts from.
    run.local[i].normal = c.force;
    run.local[i].tangential = c.friction_force;
    run.local[i].state = c.state;
  }
  if (run.ledger) run.ledger->load(state, "energy/");
}

}  // namespace stridor
