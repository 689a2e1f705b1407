// A transient of a scene that is written to a run file; common to `run` and `compare`.
#pragma once

#include <chrono>
#include <memory>
#include <optional>
#include <string>

#include "app/command.hpp"
#include "app/run_keeping.hpp"
#include "io/recorder.hpp"
#include "io/run_summary.hpp"
#include "io/scene.hpp"
#include "solvers/march.hpp"

namespace stridor {

class Transient {
 public:
  /// Builds the model, the simulation and the run file.
  /// @param loaded must live longer
  /// @throws ConfigError with places in the scene, FileError, NumericalError
  Transient(const LoadedScene& loaded, const RunOutput& output);
  /// Resumes a run from the latest checkpoint of its file, bit-identically to an uninterrupted run.
  /// @param loaded the scene of `interrupted`
  /// @throws FileError if the file has no checkpoint, or not one of this program and scene, or
  ///         cannot be changed; as the other constructor
  Transient(const LoadedScene& loaded, const InterruptedRun& interrupted);
  Transient(const Transient&) = delete;
  Transient& operator=(const Transient&) = delete;

  /// Steps until a time, or until the end of the run (including the look-ahead of its filters).
  /// @return `failed` where a step failed before the end that was asked for
  MarchEnd run_until(double time);
  MarchEnd run_to_end();

  /// Stores the state of the run in its file.
  /// @throws FileError if it cannot be written
  void write_checkpoint();
  /// Progress and the limit of wall time.
  RunKeeper& keeper() { return keeper_; }

  /// Flushes, reads the statistics from the file, stores them in it and closes it.
  /// @param error estimated error of the run, or null
  /// @return the JSON object of `run`
  Json finish(const Json& error = nullptr);

  const Simulation& simulation() const { return *simulation_; }
  const Model& model() const { return model_; }
  /// Time spent in stepping so far, s.
  double march_seconds() const { return march_seconds_; }

 private:
  using Clock = std::chrono::steady_clock;

  void make_march();
  void make_simulation();
  std::vector<SeriesSpec> series() const;
  State save() const;
  void load(const State& state);
  MarchEnd run_to_step(std::int64_t step);
  void keep_final_motion();
  void write_final_motion();

  const LoadedScene* loaded_;
  std::string file_;
  RunKeeper keeper_;
  Model model_;
  std::vector<Channel> channels_;
  double interval_ = 0.0;  ///< of the samples, s
  std::optional<Simulation> simulation_;
  std::optional<RunFileWriter> writer_;
  std::optional<Recorder> recorder_;
  std::optional<March> march_;
  std::int64_t end_step_ = 0;
  std::int64_t last_step_ = 0;
  MarchEnd end_ = MarchEnd::finished;
  State final_motion_;  ///< by path under /final; empty before the end
  double setup_seconds_ = 0.0;
  double file_seconds_ = 0.0;
  double march_seconds_ = 0.0;
};

}  // namespace stridor
