// A transient of a scene on its way into a run file; what `run` and `compare` share.
#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "app/command.hpp"
#include "io/recorder.hpp"
#include "io/run_summary.hpp"
#include "io/scene.hpp"
#include "solvers/march.hpp"

namespace stridor {

/// Where the results of a transient go, and by which command.
struct TransientOutput {
  std::string file;  ///< run file (HDF5)
  Overwrite overwrite = Overwrite::no;
  std::string command_line;
};

class Transient {
 public:
  /// Builds the model, the simulation and the run file.
  /// @param loaded must live longer
  /// @throws ConfigError with places in the scene, FileError, NumericalError
  Transient(const LoadedScene& loaded, const TransientOutput& output);
  Transient(const Transient&) = delete;
  Transient& operator=(const Transient&) = delete;

  /// Steps until a time, or until the end of the run (with what its filters look ahead).
  /// @return `failed` where a step failed before the end that was asked for
  MarchEnd run_until(double time);
  MarchEnd run_to_end();

  /// Called about four times a second with the fraction done and a short text.
  void on_progress(std::function<void(double, const std::string&)> report) {
    report_ = std::move(report);
  }

  /// Flushes, reads the statistics off the file, stores them in it and closes it.
  /// @return the JSON object of `run`
  Json finish();

  const Simulation& simulation() const { return *simulation_; }
  const Model& model() const { return model_; }
  /// Time spent in stepping so far, s.
  double march_seconds() const { return march_seconds_; }

 private:
  using Clock = std::chrono::steady_clock;

  MarchEnd run_to_step(std::int64_t step);
  void store_final_motion();

  const LoadedScene* loaded_;
  std::string file_;
  Clock::time_point setup_start_ = Clock::now();
  Model model_;
  std::optional<Simulation> simulation_;
  std::optional<RunFileWriter> writer_;
  std::optional<Recorder> recorder_;
  std::optional<March> march_;
  std::int64_t end_step_ = 0;
  std::int64_t last_step_ = 0;
  MarchEnd end_ = MarchEnd::finished;
  bool has_final_motion_ = false;
  double setup_seconds_ = 0.0;
  double file_seconds_ = 0.0;
  double march_seconds_ = 0.0;
  std::function<void(double, const std::string&)> report_;
  Clock::time_point last_flush_ = Clock::now();
};

/// Writes the bursts of the JSON object of `run` in one line each, or that there are none.
void print_bursts(const Json& results);

}  // namespace stridor
