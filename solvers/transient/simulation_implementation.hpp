// The state of a simulation and its changes in a step; for simulation.cpp and the sources that
// step several simulations simultaneously.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/errors.hpp"
#include "solvers/contact/contact_record.hpp"
#include "solvers/contact/face_contacts.hpp"
#include "solvers/contact/sliding_point.hpp"
#include "solvers/contact/substrate_step.hpp"
#include "solvers/integrators/make_propagator.hpp"
#include "solvers/transient/simulation.hpp"

namespace stridor {

/// No contact of a computable scene carries this; beyond it the numbers have run away.
inline constexpr double absurd_force = 1e30;
/// Likewise the sum of the squares of all motions, in SI units.
inline constexpr double absurd_motion = 1e30;
/// Steps between looks at the motion of the bodies: a thousandth of the cost of a step.
inline constexpr std::int64_t health_interval = 1024;
inline constexpr const char* persistent_sliding_remedy =
    "the assumption of persistent sliding no longer holds from here on; let the contact stick and "
    "lift off (contact.assumption: film, or contact.on_violation: unilateral), lower the friction "
    "coefficient, or raise contact.armed_from if this is start-up";
inline constexpr int slave_ports = 2;
/// A contact is steady after this many steps without a change: by then the transient of the forces
/// after the change has decayed to a hundredth or less (docs/theory.md, 3.5).
inline constexpr int steady_after = 6;

/// A contact with one tangent while it runs.
struct RunningContact : ContactRecord {
  explicit RunningContact(SlidingPoint point) : sliding(std::move(point)) {}

  SlidingPoint sliding;
  DrivenMotion driven;         ///< of the slave against the master
  bool tracks_slip = false;    ///< it is unilateral or may become so, or its friction is a function
                               ///< of the slip in the step

  // State.
  /// Place on the master, along its undeformed surface, that the slave was over at the end of the
  /// last step; the material point that a sticking contact keeps.
  double anchor = 0.0;

  // Scratch of one step.
  double indentation = 0.0;        ///< in a substrate, likewise, m
  double stiffness_in_step = 0.0;  ///< k W of a substrate, likewise
  double stretch = 1.0;            ///< SlidingPoint::stretch()

  const ContactPoint& point() const { return sliding.point(); }
  double rise_at(double time) const {
    return time < constant_from ? point().friction_rise.value(time) : rise;
  }
};

struct Simulation::Implementation {
  std::vector<MasterSurface> surfaces;
  std::vector<FacetSurface> facet_surfaces;
  std::vector<std::string> names;  ///< of the bodies
  std::vector<BodyLoading> loading;  ///< of the bodies
  std::vector<RayleighDamping> damping;
  std::vector<Drive> drives;
  std::vector<DrivenMotion> driven_by;  ///< of what follows each drive
  double step;
  std::int64_t next_health_check = 0;
  bool has_feedthrough = false;  ///< bodies have direct feedthrough (Propagator::has_feedthrough)
  bool is_predicting_start = false;
  bool slides_only = true;  ///< no contact tracks its slip, none is on a face
  std::int64_t index = 0;
  std::vector<std::unique_ptr<Propagator>> bodies;
  std::vector<std::unique_ptr<NodePorts>> nodes;  ///< of the bodies with contacts on facets, or null
  std::vector<Eigen::MatrixXd> shapes;  ///< of the modes; empty in reduced coordinates
  std::vector<RunningContact> contacts;  ///< with one tangent
  RunningFaces faces;
  std::vector<ContactRecord*> records;  ///< of all contacts, in the order of the system
  std::vector<std::vector<double>> forces;  ///< per body, at its ports
  std::string failure;
  Refusal refusal = Refusal::diverged;  ///< kind of `failure`

  // Quantities that no longer change are not computed again.
  double loads_constant_from = 0.0;

  std::optional<EnergyLedger> ledger;
  std::vector<ContactAction> actions;   ///< of the ledger's step, per contact
  std::vector<double> slip_velocities;  ///< likewise

  ContactSolver solver{0};
  std::vector<LocalProblem> local;  ///< per contact with one tangent
  std::vector<std::array<PortBlock, 2>> line_blocks;  ///< scratch, of these
  std::vector<char> line_looks_ahead;                 ///< likewise

  /// A contact by its index in the system: null where it is of the other kind.
  const RunningContact* line(int contact) const {
    const ContactRecord* const record = records[static_cast<std::size_t>(contact)];
    for (const RunningContact& one : contacts)
      if (&one == record) return &one;
    return nullptr;
  }
  const RunningFace* on_face(int contact) const {
    const ContactRecord* const record = records[static_cast<std::size_t>(contact)];
    for (std::size_t i = 0; i < faces.size(); ++i)
      if (&faces[i] == record) return &faces[i];
    return nullptr;
  }

  double time(std::int64_t at_index) const { return static_cast<double>(at_index) * step; }
  /// Step at which gap and slip satisfy the contact conditions.
  std::int64_t sought_index() const { return index + (has_feedthrough && !is_predicting_start ? 0 : 1); }

  /// Displacement in +x of the slave of a contact against its master by drives, m.
  double driven(const RunningContact& contact, std::int64_t at_index) const {
    return contact.driven.displacement(time(at_index));
  }

  /// Sliding distance of a contact by drives in the step from an instant on, m, frozen or not.
  double drawn_in_step(const RunningContact& contact, std::int64_t from) const {
    return 0.5 * step *
           (contact.driven.velocity(time(from)) + contact.driven.velocity(time(from + 1)));
  }

  void set_loads(double at) {
    for (std::size_t b = 0; b < bodies.size(); ++b) {
      if (loading[b].is_any()) bodies[b]->set_loads(loading[b].amplitudes(drives, at));
    }
  }

  std::span<double> forces_on(int body) { return forces[static_cast<std::size_t>(body)]; }

  /// Adds the contacts of a system. Their ports follow each other on every body.
  void add_contacts(const System& system) {
    std::vector<int> next_port(bodies.size(), 0);
    nodes.resize(bodies.size());
    std::vector<std::size_t> place;  // among those of its kind
    for (const ContactPoint& point : system.contacts) {
      if (point.has_two_tangents()) {
        place.push_back(faces.size());
        add_face(system, point, next_port);
        continue;
      }
      place.push_back(contacts.size());
      const MasterSurface& surface = surfaces[static_cast<std::size_t>(point.surface)];
      const auto slave = static_cast<std::size_t>(point.slave_body);
      const auto master = static_cast<std::size_t>(surface.body);
      const int slave_port = next_port[slave];
      next_port[slave] += slave_ports;
      const int master_port = next_port[master];
      next_port[master] += 2 * surface.stencil_size();
      RunningContact contact(
          SlidingPoint(point, surface, *bodies[slave], *bodies[master], slave_port, master_port));
      contact.driven = system.driven_motion(point);
      contact.begin(point);
      contact.tracks_slip = contact.unilateral_from < std::numeric_limits<double>::infinity() ||
                            point.friction.is_regularised();
      slides_only = slides_only && !contact.tracks_slip;
      contacts.push_back(std::move(contact));
    }
    slides_only = slides_only && faces.empty();
    fit_forces();
    for (std::size_t i = 0; i < place.size(); ++i) {
      if (system.contacts[i].has_two_tangents()) {
        records.push_back(&faces[place[i]]);
      } else {
        records.push_back(&contacts[place[i]]);
      }
    }
  }

  void add_face(const System& system, const ContactPoint& point, std::vector<int>& next_port) {
    const auto slave = static_cast<std::size_t>(point.slave_body);
    const auto master = static_cast<std::size_t>(system.master_of(point));
    const int slave_port = next_port[slave];
    next_port[slave] += point.num_slave_ports();
    if (point.face) {
      const int master_port = next_port[master];
      next_port[master] += system.num_master_ports(point);
      faces.add(make_spinning_point(point, *bodies[slave], *bodies[master], slave_port, master_port),
                *bodies[slave], *bodies[master]);
    } else {
      const bool is_on_facets = point.space->surface >= 0;
      const FacetSurface* const surface =
          is_on_facets ? &facet_surfaces[static_cast<std::size_t>(point.space->surface)] : nullptr;
      if (is_on_facets && nodes[master] == nullptr)
        nodes[master] = std::make_unique<NodePorts>(*bodies[master]);
      faces.add(make_space_point(point, surface, nodes[master].get(), system.driven_motion(point),
                                 *bodies[slave], *bodies[master], slave_port),
                *bodies[slave], *bodies[master]);
    }
    faces[faces.size() - 1].master = static_cast<int>(master);
  }

  /// Forces on the ports that there are now.
  void fit_forces() {
    for (std::size_t b = 0; b < bodies.size(); ++b)
      forces[b].resize(static_cast<std::size_t>(bodies[b]->num_ports()), 0.0);
  }

  /// Takes projection, material point and slip velocity from the motion at the present time.
  void stand(RunningContact& contact) {
    contact.sliding.stand(driven(contact, index));
    contact.anchor = contact.sliding.place();
    update_slip_velocity(contact, contact.driven.velocity(time(index)));
  }

  /// Poses the problem of one contact for its forces at t_n. @returns false where it has left its
  /// master
  [[gnu::always_inline]] bool pose(RunningContact& contact, LocalProblem& problem, double sought_time, double rise) {
    SlidingPoint& sliding = contact.sliding;
    const double driven_to = contact.driven.displacement(sought_time);
    if (!sliding.find(driven_to)) return false;
    // Gap and slip are those without the contact forces; the instantaneous response to these is
    // part of the Delassus operator.
    problem.penetration = sliding.roughness() - sliding.predicted_gap(driven_to);
    problem.sliding_friction =
        rise * sliding_friction(contact.point().friction, contact.slip_velocity);
    problem.direction = contact.slip_velocity < 0.0 ? -1.0 : 1.0;
    if (contact.tracks_slip) pose_slip(contact, problem, rise);
    return true;
  }

  /// Additional data for stick, lift-off and force laws.
  [[gnu::noinline]] void pose_slip(RunningContact& contact, LocalProblem& problem, double rise) {
    const SlidingPoint& sliding = contact.sliding;
    problem.is_unilateral = time(index) >= contact.unilateral_from;
    contact.predicts_ahead = false;
    contact.stretch = sliding.stretch();
    problem.last_slip = contact.slip_velocity;
    problem.step = step;
    if (contact.point().friction.is_regularised()) {
      problem.creep = &contact.point().friction;
      problem.friction_factor = rise;
    }
    if (const auto& substrate = contact.point().substrate) {
      problem.substrate = &*substrate;
      problem.indentation = -sliding.present_place(driven(contact, index)).gap;
    }
    if (contact.driven.is_frozen() && sought_index() > 0) {
      // Held in place, the material of the master slides away below.
      contact.anchor -= sliding.along_tangent(drawn_in_step(contact, sought_index() - 1));
    }
    problem.slip = (sliding.place() - contact.anchor) * contact.stretch;
    if (has_feedthrough) problem.slip += sliding.predicted_slip();
    set_sticking_friction(contact, problem, rise);
  }

  static void set_sticking_friction(const RunningContact& contact, LocalProblem& problem,
                                    double rise) {
    // A contact that stuck is held by the static limit; one whose sliding would turn round in this
    // step passes through rest on the way.
    const bool may_rest =
        contact.state == ContactState::stick || problem.slip * problem.direction <= 0.0;
    // Never below the friction of sliding, or that would turn the sliding round and drive it.
    problem.sticking_friction = problem.sliding_friction;
    if (may_rest) {
      problem.sticking_friction =
          std::max(problem.sticking_friction, rise * contact.point().friction.static_coefficient);
    }
  }

  /// Whether a contact with direct feedthrough is solved at t_{n+1} (docs/theory.md, 3.5): where it
  /// is open, or has recently closed or changed between stick and slip.
  bool is_unsteady(std::size_t i) const {
    return local[i].is_unilateral && contacts[i].steady_steps < steady_after;
  }

  /// Whether stick, slip or the direction of the slip are others than in the step before.
  bool has_changed(std::size_t i) const {
    return local[i].state != contacts[i].state ||
           (local[i].state == ContactState::slip &&
            local[i].tangential * contacts[i].friction_force < 0.0);
  }

  /// Poses the problem of one contact anew, with gap and slip at t_{n+1} under forces that are
  /// constant from t_n on.
  void pose_ahead(RunningContact& contact, LocalProblem& problem, double sought_time,
                  double rise) {
    contact.predicts_ahead = true;
    const SlidingPoint& sliding = contact.sliding;
    // A sticking contact keeps its material point, another one that of t_n, where the step begins.
    if (contact.state != ContactState::stick) contact.anchor = sliding.place();
    const double drawn = drawn_in_step(contact, index);
    problem.penetration =
        sliding.roughness() - sliding.gap_ahead(contact.driven.displacement(sought_time),
                                                contact.driven.is_frozen() ? 0.0 : drawn);
    problem.slip = (sliding.place() - contact.anchor) * contact.stretch + sliding.slip_ahead(drawn);
    set_sticking_friction(contact, problem, rise);
  }

  /// Solves the contacts as posed; those that are unsteady, or change, ahead.
  ContactAnswer solve_contacts(double sought_time) {
    if (slides_only) {
      fill_delassus();
      return solver.solve(local);
    }
    if (!has_feedthrough || is_predicting_start) return solve_posed();
    return solve_unsteady_contacts(sought_time);
  }

  /// Poses the problems of contacts with two tangents. @returns failure where a slave has left its master
  [[gnu::noinline]] StepOutcome pose_faces(double sought_time) {
    if (has_feedthrough && !is_predicting_start) find_answers_of_faces();
    const auto lost = faces.pose(instant(sought_time));
    fit_forces();
    return lost ? fail(faces[*lost], StepOutcome::master_lost) : StepOutcome::done;
  }

  /// The answers of the bodies to forces, where they are others than in the step before.
  void find_answers_of_faces() {
    bool has_any_changed = false;
    for (const auto& body : bodies) has_any_changed |= body->find_ahead_compliances();
    if (has_any_changed) {
      faces.find_answers(step);
    } else {
      faces.find_answers_on_new_facets(step);
    }
  }

  RunningFaces::Instant instant(double sought) const {
    return {time(index), sought, step, has_feedthrough && !is_predicting_start};
  }

  ContactAnswer solve_posed() {
    fill_delassus();
    if (faces.empty()) return solver.solve(local);
    line_blocks.clear();
    line_looks_ahead.clear();
    for (const RunningContact& contact : contacts) {
      line_blocks.push_back(contact.sliding.blocks());
      line_looks_ahead.push_back(contact.predicts_ahead ? 1 : 0);
    }
    faces.fill(solver, line_blocks, line_looks_ahead);
    return solver.solve(local, faces.problems());
  }

  [[gnu::noinline]] ContactAnswer solve_unsteady_contacts(double sought_time) {
    bool is_ahead = false;
    const auto look_ahead_with_bodies = [&] {
      if (!is_ahead) {
        for (const auto& body : bodies) body->predict_ahead();
      }
      is_ahead = true;
    };
    const auto predict_ahead = [&](std::size_t i) {
      look_ahead_with_bodies();
      pose_ahead(contacts[i], local[i], sought_time, contacts[i].rise_at(sought_time));
    };
    const auto look_ahead_on_face = [&](std::size_t i) {
      look_ahead_with_bodies();
      faces.pose_ahead(i, instant(sought_time));
    };
    for (std::size_t i = 0; i < contacts.size(); ++i) {
      if (is_unsteady(i)) predict_ahead(i);
    }
    for (std::size_t i = 0; i < faces.size(); ++i) {
      if (faces.is_unsteady(i)) look_ahead_on_face(i);
    }
    ContactAnswer answer = solve_posed();
    bool has_any_changed = false;
    for (std::size_t i = 0; i < faces.size(); ++i) {
      if (!faces.problems()[i].is_unilateral || faces[i].predicts_ahead || !faces.has_changed(i))
        continue;
      faces[i].steady_steps = 0;
      look_ahead_on_face(i);
      has_any_changed = true;
    }
    for (std::size_t i = 0; i < contacts.size(); ++i) {
      if (!local[i].is_unilateral || contacts[i].predicts_ahead || !has_changed(i)) continue;
      contacts[i].steady_steps = 0;
      predict_ahead(i);
      has_any_changed = true;
    }
    if (has_any_changed) answer = solve_posed();
    faces.count_steady();
    for (std::size_t i = 0; i < contacts.size(); ++i) {
      int& steady = contacts[i].steady_steps;
      if (local[i].state == ContactState::open || (contacts[i].predicts_ahead && has_changed(i))) {
        steady = 0;
      } else if (steady < steady_after) {
        ++steady;
      }
    }
    return answer;
  }

  /// Sets the bodies moving and finds the first contact forces.
  void start(const System& system, const TimeParameters& time_parameters) {
    const auto stand_and_solve = [&] {
      for (RunningContact& contact : contacts) {
        contact.forget();
        stand(contact);
      }
      const auto lost = faces.stand(system, instant(time(sought_index())));
      fit_forces();
      if (lost) {
        fail(faces[*lost], StepOutcome::master_lost);
        throw NumericalError(refusal, failure);
      }
      if (solve() != StepOutcome::done) throw NumericalError(refusal, failure);
    };
    const bool is_loaded = std::any_of(drives.begin(), drives.end(), [](const Drive& drive) {
      return drive.load.value(0.0) != 0.0 || drive.shift.value(0.0) != 0.0 ||
             drive.acceleration(0.0) != 0.0;
    });
    if (has_feedthrough && (is_loaded || !starts_at_rest(system))) {
      // The instantaneous part of the motion is known with the forces only.
      is_predicting_start = true;
      for (std::size_t b = 0; b < bodies.size(); ++b)
        predict_start(*bodies[b], system.bodies[b], time_parameters);
      stand_and_solve();
      is_predicting_start = false;
    }
    const auto set_moving = [&] {
      for (std::size_t b = 0; b < bodies.size(); ++b)
        start_motion(*bodies[b], system.bodies[b], time_parameters, forces[b].data());
    };
    set_moving();
    if (apply_substrates()) set_moving();
    stand_and_solve();
    // The forces at the start are now those of the springs at t_0, not of t_1.
    const bool has_springs = std::any_of(records.begin(), records.end(), [](const ContactRecord* one) {
      return one->compliance > 0.0;
    });
    if (has_feedthrough && !faces.empty() && has_springs) {
      set_moving();
      stand_and_solve();
    }
  }

  /// Forces of the contacts with a force law for the present motion. @returns whether there are any
  bool apply_substrates() {
    bool has_any = false;
    for (RunningContact& contact : contacts) {
      const auto& substrate = contact.point().substrate;
      if (!substrate) continue;
      has_any = true;
      stand(contact);
      const double indentation = -contact.sliding.present_place(driven(contact, index)).gap;
      const double direction = contact.slip_velocity > 0.0 ? 1.0 : -1.0;
      const SubstrateForces acting = substrate->at(indentation, contact.slip_velocity, direction);
      contact.force = acting.normal.value;
      // At rest it sticks; the force needed for that is not known before the first step.
      contact.friction_force = contact.slip_velocity == 0.0 ? 0.0 : -acting.tangential.value;
      apply_forces(contact);
    }
    return has_any;
  }

  /// Contact forces at t_n: those with which gap and slip satisfy the contact conditions.
  StepOutcome solve() {
    const double sought_time = time(sought_index());
    for (std::size_t i = 0; i < contacts.size(); ++i) {
      RunningContact& contact = contacts[i];
      if (!pose(contact, local[i], sought_time, contact.rise_at(sought_time)))
        return fail(contact, StepOutcome::master_lost);
    }
    if (!slides_only && !faces.empty()) {
      const StepOutcome posed = pose_faces(sought_time);
      if (posed != StepOutcome::done) return posed;
    }
    const ContactAnswer answer = solve_contacts(sought_time);
    if (answer.status != ContactStatus::converged) {
      if (answer.contact >= static_cast<int>(contacts.size())) return fail_on_face(answer);
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
    if (!slides_only && !faces.empty()) clear_forces();
    for (std::size_t i = 0; i < contacts.size(); ++i) {
      RunningContact& contact = contacts[i];
      contact.force = local[i].normal;
      contact.friction_force = local[i].tangential;
      contact.state = local[i].state;
      if (!(std::abs(contact.force) < absurd_force)) return fail(contact, StepOutcome::diverged);
      contact.count();
      if (contact.tracks_slip) {
        const StepOutcome followed = follow_slip(contact, i);
        if (followed != StepOutcome::done) return followed;
      }
      if (contact.force < 0.0 && !local[i].is_unilateral &&
          !tolerate(contact, contact.violations.negative_force)) {
        outcome = fail(contact, StepOutcome::pulling);
      }
      apply_forces(contact);
    }
    if (!slides_only && !faces.empty()) {
      const StepOutcome taken = take_faces();
      if (taken != StepOutcome::done) outcome = taken;
    }
    if (has_feedthrough && !is_predicting_start) {
      for (std::size_t b = 0; b < bodies.size(); ++b) bodies[b]->settle(forces[b].data());
      if (!update_slip_velocities(sought_time)) outcome = StepOutcome::sliding_reversed;
    }
    return outcome;
  }

  /// Contacts with two tangents add theirs.
  [[gnu::noinline]] void clear_forces() {
    for (std::vector<double>& of_body : forces) std::fill(of_body.begin(), of_body.end(), 0.0);
  }

  /// Takes up the forces of contacts on faces and applies them.
  [[gnu::noinline]] StepOutcome take_faces() {
    StepOutcome outcome = StepOutcome::done;
    faces.take();
    for (std::size_t i = 0; i < faces.size(); ++i) {
      RunningFace& face = faces[i];
      if (!(std::abs(face.force) < absurd_force)) return fail(face, StepOutcome::diverged);
      if (face.is_through()) return fail(face, StepOutcome::sunk);
      const bool is_unilateral = faces.problems()[i].is_unilateral;
      if (is_unilateral && face.point().assumption != ContactAssumption::film) {
        if (face.state == ContactState::open) note(face, face.violations.negative_force);
        if (face.state == ContactState::stick) note(face, face.violations.reversed_sliding);
      }
      if (face.force < 0.0 && !is_unilateral && !tolerate(face, face.violations.negative_force))
        outcome = fail(face, StepOutcome::pulling);
      face.kinematics->apply(face.force, face.whole_friction(),
                            forces_on(face.point().slave_body).data(),
                            forces_on(face.master).data());
    }
    return outcome;
  }

  [[gnu::cold]] StepOutcome fail_on_face(const ContactAnswer& answer) {
    const std::size_t i = static_cast<std::size_t>(answer.contact) - contacts.size();
    RunningFace& face = faces[i];
    const PlanarProblem& problem = faces.problems()[i];
    face.force = problem.normal;
    if (!std::isfinite(problem.penetration)) {
      face.force = problem.penetration;
      return fail(face, StepOutcome::diverged);
    }
    return fail(face, answer.status == ContactStatus::jammed ? StepOutcome::jammed
                                                             : StepOutcome::not_converged);
  }

  /// Additional update of a contact that may stick, separate or sink in, once its forces are known.
  [[gnu::noinline]] StepOutcome follow_slip(RunningContact& contact, std::size_t i) {
    const bool has_law = local[i].substrate != nullptr;
    const StepOutcome outcome = has_law ? check_penetration(contact, i) : StepOutcome::done;
    if (outcome == StepOutcome::done) move_anchor(contact, i);
    if (local[i].is_unilateral) note_unilateral(contact);
    return outcome;
  }

  /// A force law, unlike a constraint, lets the slave sink in without end.
  StepOutcome check_penetration(RunningContact& contact, std::size_t i) {
    const LocalProblem& problem = local[i];
    const auto row = static_cast<Eigen::Index>(2 * i);
    const double compliance = solver.delassus()(row, row);
    contact.indentation = problem.indentation;
    contact.stiffness_in_step = problem.stiffness * compliance;
    if (problem.substrate->is_sunk(problem.indentation)) return fail(contact, StepOutcome::sunk);
    if (overshoots(problem.stiffness, compliance)) return fail(contact, StepOutcome::overshot);
    return StepOutcome::done;
  }

  /// The material point of a contact that does not stick moves with its corrected slip.
  void move_anchor(RunningContact& contact, std::size_t i) {
    // Where the problem was that of t_{n+1} it stays that of t_n.
    if (contact.state == ContactState::stick || contact.predicts_ahead) return;
    double slip = local[i].slip;
    const auto row = static_cast<Eigen::Index>(2 * i + 1);
    for (std::size_t j = 0; j < contacts.size(); ++j) {
      const auto column = static_cast<Eigen::Index>(2 * j);
      slip -= solver.delassus()(row, column) * local[j].normal +
              solver.delassus()(row, column + 1) * local[j].tangential;
    }
    contact.anchor += slip / contact.stretch;
  }

  /// Counts violations of persistent sliding, where it had been assumed.
  void note_unilateral(RunningContact& contact) {
    if (contact.point().assumption == ContactAssumption::film) return;
    if (contact.state == ContactState::open) note(contact, contact.violations.negative_force);
    if (contact.state == ContactState::stick) note(contact, contact.violations.reversed_sliding);
  }

  void apply_forces(const RunningContact& contact) {
    contact.sliding.apply(contact.force, contact.friction_force,
                          forces_on(contact.point().slave_body).data(),
                          forces_on(contact.sliding.surface().body).data());
  }

  void fill_delassus() {
    for (std::size_t i = 0; i < contacts.size(); ++i) {
      for (std::size_t j = 0; j < contacts.size(); ++j) fill_delassus(i, j);
    }
  }

  /// Rows n and t of contact i against columns n and t of contact j, with the compliance of its own
  /// spring. Forces are λ_n along the
  /// normal and λ_t against the tangent of the slave. Where no contact ever sticks or lifts off,
  /// the column of λ_n holds what its friction does as well.
  void fill_delassus(std::size_t i, std::size_t j) {
    const auto row = static_cast<Eigen::Index>(2 * i);
    const auto column = static_cast<Eigen::Index>(2 * j);
    Eigen::MatrixXd& delassus = solver.delassus();
    const double own = i == j ? contacts[i].compliance : 0.0;
    if (slides_only) {
      delassus(row, column) = own + contacts[i].sliding.sliding_compliance(
          contacts[j].sliding, local[j].direction * local[j].sliding_friction);
      return;
    }
    const SlidingPoint& sliding = contacts[i].sliding;
    const ContactCompliance w = contacts[i].predicts_ahead
                                    ? sliding.compliance_ahead(contacts[j].sliding)
                                    : sliding.compliance(contacts[j].sliding);
    delassus(row, column) = own + w.nn;
    delassus(row, column + 1) = -w.nt;
    delassus(row + 1, column) = -w.tn;
    delassus(row + 1, column + 1) = w.tt;
  }

  /// From t_n to t_{n+1} with the forces that `solve` found.
  void advance() {
    const double next_time = time(index + 1);
    if (time(index) < loads_constant_from) set_loads(next_time);
    for (std::size_t b = 0; b < bodies.size(); ++b) {
      if (time(index) < damping[b].constant_from())
        bodies[b]->set_mass_damping(damping[b].alpha_at(next_time));
      bodies[b]->advance(forces[b].data());
    }
    ++index;
  }

  /// With the bodies at t_n, before the contacts are solved.
  StepOutcome arrive() {
    return has_feedthrough || update_slip_velocities(time(index)) ? StepOutcome::done
                                                                  : StepOutcome::sliding_reversed;
  }

  /// Completion of a step once the bodies are at t_n.
  StepOutcome finish_step() {
    const StepOutcome outcome = arrive();
    return outcome == StepOutcome::done ? solve() : outcome;
  }

  /// @param now t_n
  /// @returns false where an armed contact slides against the drive
  [[gnu::always_inline]] bool update_slip_velocities(double now) {
    bool is_allowed = true;
    for (RunningContact& contact : contacts) {
      const double drawn = update_slip_velocity(contact, contact.driven.velocity(now));
      if (contact.slip_velocity * drawn < 0.0 && now < contact.unilateral_from &&
          !tolerate(contact, contact.violations.reversed_sliding)) {
        fail(contact, StepOutcome::sliding_reversed);
        is_allowed = false;
      }
    }
    if (!slides_only && !faces.empty() && !follow_faces(now)) is_allowed = false;
    return is_allowed;
  }

  /// Takes the motion of contacts on faces. @returns as update_slip_velocities()
  [[gnu::noinline]] bool follow_faces(double now) {
    bool is_allowed = true;
    faces.follow({now, now, step, has_feedthrough && !is_predicting_start});
    for (std::size_t i = 0; i < faces.size(); ++i) {
      RunningFace& face = faces[i];
      if (face.velocities[0].dot(face.kinematics->drawn_velocity(now)) >= 0.0 ||
          time(index) >= face.unilateral_from ||
          tolerate(face, face.violations.reversed_sliding))
        continue;
      fail(face, StepOutcome::sliding_reversed);
      is_allowed = false;
    }
    return is_allowed;
  }

  /// `advance` and `arrive` with an entry in the ledger.
  StepOutcome advance_on_account() {
    const double acting_at = time(index);
    for (std::size_t b = 0; b < bodies.size(); ++b) {
      const auto body = static_cast<int>(b);
      bodies[b]->predict_step(forces[b].data(), ledger->position(body), ledger->increment(body));
    }
    advance();
    const StepOutcome outcome = arrive();
    // The results of the contacts are kept until they are solved anew.
    for (std::size_t i = 0; i < records.size(); ++i) {
      const auto contact = static_cast<int>(i);
      const RunningContact* const on_line = line(contact);
      actions[i] = on_line != nullptr ? action_of(*on_line) : action_of(*on_face(contact));
      slip_velocities[i] = records[i]->slip_velocity;
    }
    ledger->add(acting_at, actions, slip_velocities);
    return outcome;
  }

  static ContactAction action_of(const RunningContact& contact) {
    ContactAction action;
    action.segment = contact.sliding.segment();
    action.projection = contact.sliding.projection();
    action.force = contact.force;
    action.friction_force = contact.friction_force;
    action.state = contact.state;
    action.roughness = contact.sliding.roughness();
    return action;
  }
  ContactAction action_of(const RunningFace& face) const {
    ContactAction action;
    action.force = face.force;
    action.friction_force = face.friction_force;
    action.state = face.state;
    action.friction_across = face.friction_across;
    action.sliding = face.velocities[0];
    const FacePoint& kinematics = *face.kinematics;
    action.num_master_rows = kinematics.num_master_ports();
    action.master_rows = kinematics.master_rows();
    action.normal = kinematics.normal();
    action.along = kinematics.along();
    action.across = kinematics.across();
    action.drawn = kinematics.drawn(time(index - 1), step);
    action.lifted = kinematics.lifted(time(index - 1), step);
    return action;
  }

  /// t·(v_C − v_M) from the increments of the last step. @returns the drives' part of it
  double update_slip_velocity(RunningContact& contact, double driven_velocity) const {
    const double drawn = contact.sliding.along_tangent(driven_velocity);
    contact.slip_velocity = contact.sliding.increment() / step + drawn;
    return drawn;
  }

  void note(ContactRecord& contact, std::int64_t& counter) {
    ++counter;
    contact.violations.last_time = time(index);
  }

  /// Counts a violation of persistent sliding; false where the contact is armed.
  template <class Running>
  bool tolerate(Running& contact, std::int64_t& counter) {
    note(contact, counter);
    if (time(index) >= contact.point().armed_from) return false;
    ++contact.violations.before_armed;
    return true;
  }

  /// Contacts watch their forces; a body that none of them touches may run away unnoticed.
  StepOutcome check_health() {
    next_health_check = index + health_interval;
    for (std::size_t b = 0; b < bodies.size(); ++b) {
      const Propagator::Motion motion = bodies[b]->motion(forces[b].data());
      const double size = motion.displacement.squaredNorm() + motion.velocity.squaredNorm();
      if (size < absurd_motion) continue;
      return fail_with(
          StepOutcome::diverged,
          fmt::format(
              "{} at t = {:.9g} s (step {}): the sum of the squares of its displacements and "
              "velocities is {:.3g}: the computation has diverged. Remedy: take a smaller "
              "time.step, "
              "or check material, damping and initial state of this body.",
              names[b], time(index), index, size));
    }
    return StepOutcome::done;
  }

  [[gnu::cold]] StepOutcome fail_with(StepOutcome outcome, std::string text) {
    failure = std::move(text);
    refusal = refusal_of(outcome);
    return outcome;
  }

  [[gnu::cold]] StepOutcome fail(const RunningContact& contact, StepOutcome outcome) {
    std::string what;
    std::string remedy;
    switch (outcome) {
      case StepOutcome::master_lost: {
        const MasterSurface& surface = contact.sliding.surface();
        what = fmt::format("the slave point has left the end of the surface {} ({:.6g} m long)",
                           surface.name, surface.arc_length.back());
        remedy =
            "end the run earlier (time.end), start elsewhere (contact.start) or slide more slowly "
            "(drive.velocity)";
        if (contact.violations.before_armed > 0) {
          remedy += fmt::format(
              "; if it was thrown there, mind the {} steps without persistent sliding that were "
              "let "
              "pass before contact.armed_from: arm earlier, or take contact.assumption: film",
              contact.violations.before_armed);
        }
        break;
      }
      case StepOutcome::sunk:
        what = fmt::format(
            "it has sunk {:.4g} m into the substrate, more than its radius of {:.4g} m, where no "
            "contact law holds",
            contact.indentation, contact.point().substrate->indentation_unit);
        remedy =
            "take a smaller load (drive.load), a larger contact.normal.modulus or radius, or, "
            "if "
            "it did not sink under its load but came to swing so far, a smaller time.step";
        break;
      case StepOutcome::overshot:
        what = fmt::format(
            "the substrate is too stiff for the step: at an indentation of {:.4g} m its force "
            "undoes {:.3g} times a change of indentation in one step, and more than 4 times makes "
            "it grow",
            contact.indentation, contact.stiffness_in_step);
        remedy = fmt::format("take a smaller time.step; about {:.1g} s resolves this contact",
                             step / std::sqrt(contact.stiffness_in_step));
        break;
      default:
        return fail_anywhere(contact, fmt::format("position {:.6g} m", contact.sliding.position()),
                             outcome);
    }
    return fail_with(
        outcome, fmt::format("{} at t = {:.9g} s (step {}), position {:.6g} m: {}. Remedy: {}.",
                             contact.point().name, time(index), index, contact.sliding.position(),
                             what, remedy));
  }

  [[gnu::cold]] StepOutcome fail(const RunningFace& face, StepOutcome outcome) {
    const std::string where = face.kinematics->where();
    const auto say = [&](const std::string& what, const char* remedy) {
      return fail_with(outcome,
                       fmt::format("{} at t = {:.9g} s (step {}), {}: {}. Remedy: {}.",
                                   face.point().name, time(index), index, where, what, remedy));
    };
    if (outcome == StepOutcome::sunk) {
      return say(fmt::format("it has gone {:.4g} m into {}, more than half its thickness",
                             face.force * face.point().compliance(), face.point().face->name),
                 "take a smaller initial amplitude, a larger normal.stiffness or a smaller time.step");
    }
    if (outcome == StepOutcome::master_lost) {
      return say("the slave point has left the edge of the surface",
                 "end the run earlier (time.end), start elsewhere, name a larger surface as master, or "
                 "slide more slowly (drive.velocity)");
    }
    return fail_anywhere(face, where, outcome);
  }

  /// What can go wrong with a contact of any kinematics.
  template <class Running>
  StepOutcome fail_anywhere(const Running& contact, const std::string& where, StepOutcome outcome) {
    std::string what;
    std::string remedy;
    switch (outcome) {
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
      case StepOutcome::master_lost:
      case StepOutcome::sunk:
      case StepOutcome::overshot:
      case StepOutcome::done:
        break;
    }
    return fail_with(outcome,
                     fmt::format("{} at t = {:.9g} s (step {}), {}: {}. Remedy: {}.",
                                 contact.point().name, time(index), index, where, what, remedy));
  }
};

}  // namespace stridor
