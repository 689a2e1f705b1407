// A run file of two series whose every row is known, in a folder of its own.
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <hdf5.h>

#include <cmath>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "core/errors.hpp"
#include "io/run_file.hpp"
#include "tests/support/temporary_folder.hpp"

namespace stridor::test {

inline const RunFileHeader header{
    .version = "0.1.0",
    .commit = "abcdef",
    .command = "stridor run 'scène à bielle.yaml' --set time.end=1",
    .scene_hash = "1234",
    .date = "2024-05-17T08:30:00Z",
    .scene_text = "format: 1 # µ = 0.3\n",
    .scene_resolved = "format: 1\ntime: {step: 2.0e-7}\n",
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
