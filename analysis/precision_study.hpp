// Settings of the time integration of one scene, and runs of them against the clock.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "analysis/error_norms.hpp"
#include "coupling/system/system.hpp"
#include "solvers/transient/march.hpp"

namespace stridor {

/// Numbers of steps per sample, from `coarsest` to `finest`: as near to a geometric series as
/// distinct whole numbers come.
/// @param coarsest ≥ 1
/// @param finest   ≥ coarsest
/// @param count    how many, ≥ 1; fewer where there are not so many whole numbers
/// @throws std::invalid_argument if a parameter is out of range
std::vector<int> step_ladder(int coarsest, int finest, int count);

/// Least number of steps per sample with which the central difference is stable; 1 where it has no
/// limit.
/// @throws std::invalid_argument if there are more than 10⁵
int stable_steps_per_sample(const System& system, const TimeParameters& time, double interval);

/// Number of retained modes.
int num_moving_modes(const System& system, const TimeParameters& time);

/// The system with one contact assumption for all its contacts.
System with_assumption(const System& system, ContactAssumption assumption);

/// One way to integrate a scene, at several steps.
struct PrecisionMethod {
  Integrator integrator = Integrator::exact;
  std::optional<double> retained;  ///< modes up to this frequency move, Hz; all where absent
  ContactAssumption assumption = ContactAssumption::subs_b;
  std::vector<int> steps_per_sample;  ///< coarsest first

  TimeParameters at(int steps, const TimeParameters& time, double interval) const;
};

/// Parameters of a study.
struct StudyParameters {
  std::vector<double> retained;  ///< frequencies up to which modes are retained, Hz, ascending
  /// Contact assumptions that are compared; the scene's own need not be among them.
  std::vector<ContactAssumption> assumptions;
  int points = 7;  ///< steps per method, ≥ 2
};

struct PrecisionPlan {
  PrecisionMethod reference;             ///< steps of the check run, then of the reference itself
  std::vector<PrecisionMethod> methods;  ///< under the scene's own assumption, then under others
  int stable_steps = 1;                  ///< stable_steps_per_sample() with all modes
};

/// The methods of a study, in order: the central difference from its stability limit on (and, where
/// it has one, a step just beyond it), the exact propagation, both with all modes; the same two for
/// each of the retained frequencies that leave modes out; the exact propagation with the middle one
/// of these under each other assumption.
///
/// The reference is the exact propagation of all modes at an eighth of the largest stable step of
/// the central difference or less; its check run takes twice that step.
///
/// @param system   under the scene's own assumption
/// @param time     of the scene; its step is the choice of its author
/// @param interval between samples, s
/// @throws std::invalid_argument as stable_steps_per_sample()
PrecisionPlan make_plan(const System& system, const TimeParameters& time, double interval,
                        const StudyParameters& parameters);

/// Which displacement a run is sampled at.
struct ObservedRow {
  int body = 0;
  int row = 0;  ///< of ReducedBody::rows
};

/// Cost of a run so far.
struct RunCost {
  double setup = 0.0;        ///< s, model excluded
  double sampling = 0.0;     ///< s, time of sampling, estimated from some samples
  double stepping = 0.0;     ///< s, the rest
  double least_step = 0.0;   ///< s per step, of the fastest stretch
  double median_step = 0.0;  ///< s per step, over the stretches
  std::int64_t steps = 0;
};

/// A run that is sampled and timed in stretches.
///
/// A setting that cannot be run, or that fails on its way, is a result and no error: `failure()`
/// gives the reason.
class TimedRun {
 public:
  /// @param interval between samples, s, a whole multiple of time.step
  /// @param num_samples after that at t = 0
  TimedRun(const System& system, const TimeParameters& time, ObservedRow observed, double interval,
           std::int64_t num_samples);
  TimedRun(const TimedRun&) = delete;
  TimedRun& operator=(const TimedRun&) = delete;

  /// Steps until a sample has been taken; where the run has failed, nothing.
  /// @return `stopped` where that was asked for
  MarchEnd run_until(std::int64_t sample);

  const SampledRun& samples() const { return samples_; }
  /// Empty as long as nothing went wrong.
  const std::string& failure() const { return failure_; }
  Refusal refusal() const { return refusal_; }  ///< kind of the failure
  RunCost cost() const;

 private:
  using Clock = std::chrono::steady_clock;

  /// Looks at the simulation; times some of its looks.
  class Sampler : public SampleSink {
   public:
    Sampler(TimedRun& run, std::int64_t stride) : run_(&run), stride_(stride) {}
    std::int64_t next_step() const override { return next_step_; }
    void sample(const Simulation& simulation) override;

   private:
    TimedRun* run_;
    std::int64_t stride_;
    std::int64_t next_step_ = 0;
  };

  double look_time() const;

  ObservedRow observed_;
  std::int64_t steps_per_sample_;
  SampledRun samples_;
  std::string failure_;
  Refusal refusal_ = Refusal::diverged;
  std::optional<Simulation> simulation_;
  std::optional<Sampler> sampler_;
  std::optional<March> march_;
  double setup_seconds_ = 0.0;
  double march_seconds_ = 0.0;
  std::vector<double> look_times_;  ///< of the samples that were timed, s
  /// Of every stretch: steps, samples and duration.
  struct Stretch {
    std::int64_t steps;
    std::int64_t samples;
    double seconds;
  };
  std::vector<Stretch> stretches_;
};

}  // namespace stridor
