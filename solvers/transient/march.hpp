// A whole run: steps, samples, statistics, and the ways in which it can end.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "solvers/transient/simulation.hpp"

namespace stridor {

enum class MarchEnd {
  finished,  ///< the last step was reached
  stopped,   ///< stop_requested()
  failed,    ///< a step did not end with StepOutcome::done; Simulation::failure() gives the reason
};

struct MarchPlan {
  std::int64_t last_step = 0;
  /// Window of the contact statistics, in steps, both ends included; outside it they are not
  /// tracked.
  std::int64_t measure_from = 0;
  std::int64_t measure_to = 0;
  /// Called about four times a second of wall time, between steps.
  std::function<void(const Simulation&)> on_progress;
};

/// Statistics of every contact over the window of a plan; empty where no step fell into it.
using MeasuredContacts = std::vector<std::optional<ContactStatistics>>;

struct MarchResult {
  MarchEnd end = MarchEnd::finished;
  MeasuredContacts statistics;
};

/// Steps a simulation through a plan, in one call or in stretches, handing it to the sink whenever
/// that is due.
///
/// The samples at the present step are taken first, so a fresh simulation is sampled at t = 0. A
/// simulation that was loaded must come with a sink that was loaded.
class March {
 public:
  /// @param simulation, sink must live longer; the sink may be null
  March(Simulation& simulation, SampleSink* sink, MarchPlan plan);

  /// Steps until `step` or the end of the plan, whichever comes first.
  /// @return `finished` where it got there; after anything else it must not be called again
  /// @throws whatever the sink throws; the simulation is between two steps then
  MarchEnd run_until(std::int64_t step);

  /// Work of `run_until` between steps, for a caller that steps the simulation in its place: takes
  /// the sample and opens or closes the window where that is due at the present step.
  void attend();
  /// The next step at which `attend` has something to do, at most the last of the plan.
  std::int64_t next_event() const;
  std::int64_t last_step() const { return plan_.last_step; }

  /// Statistics of the window as far as it was run.
  MeasuredContacts statistics() const;

  void save(State& state, const std::string& prefix) const;
  /// Goes on as the march that was saved, with the simulation and the sink loaded before.
  /// @throws std::invalid_argument if the state is of another system
  void load(const State& state, const std::string& prefix);

 private:
  friend std::vector<MarchEnd> march_together(const std::vector<March*>& marches);
  enum class Window { ahead, open, closed };

  void note_window(std::int64_t now);
  void take_sample();

  Simulation* simulation_;
  SampleSink* sink_;
  MarchPlan plan_;
  std::int64_t sink_next_;
  Window window_ = Window::ahead;
  MeasuredContacts closed_statistics_;
};

/// Runs the plans of several marches together (see Batch), with a march of its own for every
/// simulation.
/// @param marches of simulations of the same step; not null
/// @return how each ended; all are `stopped` that had not ended when that was requested
/// @throws whatever a sink throws
std::vector<MarchEnd> march_together(const std::vector<March*>& marches);

/// Runs a whole plan.
MarchResult march(Simulation& simulation, SampleSink* sink, const MarchPlan& plan);

}  // namespace stridor
