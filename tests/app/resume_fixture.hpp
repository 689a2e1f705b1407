// Runs that are killed and go on, compared with one that was left alone.
#pragma once

#include <gtest/gtest.h>

#include <chrono>
#include <csignal>
#include <filesystem>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include "io/run_file/run_file.hpp"
#include "tests/support/program.hpp"

namespace stridor::test {

/// Differences between two run files in anything but times taken; empty where there are none.
inline std::string difference(const std::string& one, const std::string& other) {
  const RunFileReader a(one);
  const RunFileReader b(other);
  std::string said;
  if (a.times() != b.times()) said += "times; ";
  if (a.series_names() != b.series_names()) said += "names of series; ";
  for (const std::string& name : a.series_names()) {
    if (a.series(name) != b.series(name)) said += name + "; ";
  }
  if (a.static_names() != b.static_names()) said += "names of arrays; ";
  for (const std::string& name : a.static_names()) {
    if (a.static_array(name) != b.static_array(name)) said += name + "; ";
  }
  auto results = a.results();
  auto others = b.results();
  for (const char* name : {"file", "wall_s", "setup_s", "output_s", "step_ns"}) {
    results.erase(name);
    others.erase(name);
  }
  if (results != others) said += "results; ";
  return said;
}

inline std::vector<std::string> long_run(const std::string& output,
                                         const std::string& end = "0.3") {
  return {"run",   scene_path("beam_on_beam.yaml"),
          "-o",    output,
          "--set", "time.end=" + end,
          "--set", "time.integrator=exact",
          "--set", "time.step=1e-6",
          "--set", "measure.from=0.05",
          "--set", "checkpoint.every=0.05"};
}

/// A run that has an end only where it is stopped (in 500 million steps, and what is recorded until then
/// is summed up in less than 5 GB of memory): the beam does not get to the free end, and
/// nothing that its contact does is taken for a failure.
inline std::vector<std::string> endless_run(const std::string& output) {
  std::vector<std::string> command = long_run(output, "500");
  command.insert(command.end(),
                 {"--set", "drive.velocity=1e-7", "--set", "contact.armed_from=1e3"});
  return command;
}

inline void wait_for(const std::filesystem::path& file) {
  for (int i = 0; i < 3000 && !std::filesystem::exists(file); ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
}

/// Whether there was nothing left to do: it was over before it was killed.
inline bool was_over(const ProgramResult& result) {
  return result.exit_code == 0 && result.out.find("holds the whole run") != std::string::npos;
}

/// Kills a run again and again, resumes it each time, and compares what comes out in the end.
inline void kill_and_resume(int num_kills, int longest_ms) {
  const TemporaryFolder folder;
  const std::string whole = (folder / "whole.h5").string();
  const std::string broken = (folder / "broken.h5").string();
  ASSERT_EQ(Program(long_run(whole)).run().exit_code, 0);

  std::mt19937 random(20250102);
  std::uniform_int_distribution<int> delay(1, longest_ms);
  int kills = 0;
  while (kills < num_kills) {
    std::filesystem::remove(broken);
    std::vector<std::string> command = long_run(broken);
    // A run that is over before all kills were given begins anew.
    for (bool is_over = false; !is_over;) {
      Program program(command);
      program.start();
      wait_for(broken);
      std::this_thread::sleep_for(std::chrono::milliseconds(delay(random)));
      const bool is_last = kills >= num_kills;
      if (!is_last) program.send(SIGKILL);
      const ProgramResult result = program.wait();
      is_over = result.exit_code == 0 || was_over(result);
      if (is_over) break;
      ASSERT_EQ(result.exit_code, -1) << result.err;
      ++kills;
      // Every row there is right, not only those of the end.
      const RunFileReader file(broken);
      const RunFileReader full(whole);
      const std::size_t count = file.times().size();
      for (const std::string& name : file.series_names()) {
        std::vector<double> expected = full.series(name);
        expected.resize(count);
        ASSERT_EQ(file.series(name), expected) << name << " after kill " << kills;
      }
      command = {"run", "--resume", broken};
    }
    ASSERT_EQ(difference(whole, broken), "") << "after " << kills << " kills";
  }
}

}  // namespace stridor::test
