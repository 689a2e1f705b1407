// The verb sweep on scenes of beams, from outside.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "tests/support/dataset.hpp"
#include "tests/support/program.hpp"

namespace stridor {
namespace {

using namespace test;
using ::testing::HasSubstr;
using Json = nlohmann::json;

/// 20 ms of the main scene, most of it still in the ramp.
std::vector<std::string> with_short_scene(std::vector<std::string> arguments) {
  for (const char* set : {"time.integrator=exact", "time.step=5e-6", "time.retain.frequency=30kHz",
                          "time.end=0.02", "measure.from=0.01"}) {
    arguments.push_back("--set");
    arguments.push_back(set);
  }
  return arguments;
}

std::vector<std::string> friction_sweep(std::vector<std::string> more) {
  std::vector<std::string> arguments{"sweep",       scene_path("beam_on_beam.yaml"),
                                     "--parameter", "contact.friction.coefficient",
                                     "--from",      "0.1",
                                     "--to",        "0.3",
                                     "--points",    "3"};
  arguments.insert(arguments.end(), more.begin(), more.end());
  return with_short_scene(arguments);
}

Json rows_of(const std::vector<std::string>& arguments) {
  const ProgramResult result = Program(arguments).run();
  EXPECT_EQ(result.exit_code, 0) << result.err;
  return result.exit_code == 0 ? Json::parse(result.out)["rows"] : Json();
}

TEST(SweepProgram, EveryRowIsTheRunOfItsValue) {
  const TemporaryFolder folder;
  const Json rows = rows_of(friction_sweep({"--json", "--threads", "2"}));
  ASSERT_EQ(rows.size(), 3u);
  for (const Json& row : rows) {
    const double value = row["value"].get<double>();
    const ProgramResult single =
        Program(with_short_scene({"run", scene_path("beam_on_beam.yaml"), "--json", "--force", "-o",
                                  (folder / "run.h5").string(), "--set",
                                  "contact.friction.coefficient=" + std::to_string(value)}))
            .run();
    ASSERT_EQ(single.exit_code, 0) << single.err;
    const Json run = Json::parse(single.out);
    for (const char* key :
         {"status", "steps", "modes", "stick_fraction", "free_fraction", "violations"})
      EXPECT_EQ(row[key], run[key]) << key << " at " << value;
    // Lanes round otherwise than a simulation by itself.
    for (const char* pointer : {"/contact_force/min", "/contact_force/max",
                                "/free_end_acceleration/peak", "/free_end_acceleration/rms"}) {
      const double expected = run[Json::json_pointer(pointer)].get<double>();
      EXPECT_NEAR(row[Json::json_pointer(pointer)].get<double>(), expected,
                  1e-8 * std::abs(expected))
          << pointer << " at " << value;
    }
    EXPECT_EQ(row["bursts"].size(), run["bursts"].size());
  }
  EXPECT_NE(rows[0]["free_end_acceleration"]["peak"], rows[2]["free_end_acceleration"]["peak"]);
}

TEST(SweepProgram, DoesNotDependOnTheNumberOfThreads) {
  const auto without_cost = [](Json rows) {
    for (Json& row : rows) {
      row.erase("wall_s");
      row.erase("setup_s");
      row.erase("step_ns");
    }
    return rows;
  };
  const Json one = without_cost(rows_of(friction_sweep({"--json", "--threads", "1"})));
  EXPECT_EQ(one, without_cost(rows_of(friction_sweep({"--json", "--threads", "3"}))));
}

TEST(SweepProgram, WritesColumnsAndAPicture) {
  const TemporaryFolder folder;
  const std::string file = (folder / "sweep.h5").string();
  const std::string figure = (folder / "sweep.png").string();
  const ProgramResult result = Program(friction_sweep({"-o", file, "--figure", figure})).run();
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("rms m/s^2"));
  EXPECT_GT(std::filesystem::file_size(figure), 10000u);
  const ProgramResult again = Program(friction_sweep({"-o", file})).run();
  EXPECT_EQ(again.exit_code, 4);
  EXPECT_THAT(again.err, HasSubstr("--force"));
}

TEST(SweepProgram, ListsAndDrawsBursts) {
  const TemporaryFolder folder;
  const std::string file = (folder / "sweep.h5").string();
  const std::string figure = (folder / "sweep.svg").string();
  const ProgramResult result = Program({"sweep",       scene_path("beam_on_beam.yaml"),
                                        "--parameter", "contact.friction.coefficient",
                                        "--from",      "0.25",
                                        "--to",        "0.3",
                                        "--points",    "2",
                                        "--set",       "time.integrator=exact",
                                        "--set",       "time.step=1e-5",
                                        "--set",       "time.retain.frequency=30kHz",
                                        "-o",          file,
                                        "--figure",    figure})
                                   .run();
  ASSERT_EQ(result.exit_code, 0) << result.err;
  // The four bursts of the scene.
  EXPECT_THAT(result.out, HasSubstr("       4      35"));
  const std::vector<double> values = dataset(file, "/bursts/value");
  EXPECT_GE(values.size(), 4U);
  EXPECT_EQ(values.back(), 0.3);
  EXPECT_EQ(dataset(file, "/num_bursts").back(), 4.0);
  // Of every four, three near 3.5 kHz and one near 10.6 kHz.
  for (const double frequency : dataset(file, "/bursts/frequency"))
    EXPECT_NEAR(frequency > 7e3 ? frequency / 3.0 : frequency, 3500.0, 100.0);
  EXPECT_THAT(contents_of(figure), HasSubstr("frequency of bursts"));
}

TEST(SweepProgram, ARunThatFailsIsARowAndTheOthersGoOn) {
  const std::vector<std::string> jamming = with_short_scene(
      {"sweep", scene_path("beam_on_beam.yaml"), "--parameter", "contact.friction.coefficient",
       "--from", "0.3", "--to", "6", "--points", "2", "--json", "--set", "drive.ramp=1 ms"});
  const Json rows = rows_of(jamming);
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_EQ(rows[0]["status"], "done");
  EXPECT_EQ(rows[1]["status"], "failed");
  EXPECT_THAT(rows[1]["failure"].get<std::string>(), HasSubstr("[contact-jams]"));

  std::vector<std::string> all = jamming;
  all[5] = "5";
  const ProgramResult none = Program(all).run();
  EXPECT_EQ(none.exit_code, 3);
  EXPECT_THAT(none.err, HasSubstr("none of the 2 transients came to its end"));
}

TEST(SweepProgram, RefusesBadInput) {
  const auto refusal = [](std::vector<std::string> arguments) {
    const ProgramResult result = Program(std::move(arguments)).run();
    EXPECT_EQ(result.exit_code, 2) << result.err;
    EXPECT_TRUE(result.out.empty());
    return result.err;
  };
  std::vector<std::string> misspelt = friction_sweep({});
  misspelt[3] = "contact.friction.coeficient";
  EXPECT_THAT(refusal(misspelt), HasSubstr("did you mean 'coefficient'?"));
  EXPECT_THAT(refusal(friction_sweep({"--up-down"})), HasSubstr("--up-down"));
  std::vector<std::string> backwards = friction_sweep({});
  backwards[5] = "0.4";
  EXPECT_THAT(refusal(backwards), HasSubstr("--from: '0.4' is beyond --to '0.3'"));
  std::vector<std::string> step = friction_sweep({});
  step[3] = "contact.start";
  EXPECT_THAT(refusal(step), HasSubstr("is off the master"));
}

}  // namespace
}  // namespace stridor
