// `stridor compare` from outside.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <thread>

#include "tests/support/program.hpp"

namespace stridor {
namespace {

using namespace test;
using ::testing::AllOf;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using Json = nlohmann::json;

const std::string compared_scene = scene_path("beam_on_beam.yaml");

/// Arguments of a comparison over 10 ms.
std::vector<std::string> short_comparison(std::vector<std::string> more) {
  std::vector<std::string> arguments{"compare",       compared_scene, "--set",
                                     "time.end=0.01", "--set",        "measure.from=0.005"};
  arguments.insert(arguments.end(), more.begin(), more.end());
  return arguments;
}

TEST(CompareProgram, HasARowForEveryAssumptionInBothForms) {
  const TemporaryFolder folder;
  const std::filesystem::path kept = folder / "comparison";
  // The published form is slow: 0.1 ms of it.
  const ProgramResult result =
      Program(short_comparison({"--json", "-o", kept.string(), "--published-window", "1e-4"}))
          .run();
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const Json object = Json::parse(result.out);
  ASSERT_EQ(object["rows"].size(), 8u);
  const char* const names[] = {"subs_a", "subs_b", "subs_c", "film"};
  for (std::size_t i = 0; i < 8; ++i) {
    const Json& row = object["rows"][i];
    EXPECT_EQ(row["assumption"], names[i % 4]);
    EXPECT_EQ(row["coordinates"], i < 4 ? "modal" : "craig_bampton");
    EXPECT_EQ(row["status"], "done");
    for (const char* key : {"wall_s", "ratio"}) EXPECT_GT(row[key].get<double>(), 0.0) << key;
    for (const char* key : {"peak", "rms", "difference", "bursts"})
      ASSERT_TRUE(row.contains(key)) << key;
  }
  // FiLM is the reference. During the start-up of the main scene the others are not close to it.
  const Json& rows = object["rows"];
  EXPECT_EQ(rows[3]["ratio"], 1.0);
  EXPECT_EQ(rows[3]["difference"], 0.0);
  EXPECT_GT(rows[3]["peak"].get<double>(), 0.0);
  EXPECT_GT(rows[1]["difference"].get<double>(), 0.0);
  // The published window ends before the window of `measure` begins.
  EXPECT_TRUE(rows[4]["peak"].is_null());
  EXPECT_TRUE(rows[4]["difference"].is_null());

  for (const char* name : {"accelerations.png", "sliding_velocities.png", "contact_forces.png",
                           "spectrograms.png", "subs_a.h5", "film_published.h5"}) {
    EXPECT_TRUE(std::filesystem::exists(kept / name)) << name;
  }
  for (const char* name : {"accelerations.png", "sliding_velocities.png", "contact_forces.png"})
    EXPECT_GT(std::filesystem::file_size(kept / name), 10'000u) << name;
  EXPECT_EQ(Json::parse(contents_of(kept / "comparison.json")), object);

  const ProgramResult again = Program(short_comparison({"-o", kept.string()})).run();
  EXPECT_EQ(again.exit_code, 4);
  EXPECT_THAT(again.err, HasSubstr("exists; use --force to overwrite it"));
}

TEST(CompareProgram, PrintsATableAndKeepsNothingWithoutAFolder) {
  // The published form is timed only where it is asked for.
  const ProgramResult result = Program(short_comparison({})).run();
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("assumption"));
  for (const char* name : {"subs_a ", "subs_b ", "subs_c ", "film "})
    EXPECT_THAT(result.out, HasSubstr(name));
  EXPECT_THAT(result.out, ::testing::Not(HasSubstr("craig_bampton")));
}

TEST(CompareProgram, TakesExactPropagationWhereThePublishedFormIsNotAskedFor) {
  const TemporaryFolder folder;
  const std::filesystem::path kept = folder / "comparison";
  std::vector<std::string> exact =
      short_comparison({"--set", "time.integrator=exact", "-o", kept.string()});
  std::vector<std::string> timed = exact;
  timed.insert(timed.end(), {"--published-window", "1e-4"});
  const ProgramResult refused = Program(timed).run();
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_THAT(refused.err, HasSubstr("--published-window: the published form takes "
                                     "time.integrator: central_difference with all modes, but the "
                                     "scene has integrator: exact"));
  EXPECT_FALSE(std::filesystem::exists(kept));
  const ProgramResult result = Program(exact).run();
  EXPECT_EQ(result.exit_code, 0) << result.err;
}

TEST(CompareProgram, AnAssumptionThatFailsIsARowAndTheOthersGoOn) {
  // A load that lifts: contacts that cannot part end, FiLM parts.
  const ProgramResult result =
      Program({"compare", compared_scene, "--set", "drive.load=+0.2", "--set", "drive.ramp=1e-4",
               "--set", "contact.armed_from=2e-4", "--set", "time.end=2e-3", "--set",
               "measure.from=1e-3", "--published-window", "0"})
          .run();
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const std::string& table = result.out;
  for (const char* name : {"subs_a ", "subs_b ", "subs_c "}) {
    const std::string row = table.substr(table.find(name));
    EXPECT_THAT(row.substr(0, row.find('\n')),
                AllOf(HasSubstr("failed: contact at t = 0.0002"), EndsWith("[contact-pulls]")))
        << name;
  }
  EXPECT_THAT(table.substr(table.find("film ")), EndsWith("  done\n"));
}

TEST(CompareProgram, RunsThatEndedBeforeTheWindowHaveNoEmptyPanels) {
  const TemporaryFolder folder;
  const std::filesystem::path kept = folder / "comparison";
  const ProgramResult result =
      Program({"compare", compared_scene, "--set", "drive.load=+0.2", "--set", "drive.ramp=1e-4",
               "--set", "contact.armed_from=2e-4", "--set", "time.end=2e-3", "--set",
               "measure.from=1e-3", "-o", kept.string()})
          .run();
  ASSERT_EQ(result.exit_code, 0) << result.err;
  // Of the four forces that of FiLM alone is left: a picture of one panel is wider than high.
  std::ifstream picture(kept / "contact_forces.png", std::ios::binary);
  unsigned char head[24];
  ASSERT_TRUE(picture.read(reinterpret_cast<char*>(head), sizeof head));
  const auto number = [&](int at) {
    return (head[at] << 24) + (head[at + 1] << 16) + (head[at + 2] << 8) + head[at + 3];
  };
  EXPECT_GT(number(16), number(20));
}

TEST(CompareProgram, NeedsChannelsToCompareBy) {
  const TemporaryFolder folder;
  std::string text = contents_of(compared_scene);
  const std::size_t record = text.find("\nrecord:");
  ASSERT_NE(record, std::string::npos);
  text.erase(record, text.find("\nmeasure:") - record);
  write_file(folder / "silent.yaml", text);
  const ProgramResult result = Program({"compare", folder / "silent.yaml"}).run();
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.err, HasSubstr("record: missing: compare needs an acceleration"));
}

TEST(CompareProgram, RefusesBadInput) {
  const struct {
    std::vector<std::string> more;
    const char* message;
  } cases[] = {{{"--published-window=-1"}, "--published-window"},
               {{"--set", "time.stepp=1e-7"}, "did you mean 'step'"},
               {{"--set", "record=null"}, "record"}};
  for (const auto& [more, message] : cases) {
    std::vector<std::string> arguments{"compare", compared_scene};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const ProgramResult result = Program(arguments).run();
    EXPECT_EQ(result.exit_code, 2) << message;
    EXPECT_THAT(result.err, HasSubstr(message));
  }
}

TEST(CompareProgram, StopsOnRequestAndSaysHowFarItCame) {
  Program program({"compare", compared_scene});
  program.start();
  std::this_thread::sleep_for(std::chrono::milliseconds(500));
  program.send(SIGINT);
  const ProgramResult result = program.wait();
  EXPECT_EQ(result.exit_code, 5);
  // During set-up there is no time that it has come to.
  EXPECT_THAT(result.err,
              AnyOf(HasSubstr("nothing was compared"), HasSubstr("nothing has been written")));
}

}  // namespace
}  // namespace stridor
