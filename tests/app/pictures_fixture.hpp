// Run files as `run` leaves them, for tests of what is made of them.
#pragma once

#include <gtest/gtest.h>
#include <hdf5.h>

#include <cmath>
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <numbers>
#include <string>
#include <tuple>
#include <vector>

#include "io/run_file/run_file.hpp"
#include "tests/support/program.hpp"

namespace stridor::test {

constexpr double interval = 1e-4;
constexpr std::size_t num_rows = 4000;  // 0.4 s
constexpr double tone = 1000.0;         // Hz, from 0.2 to 0.3 s

/// How a run file of these tests differs from the usual one.
struct RunContents {
  std::vector<std::string> channels{"/channels/beam.tip.y.acceleration",
                                    "/channels/beam.tip.y.displacement",
                                    "/channels/beam.tip.y.velocity", "/contact/contact/force"};
  std::string scene = "format: 2\nmeasure: {from: 0.05, band: [500.0, 2000.0]}\n";
  bool has_bursts = true;
  double trusted_frequency = 0.0;  ///< Hz, a result of the run where positive
  std::size_t rows = num_rows;
};

inline std::string units_of(const std::string& path) {
  if (path.ends_with("acceleration")) return "m/s^2";
  if (path.ends_with("velocity")) return "m/s";
  if (path.find("force") != std::string::npos) return "N";
  return "m";
}

/// A tone of amplitude 2 in the acceleration, and its integrals; a constant force.
inline double value_at(const std::string& path, double time) {
  if (path.find("force") != std::string::npos) return 0.2;
  if (time < 0.2 || time > 0.3) return 0.0;
  const double omega = 2.0 * std::numbers::pi * tone;
  if (path.ends_with("acceleration")) return 2.0 * std::sin(omega * time);
  if (path.ends_with("velocity")) return -2.0 / omega * std::cos(omega * time);
  return -2.0 / (omega * omega) * std::sin(omega * time);
}

class Pictures : public ::testing::Test {
 protected:
  /// Writes a run file as `run` would have left it. @return its path
  std::string make_run(const RunContents& contents = {}, const std::string& name = "run.h5") const {
    std::vector<SeriesSpec> series;
    for (const std::string& path : contents.channels)
      series.push_back({path, units_of(path), SeriesKind::real, {}});
    RunFileHeader header{.version = "0.1.0",
                         .commit = "abcdef",
                         .command = "stridor run scene.yaml",
                         .scene_hash = "0123456789abcdef",
                         .date = "2024-05-17T08:30:00Z",
                         .scene_text = "format: 2\n",
                         .scene_resolved = contents.scene};
    RunFileWriter writer(path(name), Overwrite::yes, header, series);
    for (std::size_t i = 0; i < contents.rows; ++i) {
      const double time = static_cast<double>(i) * interval;
      std::vector<double> row;
      for (const std::string& channel : contents.channels) row.push_back(value_at(channel, time));
      writer.append(time, row);
    }
    if (contents.has_bursts) {
      for (const auto& [property, value, units] :
           {std::tuple{"start", 0.2, "s"}, std::tuple{"end", 0.3, "s"},
            std::tuple{"frequency", tone, "Hz"}, std::tuple{"peak", 2.0, "m/s^2"},
            std::tuple{"gain", 5.0, "1"}})
        writer.write_static({std::string("/bursts/") + property, {value}, units});
      writer.write_result("free_end_acceleration.channel", "beam.tip.y.acceleration");
    }
    if (contents.trusted_frequency > 0.0)
      writer.write_result("trusted_frequency", contents.trusted_frequency);
    writer.close();
    return path(name);
  }

  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  bool exists(const std::string& name) const { return std::filesystem::exists(folder_ / name); }

  /// Runs the program and expects it to succeed. @return its JSON object
  static nlohmann::json json_of(std::vector<std::string> arguments) {
    arguments.emplace_back("--json");
    const ProgramResult result = Program(arguments).run();
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return nlohmann::json::parse(result.out, nullptr, false);
  }

  /// Changes a finished file behind the back of the program.
  static void edit(const std::string& file, const std::function<void(hid_t)>& action) {
    const hid_t id = H5Fopen(file.c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
    ASSERT_GE(id, 0);
    action(id);
    ASSERT_GE(H5Fclose(id), 0);
  }

  TemporaryFolder folder_;
};

}  // namespace stridor::test
