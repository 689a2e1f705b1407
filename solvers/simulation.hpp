// The coupled system in time.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/state.hpp"
#include "coupling/system.hpp"
#include "solvers/time_parameters.hpp"

namespace stridor {

/// What a step ended with. Anything but `done` ends the run: bodies and channels stand at the time
/// of the failure, contact forces may be those of the step before.
enum class StepOutcome {
  done,
  master_lost,       ///< a slave point has left the end of its master surface
  pulling,           ///< λ < 0 at an armed contact: the assumption of persistent sliding is lost
  sliding_reversed,  ///< an armed contact slides against the drive: likewise
  jammed,            ///< b_C W b_Eᵀ of a contact is not positive: no contact force closes its gap
  diverged,          ///< a contact force is not finite or beyond any use
};

/// Violations of persistent sliding by one contact, counted in steps.
struct ViolationCount {
  std::int64_t negative_force = 0;  ///< λ < 0
  std::int64_t reversed_sliding =
      0;  ///< sliding velocity against that of the drive (never while the drive stands still)
  std::int64_t before_armed = 0;  ///< of the two, those before ContactPoint::armed_from
  double last_time = 0.0;         ///< of the latest one, s

  std::int64_t total() const { return negative_force + reversed_sliding; }
};

/// Where a slave point stands on its master.
struct ContactPlace {
  double gap;       ///< distance from the deformed polyline along the segment's normal, m
  double position;  ///< along the undeformed master from its first node, m
};

/// Bodies, contacts and drive marched together with the sliding contact assumptions Subs-a, -b, -c
/// (docs/theory.md, 3.1). After construction and after every `step` everything at t_n is known,
/// contact forces λ_n included.
class Simulation {
 public:
  /// @param system copied in what it needs; not referenced afterwards
  /// @param time   step h > 0 at most `step_limit(system)`; `end` is not used here
  /// @throws ConfigError for `time.step` if h is above the limit, naming both
  /// @throws NumericalError if the start itself fails (outcome other than `done`)
  Simulation(const System& system, const TimeParameters& time);
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

  /// u_n of a row of a body, m, relative to its place that follows the drive.
  double displacement(int body, int row) const;
  /// Displacement of the bodies that follow the drive, m.
  double drive_displacement() const;

  int num_contacts() const;
  /// λ_n, N, compression positive.
  double contact_force(int contact) const;
  /// Of the slave relative to the master along the tangent at t_n, m/s.
  double slip_velocity(int contact) const;
  /// At t_n.
  ContactPlace contact_place(int contact) const;
  const ViolationCount& violations(int contact) const;
  /// Smallest and largest λ since the start or the last reset, that of the present step included.
  std::pair<double, double> force_extremes(int contact) const;
  void reset_force_extremes();

  /// What went wrong in the last step that did not end with `done`: where, when, by how much, what
  /// to do.
  const std::string& failure() const;

  State save() const;
  /// Goes on from a state saved by a simulation of the same system and step, bitwise as if never
  /// stopped.
  /// @throws std::invalid_argument if the state does not fit; the simulation must not be used then
  void load(const State& state);

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

/// Where the samples of a run go. Called between steps, never inside one.
class SampleSink {
 public:
  virtual ~SampleSink() = default;
  /// Index of the next step after which `sample` must be called.
  virtual std::int64_t next_step() const = 0;
  virtual void sample(const Simulation& simulation) = 0;
};

}  // namespace stridor
