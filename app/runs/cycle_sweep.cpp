// Limit cycles of a scene along one of its keys, up and down.
#include "app/runs/sweep.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <limits>

#include "app/results/file_attributes.hpp"
#include "app/runs/cycle_motion.hpp"
#include "app/terminal/progress.hpp"
#include "core/errors.hpp"
#include "core/stop_token.hpp"
#include "core/tasks.hpp"
#include "io/figures/gnuplot.hpp"
#include "io/figures/panel_plot.hpp"
#include "io/scene/scene_family.hpp"

namespace stridor {
namespace {

/// One value of the sweep.
struct SweepPoint {
  double value = 0.0;
  LimitCycle cycle;
  SlidingOscillator oscillator;
  bool is_stable = false;  ///< the equilibrium there
};

/// The cycle at a value, from the end of another motion where there is one.
SweepPoint point_at(const LoadedScene& loaded, const NumericKey& key, double value,
                    const SweepPoint* last, BodyCache& cache) {
  const Settings settings{{key.path, value}};
  const LoadedScene here = with_settings(loaded, settings);
  Model model = build_model_with(here, settings, cache);
  const CycleScene scene = make_cycle_scene(here, model);
  SweepPoint point;
  point.value = value;
  point.oscillator = scene.oscillator;
  const SubstrateOscillator& oscillator = point.oscillator.oscillator;
  point.is_stable =
      leading_eigenvalue(small_motion(oscillator, sliding_equilibrium(point.oscillator))).real() <
      0.0;
  Eigen::Vector2d displacement = scene.displacement;
  Eigen::Vector2d velocity = scene.velocity;
  const bool moves = last != nullptr && last->cycle.status != CycleStatus::at_rest &&
                     last->cycle.status != CycleStatus::diverged;
  if (moves) {
    // Its units may have changed.
    const SlidingOscillator& before = last->oscillator;
    displacement = point.oscillator.from_si(
        before.to_si(last->cycle.last_displacement, before.length), point.oscillator.length);
    velocity =
        point.oscillator.from_si(before.to_si(last->cycle.last_velocity, before.velocity_unit()),
                                 point.oscillator.velocity_unit());
  }
  point.cycle = find_limit_cycle(oscillator, displacement, velocity, scene.options);
  return point;
}

/// Each value from the motion at the one before.
std::vector<SweepPoint> follow(const LoadedScene& scene, const NumericKey& key,
                               const std::vector<double>& values, const SweepPoint* before,
                               Progress& progress) {
  std::vector<SweepPoint> points;
  points.reserve(values.size());
  BodyCache cache;
  for (const double value : values) {
    if (stop_requested()) throw Interrupted("nothing has been written");
    points.push_back(point_at(scene, key, value, points.empty() ? before : &points.back(), cache));
    progress.report(static_cast<double>(points.size()) / static_cast<double>(values.size()),
                    value_text(key, value));
  }
  return points;
}

/// Each value by itself, from the start that the scene says.
std::vector<SweepPoint> sample(const LoadedScene& scene, const NumericKey& key,
                               const std::vector<double>& values, int num_threads,
                               Progress& progress) {
  std::vector<SweepPoint> points(values.size());
  run_tasks(
      values.size(), num_threads,
      [&](std::size_t i, std::size_t) {
        BodyCache cache;
        points[i] = point_at(scene, key, values[i], nullptr, cache);
      },
      [&](std::size_t num_done, std::size_t i) {
        progress.report(static_cast<double>(num_done) / static_cast<double>(values.size()),
                        value_text(key, values[i]));
      });
  return points;
}

/// Why no cycle was found, with its code, or "".
std::string reason_of(const SweepPoint& point) {
  if (point.cycle.failure.empty()) return "";
  return with_code(cycle_failure(point.cycle, point.oscillator), Refusal::no_convergence);
}

Json points_json(const std::vector<SweepPoint>& points) {
  Json list = Json::array();
  for (const SweepPoint& point : points) {
    Json one = {{"value", point.value}, {"equilibrium_stable", point.is_stable}};
    one.update(cycle_json(point.cycle, point.oscillator));
    if (!point.cycle.failure.empty()) one["failure"] = reason_of(point);
    list.push_back(std::move(one));
  }
  return list;
}

/// Branches of a sweep by name: "up", "down", or "rows" alone.
using Branches = std::vector<std::pair<std::string, std::vector<SweepPoint>>>;

void draw(const SweepOptions& options, const LoadedScene& loaded, const NumericKey& key,
          const Branches& branches) {
  DiagramPanel panel;
  panel.x_label = key.path;
  panel.y_label = "x r.m.s. (mm)";
  if (options.scale == "log") panel.x_kind = AxisKind::logarithmic;
  int colour = 0;
  for (const auto& [name, points] : branches) {
    PanelCurve curve{branches.size() > 1 ? name : "", {}, {}, Mark::points, colour++};
    for (const SweepPoint& point : points) {
      if (point.cycle.status == CycleStatus::diverged) continue;
      curve.x.push_back(point.value);
      curve.y.push_back(1e3 * point.oscillator.length * point.cycle.x_rms);
    }
    panel.curves.push_back(std::move(curve));
  }
  plot_panels({panel},
              fmt::format("Amplitude of the motion that the mass settles to, {}. {}, scene {}.",
                          branches.size() > 1 ? "swept up and down"
                                              : "each value from near its equilibrium",
                          std::filesystem::path(options.scene).filename().string(), loaded.hash()),
              *options.figure);
}

void write_file(const SweepOptions& options, const LoadedScene& loaded, const NumericKey& key,
                const Branches& branches) {
  std::vector<Column> columns;
  for (const auto& branch : branches) {
    const auto& name = branch.first;
    const auto& points = branch.second;
    const auto add = [&](const char* column, const std::string& units, auto&& of) {
      Column one{"/" + name + "/" + column, units, {}};
      for (const SweepPoint& point : points) one.values.push_back(static_cast<double>(of(point)));
      columns.push_back(std::move(one));
    };
    const auto add_result = [&](const char* column, const char* units, const char* pointer) {
      add(column, units, [&](const SweepPoint& point) {
        const Json found =
            cycle_json(point.cycle, point.oscillator).at(Json::json_pointer(pointer));
        return found.is_null() ? std::numeric_limits<double>::quiet_NaN() : found.get<double>();
      });
    };
    add("value", printed_units(key), [](const SweepPoint& p) { return p.value; });
    columns.back().is_scale = true;
    add_result("period", "s", "/period");
    add_result("x_rms", "m", "/x/rms");
    add_result("x_mean", "m", "/x/mean");
    add_result("x_min", "m", "/x/min");
    add_result("x_max", "m", "/x/max");
    add_result("stick_fraction", "1", "/stick_fraction");
    add_result("free_fraction", "1", "/free_fraction");
    add("status", "1", [](const SweepPoint& p) { return p.cycle.status; });
    Column reason{"/" + name + "/reason", "", {}};
    for (const SweepPoint& point : points) {
      reason.texts.push_back(reason_of(point));
    }
    columns.push_back(std::move(reason));
    add("equilibrium_stable", "1", [](const SweepPoint& p) { return p.is_stable; });
  }
  Attributes attributes = source_attributes(loaded, options.command_line);
  attributes.push_back({"parameter", key.path});
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
               "period s", "x r.m.s. m", "stick", "free", "equilibrium");
    for (const SweepPoint& point : points) {
      fmt::print("{:>5} {:>14.6g} {:>12} {:>14.8g} {:>14.8g} {:>9.5f} {:>9.5f}  {}\n", "",
                 point.value, cycle_status_text(point.cycle.status),
                 point.oscillator.time * point.cycle.period,
                 point.oscillator.length * point.cycle.x_rms, point.cycle.stick_fraction,
                 point.cycle.free_fraction, point.is_stable ? "stable" : "unstable");
    }
  }
}

}  // namespace

ExitCode sweep_cycles(const SweepOptions& options, const LoadedScene& loaded) {
  const NumericKey key = find_numeric_key(loaded.scene, options.range.parameter, "--parameter");
  const std::vector<double> values = range_values(key, options.range, options.spacing());
  Branches branches;
  Progress progress("sweep");
  if (options.is_up_and_down) {
    branches.emplace_back("up", follow(loaded, key, values, nullptr, progress));
    const std::vector<double> back(values.rbegin(), values.rend());
    const SweepPoint turning = branches.front().second.back();
    branches.emplace_back("down", follow(loaded, key, back, &turning, progress));
  } else {
    branches.emplace_back("rows", sample(loaded, key, values, options.common.threads, progress));
  }
  progress.finish();

  if (options.output) write_file(options, loaded, key, branches);
  if (options.figure) draw(options, loaded, key, branches);
  std::vector<std::string> failures;
  for (const auto& [name, points] : branches) {
    for (const SweepPoint& point : points) {
      if (!point.cycle.failure.empty())
        failures.push_back(value_text(key, point.value) + ": " +
                           cycle_failure(point.cycle, point.oscillator));
    }
  }
  if (options.common.json) {
    Json object = {{"parameter", key.path}, {"values", values}};
    for (const auto& [name, points] : branches) object[name] = points_json(points);
    print_json(object);
  } else {
    print(branches);
    for (const std::string& failure : failures)
      fmt::print("{}\n", with_code(failure, Refusal::no_convergence));
    for (const auto& file : {options.output, options.figure})
      if (file) fmt::print("{}\n", *file);
  }
  if (failures.size() == values.size() * branches.size()) {
    throw NumericalError(
        Refusal::no_convergence,
        fmt::format("none of the {} motions can be followed; {}", failures.size(), failures[0]));
  }
  return ExitCode::done;
}

}  // namespace stridor
