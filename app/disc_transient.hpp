// A transient of a disc between pads on its way into a run file.
#pragma once

#include <complex>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "app/run_keeping.hpp"
#include "io/disc_recorder.hpp"
#include "io/disc_scene.hpp"
#include "solvers/march.hpp"

namespace stridor {

/// Statistics of a run of a disc: over the whole of it, and over its second half.
class DiscStatistics {
 public:
  DiscStatistics(const DiscModel& model, double half);

  void add(const FaceContactMotion& motion, double time);
  void report(Json& results) const;

  void save(State& state, const std::string& prefix) const;
  void load(const State& state, const std::string& prefix);

 private:
  double half_;                        ///< s
  std::vector<double> least_, most_;   ///< force of every contact in the second half, N
  double before_ = 0.0, after_ = 0.0;  ///< largest displacement of a pad, m
  std::int64_t steps_ = 0, sticking_ = 0, open_ = 0;
};

/// As Transient, for discs.
class DiscTransient {
 public:
  /// @param loaded a scene of a disc; must live longer
  /// @throws ConfigError with what the scene lacks for a run; FileError, NumericalError
  DiscTransient(const LoadedDiscScene& loaded, const RunOutput& output);
  /// Goes on with a run from the latest checkpoint of its file, bitwise as if it had not stopped.
  /// @throws FileError as Transient
  DiscTransient(const LoadedDiscScene& loaded, const InterruptedRun& interrupted);
  DiscTransient(const DiscTransient&) = delete;
  DiscTransient& operator=(const DiscTransient&) = delete;

  /// Steps until a time, or until the end of the run (with what its filters look ahead).
  MarchEnd run_until(double time);
  MarchEnd run_to_end();

  /// Progress and the limit of wall time.
  RunKeeper& keeper() { return keeper_; }
  /// @throws FileError if it cannot be written
  void write_checkpoint();
  /// Stores the results in the file and closes it. @return the JSON object of `run`
  Json finish();

  double time() const;
  /// Failure with body or contact, time and remedy; empty unless the run has failed.
  const std::string& failure() const { return failure_; }

 private:
  /// The eigenvalue of the motion at the start, and that motion.
  struct Perturbation {
    std::complex<double> s;
    Eigen::VectorXd displacement, velocity;
  };

  const DiscScene& scene() const { return loaded_->scene; }
  void make_model();
  Perturbation perturbation() const;
  MarchEnd run_to_step(std::int64_t step);
  bool is_sound(bool has_converged);
  State save() const;
  void load(const State& state);

  const LoadedDiscScene* loaded_;
  std::string file_;
  RunKeeper keeper_;
  std::optional<DiscModel> model_;
  std::unique_ptr<FaceContactMotion> motion_;
  std::optional<DiscRecorder> recorder_;
  std::optional<DiscStatistics> statistics_;
  std::optional<RunFileWriter> writer_;
  std::complex<double> eigenvalue_;  ///< of the perturbation, 1/s
  std::int64_t step_ = 0;            ///< steps done, those for the filters included
  std::int64_t end_step_ = 0;
  std::int64_t last_sample_ = 0;
  MarchEnd end_ = MarchEnd::finished;
  std::string failure_;
  double setup_seconds_ = 0.0, march_seconds_ = 0.0;
};

}  // namespace stridor
