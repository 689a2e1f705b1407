// Simulations of one shape in the lanes of a vector.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "solvers/transient/displacement_sink.hpp"
#include "solvers/transient/lane_access.hpp"
#include "solvers/transient/lane_storage.hpp"

namespace stridor {

/// The shape of a simulation, or nothing where it is none that steps in lanes (Batch).
std::optional<LaneShape> lane_shape_of(Simulation::Implementation& run);

/// A simulation that steps in a lane, and who samples it.
struct LaneMember {
  explicit LaneMember(Simulation& simulation);

  Simulation* simulation;
  Simulation::Implementation* run;
  ModalRecurrence* slave;
  ModalRecurrence* master;
  std::vector<double>* slave_forces;
  std::vector<double>* master_forces;
  StepOutcome outcome = StepOutcome::done;
  bool is_resident = false;  ///< its state is in the lanes

  DisplacementSink* sink = nullptr;
  DisplacementSink::Row row{};
  std::optional<int> slave_row{};  ///< row that is watched
  std::optional<int> master_row{};
  std::int64_t next_sample = std::numeric_limits<std::int64_t>::max();

  std::int64_t index() const { return run->clock.index; }
  RunningLine& contact() const { return run->lines.front(); }
  bool is_running(std::int64_t target) const {
    return outcome == StepOutcome::done && index() < target;
  }
  void sample(double displacement) {
    sink->sample_displacement(displacement);
    next_sample = sink->next_step();
  }
  /// For simulations whose last step was done outside the lanes.
  void sample_where_due() {
    if (outcome == StepOutcome::done && index() == next_sample)
      sample(simulation->displacement(row.body, row.row));
  }
};

/// Simulations of one shape, as many as a vector holds. Steps for which a lane is not made they do
/// by themselves, out of their own state.
class LaneGroup {
 public:
  explicit LaneGroup(const LaneShape& shape) : storage_(shape) {}

  bool is_full() const { return members_.size() == storage_.width(); }
  void add(Simulation& simulation) { members_.emplace_back(simulation); }
  StepOutcome outcome(std::size_t lane) const { return members_[lane].outcome; }

  // As the functions of Batch.
  void watch(std::size_t lane, DisplacementSink& sink, DisplacementSink::Row row);
  void step_until(std::int64_t target);
  void synchronise() {
    for (std::size_t lane = 0; lane < members_.size(); ++lane) put_back(lane);
  }

 private:
  LaneAccess::Into into(std::size_t lane) const { return {lane, storage_.width()}; }
  LaneAccess::OutOf out_of(std::size_t lane) const { return {lane, storage_.width()}; }
  template <class Copy>
  void copy_place(const Copy& copy, LaneMember& member);
  template <class Copy>
  void copy_rest(const Copy& copy, LaneMember& member);
  void take_in(std::size_t lane);
  /// The whole state of a lane that holds one.
  void put_back(std::size_t lane);
  /// The same for a simulation that goes on by itself.
  void release(std::size_t lane) {
    put_back(lane);
    members_[lane].is_resident = false;
  }

  /// By itself, as long as something changes that lanes take for constant.
  void step_until_quiet(std::size_t lane, std::int64_t target);
  /// Marks the lanes of those that have yet to reach the target. @returns steps that all of them
  /// can do in the lanes, nothing where none has any to do
  std::optional<std::int64_t> use_lanes(std::int64_t target);
  /// All lanes in use; those that it takes more for than the kernel does end the last step by
  /// themselves.
  void step(std::int64_t num_steps);
  /// The samples that are due in the next steps, which the kernel has done.
  void hand_out(std::size_t lane, std::int64_t num_steps);

  LaneStorage storage_;
  std::vector<LaneMember> members_;
};

}  // namespace stridor
