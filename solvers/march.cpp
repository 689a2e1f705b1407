#include "solvers/march.hpp"

#include <algorithm>
#include <chrono>
#include <limits>

#include "core/stop_token.hpp"

namespace stridor {
namespace {

/// Steps between looks at the clock and the stop request: about a tenth of a millisecond.
constexpr std::int64_t block = 256;

}  // namespace

MarchResult march(Simulation& simulation, SampleSink* sink, const MarchPlan& plan) {
  using Clock = std::chrono::steady_clock;
  MarchResult result;
  result.force_extremes.resize(static_cast<std::size_t>(simulation.num_contacts()));
  bool is_open = false;
  bool was_closed = false;
  const auto close_window = [&] {
    if (!is_open || was_closed) return;
    was_closed = true;
    for (int i = 0; i < simulation.num_contacts(); ++i) {
      result.force_extremes[static_cast<std::size_t>(i)] = simulation.force_extremes(i);
    }
  };

  const auto start = Clock::now();
  auto next_report = start + std::chrono::milliseconds(250);
  std::int64_t next_look = 0;
  while (true) {
    const std::int64_t now = simulation.step_index();
    if (!is_open && now >= plan.measure_from && now <= plan.measure_to) {
      is_open = true;
      simulation.reset_force_extremes();
    }
    if (now >= plan.measure_to) close_window();
    if (sink != nullptr && sink->next_step() == now) sink->sample(simulation);
    if (now >= plan.last_step) break;
    if (now >= next_look) {
      next_look = now + block;
      if (stop_requested()) {
        result.end = MarchEnd::stopped;
        break;
      }
      if (plan.on_progress && Clock::now() >= next_report) {
        plan.on_progress(simulation);
        next_report = Clock::now() + std::chrono::milliseconds(250);
      }
    }
    std::int64_t target = std::min(plan.last_step, next_look);
    if (sink != nullptr) target = std::min(target, std::max(sink->next_step(), now + 1));
    if (!is_open && plan.measure_from > now) target = std::min(target, plan.measure_from);
    if (is_open && !was_closed && plan.measure_to > now) target = std::min(target, plan.measure_to);
    if (simulation.step_until(target) != StepOutcome::done) {
      result.end = MarchEnd::failed;
      break;
    }
  }
  close_window();
  return result;
}

}  // namespace stridor
