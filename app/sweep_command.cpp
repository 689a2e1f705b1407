// stridor sweep: limit cycles along one key of a scene, up and down.
#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <filesystem>
#include <memory>
#include <mutex>
#include <thread>

#include "app/progress.hpp"
#include "app/sphere_commands.hpp"
#include "app/sphere_motion.hpp"
#include "app/sphere_stability.hpp"
#include "core/errors.hpp"
#include "core/stop_token.hpp"
#include "io/gnuplot.hpp"
#include "io/panel_plot.hpp"

namespace stridor {
namespace {

struct SweepOptions {
  CommonOptions common;
  std::string scene;
  RangeOptions range;
  std::string scale = "linear";
  bool is_up_and_down = false;
  std::optional<std::string> output;
  std::optional<std::string> figure;
  std::string command_line;
};

/// One value of the sweep.
struct SweepPoint {
  double value = 0.0;
  LimitCycle cycle;
  SphereNumbers numbers;
  bool is_stable = false;  ///< the equilibrium there
};

/// The cycle at a value, from the end of another motion where there is one.
SweepPoint point_at(const SphereScene& scene, const NumericKey& key, double value,
                    const SweepPoint* last) {
  const SphereScene here = with_values(scene, {key}, std::span(&value, 1));
  const SubstrateOscillator oscillator = make_sphere(here.model);
  SweepPoint point;
  point.value = value;
  point.numbers = sphere_numbers(here.model.sphere);
  const SubstrateEquilibrium rest = sphere_equilibrium(oscillator);
  point.is_stable =
      leading_eigenvalue(small_motion(oscillator, rest, here.model.small_motion)).real() < 0.0;
  Eigen::Vector2d displacement = initial_displacement(here, oscillator);
  Eigen::Vector2d velocity = Eigen::Vector2d::Zero();
  const bool moves = last != nullptr && last->cycle.status != CycleStatus::at_rest &&
                     last->cycle.status != CycleStatus::diverged;
  if (moves) {
    // The unit of length may have changed.
    const double unit = last->numbers.length_unit / point.numbers.length_unit;
    displacement = unit * last->cycle.last_displacement;
    velocity = unit * last->cycle.last_velocity;
  }
  point.cycle = find_limit_cycle(oscillator, displacement, velocity, cycle_options(here));
  return point;
}

/// Each value from the motion at the one before.
std::vector<SweepPoint> follow(const SphereScene& scene, const NumericKey& key,
                               const std::vector<double>& values, const SweepPoint* before,
                               Progress& progress) {
  std::vector<SweepPoint> points;
  points.reserve(values.size());
  for (const double value : values) {
    if (stop_requested()) throw Interrupted("nothing has been written");
    points.push_back(point_at(scene, key, value, points.empty() ? before : &points.back()));
    progress.report(static_cast<double>(points.size()) / static_cast<double>(values.size()),
                    value_text(key, value));
  }
  return points;
}

/// Each value by itself, from the start that the scene says.
std::vector<SweepPoint> sample(const SphereScene& scene, const NumericKey& key,
                               const std::vector<double>& values, int num_threads,
                               Progress& progress) {
  std::vector<SweepPoint> points(values.size());
  std::atomic<std::size_t> next{0};
  std::size_t num_done = 0;
  std::exception_ptr failure;
  std::mutex reporting;
  const auto work = [&] {
    try {
      for (std::size_t i = next++; i < values.size() && !stop_requested(); i = next++) {
        points[i] = point_at(scene, key, values[i], nullptr);
        const std::lock_guard lock(reporting);
        ++num_done;
        progress.report(static_cast<double>(num_done) / static_cast<double>(values.size()),
                        value_text(key, values[i]));
      }
    } catch (...) {
      const std::lock_guard lock(reporting);
      failure = std::current_exception();
      next = values.size();
    }
  };
  std::vector<std::thread> threads;
  for (int i = 1; i < num_threads; ++i) threads.emplace_back(work);
  work();
  for (std::thread& thread : threads) thread.join();
  if (failure) std::rethrow_exception(failure);
  if (stop_requested()) throw Interrupted("nothing has been written");
  return points;
}

Json points_json(const std::vector<SweepPoint>& points) {
  Json list = Json::array();
  for (const SweepPoint& point : points) {
    Json one = {{"value", point.value}, {"equilibrium_stable", point.is_stable}};
    one.update(cycle_json(point.cycle, point.numbers));
    list.push_back(std::move(one));
  }
  return list;
}

/// Branches of a sweep by name: "up", "down", or "rows" alone.
using Branches = std::vector<std::pair<std::string, std::vector<SweepPoint>>>;

void draw(const SweepOptions& options, const LoadedSphereScene& loaded, const NumericKey& key,
          const Branches& branches) {
  DiagramPanel panel;
  panel.x_label = key.path;
  panel.y_label = "x r.m.s./x₀";
  if (options.scale == "log") panel.x_kind = AxisKind::logarithmic;
  int colour = 0;
  for (const auto& [name, points] : branches) {
    PanelCurve curve{branches.size() > 1 ? name : "", {}, {}, Mark::points, colour++};
    for (const SweepPoint& point : points) {
      curve.x.push_back(point.value);
      curve.y.push_back(point.cycle.x_rms);
    }
    panel.curves.push_back(std::move(curve));
  }
  plot_panels({panel},
              fmt::format("Amplitude of the motion that the sphere settles to, {}. {}, scene {}.",
                          branches.size() > 1 ? "swept up and down"
                                              : "each value from near its "
                                                "equilibrium",
                          std::filesystem::path(options.scene).filename().string(), loaded.hash()),
              *options.figure);
}

void write_file(const SweepOptions& options, const LoadedSphereScene& loaded, const NumericKey& key,
                const Branches& branches) {
  std::vector<Column> columns;
  for (const auto& [name, points] : branches) {
    const auto add = [&](const char* column, auto&& of) {
      Column one{"/" + name + "/" + column, "1", {}};
      for (const SweepPoint& point : points) one.values.push_back(static_cast<double>(of(point)));
      columns.push_back(std::move(one));
    };
    add("value", [](const SweepPoint& p) { return p.value; });
    add("period", [](const SweepPoint& p) { return p.cycle.period; });
    add("x_rms", [](const SweepPoint& p) { return p.cycle.x_rms; });
    add("x_mean", [](const SweepPoint& p) { return p.cycle.x_mean; });
    add("x_min", [](const SweepPoint& p) { return p.cycle.x_min; });
    add("x_max", [](const SweepPoint& p) { return p.cycle.x_max; });
    add("stick_fraction", [](const SweepPoint& p) { return p.cycle.stick_fraction; });
    add("free_fraction", [](const SweepPoint& p) { return p.cycle.free_fraction; });
    add("status", [](const SweepPoint& p) { return p.cycle.status; });
    add("equilibrium_stable", [](const SweepPoint& p) { return p.is_stable; });
  }
  Attributes attributes = sphere_attributes(loaded, options.command_line);
  attributes.push_back({"parameter", key.path});
  attributes.push_back({"units_of_value", printed_units(key)});
  write_column_file(*options.output, options.common.overwrite(), "sweep of limit cycles", columns,
                    attributes);
}

ExitCode sweep(const SweepOptions& options) {
  const Overwrite overwrite = options.common.overwrite();
  if (options.output) check_output(*options.output, overwrite);
  if (options.figure) check_figure(*options.figure, options.common);
  if (options.range.parameter.empty()) throw ConfigError("--parameter", "name a key of the scene");
  const LoadedSphereScene loaded = load_sphere_scene(options.scene, options.common.sets);
  const NumericKey key = find_sphere_key(loaded.scene, options.range.parameter, "--parameter");
  const double from = parse_value(key, options.range.from, "--from");
  const double to = parse_value(key, options.range.to, "--to");
  if (from > to) throw ConfigError("--from", "is beyond --to; --up-down sweeps both ways");
  const std::vector<double> values =
      spaced_values(key, from, to, options.range.points,
                    options.scale == "log" ? Spacing::logarithmic : Spacing::linear);
  Branches branches;
  Progress progress("sweep");
  if (options.is_up_and_down) {
    branches.emplace_back("up", follow(loaded.scene, key, values, nullptr, progress));
    const std::vector<double> back(values.rbegin(), values.rend());
    const SweepPoint turning = branches.front().second.back();
    branches.emplace_back("down", follow(loaded.scene, key, back, &turning, progress));
  } else {
    branches.emplace_back("rows",
                          sample(loaded.scene, key, values, options.common.threads, progress));
  }
  progress.finish();

  if (options.output) write_file(options, loaded, key, branches);
  if (options.figure) draw(options, loaded, key, branches);
  if (options.common.json) {
    Json object = {{"parameter", key.path}, {"values", values}};
    for (const auto& [name, points] : branches) object[name] = points_json(points);
    fmt::print("{}\n", object.dump(2));
    return ExitCode::done;
  }
  for (const auto& [name, points] : branches) {
    fmt::print("{:>5} {:>14} {:>12} {:>14} {:>14} {:>9} {:>9}  {}\n", name, "value", "status",
               "period", "x r.m.s.", "stick", "free", "equilibrium");
    for (const SweepPoint& point : points) {
      fmt::print("{:>5} {:>14.6g} {:>12} {:>14.8g} {:>14.8g} {:>9.5f} {:>9.5f}  {}\n", "",
                 point.value, cycle_status_text(point.cycle.status), point.cycle.period,
                 point.cycle.x_rms, point.cycle.stick_fraction, point.cycle.free_fraction,
                 point.is_stable ? "stable" : "unstable");
    }
  }
  for (const auto& file : {options.output, options.figure})
    if (file) fmt::print("{}\n", *file);
  return ExitCode::done;
}

}  // namespace

void add_sweep_command(CLI::App& program, Action& action, const std::string& command_line) {
  auto options = std::make_shared<SweepOptions>();
  options->command_line = command_line;
  options->range.points = 21;
  options->common.threads = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  CLI::App* verb = program.add_subcommand(
      "sweep", "Limit cycles along one key of an oscillator on a viscoelastic substrate");
  verb->add_option("scene", options->scene, "Scene file (YAML)")->required();
  add_range_options(*verb, options->range);
  verb->add_option("--scale", options->scale, "Spacing of the values: linear (default) or log")
      ->check(CLI::IsMember({"linear", "log"}));
  verb->add_flag("--up-down", options->is_up_and_down,
                 "Go up and then down, every value from the motion at the one before; shows where "
                 "two motions exist");
  verb->add_option("-o,--output", options->output, "File to write (HDF5)");
  verb->add_option("--figure", options->figure, "Picture of the amplitude: .png, .svg or .pdf");
  add_scene_options(*verb, options->common);
  add_json_option(*verb, options->common);
  add_force_option(*verb, options->common);
  verb->callback([options, &action] { action = [options] { return sweep(*options); }; });
}

}  // namespace stridor
