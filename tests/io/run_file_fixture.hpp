// A run file of two series whose every row is known, in a folder of its own.
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <hdf5.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <thread>
#include <vector>

#include "core/errors.hpp"
#include "io/run_file/run_file.hpp"
#include "tests/support/temporary_folder.hpp"

namespace stridor::test {

inline const RunFileHeader header{
    .version = "0.1.0",
    .commit = "abcdef",
    .command = "stridor run 'scène à bielle.yaml' --set time.end=1",
    .scene_hash = "1234",
    .date = "2024-05-17T08:30:00Z",
    .scene_text = "format: 2 # µ = 0.3\n",
    .scene_resolved = "format: 2\ntime: {step: 2.0e-7}\n",
};

inline std::vector<SeriesSpec> two_series() {
  return {{.path = "/channels/tip.y.acceleration",
           .units = "m/s2",
           .attributes = {{"filter", "linear phase"}, {"delay", 0.25}}},
          {.path = "/contact/main/state",
           .units = "1",
           .kind = SeriesKind::state,
           .attributes = {{"meaning", "0 open, 1 slip, 2 stick"}}}};
}

inline double value_at(std::uint64_t row) {
  return std::sin(0.1 * static_cast<double>(row));
}
inline double state_at(std::uint64_t row) {
  return static_cast<double>(row % 3);
}
inline double time_at(std::uint64_t row) {
  return 1e-5 * static_cast<double>(row);
}

inline void append_rows(RunFileWriter& writer, std::uint64_t begin, std::uint64_t count) {
  std::vector<double> time;
  std::vector<double> value;
  std::vector<double> state;
  for (std::uint64_t row = begin; row < begin + count; ++row) {
    time.push_back(time_at(row));
    value.push_back(value_at(row));
    state.push_back(state_at(row));
  }
  writer.append(time, {value, state});
}

// Opens the file and compares every row of it. @return number of rows
inline std::uint64_t check_rows(const std::string& path) {
  const RunFileReader reader(path);
  const auto& times = reader.times();
  const auto values = reader.series("/channels/tip.y.acceleration");
  const auto states = reader.series("/contact/main/state");
  EXPECT_EQ(values.size(), times.size());
  EXPECT_EQ(states.size(), times.size());
  std::uint64_t wrong = 0;
  for (std::uint64_t row = 0; row < times.size(); ++row) {
    if (times[row] != time_at(row) || values[row] != value_at(row) || states[row] != state_at(row))
      ++wrong;
  }
  EXPECT_EQ(wrong, 0U) << path;
  return times.size();
}

// Fills a file with series of many small pieces, so that their index grows to several levels, and
// checks it after every write to the disk, as a process killed there would leave it.
inline void check_after_every_write(const std::string& path, std::uint64_t num_rows) {
  std::uint64_t num_checks = 0;
  std::uint64_t rows_before = 0;
  RunFileOptions options{.block_rows = 20, .chunk_rows = 1};
  options.on_write = [&] {
    ++num_checks;
    const std::uint64_t rows = check_rows(path);
    EXPECT_GE(rows, rows_before);
    rows_before = rows;
  };
  RunFileWriter writer(path, Overwrite::no, header, two_series(), options);
  const std::vector<double> values{1.0, 2.0, 3.0};
  writer.write_static({"/modal/plate/frequency", values, "Hz"});
  for (std::uint64_t row = 0; row < num_rows; row += 20) {
    append_rows(writer, row, 20);
    ASSERT_FALSE(::testing::Test::HasFailure()) << "after " << num_checks << " writes";
  }
  writer.write_static({"/final/plate/displacement", values, "m", "coordinate"});
  writer.write_result("status", "done");
  writer.write_result("steps", 3.0);
  writer.close();
  EXPECT_EQ(check_rows(path), num_rows);
  EXPECT_GE(num_checks, 3 * num_rows);
}

// Fills a file without end in a process of its own, kills that after a while and checks what it
// leaves.
inline void write_until_killed(const std::string& path, std::chrono::microseconds delay) {
  const pid_t child = fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    RunFileWriter writer(path, Overwrite::yes, header, two_series(), {.block_rows = 500});
    for (std::uint64_t row = 0;; row += 500) append_rows(writer, row, 500);
  }
  while (!std::filesystem::exists(path)) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  std::this_thread::sleep_for(delay);
  kill(child, SIGKILL);
  int status = 0;
  waitpid(child, &status, 0);
  ASSERT_TRUE(WIFSIGNALED(status));
  check_rows(path);
  std::filesystem::remove(path);
}

class RunFile : public ::testing::Test {
 protected:
  std::string path(const std::string& name = "run.h5") const { return (folder_ / name).string(); }
  std::vector<std::string> files() const { return folder_.files(); }
  // A file with `rows` rows, closed.
  std::string make_file(std::uint64_t rows) const {
    RunFileWriter writer(path(), Overwrite::yes, header, two_series());
    append_rows(writer, 0, rows);
    writer.close();
    return path();
  }
  // Changes a finished file behind the back of the writer.
  static void edit(const std::string& file, const std::function<void(hid_t)>& action) {
    const hid_t id = H5Fopen(file.c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
    ASSERT_GE(id, 0);
    action(id);
    ASSERT_GE(H5Fclose(id), 0);
  }

  TemporaryFolder folder_;
};

template <typename Action>
void expect_file_error(const Action& action,
                       const ::testing::Matcher<const std::string&>& message) {
  EXPECT_THAT(action, ThrowsMessage<FileError>(message));
}

}  // namespace stridor::test
