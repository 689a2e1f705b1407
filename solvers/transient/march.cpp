#include "solvers/transient/march.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <limits>
#include <utility>

#include "core/stop_token.hpp"
#include "solvers/transient/batch.hpp"

namespace stridor {
namespace {

/// Steps between looks at the clock and the stop request: a fraction of a millisecond.
constexpr std::int64_t block = 1024;

}  // namespace

March::March(Simulation& simulation, SampleSink* sink, MarchPlan plan)
    : simulation_(&simulation),
      sink_(sink),
      plan_(std::move(plan)),
      sink_next_(sink != nullptr ? sink->next_step() : std::numeric_limits<std::int64_t>::max()),
      closed_statistics_(static_cast<std::size_t>(simulation.num_contacts())) {}

void March::note_window(std::int64_t now) {
  if (window_ == Window::ahead && now >= plan_.measure_from && now <= plan_.measure_to) {
    window_ = Window::open;
    simulation_->reset_statistics();
  }
  if (window_ == Window::open && now >= plan_.measure_to) {
    closed_statistics_ = statistics();
    window_ = Window::closed;
  }
}

MeasuredContacts March::statistics() const {
  MeasuredContacts measured = closed_statistics_;
  if (window_ != Window::open) return measured;
  for (int i = 0; i < simulation_->num_contacts(); ++i)
    measured[static_cast<std::size_t>(i)] = simulation_->statistics(i);
  return measured;
}

void March::save(State& state, const std::string& prefix) const {
  state.put(prefix + "window", static_cast<double>(window_));
  for (std::size_t i = 0; i < closed_statistics_.size(); ++i) {
    const ContactStatistics one = closed_statistics_[i].value_or(ContactStatistics{});
    state.put(fmt::format("{}is_closed/{}", prefix, i), closed_statistics_[i] ? 1.0 : 0.0);
    state.put(fmt::format("{}closed/{}", prefix, i), one.numbers());
  }
}

void March::load(const State& state, const std::string& prefix) {
  window_ = static_cast<Window>(static_cast<int>(state.get(prefix + "window")));
  for (std::size_t i = 0; i < closed_statistics_.size(); ++i) {
    ContactStatistics::Numbers numbers;
    state.get(fmt::format("{}closed/{}", prefix, i), numbers);
    closed_statistics_[i].reset();
    if (state.get(fmt::format("{}is_closed/{}", prefix, i)) != 0.0)
      closed_statistics_[i] = ContactStatistics::of(numbers);
  }
  if (sink_ != nullptr) sink_next_ = sink_->next_step();
}

void March::attend() {
  const std::int64_t now = simulation_->step_index();
  note_window(now);
  if (sink_next_ == now) take_sample();
}

void March::take_sample() {
  simulation_->end_interval();
  sink_->sample(*simulation_);
  sink_next_ = sink_->next_step();
}

std::int64_t March::next_event() const {
  const std::int64_t now = simulation_->step_index();
  std::int64_t event = plan_.last_step;
  if (sink_next_ > now) event = std::min(event, sink_next_);
  if (window_ == Window::ahead && plan_.measure_from > now)
    event = std::min(event, plan_.measure_from);
  if (window_ == Window::open) event = std::min(event, plan_.measure_to);
  return event;
}

std::vector<MarchEnd> march_together(const std::vector<March*>& marches) {
  std::vector<Simulation*> simulations;
  for (const March* march : marches) simulations.push_back(march->simulation_);
  Batch batch(simulations);
  for (std::size_t i = 0; i < marches.size(); ++i) {
    auto* const sink = dynamic_cast<DisplacementSink*>(marches[i]->sink_);
    if (sink == nullptr || !sink->sole_row() || !batch.steps_in_lanes(i)) continue;
    // The first sample may be due now; later ones go from the batch to the sink.
    marches[i]->attend();
    marches[i]->sink_next_ = std::numeric_limits<std::int64_t>::max();
    batch.watch(i, *sink);
  }
  std::vector<std::optional<MarchEnd>> ends(marches.size());
  std::int64_t next_look = 0;
  while (true) {
    std::int64_t event = std::numeric_limits<std::int64_t>::max();
    std::int64_t now = event;
    for (std::size_t i = 0; i < marches.size(); ++i) {
      if (ends[i]) continue;
      if (batch.outcome(i) != StepOutcome::done) {
        ends[i] = MarchEnd::failed;
        continue;
      }
      marches[i]->attend();
      now = std::min(now, simulations[i]->step_index());
      if (simulations[i]->step_index() >= marches[i]->last_step()) {
        ends[i] = MarchEnd::finished;
      } else {
        event = std::min(event, marches[i]->next_event());
      }
    }
    if (event == std::numeric_limits<std::int64_t>::max()) break;
    if (now >= next_look) {
      next_look = now + block;
      if (stop_requested()) break;
    }
    batch.step_until(std::min(event, next_look));
  }
  batch.synchronise();
  for (March* march : marches)
    if (march->sink_ != nullptr) march->sink_next_ = march->sink_->next_step();
  std::vector<MarchEnd> all;
  for (const auto& end : ends) all.push_back(end.value_or(MarchEnd::stopped));
  return all;
}

MarchEnd March::run_until(std::int64_t step) {
  using Clock = std::chrono::steady_clock;
  const std::int64_t last_step = std::min(step, plan_.last_step);
  auto next_report = Clock::now() + std::chrono::milliseconds(250);
  std::int64_t next_look = simulation_->step_index();
  while (true) {
    attend();
    const std::int64_t now = simulation_->step_index();
    if (now >= last_step) return MarchEnd::finished;
    if (now >= next_look) {
      next_look = now + block;
      if (stop_requested()) return MarchEnd::stopped;
      if (plan_.on_progress && Clock::now() >= next_report) {
        plan_.on_progress(*simulation_);
        next_report = Clock::now() + std::chrono::milliseconds(250);
      }
    }
    // Up to the next event only the sink interrupts the steps.
    std::int64_t event = std::min(last_step, next_look);
    if (window_ == Window::ahead && plan_.measure_from > now)
      event = std::min(event, plan_.measure_from);
    if (window_ == Window::open) event = std::min(event, plan_.measure_to);
    StepOutcome outcome = StepOutcome::done;
    while (sink_next_ < event && outcome == StepOutcome::done) {
      outcome = simulation_->step_until(sink_next_);
      if (outcome == StepOutcome::done) take_sample();
    }
    if (outcome == StepOutcome::done) outcome = simulation_->step_until(event);
    if (outcome != StepOutcome::done) return MarchEnd::failed;
  }
}

MarchResult march(Simulation& simulation, SampleSink* sink, const MarchPlan& plan) {
  March whole(simulation, sink, plan);
  const MarchEnd end = whole.run_until(plan.last_step);
  return {end, whole.statistics()};
}

}  // namespace stridor
