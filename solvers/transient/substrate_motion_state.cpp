// What a motion from event to event needs to go on, in a checkpoint.
#include <algorithm>
#include <array>

#include "solvers/transient/substrate_motion.hpp"

namespace stridor {

void SubstrateMotion::save(stridor::State& state, const std::string& prefix) const {
  state.put(prefix + "time", time_);
  state.put(prefix + "step", step_);
  state.put(prefix + "state", state_);
  state.put(prefix + "slope", slope_);
  state.put(prefix + "mode", static_cast<double>(mode_));
  std::array<double, num_events> armed{};
  std::copy(armed_.begin(), armed_.end(), armed.begin());
  state.put(prefix + "armed", armed);
  const Statistics& seen = statistics_;
  state.put(prefix + "statistics",
            std::array{seen.from, seen.stick_time, seen.free_time, seen.smallest_x, seen.largest_x,
                       seen.largest_y, static_cast<double>(seen.steps),
                       static_cast<double>(seen.evaluations), static_cast<double>(seen.events)});
}

void SubstrateMotion::load(const stridor::State& state, const std::string& prefix) {
  time_ = state.get(prefix + "time");
  step_ = state.get(prefix + "step");
  state.get(prefix + "state", state_);
  state.get(prefix + "slope", slope_);
  mode_ = static_cast<SubstrateMode>(static_cast<int>(state.get(prefix + "mode")));
  std::array<double, num_events> armed{};
  state.get(prefix + "armed", armed);
  std::transform(armed.begin(), armed.end(), armed_.begin(), [](double on) { return on != 0.0; });
  std::array<double, 9> seen{};
  state.get(prefix + "statistics", seen);
  statistics_ = {seen[0],
                 seen[1],
                 seen[2],
                 seen[3],
                 seen[4],
                 seen[5],
                 static_cast<std::int64_t>(seen[6]),
                 static_cast<std::int64_t>(seen[7]),
                 static_cast<std::int64_t>(seen[8])};
}

}  // namespace stridor
