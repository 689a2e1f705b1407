// A transient of a sphere on a viscoelastic substrate on its way into a run file.
#pragma once

#include <deque>
#include <limits>
#include <optional>
#include <string>

#include "app/run_keeping.hpp"
#include "app/sphere_motion.hpp"
#include "io/sphere_scene.hpp"
#include "solvers/march.hpp"
#include "solvers/substrate_stepper.hpp"

namespace stridor {

/// Reads amplitude and period from the whole cycles of the second half of a run.
class CycleMeter {
 public:
  /// Quantities gathered up to a turn, where x is largest.
  struct Turn {
    double time = 0.0;
    double x = 0.0;
    double sum = 0.0;      ///< ∫ x dt
    double squares = 0.0;  ///< ∫ x² dt
    double stick = 0.0;    ///< time
    double free = 0.0;     ///< time
  };

  explicit CycleMeter(double end) : from_(0.5 * end) {}

  void note_turn(const Turn& turn);
  void note_position(double time, double x, double y);
  /// Largest y; minus infinity where no position has been noted.
  double deepest() const { return deepest_; }
  /// Adds x, period and fractions; null where no cycle is whole.
  void report(Json& results) const;

  void save(State& state, const std::string& prefix) const;
  void load(const State& state, const std::string& prefix);

 private:
  std::size_t repeats_after() const;

  double from_;
  std::size_t num_turns_ = 0;
  std::deque<Turn> turns_;  ///< the first, and as many of the last as are compared
  double smallest_ = std::numeric_limits<double>::infinity();
  double largest_ = -std::numeric_limits<double>::infinity();
  double deepest_ = -std::numeric_limits<double>::infinity();
};

/// As Transient, for spheres. Times are multiples of the time unit of the sphere.
class SphereTransient {
 public:
  /// @param loaded must live longer
  /// @throws ConfigError if the step is beyond the limit; FileError, NumericalError
  SphereTransient(const LoadedSphereScene& loaded, const RunOutput& output);
  /// Resumes a run from the latest checkpoint of its file, bit-identically to an uninterrupted run.
  /// @throws FileError as Transient
  SphereTransient(const LoadedSphereScene& loaded, const InterruptedRun& interrupted);
  SphereTransient(const SphereTransient&) = delete;
  SphereTransient& operator=(const SphereTransient&) = delete;

  /// Goes to a time, on to the next sample or step there, or to the end of the run.
  MarchEnd run_until(double time);
  MarchEnd run_to_end();

  /// Progress and the limit of wall time.
  RunKeeper& keeper() { return keeper_; }
  /// @throws FileError if it cannot be written
  void write_checkpoint();
  /// Stores the results in the file and closes it. @return the JSON object of `run`
  Json finish();

  double time() const;
  const SphereNumbers& numbers() const { return numbers_; }
  /// Cause, time and remedy of the failure; empty unless the run has failed.
  const std::string& failure() const { return failure_; }

 private:
  const SphereScene& scene() const { return loaded_->scene; }
  bool is_event_driven() const { return motion_.has_value(); }
  void make_model();
  std::int64_t last_unit(double time) const;
  bool advance();
  bool advance_to_sample();
  bool advance_a_step();
  void write_samples();
  State save() const;
  void load(const State& state);

  const LoadedSphereScene* loaded_;
  std::string file_;
  RunKeeper keeper_;
  SphereNumbers numbers_;
  SubstrateOscillator oscillator_;
  std::optional<SubstrateMotion> motion_;  ///< one of these two
  std::optional<SubstrateStepper> stepper_;
  CycleMeter meter_;
  CycleMeter::Turn gathered_;   ///< by the stepper
  double last_velocity_ = 0.0;  ///< of the stepper
  SphereHistory history_;       ///< samples not yet written
  std::optional<RunFileWriter> writer_;
  std::int64_t unit_ = 0;  ///< samples reached, or steps made
  MarchEnd end_ = MarchEnd::finished;
  std::string failure_;
  double setup_seconds_ = 0.0, march_seconds_ = 0.0;
};

}  // namespace stridor
