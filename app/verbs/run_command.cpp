// stridor run: transient simulation of a scene.
#include <fmt/format.h>

#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "app/results/pictures.hpp"
#include "app/runs/error_estimate.hpp"
#include "app/runs/heard_windows.hpp"
#include "app/runs/run_ending.hpp"
#include "app/runs/transient.hpp"
#include "app/runs/transient_report.hpp"
#include "app/stability/prediction.hpp"
#include "app/terminal/command.hpp"
#include "app/terminal/progress.hpp"
#include "core/errors.hpp"
#include "core/stop_token.hpp"
#include "io/hdf5/damage_guard.hpp"
#include "io/scene/scene_warnings.hpp"

namespace stridor {
namespace {

struct RunOptions {
  CommonOptions common;
  std::string scene;
  std::string output;
  std::string resumed;
  double max_wall = std::numeric_limits<double>::infinity();  ///< s
  bool verify = false;
  bool error = false;
  std::optional<std::string> predict;       ///< locus file
  std::optional<std::string> vtu;           ///< folder
  std::optional<std::string> vtu_interval;  ///< as the user wrote it
  std::string command_line;
};

Json error_json(const ErrorEstimate& estimate) {
  return {{"force", number(estimate.errors.force)},
          {"acceleration", number(estimate.errors.acceleration)},
          {"envelope", number(estimate.errors.envelope)},
          {"is", fmt::format("difference from exact propagation of all modes at {:.4g} s",
                             estimate.step)},
          {"wall_s", number(estimate.seconds)},
          {"failure", estimate.failure.empty() ? Json(nullptr) : Json(estimate.failure)}};
}

/// Refuses before the run settings that cannot be studied.
std::optional<StudiedScene> studied(const LoadedScene& loaded, const RunOptions& options) {
  if (!options.error) return std::nullopt;
  if (loaded.scene.time->is_event_driven()) {
    throw ConfigError(Refusal::contradiction, "--error",
                      "is for time.step; of time.integrator: event_driven the verb "
                      "`precision` says the error");
  }
  return study_scene(loaded);
}

/// A transient whose error is estimated once it is whole, where there is a study of its scene.
class StudiedRun {
 public:
  StudiedRun(Transient& transient, const std::optional<StudiedScene>& study)
      : transient_(&transient), study_(&study) {}

  RunKeeper& keeper() { return transient_->keeper(); }
  MarchEnd run_to_end() { return end_ = transient_->run_to_end(); }
  void write_checkpoint() { transient_->write_checkpoint(); }
  double time() const { return transient_->time(); }
  const std::string& failure() const { return transient_->failure(); }
  Refusal refusal() const { return transient_->refusal(); }

  Json finish() {
    if (!*study_ || end_ != MarchEnd::finished) return transient_->finish();
    Progress progress("error");
    const ErrorEstimate estimate = estimate_error(
        **study_, [&](double part) { progress.report(part, "a finer run beside it"); });
    progress.finish();
    is_cut_short_ = stop_requested() && !estimate.failure.empty();
    return transient_->finish(error_json(estimate));
  }
  /// Whether a request to stop came before the error was known.
  bool is_cut_short() const { return is_cut_short_; }

 private:
  Transient* transient_;
  const std::optional<StudiedScene>* study_;
  MarchEnd end_ = MarchEnd::finished;
  bool is_cut_short_ = false;
};

/// Time between the files of --vtu, s; nothing where none are wanted.
std::optional<double> frame_interval(const RunOptions& options, const LoadedScene& loaded) {
  if (!options.vtu) {
    if (options.vtu_interval)
      throw ConfigError(Refusal::wrong_value, "--vtu-interval",
                        "is the time between files of --vtu FOLDER; give that too");
    return std::nullopt;
  }
  constexpr double num_frames = 100.0;
  if (!options.vtu_interval) return loaded.scene.time->end / num_frames;
  const double interval =
      option_value("--vtu-interval", *options.vtu_interval, "s", Range::positive());
  constexpr double most = 1e5;
  if (loaded.scene.time->end > most * interval) {
    throw ConfigError(Refusal::too_large, "--vtu-interval",
                      fmt::format("makes more than {:g} files; take a longer one", most));
  }
  return interval;
}

/// Windows to be set beside the bursts; what cannot be compared is refused before the run.
std::optional<std::vector<TimedWindow>> predicted_windows(const RunOptions& options,
                                                          const LoadedScene& loaded) {
  if (!options.predict) return std::nullopt;
  if (loaded.scene.measure.band.empty()) {
    throw ConfigError(Refusal::contradiction, "--predict",
                      "sets windows beside bursts, but the scene seeks none; give it measure.band, "
                      "the frequencies in which they are sought");
  }
  return read_predictions(*options.predict, {loaded.hash(), loaded.resolved()},
                          loaded.scene.measure.band.back());
}

/// @param study of the scene, where the error is to be estimated
ExitCode run_to_end(Transient& transient, const LoadedScene& loaded, const std::string& file,
                    const std::optional<StudiedScene>& study, const RunEnding& ending) {
  StudiedRun run(transient, study);
  const ExitCode code = run_and_report(
      run, loaded.scene.time->end, file, ending, loaded.scene.expect, [&](const Json& results) {
        loaded.scene.time->is_event_driven() ? print_cycles(results, file)
                                            : print_summary(results, file);
      });
  if (run.is_cut_short())
    throw Interrupted(file + " holds the whole run; its error was not estimated");
  return code;
}

ExitCode begin(const RunOptions& options) {
  const RunOutput output{options.output, options.common.overwrite(), options.command_line};
  const RunEnding ending{options.max_wall, options.common.json, options.verify};
  const LoadedScene loaded = load_scene(options.scene, options.common.sets);
  loaded.require_section("time", "run");
  const auto study = studied(loaded, options);
  const std::optional<double> frames = frame_interval(options, loaded);
  auto windows = predicted_windows(options, loaded);
  Transient transient(loaded, output);
  if (frames) transient.write_frames(*options.vtu, *frames);
  if (windows) transient.compare_with(std::move(*windows));
  print_warnings(scene_warnings(loaded, transient.model()));
  return run_to_end(transient, loaded, options.output, study, ending);
}

/// Says what a run gave that is done already.
ExitCode report_done(const RunOptions& options, const RunFileReader& reader) {
  if (options.error) {
    throw ConfigError(Refusal::wrong_value, "--error",
                      options.resumed +
                          " holds a whole run; an error is estimated with the run, "
                          "so begin it anew");
  }
  if (options.predict) {
    throw ConfigError(Refusal::contradiction, "--predict",
                      fmt::format("{} holds a whole run; `stridor spectrogram {} "
                                  "--predict` sets windows beside its bursts",
                                  options.resumed, options.resumed));
  }
  const Json results = stored_results(reader);
  if (options.common.json) {
    print_warnings({});  // those of the scene were told when the run began
    print_json(results);
  } else {
    fmt::print("{:<24}done; {} holds the whole run, there is nothing left to do\n", "status",
               options.resumed);
  }
  if (options.verify) {
    const std::string& text = reader.header().scene_resolved;
    const std::string source = options.resumed + ":/scene/resolved";
    check_expectations(load_resolved_scene(text, source).scene.expect, results);
  }
  return ExitCode::done;
}

ExitCode resume(const RunOptions& options) {
  std::optional<DamageGuard> guard(options.resumed);
  {
    const RunFileReader reader(options.resumed);
    if (is_done(reader)) return report_done(options, reader);
  }
  const InterruptedRun interrupted = find_interrupted_run(options.resumed);
  guard.reset();
  const std::string source = options.resumed + ":/scene/resolved";
  const RunEnding ending{options.max_wall, options.common.json, options.verify};
  const LoadedScene loaded = load_resolved_scene(interrupted.scene_text, source);
  const auto study = studied(loaded, options);
  const std::optional<double> frames = frame_interval(options, loaded);
  auto windows = predicted_windows(options, loaded);
  Transient transient(loaded, interrupted);
  if (frames) transient.write_frames(*options.vtu, *frames);
  if (windows) transient.compare_with(std::move(*windows));
  print_warnings({});  // those of the scene were told when the run began
  return run_to_end(transient, loaded, options.resumed, study, ending);
}

/// @throws ConfigError where the options do not say what to run, or twice
ExitCode run(const RunOptions& options) {
  const bool has_scene = !options.scene.empty();
  if (options.resumed.empty()) {
    if (!has_scene)
      throw ConfigError(Refusal::missing, "", "run: give a scene, or --resume FILE.h5");
    if (options.output.empty())
      throw ConfigError(Refusal::missing, "", "run: --output is required");
    return begin(options);
  }
  if (has_scene || !options.output.empty() || !options.common.sets.empty() ||
      options.common.force) {
    throw ConfigError(Refusal::wrong_value, "",
                      "run: --resume goes on with the scene in the file and writes into it; leave "
                      "scene, --output, --set and --force away");
  }
  return resume(options);
}

}  // namespace

void add_run_command(CLI::App& program, Action& action, const std::string& command_line) {
  auto options = std::make_shared<RunOptions>();
  options->command_line = command_line;
  CLI::App* verb = program.add_subcommand("run", "Transient simulation of a scene");
  verb->add_option("scene", options->scene, "Scene file (YAML)");
  verb->add_option("-o,--output", options->output, "Run file to write (HDF5)");
  verb->add_option("--resume", options->resumed,
                   "Go on with an interrupted run, from the latest checkpoint in its file");
  verb->add_option("--max-wall", options->max_wall,
                   "Stop after this much wall time (s), resumable; exit 5")
      ->check(CLI::PositiveNumber);
  verb->add_flag("--verify", options->verify,
                 "Compare the results with the scene's `expect` block; exit 3 where they differ");
  verb->add_flag("--error", options->error, "Estimate the error of the run by a second, finer one");
  verb->add_option("--predict", options->predict,
                   "Locus file (`locus -o`) whose unstable windows are set beside the bursts");
  verb->add_option("--vtu", options->vtu,
                   "Folder for the shapes of the bodies over time, as files for ParaView (run.pvd)");
  verb->add_option("--vtu-interval", options->vtu_interval,
                   "Time between these (default: a hundredth of the run)");
  add_scene_options(*verb, options->common);
  add_json_option(*verb, options->common);
  add_force_option(*verb, options->common);
  verb->callback([options, &action] { action = [options] { return run(*options); }; });
}

}  // namespace stridor
