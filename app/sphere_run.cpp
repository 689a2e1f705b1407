#include "app/sphere_run.hpp"

#include <fmt/format.h>

#include <cmath>
#include <cstdio>

#include "app/expectations.hpp"
#include "app/progress.hpp"
#include "app/sphere_motion.hpp"
#include "core/errors.hpp"
#include "core/stop_token.hpp"
#include "io/run_file.hpp"
#include "solvers/substrate_stepper.hpp"

namespace stridor {
namespace {

/// What has been gathered up to a turn, where x is largest.
struct Turn {
  double time = 0.0;
  double x = 0.0;
  double sum = 0.0;      ///< ∫ x dt
  double squares = 0.0;  ///< ∫ x² dt
  double stick = 0.0;    ///< time
  double free = 0.0;     ///< time
};

/// Reads amplitude and period off the whole cycles of the second half of a run.
class CycleMeter {
 public:
  explicit CycleMeter(double end) : from_(0.5 * end) {}

  void note_turn(const Turn& turn) {
    if (turn.time >= from_) turns_.push_back(turn);
  }
  void note_position(double time, double x) {
    if (time < from_) return;
    smallest_ = std::min(smallest_, x);
    largest_ = std::max(largest_, x);
  }

  /// Adds x, period and fractions; null where no cycle is whole.
  void report(Json& results) const {
    if (turns_.size() < 3) {
      results["x"] = {{"min", number(smallest_)},
                      {"max", number(largest_)},
                      {"mean", nullptr},
                      {"rms", nullptr}};
      results["period"] = nullptr;
      results["stick_fraction"] = nullptr;
      results["free_fraction"] = nullptr;
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
    const double turn_time = duration / static_cast<double>(turns_.size() - 1);
    results["period"] = loops > 0 ? number(static_cast<double>(loops) * turn_time) : Json(nullptr);
    results["stick_fraction"] = number((last.stick - first.stick) / duration);
    results["free_fraction"] = number((last.free - first.free) / duration);
  }

 private:
  /// Turns after which the motion repeats itself to 1 % of its width; 0 where it does not.
  std::size_t repeats_after() const {
    constexpr std::size_t most = 12;
    for (std::size_t loops = 1; loops <= std::min(most, turns_.size() / 2); ++loops) {
      double apart = 0.0;
      for (std::size_t i = turns_.size() - loops; i < turns_.size(); ++i)
        apart = std::max(apart, std::abs(turns_[i].x - turns_[i - loops].x));
      if (apart <= 1e-2 * (largest_ - smallest_)) return loops;
    }
    return 0;
  }

  double from_;
  std::vector<Turn> turns_;
  double smallest_ = std::numeric_limits<double>::infinity();
  double largest_ = -std::numeric_limits<double>::infinity();
};

/// A march and what came of it.
struct MarchResult {
  SphereHistory history;
  std::int64_t steps = 0;
  double reached = 0.0;
  bool failed = false;
};

MarchResult march_events(const SphereScene& scene, const SubstrateOscillator& oscillator,
                         CycleMeter& meter, RunKeeper& keeper) {
  SubstrateMotion motion(oscillator, scene.time.tolerance);
  motion.start(initial_displacement(scene, oscillator), Eigen::Vector2d::Zero());
  MarchResult result;
  result.history.add(oscillator, motion);
  const auto num_samples = static_cast<std::int64_t>(
      std::floor(scene.time.end / scene.time.record_interval * (1.0 + 1e-12)));
  for (std::int64_t k = 1; k <= num_samples && !result.failed && !stop_requested(); ++k) {
    const double target = static_cast<double>(k) * scene.time.record_interval;
    while (motion.time() < target && !result.failed) {
      const SubstrateMotion::Stop stop = motion.advance(target, true);
      const SubstrateMotion::State& s = motion.state();
      meter.note_position(motion.time(), s[0]);
      result.failed = stop == SubstrateMotion::Stop::failed;
      if (stop == SubstrateMotion::Stop::turn) {
        const SubstrateMotion::Statistics& seen = motion.statistics();
        meter.note_turn({motion.time(), s[0], s[4], s[5], seen.stick_time, seen.free_time});
      }
    }
    if (!result.failed) result.history.add(oscillator, motion);
    if (k % 256 == 0 && keeper.is_due())
      keeper.look_after(motion.time(), scene.time.end, nullptr, {});
  }
  result.steps = motion.statistics().steps;
  result.reached = motion.time();
  return result;
}

MarchResult march_steps(const SphereScene& scene, const SubstrateOscillator& oscillator,
                        SubstrateStepper& stepper, CycleMeter& meter, RunKeeper& keeper) {
  const double h = *scene.time.step;
  stepper.start(initial_displacement(scene, oscillator), Eigen::Vector2d::Zero());
  const auto num_steps = static_cast<std::int64_t>(std::llround(scene.time.end / h));
  const auto stride = std::max<std::int64_t>(1, std::llround(scene.time.record_interval / h));
  MarchResult result;
  Turn gathered;
  double last_velocity = 0.0;
  for (std::int64_t n = 0; n <= num_steps; ++n) {
    if (!stepper.advance()) {
      result.failed = true;
      break;
    }
    const double time = static_cast<double>(n) * h;
    const double x = stepper.displacement().x();
    const double velocity = stepper.velocity().x();
    meter.note_position(time, x);
    if (last_velocity > 0.0 && velocity <= 0.0) {
      // Between the two steps, along straight lines.
      const double share = last_velocity / (last_velocity - velocity);
      Turn turn = gathered;
      turn.time = time - h + share * h;
      turn.x = x;
      turn.sum += share * h * x;
      turn.squares += share * h * x * x;
      meter.note_turn(turn);
    }
    last_velocity = velocity;
    gathered.sum += h * x;
    gathered.squares += h * x * x;
    if (stepper.mode() == SubstrateMode::stick) gathered.stick += h;
    if (stepper.mode() == SubstrateMode::free) gathered.free += h;
    if (n % stride == 0) {
      result.history.add(oscillator, time, stepper.displacement(), stepper.velocity(),
                         stepper.mode(), stepper.normal_force(), stepper.tangential_force());
    }
    result.reached = time;
    if (n % 65536 == 0) {
      if (stop_requested()) break;
      if (keeper.is_due()) keeper.look_after(time, scene.time.end, nullptr, {});
    }
  }
  result.steps = stepper.steps();
  return result;
}

/// The run in SI units, as the run files of bodies.
void write_run(const RunOutput& output, const LoadedSphereScene& loaded,
               const SphereNumbers& numbers, const SphereHistory& history, const Json& results) {
  const double length = numbers.length_unit;
  const double velocity = length / numbers.time_unit;
  const double force = numbers.force_unit;
  const double radius = loaded.scene.model.sphere.radius;
  struct Series {
    SeriesSpec spec;
    const std::vector<double>* values;
    double unit;
  };
  const Attributes meaning{{"meaning", std::string("0 slower than the substrate, 1 faster, "
                                                   "2 stick, 3 off it")}};
  const std::vector<Series> series{
      {{"/channels/sphere.x.displacement", "m"}, &history.x, length},
      {{"/channels/sphere.y.displacement", "m"}, &history.y, length},
      {{"/channels/sphere.x.velocity", "m/s"}, &history.vx, velocity},
      {{"/channels/sphere.y.velocity", "m/s"}, &history.vy, velocity},
      {{"/contact/contact/force", "N"}, &history.normal_force, force},
      {{"/contact/contact/friction_force", "N"}, &history.friction_force, force},
      {{"/contact/contact/slip_velocity", "m/s"}, &history.slip, velocity},
      {{"/contact/contact/area", "m^2"}, &history.area, radius * radius},
      {{"/contact/contact/state", "1", SeriesKind::state, meaning}, &history.mode, 1.0}};
  std::vector<SeriesSpec> specs;
  std::vector<std::vector<double>> columns;
  for (const Series& one : series) {
    specs.push_back(one.spec);
    columns.push_back(*one.values);
    for (double& value : columns.back()) value *= one.unit;
  }
  std::vector<double> time = history.time;
  for (double& at : time) at *= numbers.time_unit;
  RunFileWriter writer(output.file, output.overwrite,
                       run_header(output.command_line, loaded.tree.document, loaded.resolved()),
                       specs);
  writer.append(time, {columns.begin(), columns.end()});
  store_results(writer, results);
  writer.close();
}

void print_results(const Json& results, const SphereNumbers& numbers, const std::string& file) {
  const auto print = [&](const char* name, const Json& value, double unit, const char* units) {
    if (value.is_null()) {
      fmt::print("{:<24}{:>16}\n", name, "-");
    } else if (unit > 0.0) {
      fmt::print("{:<24}{:>16.10g}  ({:.6g} {})\n", name, value.get<double>(),
                 value.get<double>() * unit, units);
    } else {
      fmt::print("{:<24}{:>16.8g}\n", name, value.get<double>());
    }
  };
  fmt::print("{:<24}{:>16}\n", "status", results["status"].get<std::string>());
  fmt::print("{:<24}{:>16}  ({:.3g} s)\n", "steps", results["steps"].get<std::int64_t>(),
             results["wall_s"].get<double>());
  print("period", results["period"], numbers.time_unit, "s");
  print("x, r.m.s. about mean", results["x"]["rms"], numbers.length_unit, "m");
  print("x, smallest", results["x"]["min"], numbers.length_unit, "m");
  print("x, largest", results["x"]["max"], numbers.length_unit, "m");
  print("part of time sticking", results["stick_fraction"], 0.0, "");
  print("part of time lifted off", results["free_fraction"], 0.0, "");
  fmt::print("{:<24}{}\n", "run file", file);
}

}  // namespace

ExitCode run_sphere(const LoadedSphereScene& loaded, const RunOutput& output,
                    const RunEnding& ending) {
  check_output(output.file, output.overwrite);
  RunKeeper keeper;
  const SphereScene& scene = loaded.scene;
  const SphereNumbers numbers = sphere_numbers(scene.model.sphere);
  const SubstrateOscillator oscillator = make_sphere(scene.model);
  const bool is_event_driven = scene.time.integrator == SphereIntegrator::event_driven;
  Json limit = nullptr;
  std::optional<SubstrateStepper> stepper;
  if (!is_event_driven) {
    const Integrator integrator = scene.time.integrator == SphereIntegrator::exact
                                      ? Integrator::exact
                                      : Integrator::central_difference;
    stepper.emplace(oscillator, integrator, *scene.time.step);
    limit = number(stepper->step_limit());
  }
  CycleMeter meter(scene.time.end);
  Progress progress("run");
  keeper.on_progress(
      [&](double fraction, const std::string& detail) { progress.report(fraction, detail); });
  keeper.limit_wall_time(ending.max_wall);
  RunTimes times;
  times.setup = keeper.seconds();
  const MarchResult march = is_event_driven
                                ? march_events(scene, oscillator, meter, keeper)
                                : march_steps(scene, oscillator, *stepper, meter, keeper);
  times.march = keeper.seconds() - times.setup;
  progress.finish();
  const bool is_stopped = !march.failed && stop_requested();

  Json results = {{"status", march.failed ? "failed" : is_stopped ? "stopped" : "done"}};
  results.update(effort_json(
      march.steps, is_event_driven ? Json(nullptr) : number(*scene.time.step), limit, times));
  meter.report(results);
  results["length_unit"] = numbers.length_unit;
  results["time_unit"] = numbers.time_unit;
  write_run(output, loaded, numbers, march.history, results);
  results["output_s"] = keeper.seconds() - times.setup - times.march;
  results["file"] = output.file;
  if (ending.json) {
    fmt::print("{}\n", results.dump(2));
  } else {
    print_results(results, numbers, output.file);
  }
  std::fflush(stdout);
  if (march.failed) {
    throw NumericalError(fmt::format(
        "the motion grew without bound, or its steps became too small, after t = {:.6g} "
        "of {:g}; {} holds what came before",
        march.reached, scene.time.end, output.file));
  }
  if (is_stopped) throw_interrupted(march.reached, scene.time.end, output.file, Resumable::no);
  if (ending.verify) check_expectations(scene.expect, results);
  return ExitCode::done;
}

}  // namespace stridor
