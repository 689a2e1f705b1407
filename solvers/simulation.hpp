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
#include "coupling/system.hpp"
#include "solvers/contact_solver.hpp"
#include "solvers/energy_ledger.hpp"
#include "solvers/propagator.hpp"
#include "solvers/sliding_point.hpp"
#include "solvers/time_parameters.hpp"

namespace stridor {

/// Outcome of a step. Anything but `done` ends the run: bodies and channels are at the time of the
/// failure, contact forces may be those of the step before.
enum class StepOutcome {
  done,
  master_lost,       ///< a slave point has left the end of its master surface
  pulling,           ///< λ < 0 at an armed contact: the assumption of persistent sliding is lost
  sliding_reversed,  ///< an armed contact slides against the drive: likewise
  jammed,            ///< b_C W b_Eᵀ of a contact is not positive: no contact force closes its gap
  not_converged,     ///< the forces of several contacts have not settled
  diverged,          ///< a contact force is not finite or beyond any use
  sunk,              ///< a slave point is deeper in its substrate than its radius, or has gone through a plate
  overshot,          ///< a substrate is so stiff for the step that indentations grow with each
};

/// Violations of persistent sliding by one contact, counted in steps; none with FiLM, which does
/// not assume it.
struct ViolationCount {
  std::int64_t negative_force = 0;  ///< λ < 0, or lifted off where the contact is unilateral
  /// Sliding velocity against that of the drive (never while the drive is at rest), or sticking.
  std::int64_t reversed_sliding = 0;
  std::int64_t before_armed = 0;  ///< of the two, those before ContactPoint::armed_from
  double last_time = 0.0;         ///< of the latest one, s

  std::int64_t total() const { return negative_force + reversed_sliding; }
};

/// Statistics of a contact over a stretch of steps.
struct ContactStatistics {
  double force_min = std::numeric_limits<double>::infinity();      ///< of λ, N
  double force_max = -std::numeric_limits<double>::infinity();     ///< of λ, N
  double friction_min = std::numeric_limits<double>::infinity();   ///< of λ_t, N
  double friction_max = -std::numeric_limits<double>::infinity();  ///< of λ_t, N
  std::int64_t steps = 0;
  std::int64_t sticking = 0;  ///< steps that ended in stick
  std::int64_t open = 0;      ///< steps without contact

  /// Adds the statistics of another stretch.
  void add(const ContactStatistics& other) {
    force_min = std::min(force_min, other.force_min);
    force_max = std::max(force_max, other.force_max);
    friction_min = std::min(friction_min, other.friction_min);
    friction_max = std::max(friction_max, other.friction_max);
    steps += other.steps;
    sticking += other.sticking;
    open += other.open;
  }

  /// The same as numbers, for a saved state.
  using Numbers = std::array<double, 7>;
  Numbers numbers() const {
    return {force_min,
            force_max,
            friction_min,
            friction_max,
            static_cast<double>(steps),
            static_cast<double>(sticking),
            static_cast<double>(open)};
  }
  static ContactStatistics of(std::span<const double, std::tuple_size_v<Numbers>> numbers) {
    const auto count = [&](std::size_t k) { return static_cast<std::int64_t>(numbers[k]); };
    return {numbers[0], numbers[1], numbers[2], numbers[3], count(4), count(5), count(6)};
  }
};

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
