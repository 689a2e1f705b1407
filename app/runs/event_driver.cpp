#include "app/runs/event_driver.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>

#include "app/results/transient_results.hpp"
#include "app/runs/cycle_motion.hpp"
#include "core/errors.hpp"
#include "core/stop_token.hpp"

namespace stridor {
namespace {

std::vector<Channel> channels_of(const Scene& scene) {
  return scene.record ? parse_channels(*scene.record, scene.model) : std::vector<Channel>();
}

/// @throws NumericalError if the oscillator does not slide steadily, which gives its size
SubstrateMotion make_motion(const SlidingOscillator& oscillator, const TimeParameters& time) {
  (void)sliding_equilibrium(oscillator);
  return {oscillator.oscillator, time.tolerance};
}

}  // namespace

EventDriver::EventDriver(const LoadedScene& loaded, const Model& model)
    : loaded_(&loaded),
      model_(&model),
      channels_(channels_of(loaded.scene)),
      interval_(loaded.scene.record ? loaded.scene.record->interval : loaded.scene.time->end),
      oscillator_(oscillator_of(loaded, model.system, "time.integrator")),
      motion_(make_motion(oscillator_, *loaded.scene.time)),
      recorder_(model, channels_, oscillator_),
      meter_(loaded.scene.measure.from / oscillator_.time,
             loaded.scene.measure.to.value_or(loaded.scene.time->end) / oscillator_.time) {
  motion_.start(oscillator_.initial_displacement(model.system),
                oscillator_.initial_velocity(model.system));
}

std::vector<SeriesSpec> EventDriver::series() const {
  return EventRecorder::series(*model_, channels_);
}

void EventDriver::begin(RowSink& rows, std::function<void()> on_progress) {
  rows_ = &rows;
  on_progress_ = std::move(on_progress);
}

/// Called between steps, where the run may stop: from a state saved there it resumes bit-identically
/// to an uninterrupted run.
bool EventDriver::is_to_stop() {
  if (stop_requested()) return true;
  const auto now = std::chrono::steady_clock::now();
  if (now >= last_report_ + std::chrono::milliseconds(250)) {
    last_report_ = now;
    on_progress_();
  }
  return false;
}

/// To a time, s, by the ends of the window.
MarchEnd EventDriver::advance_to(double time) {
  if (window_ == Window::ahead && scene().measure.from <= time) {
    const MarchEnd reached = go_to(scene().measure.from);
    if (reached != MarchEnd::finished) return reached;
    steps_before_ = motion_.statistics().steps;
    motion_.restart_statistics();
    window_ = Window::open;
  }
  if (window_ == Window::open && measure_to() <= time) {
    const MarchEnd reached = go_to(measure_to());
    if (reached != MarchEnd::finished) return reached;
    meter_ = with_extremes();
    window_ = Window::closed;
  }
  return go_to(time);
}

CycleMeter EventDriver::with_extremes() const {
  CycleMeter meter = meter_;
  if (window_ != Window::open) return meter;
  const SubstrateMotion::Statistics& seen = motion_.statistics();
  const double at = std::min(motion_.time(), measure_to() / oscillator_.time);
  meter.note_position(at, seen.smallest_x, seen.largest_y);
  meter.note_position(at, seen.largest_x, seen.largest_y);
  return meter;
}

MarchEnd EventDriver::go_to(double time) {
  const double target = time / oscillator_.time;
  while (motion_.time() < target) {
    if (is_to_stop()) return MarchEnd::stopped;
    const SubstrateMotion::Stop stop = motion_.advance(target, true);
    const SubstrateMotion::State& s = motion_.state();
    if (stop == SubstrateMotion::Stop::failed) {
      failure_ = fmt::format("after t = {:.6g} s {}", this->time(), motion_.failure());
      return MarchEnd::failed;
    }
    if (stop == SubstrateMotion::Stop::turn) {
      const SubstrateMotion::Statistics& seen = motion_.statistics();
      meter_.note_turn({motion_.time(), s[0], s[4], s[5], seen.stick_time, seen.free_time});
    }
  }
  return MarchEnd::finished;
}

void EventDriver::sample() {
  const double at = static_cast<double>(next_sample_) * interval_;
  const MeasureParameters& measure = scene().measure;
  if (at >= measure.from && at <= measure.to.value_or(at)) {
    const double force = oscillator_.force * motion_.forces().normal.value;
    force_min_ = std::min(force_min_, force);
    force_max_ = std::max(force_max_, force);
  }
  recorder_.write(at, motion_, *rows_);
  ++next_sample_;
}

MarchEnd EventDriver::run_until(double time) {
  const auto last = static_cast<std::int64_t>(std::floor(time / interval_ + 1e-6));
  while (next_sample_ <= last) {
    const MarchEnd reached = advance_to(static_cast<double>(next_sample_) * interval_);
    if (reached != MarchEnd::finished) return reached;
    sample();
  }
  return MarchEnd::finished;
}

MarchEnd EventDriver::run_to_end() {
  const double end = scene().time->end;
  MarchEnd reached = run_until(end);
  if (reached == MarchEnd::finished) reached = advance_to(end);
  if (reached == MarchEnd::finished) keep_final_motion();
  return reached;
}

State EventDriver::save() const {
  State state;
  motion_.save(state, "motion/");
  meter_.save(state, "meter/");
  state.put("window", static_cast<double>(window_));
  state.put("steps_before", static_cast<double>(steps_before_));
  state.put("next_sample", static_cast<double>(next_sample_));
  state.put("force", std::array{force_min_, force_max_});
  for (const auto& [path, values] : final_motion_.arrays()) state.put("final/" + path, values);
  return state;
}

void EventDriver::load(const State& state) {
  motion_.load(state, "motion/");
  meter_.load(state, "meter/");
  window_ = static_cast<Window>(static_cast<int>(state.get("window")));
  steps_before_ = static_cast<std::int64_t>(state.get("steps_before"));
  next_sample_ = static_cast<std::int64_t>(state.get("next_sample"));
  std::array<double, 2> force{};
  state.get("force", force);
  force_min_ = force[0];
  force_max_ = force[1];
  const std::string prefix = "final/";
  for (const auto& [name, values] : state.arrays()) {
    if (name.starts_with(prefix)) final_motion_.put(name.substr(prefix.size()), values);
  }
}

State EventDriver::present_motion() const {
  State now;
  const SubstrateMotion::State& s = motion_.state();
  now.put("time", time());
  std::vector<double> driven;
  for (const Drive& drive : model_->system.drives) driven.push_back(drive.displacement(time()));
  now.put("drive_displacement", driven);
  const std::string& body =
      model_->system.bodies[static_cast<std::size_t>(oscillator_.mass.body)].name;
  const auto keep = [&](const char* name, const Eigen::Vector2d& in_contact) {
    const Eigen::Vector2d reduced = oscillator_.mass.to_body * in_contact;
    now.put(body + name, {reduced.data(), 2});
  };
  keep("/displacement", oscillator_.to_si({s[0], s[1]}, oscillator_.length));
  keep("/velocity", oscillator_.to_si({s[2], s[3]}, oscillator_.velocity_unit()));
  return now;
}

void EventDriver::keep_final_motion() {
  if (final_motion_.arrays().empty()) final_motion_ = present_motion();
}

Json EventDriver::results(MarchEnd end,
                          const std::optional<AccelerationSummary>& acceleration) const {
  const CycleMeter::Reading seen = with_extremes().reading();
  const double length = oscillator_.length;
  Json results = {{"status", end == MarchEnd::finished  ? "done"
                             : end == MarchEnd::stopped ? "stopped"
                                                        : "failed"},
                  {"contact_force", {{"min", number(force_min_)}, {"max", number(force_max_)}}},
                  {"stick_fraction", number_or_null(seen.stick_fraction)},
                  {"free_fraction", number_or_null(seen.free_fraction)},
                  {"period", seen.period ? number(oscillator_.time * *seen.period) : Json(nullptr)},
                  {"x", displacement_json(seen, oscillator_)}};
  results.update(indentation_json(seen.deepest * length, oscillator_.mass));
  results.update(acceleration_json(acceleration));
  return results;
}

}  // namespace stridor
