// Functions common to runs of every kind of scene: resumption, run times and endings.
#pragma once

#include <chrono>
#include <functional>
#include <limits>
#include <string>

#include "app/terminal/command.hpp"
#include "io/run_file/run_file.hpp"
#include "io/scene/scene_files.hpp"

namespace stridor {

/// Destination of the results of a run, and the command.
struct RunOutput {
  std::string file;  ///< run file (HDF5)
  Overwrite overwrite = Overwrite::no;
  std::string command_line;
};

/// Requested ending of a run, and its report.
struct RunEnding {
  double max_wall = std::numeric_limits<double>::infinity();  ///< s
  bool json = false;
  bool verify = false;
};

/// A run that can go on.
struct InterruptedRun {
  std::string file;
  std::string scene_text;  ///< resolved
  Checkpoint checkpoint;
};

/// Whether a run file holds a run that is done.
bool is_done(const RunFileReader& reader);
/// The results that a run file keeps, as `run` nests them: numbers and texts, no lists.
Json stored_results(const RunFileReader& reader);

/// Finds out whether and from where a run can go on.
/// @throws FileError if the file is no run file, was written by another program or of a scene that
///         is not what it was, holds a whole run or no checkpoint
InterruptedRun find_interrupted_run(const std::string& file);
/// That its checkpoint is of another scene or program.
[[noreturn]] void throw_unfit_checkpoint(const std::string& file, const std::string& what);

/// @param text     of the scene as given
/// @param resolved with all defaults and --set
/// @param files    that it names
RunFileHeader run_header(const std::string& command_line, const std::string& text,
                         const std::string& resolved, const std::vector<SceneFile>& files);

/// Writes the numbers and texts of a JSON object under dotted names.
void store_results(RunFileWriter& writer, const Json& results);

/// Seconds of wall time since a moment.
double seconds_since(std::chrono::steady_clock::time_point moment);

/// Times that a run took, s.
struct RunTimes {
  double setup = 0.0, march = 0.0, output = 0.0;
};
/// steps, step, step_limit, wall_s, setup_s, output_s and step_ns.
/// @param step, limit s, or null
Json effort_json(std::int64_t steps, const Json& step, const Json& limit, const RunTimes& times);

/// Looks after a run between its steps: progress, checkpoints and flushes, the limit of wall time.
class RunKeeper {
 public:
  /// @param every wall time between checkpoints, s
  explicit RunKeeper(double every = std::numeric_limits<double>::infinity()) : every_(every) {}

  /// Called with the fraction done and a short text.
  void on_progress(std::function<void(double, const std::string&)> report) {
    report_ = std::move(report);
  }
  /// A request to stop is made by itself when this much wall time has passed since the
  /// construction, s.
  void limit_wall_time(double seconds) { wall_limit_ = seconds; }

  /// Whether a quarter of a second has passed since this was last true.
  bool is_due();
  /// To be called about four times a second.
  /// @param save gives the state for checkpoints
  void look_after(double time, double end, RunFileWriter& writer,
                  const std::function<State()>& save);
  /// @throws FileError if it cannot be written
  void write_checkpoint(RunFileWriter& writer, const State& state);

  /// Wall time since the construction, s.
  double seconds() const { return seconds_since(start_); }

 private:
  using Clock = std::chrono::steady_clock;
  Clock::time_point start_ = Clock::now();
  Clock::time_point last_look_ = start_, last_flush_ = start_, last_checkpoint_ = start_;
  double every_;
  double wall_limit_ = std::numeric_limits<double>::infinity();
  std::function<void(double, const std::string&)> report_;
};

/// Message that a run was stopped on request, and how to resume it.
/// @param time, end s, or in units of the run
[[noreturn]] void throw_interrupted(double time, double end, const std::string& file);

}  // namespace stridor
