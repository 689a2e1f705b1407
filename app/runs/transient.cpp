#include "app/runs/transient.hpp"

#include <numbers>
#include <utility>

#include "app/runs/heard_windows.hpp"
#include "app/stability/verdict.hpp"
#include "core/activity.hpp"
#include "core/errors.hpp"
#include "io/run_file/initial_state.hpp"

namespace stridor {
namespace {

/// Frequencies and damping ratios of the reduced bodies; the damping is the one after its schedule.
std::vector<StaticArray> modes_of(const System& system) {
  std::vector<StaticArray> arrays;
  for (const SystemBody& body : system.bodies) {
    const ModalBody& modal = body.modal;
    std::vector<double> frequency;
    std::vector<double> damping_ratio;
    for (const double omega : modal.omega) {
      frequency.push_back(omega / (2.0 * std::numbers::pi));
      damping_ratio.push_back(
          omega > 0.0 ? 0.5 * (modal.damping.alpha / omega + modal.damping.beta * omega) : 0.0);
    }
    arrays.push_back({"/modal/" + body.name + "/frequency", std::move(frequency), "Hz"});
    arrays.push_back({"/modal/" + body.name + "/damping_ratio", std::move(damping_ratio), "1"});
  }
  return arrays;
}

/// How the bodies and the drives were when the run began, so that one that goes on begins likewise:
/// what they were taken from may be gone.
void save_start(const System& system, State& state) {
  std::vector<double> displaced;
  displaced.reserve(system.drives.size());
  for (const Drive& drive : system.drives) displaced.push_back(drive.displaced);
  state.put("start/drive", displaced);
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
  std::vector<double> displaced(system.drives.size());
  state.get("start/drive", displaced);
  for (std::size_t d = 0; d < displaced.size(); ++d) system.drives[d].displaced = displaced[d];
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
  start_ = set_initial_state(model_.system, loaded);
  driver_ = make_run_driver(loaded, model_);
  const auto file_start = Clock::now();
  writer_.emplace(
      file_, output.overwrite,
      run_header(output.command_line, loaded.text, loaded.resolved(), scene_files(loaded)),
      driver_->series(), RunFileOptions{}, modes_of(model_.system));
  begin();
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
    driver_ = make_run_driver(loaded, model_);
    const auto file_start = Clock::now();
    writer_.emplace(RunFileWriter::resume(file_, driver_->series(), interrupted.checkpoint));
    file_seconds_ = seconds_since(file_start);
    begin();
    load(interrupted.checkpoint.state);
  } catch (const std::invalid_argument& error) {
    throw_unfit_checkpoint(file_, error.what());
  }
  setup_seconds_ = keeper_.seconds() - file_seconds_;
}

void Transient::begin() {
  driver_->begin(*writer_, [this] {
    keeper_.look_after(time(), loaded_->scene.time->end, *writer_, [this] { return save(); });
  });
}

State Transient::save() const {
  State state = driver_->save();
  state.put("march_seconds", march_seconds_);
  save_start(model_.system, state);
  if (start_.perturbation) {
    const double s[] = {start_.perturbation->real(), start_.perturbation->imag()};
    state.put("start/perturbation", s);
  }
  return state;
}

void Transient::load(const State& state) {
  driver_->load(state);
  march_seconds_ = state.get("march_seconds");
  if (state.arrays().contains("start/perturbation")) {
    double s[2];
    state.get("start/perturbation", s);
    start_.perturbation = {s[0], s[1]};
  }
}

void Transient::write_checkpoint() {
  keeper_.write_checkpoint(*writer_, save());
}

template <class Advance>
MarchEnd Transient::timed(const Advance& advance) {
  const auto start = Clock::now();
  const double writing_before = writer_->write_seconds();
  end_ = advance();
  march_seconds_ += seconds_since(start) - (writer_->write_seconds() - writing_before);
  return end_;
}

MarchEnd Transient::run_until(double time) {
  return timed([&] { return driver_->run_until(time); });
}

void Transient::write_frames(const std::filesystem::path& folder, double interval) {
  frames_ = std::make_unique<RunFrames>(model_, folder);
  frame_interval_ = interval;
}

void Transient::compare_with(std::vector<TimedWindow> windows) {
  windows_ = std::move(windows);
}

/// Shapes before the present time are those of a run that this one goes on with.
MarchEnd Transient::run_from_frame_to_frame() {
  const double end = loaded_->scene.time->end * (1.0 + 1e-12);
  for (int number = 0; number * frame_interval_ <= end; ++number) {
    const double time = number * frame_interval_;
    if (time < driver_->time() - 1e-9 * frame_interval_) {
      frames_->adopt(number, time);
      continue;
    }
    const MarchEnd how = run_until(time);
    if (how != MarchEnd::finished) return how;
    frames_->write(number, driver_->present_motion());
  }
  return MarchEnd::finished;
}

MarchEnd Transient::run_to_end() {
  if (frames_) {
    const MarchEnd how = run_from_frame_to_frame();
    if (how != MarchEnd::finished) return how;
  }
  return timed([&] { return driver_->run_to_end(); });
}

/// The motion of every body where the run has ended, for scenes that start from it.
void Transient::write_final_motion() {
  driver_->keep_final_motion();
  const State motion = driver_->final_motion();
  for (const auto& [path, values] : motion.arrays()) {
    const bool is_time = path == "time";
    const bool is_velocity = path.ends_with("/velocity");
    const bool is_of_drives = path == "drive_displacement";
    writer_->write_static({"/final/" + path, values, is_time ? "s" : (is_velocity ? "m/s" : "m"),
                           is_time ? "time" : (is_of_drives ? "drive" : "coordinate")});
  }
}

Json Transient::finish(const Json& error) {
  const Activity summing("summing up the run");
  const Scene& scene = loaded_->scene;
  writer_->flush();
  const auto acceleration = summarise_acceleration(RunFileReader(file_), scene.measure);
  Json results = driver_->results(end_, acceleration);
  const RunDriver::Effort effort = driver_->effort();
  results.update(
      effort_json(effort.steps, effort.step, effort.limit,
                  {setup_seconds_, march_seconds_, file_seconds_ + writer_->write_seconds()}));
  results["error"] = error;
  results["perturbation"] =
      start_.perturbation
          ? Json{{"frequency", number(start_.perturbation->imag() / (2.0 * std::numbers::pi))},
                 {"growth", number(start_.perturbation->real())}}
          : Json(nullptr);
  results["file"] = file_;
  results["trusted_frequency"] = number(trusted_frequency(model_.system));
  write_final_motion();
  const bool is_searched = acceleration && acceleration->bursts;
  if (is_searched) store_bursts(*writer_, *acceleration->bursts);
  if (windows_) {
    results["prediction"] = results["unexplained"] = nullptr;
    if (is_searched) store_heard_windows(*writer_, *windows_, *acceleration->bursts, results);
  }
  store_results(*writer_, results);
  writer_->close();
  return results;
}

}  // namespace stridor
