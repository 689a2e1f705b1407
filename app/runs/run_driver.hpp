// The way in which a transient is marched: what `Transient` asks of it.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/terminal/command.hpp"
#include "io/run_file/run_file.hpp"
#include "io/run_file/run_summary.hpp"
#include "io/scene/scene.hpp"
#include "solvers/transient/march.hpp"

namespace stridor {

/// Marches the system of a scene and writes its channels.
class RunDriver {
 public:
  virtual ~RunDriver() = default;

  /// Series of the run file, in the order of the rows.
  virtual std::vector<SeriesSpec> series() const = 0;
  /// To be called once, before the rest.
  /// @param rows       receives the samples; must live longer
  /// @param on_progress called about four times a second, between steps
  virtual void begin(RowSink& rows, std::function<void()> on_progress) = 0;

  /// Goes to a time, or a sample near it. @return `failed` where it cannot get there
  virtual MarchEnd run_until(double time) = 0;
  /// Goes to the end of the run, and as far as its samples need.
  virtual MarchEnd run_to_end() = 0;

  virtual double time() const = 0;  ///< s
  /// Cause, time and remedy of a failure.
  virtual const std::string& failure() const = 0;
  virtual Refusal refusal() const = 0;  ///< its kind

  virtual State save() const = 0;
  /// Goes on from a state, bit-identically. After begin().
  /// @throws std::invalid_argument if the state is of another run
  virtual void load(const State& state) = 0;

  /// The motion of every body now: time, drive_displacement, and of every body that moves
  /// "<body>/displacement" and "<body>/velocity" in its reduced coordinates.
  virtual State present_motion() const = 0;
  /// The motion of every body at the end, by path under /final; empty before it.
  virtual State final_motion() const = 0;
  /// Keeps the present motion as the final one, unless there is one.
  virtual void keep_final_motion() = 0;

  /// Steps, and step and its limit or null: the first arguments of effort_json().
  struct Effort {
    std::int64_t steps = 0;
    Json step, limit;
  };
  virtual Effort effort() const = 0;
  /// The numbers of the run, without those of its effort and its file.
  virtual Json results(MarchEnd end,
                       const std::optional<AccelerationSummary>& acceleration) const = 0;
};

/// The driver that `time.integrator` names.
/// @param loaded, model must live longer; the model in its initial state
/// @throws ConfigError with places in the scene, NumericalError
std::unique_ptr<RunDriver> make_run_driver(const LoadedScene& loaded, const Model& model);

}  // namespace stridor
