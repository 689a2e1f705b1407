#include "solvers/march.hpp"

#include <algorithm>
#include <chrono>
#include <limits>

#include "core/stop_token.hpp"

namespace stridor {
namespace {

/// Steps between looks at the clock and the stop request: a fraction of a millisecond.
constexpr std::int64_t block = 1024;

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
  constexpr std::int64_t never = std::numeric_limits<std::int64_t>::max();
  std::int64_t sink_next = sink != nullptr ? sink->next_step() : never;
  while (true) {
    const std::int64_t now = simulation.step_index();
    if (!is_open && now >= plan.measure_from && now <= plan.measure_to) {
      is_open = true;
      simulation.reset_force_extremes();
    }
    if (now >= plan.measure_to) close_window();
    if (sink_next == now) {
      sink->sample(simulation);
      sink_next = sink->next_step();
    }
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
    // Up to the next event only the sink interrupts the steps.
    std::int64_t event = std::min(plan.last_step, next_look);
    if (!is_open && plan.measure_from > now) event = std::min(event, plan.measure_from);
    if (is_open && !was_closed && plan.measure_to > now) event = std::min(event, plan.measure_to);
    StepOutcome outcome = StepOutcome::done;
    while (sink_next < event && outcome == StepOutcome::done) {
      outcome = simulation.step_until(sink_next);
      if (outcome == StepOutcome::done) {
        sink->sample(simulation);
        sink_next = sink->next_step();
      }
    }
    if (outcome == StepOutcome::done) outcome = simulation.step_until(event);
    if (outcome != StepOutcome::done) {
      result.end = MarchEnd::failed;
      break;
    }
  }
  close_window();
  return result;
}

}  // namespace stridor
