#include "app/runs/step_driver.hpp"

#include <cmath>

#include "analysis/step_guard.hpp"
#include "app/results/transient_results.hpp"

namespace stridor {

StepDriver::StepDriver(const LoadedScene& loaded, const Model& model)
    : loaded_(&loaded),
      model_(&model),
      interval_(loaded.scene.record ? loaded.scene.record->interval : loaded.scene.time->step),
      simulation_(make_run_simulation(model.system, *loaded.scene.time, accounts_of(loaded.scene))) {
  if (scene().record) channels_ = parse_channels(*scene().record, scene().model);
}

std::vector<SeriesSpec> StepDriver::series() const {
  return Recorder::series(*model_, channels_, scene().time->step, interval_);
}

void StepDriver::begin(RowSink& rows, std::function<void()> on_progress) {
  const double step = scene().time->step;
  recorder_.emplace(*model_, channels_, step, interval_, rows);
  end_step_ = static_cast<std::int64_t>(std::llround(scene().time->end / step));
  // The last sample needs the filter's look-ahead beyond the end.
  last_step_ = end_step_ + recorder_->latency();
  recorder_->limit_samples(
      static_cast<std::int64_t>(std::floor(scene().time->end / interval_ + 1e-6)) + 1);
  MarchPlan plan = measured_plan(scene(), last_step_);
  plan.on_progress = [report = std::move(on_progress)](const Simulation&) { report(); };
  march_.emplace(simulation_, &*recorder_, std::move(plan));
}

State StepDriver::save() const {
  State state = simulation_.save();
  recorder_->save(state, "recorder/");
  march_->save(state, "march/");
  for (const auto& [path, values] : final_motion_.arrays()) state.put("final/" + path, values);
  return state;
}

void StepDriver::load(const State& state) {
  simulation_.load(state);
  recorder_->load(state, "recorder/");
  march_->load(state, "march/");
  const std::string prefix = "final/";
  for (const auto& [name, values] : state.arrays()) {
    if (name.starts_with(prefix)) final_motion_.put(name.substr(prefix.size()), values);
  }
}

MarchEnd StepDriver::run_to_step(std::int64_t step) {
  // The final motion is that at the end asked for, not where the filters have seen enough.
  if (step > end_step_ && final_motion_.arrays().empty()) {
    const MarchEnd end = run_to_step(end_step_);
    if (end != MarchEnd::finished) return end;
  }
  MarchEnd end = march_->run_until(step);
  // Losing the contact within the filter's look-ahead is no failure of the run that was asked for.
  if (end == MarchEnd::failed && simulation_.step_index() >= end_step_) end = MarchEnd::finished;
  if (simulation_.step_index() == end_step_) keep_final_motion();
  return end;
}

MarchEnd StepDriver::run_until(double time) {
  return run_to_step(static_cast<std::int64_t>(std::llround(time / scene().time->step)));
}

State StepDriver::present_motion() const {
  State now;
  now.put("time", simulation_.time());
  std::vector<double> driven;
  for (std::size_t d = 0; d < model_->system.drives.size(); ++d)
    driven.push_back(simulation_.drive_displacement(static_cast<int>(d)));
  now.put("drive_displacement", driven);
  for (std::size_t b = 0; b < model_->system.bodies.size(); ++b) {
    const SystemBody& body = model_->system.bodies[b];
    if (body.modal.size() == 0) continue;
    const Propagator::Motion motion = simulation_.reduced_motion(static_cast<int>(b));
    const auto keep = [&](const char* name, const Eigen::VectorXd& vector) {
      now.put(body.name + name, {vector.data(), static_cast<std::size_t>(vector.size())});
    };
    keep("/displacement", motion.displacement);
    keep("/velocity", motion.velocity);
  }
  return now;
}

void StepDriver::keep_final_motion() {
  if (final_motion_.arrays().empty()) final_motion_ = present_motion();
}

RunDriver::Effort StepDriver::effort() const {
  return {simulation_.step_index(), number(scene().time->step),
          step_limit_json(model_->system, *scene().time)};
}

Json StepDriver::results(MarchEnd end,
                         const std::optional<AccelerationSummary>& acceleration) const {
  return transient_results(simulation_, model_->system, *scene().time, end, march_->statistics(),
                           acceleration);
}

}  // namespace stridor
