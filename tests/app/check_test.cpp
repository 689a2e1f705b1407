// What the program says of a wrong scene: the place in a line of its own, the line, a caret.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/support/program.hpp"

namespace stridor {
namespace {

using namespace test;
using ::testing::HasSubstr;
using Json = nlohmann::json;

/// The main scene with every first `from` replaced.
std::string main_scene_with(const std::vector<std::pair<std::string, std::string>>& changes) {
  std::string text = contents_of(scene_path("beam_on_beam.yaml"));
  for (const auto& [from, to] : changes) {
    const std::size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    text.replace(at, from.size(), to);
  }
  return text;
}

TEST(Check, ShowsTheLineOfEveryErrorWithACaret) {
  const TemporaryFolder folder;
  const std::string path = folder / "bad.yaml";
  write_file(path,
             "format: 1  # µ\nsubstructures: {}\ndrive: {velocity: 1 kg, load: 1, ramp: 0}\n"
             "time: {step: 1e-7, end: 1, stepp: 2}\n");
  const ProgramResult result = Program({"check", path}).run();
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_EQ(result.out, "");
  EXPECT_EQ(result.err,
            "stridor: the input is wrong\n" + path +
                ":3:19: drive.velocity: '1 kg' has unit kg, expected a velocity in m s-1\n"
                "    3 | drive: {velocity: 1 kg, load: 1, ramp: 0}\n"
                "      |                   ^\n" +
                path +
                ":4:28: time.stepp: unknown key 'stepp', did you mean 'step'?\n"
                "    4 | time: {step: 1e-7, end: 1, stepp: 2}\n"
                "      |                            ^\n");
}

TEST(Check, ShowsTheAssignmentWhereTheErrorLiesInOne) {
  const ProgramResult result = Program({"check", scene_path("beam_on_beam.yaml"), "--set",
                                        "contact.strat=30 mm", "--set", "time.step=2e-7 kg"})
                                   .run();
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_EQ(result.err,
            "stridor: the input is wrong\n"
            "--set contact.strat=30 mm: contact.strat: unknown key 'strat', did you mean "
            "'start'?\n"
            "      | --set contact.strat=30 mm\n"
            "      |               ^\n"
            "--set time.step=2e-7 kg: time.step: '2e-7 kg' has unit kg, expected a time in s\n"
            "      | --set time.step=2e-7 kg\n"
            "      |                 ^\n");
}

TEST(Check, ErrorsThatOnlyTheModelFindsAreShownInTheirLine) {
  const TemporaryFolder folder;
  const std::string path = folder / "bad.yaml";
  write_file(path, main_scene_with({{"master: cantilever.top", "master: cantilever.tpo"}}));
  for (const std::vector<std::string>& arguments :
       {std::vector<std::string>{"check", path},
        std::vector<std::string>{"run", path, "-o", folder / "a.h5"}}) {
    const ProgramResult result = Program(arguments).run();
    EXPECT_EQ(result.exit_code, 2);
    EXPECT_THAT(result.err, HasSubstr("|   master: cantilever.tpo\n      |           ^\n"));
  }
}

TEST(Check, JsonHoldsPlaceKeyAndMessageAlone) {
  const TemporaryFolder folder;
  const std::string path = folder / "bad.yaml";
  write_file(path, main_scene_with({{"ramp: 0.1}", "ramp: -1}"}}));
  const ProgramResult result = Program({"check", path, "--json", "--set", "time.step=x"}).run();
  EXPECT_EQ(result.exit_code, 2);
  const Json errors = Json::parse(result.out)["errors"];
  ASSERT_EQ(errors.size(), 2u) << result.out;
  for (const Json& error : errors) {
    std::vector<std::string> names;
    for (const auto& [name, value] : error.items()) names.push_back(name);
    EXPECT_THAT(names, ::testing::UnorderedElementsAre("file", "line", "column", "key", "message"));
  }
  EXPECT_EQ(errors[0]["file"], path);
  EXPECT_EQ(errors[0]["key"], "drive.ramp");
  EXPECT_EQ(errors[1]["file"], "--set time.step=x");
  EXPECT_EQ(errors[1]["line"], 0);
  EXPECT_EQ(errors[1]["column"], 0);
}

}  // namespace
}  // namespace stridor
