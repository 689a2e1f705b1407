// Runs of every kind of scene that die, or find the disk full, at a chosen write.
#pragma once

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <functional>
#include <new>
#include <string>
#include <vector>

#include "app/runs/transient.hpp"
#include "core/errors.hpp"
#include "core/stop_token.hpp"
#include "tests/app/resume_fixture.hpp"
#include "tests/support/write_faults.hpp"

namespace stridor::test {

/// A kind of scene, as `stridor run` takes it.
struct FaultyScene {
  const char* name;
  std::function<void(const std::string& file)> run;           ///< with a checkpoint on the way
  std::function<void(const std::string& file)> run_and_stop;  ///< on request, half-way
  std::function<void(const std::string& file)> resume;
};

inline void PrintTo(const FaultyScene& scene, std::ostream* stream) {
  *stream << scene.name;
}

template <class Run>
void go_to_end(Run& run) {
  if (run.run_to_end() != MarchEnd::finished)
    throw NumericalError(Refusal::diverged, "the run has not finished");
  run.finish();
}

template <class Run, class Loaded>
void run_all(const Loaded& loaded, double half, const std::string& file) {
  Run run(loaded, RunOutput{file, Overwrite::no, "test"});
  run.run_until(half);
  run.write_checkpoint();
  go_to_end(run);
}

template <class Run, class Loaded>
void run_half(const Loaded& loaded, double half, const std::string& file) {
  Run run(loaded, RunOutput{file, Overwrite::no, "test"});
  run.run_until(half);
  request_stop();
  run.run_to_end();
  request_stop(false);
  run.write_checkpoint();
  run.finish();
}

inline std::vector<FaultyScene> faulty_scenes() {
  const auto beam = [] {
    return load_scene(scene_path("examples/stick_slip.yaml"),
                      {"time.end=4e-5", "record.interval=1e-6", "measure.from=0",
                       "record.channels=[contact.force, reed.tip.x.displacement]",
                       "substructures.reed.mesh.along=4",
                       "substructures.reed.reduction.fixed_interface_modes=2"});
  };
  const auto disc = [] {
    return load_scene(scene_path("examples/disc_squeal.yaml"),
                      {"time.end=2e-3", "record.channels=[upper.force, upper.state]"});
  };
  const auto sphere = [] {
    return load_scene(scene_path("viscoelastic_sphere.yaml"), {"time.end=0.25", "measure.from=0"});
  };
  return {{"Beam", [=](const std::string& file) { run_all<Transient>(beam(), 2e-5, file); },
           [=](const std::string& file) { run_half<Transient>(beam(), 2e-5, file); },
           [](const std::string& file) {
             const InterruptedRun interrupted = find_interrupted_run(file);
             const LoadedScene loaded = load_resolved_scene(interrupted.scene_text, file);
             Transient run(loaded, interrupted);
             go_to_end(run);
           }},
          {"Disc", [=](const std::string& file) { run_all<Transient>(disc(), 1e-3, file); },
           [=](const std::string& file) { run_half<Transient>(disc(), 1e-3, file); },
           [](const std::string& file) {
             const InterruptedRun interrupted = find_interrupted_run(file);
             const LoadedScene loaded = load_resolved_scene(interrupted.scene_text, file);
             Transient run(loaded, interrupted);
             go_to_end(run);
           }},
          {"Events", [=](const std::string& file) { run_all<Transient>(sphere(), 0.125, file); },
           [=](const std::string& file) { run_half<Transient>(sphere(), 0.125, file); },
           [](const std::string& file) {
             const InterruptedRun interrupted = find_interrupted_run(file);
             const LoadedScene loaded = load_resolved_scene(interrupted.scene_text, file);
             Transient run(loaded, interrupted);
             go_to_end(run);
           }}};
}

/// How a process ended that did something under a plan of faults.
struct FaultyEnd {
  int exit_code = -1;  ///< 0 done, 4 a FileError, 99 anything else thrown; −1 killed
  long count = 0;      ///< calls that write files
};

/// Does it in a process of its own.
inline FaultyEnd with_fault(FaultPlan plan, const std::function<void()>& action) {
  void* shared =
      mmap(nullptr, sizeof(FaultPlan), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  if (shared == MAP_FAILED) throw std::bad_alloc();
  auto* in_force = new (shared) FaultPlan(plan);
  std::fflush(nullptr);
  const pid_t child = fork();
  if (child == 0) {
    int code = 0;
    fault_plan = in_force;
    try {
      action();
    } catch (const FileError&) {
      code = 4;
    } catch (const std::exception& error) {
      fault_plan = nullptr;
      fmt::print(stderr, "unexpected: {}\n", error.what());
      code = 99;
    }
    _exit(code);
  }
  int status = 0;
  waitpid(child, &status, 0);
  const FaultyEnd end{WIFEXITED(status) ? WEXITSTATUS(status) : -1, in_force->count};
  munmap(shared, sizeof(FaultPlan));
  return end;
}

/// A scene with what its run should give, and the faults its runs were given so far.
class FaultTrial {
 public:
  explicit FaultTrial(FaultyScene scene) : scene_(std::move(scene)) {
    EXPECT_EQ(with_fault({}, [&] { scene_.run(whole_); }).exit_code, 0);
    EXPECT_EQ(with_fault({}, [&] { scene_.run_and_stop(stopped_); }).exit_code, 0);
  }

  /// Calls that a run from the beginning takes, or one that is resumed.
  long num_calls(bool is_resumed) {
    prepare(is_resumed);
    return with_fault({}, action(is_resumed)).count;
  }

  /// A run under a plan: its file is absent, or readable and resumes to the same as the whole run.
  void give(const FaultPlan& plan, bool is_resumed) {
    prepare(is_resumed);
    const FaultyEnd end = with_fault(plan, action(is_resumed));
    ++num_given_;
    if (plan.fault == Fault::kill || plan.fault == Fault::torn) {
      ASSERT_EQ(end.exit_code, -1);
    } else {
      ASSERT_TRUE(end.exit_code == 0 || end.exit_code == 4 || end.exit_code == -1);
    }
    if (!std::filesystem::exists(broken_)) {
      ASSERT_FALSE(is_resumed);
      ASSERT_NE(end.exit_code, 0);
      return;
    }
    try {
      check_file(end, is_resumed);
    } catch (const FileError& error) {
      FAIL() << error.what();
    }
  }

  int num_given() const { return num_given_; }

 private:
  /// What is left of a run: readable, done where it says so, else to be resumed.
  void check_file(const FaultyEnd& end, bool is_resumed) {
    ASSERT_NO_FATAL_FAILURE(check_rows());
    if (is_done(RunFileReader(broken_))) {
      ASSERT_EQ(difference(whole_, broken_), "") << "says it is done";
      return;
    }
    ASSERT_NE(end.exit_code, 0);
    if (!RunFileReader(broken_).checkpoint()) {
      // Killed before its first checkpoint: it has not begun, and that is what resuming says.
      ASSERT_FALSE(is_resumed);
      ASSERT_TRUE(RunFileReader(broken_).times().size() <= 1);
      ASSERT_EQ(with_fault({}, [&] { scene_.resume(broken_); }).exit_code, 4);
      return;
    }
    ASSERT_EQ(with_fault({}, [&] { scene_.resume(broken_); }).exit_code, 0);
    ASSERT_EQ(difference(whole_, broken_), "");
    for (const std::string& name : folder_.files())
      ASSERT_EQ(name.find(".part-"), std::string::npos) << "left: " << name;
  }
  void prepare(bool is_resumed) {
    for (const std::string& name : folder_.files()) {
      if (name.starts_with("broken.h5")) std::filesystem::remove(folder_ / name);
    }
    if (is_resumed) std::filesystem::copy_file(stopped_, broken_);
  }
  std::function<void()> action(bool is_resumed) {
    return [this, is_resumed] { is_resumed ? scene_.resume(broken_) : scene_.run(broken_); };
  }
  /// The rows there are must be those of the whole run.
  void check_rows() const {
    const RunFileReader file(broken_);
    const RunFileReader full(whole_);
    const std::size_t count = file.times().size();
    for (const std::string& name : file.series_names()) {
      std::vector<double> expected = full.series(name);
      ASSERT_LE(count, expected.size());
      expected.resize(count);
      ASSERT_EQ(file.series(name), expected) << name;
    }
  }

  FaultyScene scene_;
  TemporaryFolder folder_;
  const std::string whole_ = (folder_ / "whole.h5").string();
  const std::string stopped_ = (folder_ / "stopped.h5").string();
  const std::string broken_ = (folder_ / "broken.h5").string();
  int num_given_ = 0;
};

/// Every fault of a kind, at every `stride`-th call of a run and of one that is resumed.
inline void give_everywhere(FaultTrial& trial, Fault fault, long stride) {
  for (const bool is_resumed : {false, true}) {
    const long count = trial.num_calls(is_resumed);
    for (long at = 1; at <= count; at += stride) {
      SCOPED_TRACE(fmt::format("fault {} at call {} of {} of a run {}", static_cast<int>(fault), at,
                               count, is_resumed ? "that is resumed" : "from the beginning"));
      ASSERT_NO_FATAL_FAILURE(trial.give({fault, at, 0, 0}, is_resumed));
    }
  }
}

inline std::string name_of_scene(const ::testing::TestParamInfo<FaultyScene>& tested) {
  return tested.param.name;
}

}  // namespace stridor::test
