// Transients along one key of a scene of beams.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "analysis/step_guard.hpp"
#include "app/results/transient_results.hpp"
#include "app/runs/run_keeping.hpp"
#include "app/runs/sweep.hpp"
#include "app/runs/swept_transients.hpp"
#include "app/terminal/progress.hpp"
#include "core/blas.hpp"
#include "core/errors.hpp"
#include "core/tasks.hpp"
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

  SweptTransient point(double value, MarchEnd end, double wall_seconds) const {
    SweptTransient point;
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
SweptTransients points_at(const LoadedScene& scene, const NumericKey& key,
                          std::span<const double> values, BodyCache& cache) {
  SweptTransients points(values.size());
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

/// Threads that the steps of a scene can use: where many contacts slide, their forces are solved
/// for by BLAS.
int num_threads(const Model& model, int wanted) {
  constexpr std::size_t most_without_blas = 8;
  return is_blas_reentrant() || model.system.contacts.size() <= most_without_blas ? wanted : 1;
}

/// The transients at all values, several together on every thread.
SweptTransients sweep_values(const SweepOptions& options, const LoadedScene& loaded,
                             const NumericKey& key, const std::vector<double>& values) {
  SweptTransients points(values.size());
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
        SweptTransients done = points_at(loaded, key, here, caches[thread]);
        std::move(done.begin(), done.end(), points.begin() + static_cast<std::ptrdiff_t>(first));
      },
      [&](std::size_t num_done, std::size_t task) {
        progress.report(static_cast<double>(num_done) / static_cast<double>(num_batches),
                        value_text(key, values[first_of(task)]));
      });
  progress.finish();
  return points;
}

}  // namespace

ExitCode sweep_transients(const SweepOptions& options, const LoadedScene& loaded) {
  const NumericKey key = find_numeric_key(loaded.scene, options.range.parameter, "--parameter");
  const std::vector<double> values = range_values(key, options.range, options.spacing());
  // The ends of the range are read first: a mistake should not show after an hour.
  for (const double value : {values.front(), values.back()})
    with_settings(loaded, {{key.path, value}});

  const SweptTransients points = sweep_values(options, loaded, key, values);
  if (options.output) write_swept(options, loaded, key, points);
  if (options.figure) draw_swept(options, loaded, key, points);
  if (options.common.json) {
    print_json(Json{{"parameter", key.path}, {"values", values}, {"rows", json_of_swept(points)}});
  } else {
    print_swept(key, points);
    for (const auto& file : {options.output, options.figure})
      if (file) fmt::print("{}\n", *file);
  }
  const bool has_any_done = std::any_of(points.begin(), points.end(),
                                        [](const SweptTransient& p) { return p.failure.empty(); });
  if (!has_any_done) {
    throw NumericalError(points.front().refusal,
                         fmt::format("none of the {} transients came to its end; {}", points.size(),
                                     points.front().failure));
  }
  return ExitCode::done;
}

}  // namespace stridor
