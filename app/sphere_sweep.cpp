// Limit cycles of a sphere along one key of its scene, up and down.
#include "app/sweep.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "app/progress.hpp"
#include "app/sphere_motion.hpp"
#include "app/sphere_stability.hpp"
#include "core/errors.hpp"
#include "core/stop_token.hpp"
#include "core/tasks.hpp"
#include "io/gnuplot.hpp"
#include "io/panel_plot.hpp"

namespace stridor {
namespace {

/// One value of the sweep.
struct SweepPoint {
  double value = 0.0;
  LimitCycle cycle;
  SphereNumbers numbers;
  bool is_stable = false;  ///< the equilibrium there
};

/// The cycle at a value, from the end of another motion where there is one.
SweepPoint point_at(const LoadedSphereScene& scene, const NumericKey& key, double value,
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
std::vector<SweepPoint> follow(const LoadedSphereScene& scene, const NumericKey& key,
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
std::vector<SweepPoint> sample(const LoadedSphereScene& scene, const NumericKey& key,
                               const std::vector<double>& values, int num_threads,
                               Progress& progress) {
  std::vector<SweepPoint> points(values.size());
  run_tasks(
      values.size(), num_threads,
      [&](std::size_t i, std::size_t) { points[i] = point_at(scene, key, values[i], nullptr); },
      [&](std::size_t num_done, std::size_t i) {
        progress.report(static_cast<double>(num_done) / static_cast<double>(values.size()),
                        value_text(key, values[i]));
      });
  return points;
}

Json points_json(const std::vector<SweepPoint>& points) {
  Json list = Json::array();
  for (const SweepPoint& point : points) {
    Json one = {{"value", point.value}, {"equilibrium_stable", point.is_stable}};
    one.update(cycle_json(point.cycle, point.numbers));
    if (!point.cycle.failure.empty()) one["failure"] = point.cycle.failure;
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
      if (point.cycle.status == CycleStatus::diverged) continue;
      curve.x.push_back(point.value);
      curve.y.push_back(point.cycle.x_rms);
    }
    panel.curves.push_back(std::move(curve));
  }
  plot_panels({panel},
              fmt::format("Amplitude of the motion that the sphere settles to, {}. {}, scene {}.",
                          branches.size() > 1 ? "swept up and down"
                                              : "each value from near its equilibrium",
                          std::filesystem::path(options.scene).filename().string(), loaded.hash()),
              *options.figure);
}

void write_file(const SweepOptions& options, const LoadedSphereScene& loaded, const NumericKey& key,
                const Branches& branches) {
  std::vector<Column> columns;
  for (const auto& branch : branches) {
    const auto& name = branch.first;
    const auto& points = branch.second;
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
  std::string statuses;
  for (int status = 0; status <= static_cast<int>(CycleStatus::settling); ++status) {
    statuses += fmt::format("{}{} {}", status > 0 ? ", " : "", status,
                            cycle_status_text(static_cast<CycleStatus>(status)));
  }
  attributes.push_back({"meaning_of_status", statuses});
  write_column_file(*options.output, options.common.overwrite(), "sweep of limit cycles", columns,
                    attributes);
}

void print(const Branches& branches) {
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
}

}  // namespace

ExitCode sweep_spheres(const SweepOptions& options) {
  const LoadedSphereScene loaded = load_sphere_scene(options.scene, options.common.sets);
  const NumericKey key = find_sphere_key(loaded.scene, options.range.parameter, "--parameter");
  const std::vector<double> values = range_values(key, options.range, options.spacing());
  Branches branches;
  Progress progress("sweep");
  if (options.is_up_and_down) {
    branches.emplace_back("up", follow(loaded, key, values, nullptr, progress));
    const std::vector<double> back(values.rbegin(), values.rend());
    const SweepPoint turning = branches.front().second.back();
    branches.emplace_back("down", follow(loaded, key, back, &turning, progress));
  } else {
    branches.emplace_back("rows",
                          sample(loaded, key, values, options.common.threads, progress));
  }
  progress.finish();

  if (options.output) write_file(options, loaded, key, branches);
  if (options.figure) draw(options, loaded, key, branches);
  std::vector<std::string> failures;
  for (const auto& [name, points] : branches) {
    for (const SweepPoint& point : points) {
      if (!point.cycle.failure.empty())
        failures.push_back(value_text(key, point.value) + ": " + point.cycle.failure);
    }
  }
  if (options.common.json) {
    Json object = {{"parameter", key.path}, {"values", values}};
    for (const auto& [name, points] : branches) object[name] = points_json(points);
    print_json(object);
  } else {
    print(branches);
    for (const std::string& failure : failures) fmt::print("{}\n", failure);
    for (const auto& file : {options.output, options.figure})
      if (file) fmt::print("{}\n", *file);
  }
  if (failures.size() == values.size() * branches.size()) {
    throw NumericalError(
        fmt::format("none of the {} motions can be followed; {}", failures.size(), failures[0]));
  }
  return ExitCode::done;
}

}  // namespace stridor
