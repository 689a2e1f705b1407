#include "app/transient.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <tuple>

#include "analysis/step_guard.hpp"
#include "app/transient_results.hpp"
#include "core/activity.hpp"
#include "core/errors.hpp"
#include "io/initial_state.hpp"

namespace stridor {
namespace {

/// Frequencies and damping ratios of a reduced body; the damping is the one after its schedule.
void write_modes(RunFileWriter& writer, const SystemBody& body) {
  const ModalBody& modal = body.modal;
  std::vector<double> frequency;
  std::vector<double> damping_ratio;
  for (const double omega : modal.omega) {
    frequency.push_back(omega / (2.0 * std::numbers::pi));
    damping_ratio.push_back(
        omega > 0.0 ? 0.5 * (modal.damping.alpha / omega + modal.damping.beta * omega) : 0.0);
  }
  writer.write_static("/modal/" + body.name + "/frequency", frequency, "Hz");
  writer.write_static("/modal/" + body.name + "/damping_ratio", damping_ratio, "1");
}

/// One array per property of the bursts, so that any reader of HDF5 can take them.
void store_bursts(RunFileWriter& writer, const std::vector<Burst>& bursts) {
  const std::vector<std::tuple<const char*, double Burst::*, const char*>> properties{
      {"start", &Burst::start, "s"},
      {"end", &Burst::end, "s"},
      {"frequency", &Burst::frequency, "Hz"},
      {"peak", &Burst::peak, "m/s^2"},
      {"gain", &Burst::gain, "1"}};
  for (const auto& [name, member, units] : properties) {
    std::vector<double> values;
    values.reserve(bursts.size());
    for (const Burst& burst : bursts) values.push_back(burst.*member);
    writer.write_static(std::string("/bursts/") + name, values, units);
  }
}

/// How the bodies and the drive were when the run began, so that one that goes on begins likewise:
/// what they were taken from may be gone.
void save_start(const System& system, State& state) {
  state.put("start/drive", system.drive.displaced);
  const auto put = [&](const std::string& name, const Eigen::VectorXd& motion) {
    if (motion.size() > 0)
      state.put(name, {motion.data(), static_cast<std::size_t>(motion.size())});
  };
  for (const SystemBody& body : system.bodies) {
    put("start/" + body.name + "/displacement", body.initial_displacement);
    put("start/" + body.name + "/velocity", body.initial_velocity);
  }
}

void load_start(const State& state, System& system) {
  system.drive.displaced = state.get("start/drive");
  const auto get = [&](const std::string& name, Eigen::VectorXd& motion) {
    const auto found = state.arrays().find(name);
    if (found == state.arrays().end()) return;
    motion = Eigen::Map<const Eigen::VectorXd>(found->second.data(),
                                               static_cast<Eigen::Index>(found->second.size()));
  };
  for (SystemBody& body : system.bodies) {
    get("start/" + body.name + "/displacement", body.initial_displacement);
    get("start/" + body.name + "/velocity", body.initial_velocity);
  }
}

}  // namespace

Transient::Transient(const LoadedScene& loaded, const RunOutput& output)
    : loaded_(&loaded), file_(output.file), keeper_(loaded.scene.checkpoint.every) {
  check_output(file_, output.overwrite);
  model_ = build_model(loaded);
  const Activity preparing("preparing the first step");
  set_initial_state(model_.system, loaded);
  try {
    make_simulation();
  } catch (const ConfigError& error) {
    throw loaded.located(error);
  }
  const auto file_start = Clock::now();
  writer_.emplace(
      file_, output.overwrite,
      run_header(output.command_line, loaded.text, loaded.resolved(), scene_files(loaded)),
      series());
  for (const SystemBody& body : model_.system.bodies) write_modes(*writer_, body);
  make_march();
  write_checkpoint();
  file_seconds_ = seconds_since(file_start);
  setup_seconds_ = keeper_.seconds() - file_seconds_;
}

Transient::Transient(const LoadedScene& loaded, const InterruptedRun& interrupted)
    : loaded_(&loaded), file_(interrupted.file), keeper_(loaded.scene.checkpoint.every) {
  model_ = build_model(loaded);
  const Activity preparing("preparing the next step");
  try {
    load_start(interrupted.checkpoint.state, model_.system);
    make_simulation();
    const auto file_start = Clock::now();
    writer_.emplace(RunFileWriter::resume(file_, series(), interrupted.checkpoint));
    file_seconds_ = seconds_since(file_start);
    make_march();
    load(interrupted.checkpoint.state);
  } catch (const std::invalid_argument& error) {
    throw_unfit_checkpoint(file_, error.what());
  }
  setup_seconds_ = keeper_.seconds() - file_seconds_;
}

void Transient::make_simulation() {
  const Scene& scene = loaded_->scene;
  simulation_ = make_run_simulation(model_.system, *scene.time, accounts_of(scene));
  if (scene.record) channels_ = parse_channels(*scene.record, scene.model);
  interval_ = scene.record ? scene.record->interval : scene.time->step;
}

std::vector<SeriesSpec> Transient::series() const {
  return Recorder::series(model_, channels_, loaded_->scene.time->step, interval_);
}

void Transient::make_march() {
  const Scene& scene = loaded_->scene;
  const double step = scene.time->step;
  recorder_.emplace(model_, channels_, step, interval_, *writer_);
  end_step_ = static_cast<std::int64_t>(std::llround(scene.time->end / step));
  // The last sample needs the filter's look-ahead beyond the end.
  last_step_ = end_step_ + recorder_->latency();
  recorder_->limit_samples(
      static_cast<std::int64_t>(std::floor(scene.time->end / interval_ + 1e-6)) + 1);
  MarchPlan plan = measured_plan(scene, last_step_);
  plan.on_progress = [this](const Simulation& running) {
    keeper_.look_after(running.time(), loaded_->scene.time->end, *writer_,
                       [this] { return save(); });
  };
  march_.emplace(*simulation_, &*recorder_, std::move(plan));
}

State Transient::save() const {
  State state = simulation_->save();
  recorder_->save(state, "recorder/");
  march_->save(state, "march/");
  state.put("march_seconds", march_seconds_);
  save_start(model_.system, state);
  for (const auto& [path, values] : final_motion_.arrays()) state.put("final/" + path, values);
  return state;
}

void Transient::load(const State& state) {
  simulation_->load(state);
  recorder_->load(state, "recorder/");
  march_->load(state, "march/");
  march_seconds_ = state.get("march_seconds");
  const std::string prefix = "final/";
  for (const auto& [name, values] : state.arrays()) {
    if (name.starts_with(prefix)) final_motion_.put(name.substr(prefix.size()), values);
  }
}

void Transient::write_checkpoint() {
  keeper_.write_checkpoint(*writer_, save());
}

MarchEnd Transient::run_to_step(std::int64_t step) {
  // The final motion is that at the end asked for, not where the filters have seen enough.
  if (step > end_step_ && final_motion_.arrays().empty() &&
      run_to_step(end_step_) != MarchEnd::finished)
    return end_;
  const auto start = Clock::now();
  const double writing_before = writer_->write_seconds();
  end_ = march_->run_until(step);
  march_seconds_ += seconds_since(start) - (writer_->write_seconds() - writing_before);
  // Losing the contact within the filter's look-ahead is no failure of the run that was asked for.
  if (end_ == MarchEnd::failed && simulation_->step_index() >= end_step_) end_ = MarchEnd::finished;
  if (simulation_->step_index() == end_step_) keep_final_motion();
  return end_;
}

MarchEnd Transient::run_until(double time) {
  return run_to_step(static_cast<std::int64_t>(std::llround(time / loaded_->scene.time->step)));
}

MarchEnd Transient::run_to_end() {
  return run_to_step(last_step_);
}

/// The motion of every body where the run has ended, for scenes that start from it.
void Transient::keep_final_motion() {
  if (!final_motion_.arrays().empty()) return;
  final_motion_.put("time", simulation_->time());
  final_motion_.put("drive_displacement", simulation_->drive_displacement());
  for (std::size_t b = 0; b < model_.system.bodies.size(); ++b) {
    const SystemBody& body = model_.system.bodies[b];
    if (body.modal.size() == 0) continue;
    const Propagator::Motion motion = simulation_->reduced_motion(static_cast<int>(b));
    const auto keep = [&](const char* name, const Eigen::VectorXd& vector) {
      final_motion_.put(body.name + name, {vector.data(), static_cast<std::size_t>(vector.size())});
    };
    keep("/displacement", motion.displacement);
    keep("/velocity", motion.velocity);
  }
}

void Transient::write_final_motion() {
  for (const auto& [path, values] : final_motion_.arrays()) {
    const bool is_velocity = path.ends_with("/velocity");
    writer_->write_static("/final/" + path, values,
                          path == "time" ? "s" : (is_velocity ? "m/s" : "m"));
  }
}

Json Transient::finish(const Json& error) {
  const Activity summing("summing up the run");
  const Scene& scene = loaded_->scene;
  writer_->flush();
  const auto acceleration = summarise_acceleration(RunFileReader(file_), scene.measure);
  const std::int64_t steps = simulation_->step_index();
  Json results = transient_results(*simulation_, model_.system, *scene.time, end_,
                                   march_->statistics(), acceleration);
  results.update(
      effort_json(steps, scene.time->step, step_limit_json(model_.system, *scene.time),
                  {setup_seconds_, march_seconds_, file_seconds_ + writer_->write_seconds()}));
  results["error"] = error;
  results["file"] = file_;
  keep_final_motion();
  write_final_motion();
  store_results(*writer_, results);
  if (acceleration && acceleration->bursts && !acceleration->bursts->empty()) {
    store_bursts(*writer_, *acceleration->bursts);
  }
  writer_->close();
  return results;
}

}  // namespace stridor
