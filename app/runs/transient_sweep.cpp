// Transients along one key of a scene of beams.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "analysis/step_guard.hpp"
#include "app/results/transient_results.hpp"
#include "app/runs/run_keeping.hpp"
#include "app/runs/sweep.hpp"
#include "app/stability/axis_units.hpp"
#include "app/terminal/progress.hpp"
#include "core/blas.hpp"
#include "core/errors.hpp"
#include "core/tasks.hpp"
#include "core/version.hpp"
#include "io/figures/panel_plot.hpp"
#include "io/results/column_file.hpp"
#include "io/run_file/initial_state.hpp"
#include "io/run_file/recorder.hpp"
#include "io/scene/channels.hpp"
#include "io/scene/scene_family.hpp"

namespace stridor {
namespace {

using Clock = std::chrono::steady_clock;

/// Keeps one channel.
class ChannelMemory : public RowSink {
 public:
  void append(double time, std::span<const double> row) override {
    if (values.empty()) first = time;
    last = time;
    values.push_back(row[0]);
  }
  double first = 0.0;  ///< time, s
  double last = 0.0;
  std::vector<double> values;
};

/// The transient at one value.
// NOLINTNEXTLINE(bugprone-exception-escape): the moves of Json are declared not to throw.
struct TransientPoint {
  double value = 0.0;
  Json results;
  std::string failure;  ///< why it ended early, or did not start
  Refusal refusal = Refusal::diverged;  ///< its kind

  /// A number among the results; NaN where there is none.
  double number_at(const char* pointer) const {
    const Json::json_pointer at(pointer);
    return results.contains(at) && results[at].is_number()
               ? results[at].get<double>()
               : std::numeric_limits<double>::quiet_NaN();
  }
  /// The burst of the highest peak; null where there is none.
  Json largest_burst() const {
    Json largest;
    if (!results.contains("bursts") || results["bursts"].is_null()) return largest;
    for (const Json& burst : results["bursts"]) {
      if (largest.is_null() || burst["peak"].get<double>() > largest["peak"].get<double>())
        largest = burst;
    }
    return largest;
  }
};

/// The channel that a run is summed up by.
std::vector<Channel> summed_up(const Scene& scene) {
  if (!scene.record) return {};
  const auto name = acceleration_channel(*scene.record);
  if (!name) return {};
  std::vector<Channel> channels = parse_channels(*scene.record, scene.model);
  std::erase_if(channels, [&](const Channel& channel) { return channel.name != *name; });
  return channels;
}

/// One transient of a sweep.
struct Transit {
  LoadedScene loaded;
  Model model;
  std::vector<Channel> channels;
  ChannelMemory memory;
  std::optional<Simulation> simulation;
  std::optional<Recorder> recorder;
  std::optional<March> march;
  std::int64_t end_step = 0;
  double setup_seconds = 0.0;

  Transit(LoadedScene scene, const Settings& settings, BodyCache& cache)
      : loaded(std::move(scene)), model(build_model_with(loaded, settings, cache)) {
    const auto start = Clock::now();
    const Scene& given = loaded.scene;
    const double step = given.time->step;
    (void)set_initial_state(model.system, loaded);
    try {
      simulation = make_run_simulation(model.system, *given.time, accounts_of(given));
    } catch (const ConfigError& error) {
      throw loaded.located(error);
    }
    channels = summed_up(given);
    const double interval = given.record ? given.record->interval : step;
    recorder.emplace(model, channels, step, interval, memory);
    recorder->limit_samples(
        static_cast<std::int64_t>(std::floor(given.time->end / interval + 1e-6)) + 1);
    end_step = static_cast<std::int64_t>(std::llround(given.time->end / step));
    march.emplace(*simulation, &*recorder, measured_plan(given, end_step + recorder->latency()));
    setup_seconds = seconds_since(start);
  }
  Transit(const Transit&) = delete;
  Transit& operator=(const Transit&) = delete;

  TransientPoint point(double value, MarchEnd end, double wall_seconds) const {
    TransientPoint point;
    point.value = value;
    // Losing the contact within the filter's look-ahead is no failure of the run asked for.
    if (end == MarchEnd::failed && simulation->step_index() >= end_step) end = MarchEnd::finished;
    if (end == MarchEnd::failed) {
      point.failure = simulation->failure();
      point.refusal = simulation->refusal();
    }
    std::optional<AccelerationSummary> acceleration;
    if (!channels.empty() && memory.values.size() > 1) {
      const double interval =
          (memory.last - memory.first) / static_cast<double>(memory.values.size() - 1);
      acceleration = summarise_acceleration(channels.front().name, memory.first, interval,
                                            SampleSpan(memory.values), loaded.scene.measure);
    }
    point.results = transient_results(*simulation, model.system, *loaded.scene.time, end,
                                      march->statistics(), acceleration);
    point.results.update(effort_json(simulation->step_index(), loaded.scene.time->step,
                                     step_limit_json(model.system, *loaded.scene.time),
                                     {setup_seconds, wall_seconds, 0.0}));
    return point;
  }
};

/// The transients at some values, stepped together.
std::vector<TransientPoint> points_at(const LoadedScene& scene, const NumericKey& key,
                                      std::span<const double> values, BodyCache& cache) {
  std::vector<TransientPoint> points(values.size());
  std::vector<std::unique_ptr<Transit>> transits(values.size());
  std::vector<March*> marches;
  {
    // Set-up uses BLAS and LAPACK; what follows does not, but for many contacts (see
    // num_threads()).
    const BlasGuard guard;
    for (std::size_t i = 0; i < values.size(); ++i) {
      const Settings settings{{key.path, values[i]}};
      try {
        transits[i] = std::make_unique<Transit>(with_settings(scene, settings), settings, cache);
        marches.push_back(&*transits[i]->march);
      } catch (const NumericalError& error) {
        // It did not start; the others may.
        points[i].value = values[i];
        points[i].results = {{"status", "failed"}};
        points[i].failure = error.what();
        points[i].refusal = error.refusal();
      }
    }
  }
  const auto start = Clock::now();
  const std::vector<MarchEnd> ends = march_together(marches);
  const double seconds =
      seconds_since(start) / static_cast<double>(std::max<std::size_t>(marches.size(), 1));
  std::size_t next = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (transits[i]) points[i] = transits[i]->point(values[i], ends[next++], seconds);
  }
  return points;
}

using Points = std::vector<TransientPoint>;

/// Threads that the steps of a scene can use: where many contacts slide, their forces are solved
/// for by BLAS.
int num_threads(const Model& model, int wanted) {
  constexpr std::size_t most_without_blas = 8;
  return is_blas_reentrant() || model.system.contacts.size() <= most_without_blas ? wanted : 1;
}

/// What is written and drawn of every transient.
struct SweptNumber {
  const char* name;
  const char* units;
  const char* pointer;  ///< into the results
};
constexpr SweptNumber swept_numbers[] = {
    {"acceleration_peak", "m/s^2", "/free_end_acceleration/peak"},
    {"acceleration_rms", "m/s^2", "/free_end_acceleration/rms"},
    {"force_min", "N", "/contact_force/min"},
    {"force_max", "N", "/contact_force/max"},
    {"stick_fraction", "1", "/stick_fraction"},
    {"free_fraction", "1", "/free_fraction"},
    {"violations", "1", "/violations"},
    {"steps", "1", "/steps"}};

std::vector<double> column(const Points& points, const char* pointer) {
  std::vector<double> values;
  for (const TransientPoint& point : points) values.push_back(point.number_at(pointer));
  return values;
}

std::vector<double> values_of(const Points& points) {
  std::vector<double> values;
  for (const TransientPoint& point : points) values.push_back(point.value);
  return values;
}

void write_file(const SweepOptions& options, const LoadedScene& loaded, const NumericKey& key,
                const Points& points) {
  std::vector<Column> columns{{"/value", printed_units(key), values_of(points)}};
  Column failed{"/failed", "1", {}};
  Column reason{"/reason", "", {}};
  Column num_bursts{"/num_bursts", "1", {}};
  for (const TransientPoint& point : points) {
    failed.values.push_back(point.failure.empty() ? 0.0 : 1.0);
    reason.texts.push_back(point.failure);
    const bool has_bursts = point.results.contains("bursts") && point.results["bursts"].is_array();
    num_bursts.values.push_back(has_bursts ? static_cast<double>(point.results["bursts"].size())
                                           : std::numeric_limits<double>::quiet_NaN());
  }
  columns.push_back(failed);
  columns.push_back(reason);
  columns.push_back(num_bursts);
  for (const SweptNumber& number : swept_numbers) {
    columns.push_back(
        {std::string("/") + number.name, number.units, column(points, number.pointer)});
  }
  // All bursts of all transients, one after the other.
  const std::pair<const char*, const char*> properties[] = {
      {"start", "s"}, {"end", "s"}, {"frequency", "Hz"}, {"peak", "m/s^2"}, {"gain", "1"}};
  Column burst_value{"/bursts/value", printed_units(key), {}};
  std::vector<Column> bursts;
  for (const auto& [name, units] : properties)
    bursts.push_back({std::string("/bursts/") + name, units, {}});
  for (const TransientPoint& point : points) {
    if (!point.results.contains("bursts") || !point.results["bursts"].is_array()) continue;
    for (const Json& burst : point.results["bursts"]) {
      burst_value.values.push_back(point.value);
      for (std::size_t k = 0; k < bursts.size(); ++k)
        bursts[k].values.push_back(burst[properties[k].first].get<double>());
    }
  }
  columns.push_back(burst_value);
  columns.insert(columns.end(), bursts.begin(), bursts.end());
  const Attributes attributes{{"version", std::string(version)},
                              {"commit", std::string(commit)},
                              {"command", options.command_line},
                              {"scene_hash", loaded.hash()},
                              {"scene_resolved", loaded.resolved()},
                              {"parameter", key.path},
                              {"date", utc_now()}};
  write_column_file(*options.output, options.common.overwrite(), "sweep of transients", columns,
                    attributes);
}

void draw(const SweepOptions& options, const LoadedScene& loaded, const NumericKey& key,
          const Points& points) {
  const AxisUnit unit = axis_unit(key, {options.range.from, options.range.to}, &loaded.tree);
  const std::string x_label =
      key.unit.empty() ? key.path : fmt::format("{} ({})", key.path, unit.name);
  const auto panel = [&](const char* y_label) {
    DiagramPanel one;
    one.x_label = x_label;
    one.y_label = y_label;
    if (options.scale == "log") one.x_kind = AxisKind::logarithmic;
    return one;
  };
  const std::vector<double> values = unit.numbers(values_of(points));
  std::vector<DiagramPanel> panels;
  const std::vector<double> rms = column(points, "/free_end_acceleration/rms");
  if (std::any_of(rms.begin(), rms.end(), [](double one) { return std::isfinite(one); })) {
    panels.push_back(panel("acceleration (m/s²)"));
    panels.back().y_kind = AxisKind::logarithmic;
    panels.back().curves = {
        {"r.m.s. in the band", values, rms, Mark::line, 0},
        {"peak", values, column(points, "/free_end_acceleration/peak"), Mark::line, 1}};
  }
  PanelCurve bursts{"", {}, {}, Mark::points, 2};
  for (const TransientPoint& point : points) {
    if (!point.results.contains("bursts") || !point.results["bursts"].is_array()) continue;
    for (const Json& burst : point.results["bursts"]) {
      bursts.x.push_back(unit.number(point.value));
      bursts.y.push_back(1e-3 * burst["frequency"].get<double>());
    }
  }
  if (!bursts.x.empty()) {
    panels.push_back(panel("frequency of bursts (kHz)"));
    panels.back().curves = {bursts};
  }
  if (points.front().results.contains("contact_force")) {
    panels.push_back(panel("contact force (N)"));
    panels.back().curves = {
        {"largest", values, column(points, "/contact_force/max"), Mark::line, 0},
        {"smallest", values, column(points, "/contact_force/min"), Mark::line, 1}};
  }
  if (panels.empty()) {
    panels.push_back(panel("part of the time that it sticks"));
    panels.back().curves = {{"", values, column(points, "/stick_fraction"), Mark::line, 0}};
  }
  plot_panels(panels,
              fmt::format("{} transients, scene {} ({}).", points.size(),
                          std::filesystem::path(options.scene).filename().string(), loaded.hash()),
              *options.figure);
}

void print(const NumericKey& key, const Points& points) {
  const auto text = [](double value) {
    return std::isfinite(value) ? fmt::format("{:.5g}", value) : std::string("-");
  };
  fmt::print("{:>14} {:>8} {:>11} {:>11} {:>7} {:>11} {:>8} {:>8} {:>9}\n", "value", "status",
             "peak m/s^2", "rms m/s^2", "bursts", "at Hz", "stick %", "open %", "wall s");
  for (const TransientPoint& point : points) {
    const bool has_bursts = point.results.contains("bursts") && point.results["bursts"].is_array();
    const Json largest = point.largest_burst();
    fmt::print("{:>14.6g} {:>8} {:>11} {:>11} {:>7} {:>11} {:>8} {:>8} {:>9}\n", point.value,
               point.results["status"].get<std::string>(),
               text(point.number_at("/free_end_acceleration/peak")),
               text(point.number_at("/free_end_acceleration/rms")),
               has_bursts ? fmt::format("{}", point.results["bursts"].size()) : "-",
               largest.is_null() ? "-" : text(largest["frequency"].get<double>()),
               text(100.0 * point.number_at("/stick_fraction")),
               text(100.0 * point.number_at("/free_fraction")), text(point.number_at("/wall_s")));
  }
  for (const TransientPoint& point : points) {
    if (!point.failure.empty()) fmt::print("{}: {}\n", value_text(key, point.value), point.failure);
  }
}

}  // namespace

ExitCode sweep_transients(const SweepOptions& options, const LoadedScene& loaded) {
  const NumericKey key = find_numeric_key(loaded.scene, options.range.parameter, "--parameter");
  const std::vector<double> values = range_values(key, options.range, options.spacing());
  // The ends of the range are read first: a mistake should not show after an hour.
  for (const double value : {values.front(), values.back()})
    with_settings(loaded, {{key.path, value}});

  Points points(values.size());
  // Every thread begins with the bodies of the scene: most keys leave most of them as they are.
  BodyCache cache;
  const int threads = static_cast<int>(std::min(
      static_cast<std::size_t>(num_threads(build_runnable_model(loaded, cache), options.common.threads)),
      values.size()));
  std::vector<BodyCache> caches(static_cast<std::size_t>(threads), cache);
  // As many together as vectors hold, and as much work for every thread.
  constexpr std::size_t largest_batch = 8;
  const std::size_t for_each =
      (values.size() + largest_batch * caches.size() - 1) / (largest_batch * caches.size());
  const std::size_t num_batches = std::min(values.size(), for_each * caches.size());
  const auto first_of = [&](std::size_t batch) { return batch * values.size() / num_batches; };
  Progress progress("sweep");
  run_tasks(
      num_batches, threads,
      [&](std::size_t task, std::size_t thread) {
        const std::size_t first = first_of(task);
        const std::span<const double> here(values.data() + first, first_of(task + 1) - first);
        Points done = points_at(loaded, key, here, caches[thread]);
        std::move(done.begin(), done.end(), points.begin() + static_cast<std::ptrdiff_t>(first));
      },
      [&](std::size_t num_done, std::size_t task) {
        progress.report(static_cast<double>(num_done) / static_cast<double>(num_batches),
                        value_text(key, values[first_of(task)]));
      });
  progress.finish();

  if (options.output) write_file(options, loaded, key, points);
  if (options.figure) draw(options, loaded, key, points);
  if (options.common.json) {
    Json rows = Json::array();
    for (const TransientPoint& point : points) {
      Json row = {{"value", point.value}};
      row.update(point.results);
      if (!point.failure.empty()) row["failure"] = point.failure;
      rows.push_back(std::move(row));
    }
    print_json(Json{{"parameter", key.path}, {"values", values}, {"rows", rows}});
  } else {
    print(key, points);
    for (const auto& file : {options.output, options.figure})
      if (file) fmt::print("{}\n", *file);
  }
  const bool has_any_done = std::any_of(points.begin(), points.end(),
                                        [](const TransientPoint& p) { return p.failure.empty(); });
  if (!has_any_done) {
    throw NumericalError(points.front().refusal,
                         fmt::format("none of the {} transients came to its end; {}", points.size(),
                                     points.front().failure));
  }
  return ExitCode::done;
}

}  // namespace stridor
