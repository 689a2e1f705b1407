#include "app/sphere_transient.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "core/errors.hpp"
#include "core/stop_token.hpp"

namespace stridor {
namespace {

/// After so many turns a motion may repeat itself.
constexpr std::size_t most_loops = 12;

/// Recorded series, with the units in which the sphere measures them.
struct Series {
  SeriesSpec spec;
  std::vector<double> SphereHistory::*values;
  double unit;
};

std::vector<Series> recorded(const SphereNumbers& numbers, double radius) {
  const double length = numbers.length_unit;
  const double velocity = length / numbers.time_unit;
  const double force = numbers.force_unit;
  // Values at the times of the rows, as the integrator has them.
  const auto series = [](const char* path, const char* units) {
    return SeriesSpec{path, units, SeriesKind::real, {{"filter", "none"}}};
  };
  SeriesSpec state = series("/contact/contact/state", "1");
  state.kind = SeriesKind::state;
  state.attributes.emplace_back("meaning",
                                "0 slower than the substrate, 1 faster, 2 stick, 3 off it");
  return {{series("/channels/sphere.x.displacement", "m"), &SphereHistory::x, length},
          {series("/channels/sphere.y.displacement", "m"), &SphereHistory::y, length},
          {series("/channels/sphere.x.velocity", "m/s"), &SphereHistory::vx, velocity},
          {series("/channels/sphere.y.velocity", "m/s"), &SphereHistory::vy, velocity},
          {series("/contact/contact/force", "N"), &SphereHistory::normal_force, force},
          {series("/contact/contact/friction_force", "N"), &SphereHistory::friction_force, force},
          {series("/contact/contact/slip_velocity", "m/s"), &SphereHistory::slip, velocity},
          {series("/contact/contact/area", "m^2"), &SphereHistory::area, radius * radius},
          {state, &SphereHistory::mode, 1.0}};
}

std::vector<SeriesSpec> specs_of(const std::vector<Series>& series) {
  std::vector<SeriesSpec> specs;
  specs.reserve(series.size());
  for (const Series& one : series) specs.push_back(one.spec);
  return specs;
}

}  // namespace

void CycleMeter::note_turn(const Turn& turn) {
  if (turn.time < from_) return;
  ++num_turns_;
  turns_.push_back(turn);
  if (turns_.size() > 2 * most_loops + 1) turns_.erase(turns_.begin() + 1);
}

void CycleMeter::note_position(double time, double x, double y) {
  if (time < from_) return;
  smallest_ = std::min(smallest_, x);
  largest_ = std::max(largest_, x);
  deepest_ = std::max(deepest_, y);
}

void CycleMeter::report(Json& results) const {
  if (num_turns_ < 3) {
    results["x"] = {
        {"min", number(smallest_)}, {"max", number(largest_)}, {"mean", nullptr}, {"rms", nullptr}};
    for (const char* name : {"period", "stick_fraction", "free_fraction"}) results[name] = nullptr;
    return;
  }
  const Turn& first = turns_.front();
  const Turn& last = turns_.back();
  const double duration = last.time - first.time;
  const double mean = (last.sum - first.sum) / duration;
  const double square = (last.squares - first.squares) / duration - mean * mean;
  results["x"] = {{"min", number(smallest_)},
                  {"max", number(largest_)},
                  {"mean", number(mean)},
                  {"rms", number(std::sqrt(std::max(0.0, square)))}};
  const auto loops = repeats_after();
  const double turn_time = duration / static_cast<double>(num_turns_ - 1);
  results["period"] = loops > 0 ? number(static_cast<double>(loops) * turn_time) : Json(nullptr);
  results["stick_fraction"] = number((last.stick - first.stick) / duration);
  results["free_fraction"] = number((last.free - first.free) / duration);
}

/// Turns after which the motion repeats itself to 1 % of its width; 0 where it does not.
std::size_t CycleMeter::repeats_after() const {
  for (std::size_t loops = 1; loops <= std::min(most_loops, num_turns_ / 2); ++loops) {
    double apart = 0.0;
    for (std::size_t i = turns_.size() - loops; i < turns_.size(); ++i)
      apart = std::max(apart, std::abs(turns_[i].x - turns_[i - loops].x));
    if (apart <= 1e-2 * (largest_ - smallest_)) return loops;
  }
  return 0;
}

void CycleMeter::save(State& state, const std::string& prefix) const {
  state.put(prefix + "extremes", std::array{smallest_, largest_, deepest_});
  state.put(prefix + "num_turns", static_cast<double>(num_turns_));
  std::vector<double> values;
  for (const Turn& turn : turns_)
    values.insert(values.end(), {turn.time, turn.x, turn.sum, turn.squares, turn.stick, turn.free});
  state.put(prefix + "turns", values);
}

void CycleMeter::load(const State& state, const std::string& prefix) {
  std::array<double, 3> extremes{};
  state.get(prefix + "extremes", extremes);
  smallest_ = extremes[0];
  largest_ = extremes[1];
  deepest_ = extremes[2];
  num_turns_ = static_cast<std::size_t>(state.get(prefix + "num_turns"));
  turns_.clear();
  const std::vector<double>& v = state.array(prefix + "turns");
  for (std::size_t i = 0; i + 6 <= v.size(); i += 6)
    turns_.push_back({v[i], v[i + 1], v[i + 2], v[i + 3], v[i + 4], v[i + 5]});
}

SphereTransient::SphereTransient(const LoadedSphereScene& loaded, const RunOutput& output)
    : loaded_(&loaded), file_(output.file), meter_(loaded.scene.time.end) {
  check_output(file_, output.overwrite);
  make_model();
  const Eigen::Vector2d start = initial_displacement(scene(), oscillator_);
  if (is_event_driven()) {
    motion_->start(start, Eigen::Vector2d::Zero());
    history_.add(oscillator_, *motion_);
  } else {
    stepper_->start(start, Eigen::Vector2d::Zero());
  }
  writer_.emplace(
      file_, output.overwrite,
      run_header(output.command_line, loaded.tree.document, loaded.resolved(), scene_files(loaded)),
      specs_of(recorded(numbers_, scene().model.sphere.radius)));
  write_checkpoint();
  setup_seconds_ = keeper_.seconds();
}

SphereTransient::SphereTransient(const LoadedSphereScene& loaded, const InterruptedRun& interrupted)
    : loaded_(&loaded), file_(interrupted.file), meter_(loaded.scene.time.end) {
  make_model();
  try {
    writer_.emplace(RunFileWriter::resume(
        file_, specs_of(recorded(numbers_, scene().model.sphere.radius)), interrupted.checkpoint));
    load(interrupted.checkpoint.state);
  } catch (const std::invalid_argument& error) {
    throw_unfit_checkpoint(file_, error.what());
  }
  setup_seconds_ = keeper_.seconds();
}

void SphereTransient::make_model() {
  keeper_ = RunKeeper(scene().checkpoint.every);
  numbers_ = sphere_numbers(scene().model.sphere);
  oscillator_ = make_sphere(scene().model);
  const SphereTimeParameters& time = scene().time;
  if (time.integrator == SphereIntegrator::event_driven) {
    motion_.emplace(oscillator_, time.tolerance);
    return;
  }
  stepper_.emplace(oscillator_,
                   time.integrator == SphereIntegrator::exact ? Integrator::exact
                                                              : Integrator::central_difference,
                   *time.step);
  if (*time.step <= stepper_->step_limit()) return;
  std::vector<Problem> problems{
      {"time.step",
       fmt::format("{:g} is beyond {:.6g}, the largest step at which the sphere by itself is "
                   "stable with the central difference",
                   *time.step, stepper_->step_limit()),
       {},
       0,
       0}};
  locate(problems, loaded_->tree);
  throw ConfigError(std::move(problems));
}

State SphereTransient::save() const {
  State state;
  if (is_event_driven()) {
    motion_->save(state, "motion/");
  } else {
    stepper_->save(state, "stepper/");
    state.put("gathered", std::array{gathered_.sum, gathered_.squares, gathered_.stick,
                                     gathered_.free, last_velocity_});
  }
  meter_.save(state, "meter/");
  state.put("unit", static_cast<double>(unit_));
  state.put("march_seconds", march_seconds_);
  return state;
}

void SphereTransient::load(const State& state) {
  if (is_event_driven()) {
    motion_->load(state, "motion/");
  } else {
    stepper_->load(state, "stepper/");
    std::array<double, 5> gathered{};
    state.get("gathered", gathered);
    gathered_ = {0.0, 0.0, gathered[0], gathered[1], gathered[2], gathered[3]};
    last_velocity_ = gathered[4];
  }
  meter_.load(state, "meter/");
  unit_ = static_cast<std::int64_t>(state.get("unit"));
  march_seconds_ = state.get("march_seconds");
}

double SphereTransient::time() const {
  if (is_event_driven()) return motion_->time();
  return static_cast<double>(std::max<std::int64_t>(0, unit_ - 1)) * *scene().time.step;
}

void SphereTransient::write_checkpoint() {
  write_samples();
  keeper_.write_checkpoint(*writer_, save());
}

/// In SI units, as the run files of bodies.
void SphereTransient::write_samples() {
  if (history_.time.empty()) return;
  std::vector<double> time = history_.time;
  for (double& at : time) at *= numbers_.time_unit;
  std::vector<std::vector<double>> columns;
  for (const Series& one : recorded(numbers_, scene().model.sphere.radius)) {
    columns.push_back(history_.*one.values);
    for (double& value : columns.back()) value *= one.unit;
  }
  writer_->append(time, {columns.begin(), columns.end()});
  history_ = {};
}

/// To the next sample. @return false where it fails
bool SphereTransient::advance_to_sample() {
  const double target = static_cast<double>(unit_ + 1) * scene().time.record_interval;
  while (motion_->time() < target) {
    const SubstrateMotion::Stop stop = motion_->advance(target, true);
    const SubstrateMotion::State& s = motion_->state();
    meter_.note_position(motion_->time(), s[0], s[1]);
    if (stop == SubstrateMotion::Stop::failed) {
      failure_ = fmt::format("after t = {:.6g} {}", motion_->time(), motion_->failure());
      return false;
    }
    if (stop == SubstrateMotion::Stop::turn) {
      const SubstrateMotion::Statistics& seen = motion_->statistics();
      meter_.note_turn({motion_->time(), s[0], s[4], s[5], seen.stick_time, seen.free_time});
    }
  }
  history_.add(oscillator_, *motion_);
  return true;
}

/// One step. @return false where it fails
bool SphereTransient::advance_a_step() {
  const double h = *scene().time.step;
  if (!stepper_->advance()) {
    failure_ = fmt::format("after t = {:.6g} {}", time(), stepper_->failure());
    return false;
  }
  const double time = static_cast<double>(unit_) * h;
  const double x = stepper_->displacement().x();
  const double velocity = stepper_->velocity().x();
  meter_.note_position(time, x, stepper_->displacement().y());
  if (last_velocity_ > 0.0 && velocity <= 0.0) {
    // Between the two steps, along straight lines.
    const double share = last_velocity_ / (last_velocity_ - velocity);
    CycleMeter::Turn turn = gathered_;
    turn.time = time - h + share * h;
    turn.x = x;
    turn.sum += share * h * x;
    turn.squares += share * h * x * x;
    meter_.note_turn(turn);
  }
  last_velocity_ = velocity;
  gathered_.sum += h * x;
  gathered_.squares += h * x * x;
  if (stepper_->mode() == SubstrateMode::stick) gathered_.stick += h;
  if (stepper_->mode() == SubstrateMode::free) gathered_.free += h;
  const auto stride = std::max<std::int64_t>(1, std::llround(scene().time.record_interval / h));
  if (unit_ % stride == 0) {
    history_.add(oscillator_, time, stepper_->displacement(), stepper_->velocity(),
                 stepper_->mode(), stepper_->normal_force(), stepper_->tangential_force());
  }
  return true;
}

bool SphereTransient::advance() {
  if (!(is_event_driven() ? advance_to_sample() : advance_a_step())) return false;
  ++unit_;
  return true;
}

/// Samples, or steps, up to a time. The step from a time on is what tells the velocity there.
std::int64_t SphereTransient::last_unit(double time) const {
  if (is_event_driven()) {
    return static_cast<std::int64_t>(
        std::floor(time / scene().time.record_interval * (1.0 + 1e-12)));
  }
  return static_cast<std::int64_t>(std::llround(time / *scene().time.step)) + 1;
}

MarchEnd SphereTransient::run_until(double time) {
  constexpr std::int64_t units_between_looks = 256;
  constexpr std::size_t samples_between_writes = 4096;
  const std::int64_t last = last_unit(time);
  const auto start = std::chrono::steady_clock::now();
  const double writing_before = writer_->write_seconds();
  end_ = MarchEnd::finished;
  while (unit_ < last && end_ == MarchEnd::finished) {
    if (unit_ % units_between_looks == 0) {
      if (stop_requested()) {
        end_ = MarchEnd::stopped;
        break;
      }
      if (keeper_.is_due()) {
        write_samples();
        keeper_.look_after(this->time(), scene().time.end, *writer_, [this] { return save(); });
      }
    }
    if (!advance()) end_ = MarchEnd::failed;
    if (history_.time.size() >= samples_between_writes) write_samples();
  }
  march_seconds_ += seconds_since(start) - (writer_->write_seconds() - writing_before);
  return end_;
}

MarchEnd SphereTransient::run_to_end() {
  return run_until(scene().time.end);
}

Json SphereTransient::finish() {
  write_samples();
  Json results = {{"status", end_ == MarchEnd::finished  ? "done"
                             : end_ == MarchEnd::stopped ? "stopped"
                                                         : "failed"}};
  results.update(effort_json(is_event_driven() ? motion_->statistics().steps : stepper_->steps(),
                             is_event_driven() ? Json(nullptr) : number(*scene().time.step),
                             is_event_driven() ? Json(nullptr) : number(stepper_->step_limit()),
                             {setup_seconds_, march_seconds_, writer_->write_seconds()}));
  meter_.report(results);
  results.update(indentation_json(meter_.deepest(), numbers_));
  results["length_unit"] = numbers_.length_unit;
  results["time_unit"] = numbers_.time_unit;
  results["file"] = file_;
  store_results(*writer_, results);
  writer_->close();
  return results;
}

}  // namespace stridor
