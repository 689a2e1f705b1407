// The coupled system in time.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/state.hpp"
#include "coupling/system/system.hpp"
#include "solvers/contact/contact_record.hpp"
#include "solvers/contact/contact_solver.hpp"
#include "solvers/integrators/propagator.hpp"
#include "solvers/integrators/time_parameters.hpp"
#include "solvers/transient/energy_ledger.hpp"
#include "solvers/transient/step_outcome.hpp"

namespace stridor {

/// Quantities that a simulation keeps account of from its start.
enum class Accounts {
  none,
  energy,  ///< a step costs two and a half times as much
};

/// Bodies, contacts and drives marched together under the contact assumptions Subs-a, -b, -c and
/// FiLM (docs/theory.md, 3.1). After construction and after every `step` everything at t_n is
/// known, contact forces λ_n included.
class Simulation {
 public:
  /// @param system its needed parts are copied; not referenced afterwards
  /// @param time   step h > 0, at most `step_limit(system, time)`; `end` is not used here
  /// @throws ConfigError for `time.step` if h is above the limit, naming both; for keys that do not
  ///         go together
  /// @throws NumericalError if the start itself fails (outcome other than `done`)
  Simulation(const System& system, const TimeParameters& time, Accounts accounts = Accounts::none);
  ~Simulation();
  Simulation(Simulation&&) noexcept;
  Simulation& operator=(Simulation&&) noexcept;

  /// One step. No allocation, no exception in its normal path.
  StepOutcome step();
  /// Steps until `target` or until one does not end with `done`.
  StepOutcome step_until(std::int64_t target);

  std::int64_t step_index() const;
  double time() const;
  double step_size() const;

  /// u_n of a row of a body, m, relative to its place that follows a drive.
  double displacement(int body, int row) const;
  /// u_n and its rate by backward difference, of a body in the coordinates that it is marched in.
  Propagator::Motion motion(int body) const;
  /// The same in the reduced coordinates of the body, including the truncated modes.
  Propagator::Motion reduced_motion(int body) const;
  /// Displacement of the bodies that follow a drive, m.
  /// @param drive index into System::drives
  double drive_displacement(int drive) const;

  int num_contacts() const;
  /// λ_n, N, compression positive.
  double contact_force(int contact) const;
  /// λ_t, N, positive against sliding of the slave along +t; on a face that along the circumference, in
  /// which the face drives the slave towards +φ.
  double friction_force(int contact) const;
  /// On a face, friction along the radius, N; 0 of other contacts.
  double friction_across(int contact) const;
  ContactState contact_state(int contact) const;
  /// Area of a contact with a force law that has one, m²; 0 of any other.
  double contact_area(int contact) const;
  /// Action of a contact on its bodies from t_n to t_{n+1}.
  ContactAction contact_action(int contact) const;
  /// Of the slave relative to the master along the tangent at t_n, m/s; on a face that of the face
  /// against the slave along the circumference.
  double slip_velocity(int contact) const;
  /// The same along both tangents.
  Eigen::Vector2d sliding_velocity(int contact) const;
  /// At t_n.
  ContactPlace contact_place(int contact) const;
  const ViolationCount& violations(int contact) const;
  /// Since the start or the last reset, the present step included.
  ContactStatistics statistics(int contact) const;
  void reset_statistics();
  /// Ends an interval at the present step, which is its last; the next one begins after it. Resets
  /// of the statistics do not touch intervals.
  void end_interval();
  /// Over all steps of the interval that ended last.
  const ContactStatistics& interval_statistics(int contact) const;

  /// Up to t_n; null unless Accounts::energy was asked for.
  const EnergyLedger* energy() const;

  /// Failure of the last step that did not end with `done`: place, time, size and remedy.
  const std::string& failure() const;
  Refusal refusal() const;  ///< its kind

  struct Implementation;  ///< see simulation_implementation.hpp
  Implementation& implementation() { return *implementation_; }

  State save() const;
  /// Resumes from a state saved by a simulation of the same system, step and accounts,
  /// bit-identically to an uninterrupted run.
  /// @throws std::invalid_argument if the state does not fit; the simulation must not be used then
  void load(const State& state);

 private:
  std::unique_ptr<Implementation> implementation_;
};

/// Destination of the samples of a run. Called between steps, never inside one, after
/// Simulation::end_interval().
class SampleSink {
 public:
  virtual ~SampleSink() = default;
  /// Index of the next step after which `sample` must be called.
  virtual std::int64_t next_step() const = 0;
  virtual void sample(const Simulation& simulation) = 0;
};

}  // namespace stridor
