// A transient of a scene that is written to a run file; common to `run` and `compare`.
#pragma once

#include <chrono>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/runs/run_driver.hpp"
#include "app/runs/run_frames.hpp"
#include "app/runs/run_keeping.hpp"
#include "io/results/locus_file.hpp"
#include "io/run_file/initial_state.hpp"

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

  /// Goes to a time, or to the end of the run (including the look-ahead of its filters).
  /// @return `failed` where it failed before the end that was asked for
  MarchEnd run_until(double time);
  MarchEnd run_to_end();
  /// Has run_to_end() write the shapes of the bodies at equal times (RunFrames).
  /// @throws FileError as RunFrames
  void write_frames(const std::filesystem::path& folder, double interval);

  /// Has finish() set unstable windows beside the bursts of the run (store_heard_windows()).
  void compare_with(std::vector<TimedWindow> windows);

  /// Stores the state of the run in its file.
  /// @throws FileError if it cannot be written
  void write_checkpoint();
  /// Progress and the limit of wall time.
  RunKeeper& keeper() { return keeper_; }

  /// Flushes, reads the statistics from the file, stores them in it and closes it.
  /// @param error estimated error of the run, or null
  /// @return the JSON object of `run`
  Json finish(const Json& error = nullptr);

  double time() const { return driver_->time(); }
  /// Cause, time and remedy of the failure; empty unless the run has failed.
  const std::string& failure() const { return driver_->failure(); }
  Refusal refusal() const { return driver_->refusal(); }
  const Model& model() const { return model_; }

 private:
  using Clock = std::chrono::steady_clock;

  void begin();
  State save() const;
  void load(const State& state);
  MarchEnd run_from_frame_to_frame();
  template <class Advance>
  MarchEnd timed(const Advance& advance);
  void write_final_motion();

  const LoadedScene* loaded_;
  std::string file_;
  RunKeeper keeper_;
  Model model_;
  InitialState start_;
  std::optional<std::vector<TimedWindow>> windows_;  ///< predicted, where they are to be compared
  std::unique_ptr<RunFrames> frames_;
  double frame_interval_ = 0.0;  ///< s
  std::unique_ptr<RunDriver> driver_;
  std::optional<RunFileWriter> writer_;
  MarchEnd end_ = MarchEnd::finished;
  double setup_seconds_ = 0.0;
  double file_seconds_ = 0.0;
  double march_seconds_ = 0.0;
};

}  // namespace stridor
