// The state of a simulation and its changes in a step; for the sources of the simulation and those
// that step several simulations simultaneously.
#pragma once

#include <array>
#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/errors.hpp"
#include "solvers/contact/face_contacts.hpp"
#include "solvers/contact/line_contacts.hpp"
#include "solvers/contact/substrate_step.hpp"
#include "solvers/integrators/make_propagator.hpp"
#include "solvers/transient/simulation.hpp"

namespace stridor {

/// No contact of a computable scene carries this; beyond it the numbers have run away.
inline constexpr double absurd_force = 1e30;

/// Bodies, contacts and drives between two steps. The steps of contacts that slide for good are
/// inline here; what other contacts take besides is in simulation_contacts.cpp, the beginning in
/// simulation_setup.cpp.
struct Simulation::Implementation {
  std::vector<MasterSurface> surfaces;
  std::vector<FacetSurface> facet_surfaces;
  std::vector<std::string> names;  ///< of the bodies
  std::vector<BodyLoading> loading;  ///< of the bodies
  std::vector<RayleighDamping> damping;
  std::vector<Drive> drives;
  std::vector<DrivenMotion> driven_by;  ///< of what follows each drive
  StepClock clock;
  std::int64_t next_health_check = 0;
  bool slides_only = true;  ///< no contact tracks its slip, none is on a face
  std::vector<std::unique_ptr<Propagator>> bodies;
  std::vector<std::unique_ptr<NodePorts>> nodes;  ///< of the bodies with contacts on facets, or null
  std::vector<Eigen::MatrixXd> shapes;  ///< of the modes; empty in reduced coordinates
  RunningLines lines;
  RunningFaces faces;
  std::vector<ContactRecord*> records;  ///< of all contacts, in the order of the system
  std::vector<std::vector<double>> forces;  ///< per body, at its ports
  StepFailure failure;

  // Quantities that no longer change are not computed again.
  double loads_constant_from = 0.0;

  std::optional<EnergyLedger> ledger;
  std::vector<ContactAction> actions;   ///< of the ledger's step, per contact
  std::vector<double> slip_velocities;  ///< likewise

  ContactSolver solver{0};
  std::vector<std::array<PortBlock, 2>> line_blocks;  ///< scratch, of `lines`
  std::vector<char> line_looks_ahead;                 ///< likewise

  // The beginning.

  /// Bodies, contacts and the ledger; to be called once.
  void set_up(const System& system, const TimeParameters& time, Accounts accounts);
  void add_bodies(const System& system, const TimeParameters& time);
  /// Adds the contacts of a system. Their ports follow each other on every body.
  void add_contacts(const System& system);
  void add_line(const System& system, const ContactPoint& point, std::vector<int>& next_port);
  void add_face(const System& system, const ContactPoint& point, std::vector<int>& next_port);
  /// Sets the bodies moving and finds the first contact forces.
  void start(const System& system, const TimeParameters& time);
  /// @throws NumericalError if they are not found
  void find_first_forces(const System& system);
  /// Forces of the contacts with a force law for the present motion. @returns whether there are any
  bool apply_substrates();

  // Parts.

  /// A contact by its index in the system: null where it is of the other kind.
  const RunningLine* line(int contact) const {
    const ContactRecord* const record = records[static_cast<std::size_t>(contact)];
    for (const RunningLine& one : lines)
      if (&one == record) return &one;
    return nullptr;
  }
  const RunningFace* on_face(int contact) const {
    const ContactRecord* const record = records[static_cast<std::size_t>(contact)];
    for (std::size_t i = 0; i < faces.size(); ++i)
      if (&faces[i] == record) return &faces[i];
    return nullptr;
  }
  ContactAction action(int contact) const;

  void set_loads(double at) {
    for (std::size_t b = 0; b < bodies.size(); ++b) {
      if (loading[b].is_any()) bodies[b]->set_loads(loading[b].amplitudes(drives, at));
    }
  }

  std::span<double> forces_on(int body) { return forces[static_cast<std::size_t>(body)]; }
  /// Forces on the ports that there are now.
  void fit_forces() {
    for (std::size_t b = 0; b < bodies.size(); ++b)
      forces[b].resize(static_cast<std::size_t>(bodies[b]->num_ports()), 0.0);
  }

  // The step: the bodies advance, the contacts follow them, and are solved.

  /// From t_n to t_{n+1} with the forces that `solve` found.
  void advance() {
    const double next_time = clock.time(clock.index + 1);
    if (clock.now() < loads_constant_from) set_loads(next_time);
    for (std::size_t b = 0; b < bodies.size(); ++b) {
      if (clock.now() < damping[b].constant_from())
        bodies[b]->set_mass_damping(damping[b].alpha_at(next_time));
      bodies[b]->advance(forces[b].data());
    }
    ++clock.index;
  }
  /// `advance` and `arrive` with an entry in the ledger.
  StepOutcome advance_on_account();

  /// With the bodies at t_n, before the contacts are solved.
  StepOutcome arrive() {
    return clock.has_feedthrough || update_slip_velocities(clock.now())
               ? StepOutcome::done
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
    for (RunningLine& contact : lines) {
      const double drawn = contact.update_slip_velocity(contact.driven.velocity(now), clock.step);
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
  bool follow_faces(double now);

  /// Contact forces at t_n: those with which gap and slip satisfy the contact conditions.
  StepOutcome solve() {
    const double sought_time = clock.time(clock.sought_index());
    for (std::size_t i = 0; i < lines.size(); ++i) {
      if (!lines.pose(i, clock, sought_time)) return fail(lines[i], StepOutcome::master_lost);
    }
    if (!slides_only && !faces.empty()) {
      const StepOutcome posed = pose_faces(sought_time);
      if (posed != StepOutcome::done) return posed;
    }
    const ContactAnswer answer = solve_contacts(sought_time);
    if (answer.status != ContactStatus::converged) return fail_unsolved(answer);

    StepOutcome outcome = StepOutcome::done;
    if (!slides_only && !faces.empty()) clear_forces();
    for (std::size_t i = 0; i < lines.size(); ++i) {
      const StepOutcome taken = take_line(i);
      // One that pulls has a force all the same.
      if (taken != StepOutcome::done && taken != StepOutcome::pulling) return taken;
      if (taken == StepOutcome::pulling) outcome = taken;
    }
    if (!slides_only && !faces.empty()) {
      const StepOutcome taken = take_faces();
      if (taken != StepOutcome::done) outcome = taken;
    }
    if (clock.is_fed_through()) {
      for (std::size_t b = 0; b < bodies.size(); ++b) bodies[b]->settle(forces[b].data());
      if (!update_slip_velocities(sought_time)) outcome = StepOutcome::sliding_reversed;
    }
    return outcome;
  }

  /// Solves the contacts as posed; those that are unsteady, or change, ahead.
  ContactAnswer solve_contacts(double sought_time) {
    if (slides_only) {
      lines.fill_sliding(solver);
      return solver.solve(lines.problems());
    }
    if (!clock.is_fed_through()) return solve_posed();
    return solve_unsteady_contacts(sought_time);
  }
  ContactAnswer solve_posed() {
    lines.fill(solver);
    if (faces.empty()) return solver.solve(lines.problems());
    return solve_with_faces();
  }
  ContactAnswer solve_with_faces();
  ContactAnswer solve_unsteady_contacts(double sought_time);

  /// Takes up the forces of a contact with one tangent and applies them.
  [[gnu::always_inline]] StepOutcome take_line(std::size_t i) {
    RunningLine& contact = lines[i];
    const LocalProblem& problem = lines.problems()[i];
    contact.force = problem.normal;
    contact.friction_force = problem.tangential;
    contact.state = problem.state;
    if (!(std::abs(contact.force) < absurd_force)) return fail(contact, StepOutcome::diverged);
    contact.count();
    if (contact.tracks_slip) {
      const StepOutcome followed = follow_slip(contact, i);
      if (followed != StepOutcome::done) return followed;
    }
    StepOutcome outcome = StepOutcome::done;
    if (contact.force < 0.0 && !problem.is_unilateral &&
        !tolerate(contact, contact.violations.negative_force)) {
      outcome = fail(contact, StepOutcome::pulling);
    }
    apply_forces(contact);
    return outcome;
  }
  void apply_forces(const RunningLine& contact) {
    contact.sliding.apply(contact.force, contact.friction_force,
                          forces_on(contact.point().slave_body).data(),
                          forces_on(contact.sliding.surface().body).data());
  }

  // What only contacts that stick, separate, sink in or have two tangents take.

  /// Additional update of a contact that may stick, separate or sink in, once its forces are known.
  StepOutcome follow_slip(RunningLine& contact, std::size_t i);
  /// A force law, unlike a constraint, lets the slave sink in without end.
  StepOutcome check_penetration(RunningLine& contact, std::size_t i);
  /// Poses the problems of contacts with two tangents. @returns failure where a slave has left its
  /// master
  StepOutcome pose_faces(double sought_time);
  /// The answers of the bodies to forces, where they are others than in the step before.
  void find_answers_of_faces();
  /// Contacts with two tangents add theirs.
  void clear_forces();
  /// Takes up the forces of contacts on faces and applies them.
  StepOutcome take_faces();

  // Guards.

  /// Counts a violation of persistent sliding; false where the contact is armed.
  template <class Running>
  bool tolerate(Running& contact, std::int64_t& counter) {
    return contact.tolerate(counter, clock.now(), contact.point().armed_from);
  }
  /// Counts violations of persistent sliding by a unilateral contact, where it had been assumed.
  template <class Running>
  void note_unilateral(Running& contact) {
    if (contact.point().assumption == ContactAssumption::film) return;
    if (contact.state == ContactState::open)
      contact.note(contact.violations.negative_force, clock.now());
    if (contact.state == ContactState::stick)
      contact.note(contact.violations.reversed_sliding, clock.now());
  }
  /// Contacts watch their forces; a body that none of them touches may run away unnoticed.
  StepOutcome check_health();

  template <class Running>
  [[gnu::cold]] StepOutcome fail(const Running& contact, StepOutcome outcome) {
    failure = failure_of(contact, outcome, clock);
    return outcome;
  }
  StepOutcome fail_unsolved(const ContactAnswer& answer);
};

}  // namespace stridor
