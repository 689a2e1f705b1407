#include "core/errors.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>
#include <string_view>
#include <type_traits>

namespace stridor {
namespace {

TEST(Problem, TextHoldsPlaceKeyAndMessage) {
  const Problem problem{Refusal::wrong_value, "time.step", "must be > 0", "scene.yaml", 12, 7};
  EXPECT_EQ(problem.text(), "scene.yaml:12:7: time.step: must be > 0");
}

TEST(Problem, TextLeavesOutAnUnknownLine) {
  const Problem problem{Refusal::wrong_value, "time.step", "must be > 0",
                        "--set time.step=0",  0,           0};
  EXPECT_EQ(problem.text(), "--set time.step=0: time.step: must be > 0");
}

TEST(Problem, TextLeavesOutAnEmptyKey) {
  const Problem problem{Refusal::wrong_value, "", "is not a map", "scene.yaml", 1, 1};
  EXPECT_EQ(problem.text(), "scene.yaml:1:1: is not a map");
}

TEST(Problem, TextLeavesOutAnUnknownSource) {
  EXPECT_EQ((Problem{Refusal::wrong_value, "time.step", "is missing", "", 0, 0}.text()),
            "time.step: is missing");
}

TEST(Problem, TextIsTheMessageWhereNothingElseIsKnown) {
  EXPECT_EQ((Problem{Refusal::wrong_value, "", "no scene given", "", 0, 0}.text()),
            "no scene given");
}

TEST(Problem, TextLeavesOutAnUnknownColumn) {
  EXPECT_EQ((Problem{Refusal::wrong_value, "time.step", "is missing", "scene.yaml", 12, 0}.text()),
            "scene.yaml:12: time.step: is missing");
}

TEST(ConfigError, SaysAllProblemsInOrderOneLineEach) {
  const ConfigError error({{Refusal::unknown_key, "b", "second key, first line", "s.yaml", 1, 1},
                           {Refusal::wrong_value, "a", "first key", "s.yaml", 2, 3}});
  EXPECT_STREQ(error.what(), "s.yaml:1:1: b: second key, first line\ns.yaml:2:3: a: first key");
  ASSERT_EQ(error.problems().size(), 2u);
  EXPECT_EQ(error.problems()[0].key, "b");
  EXPECT_EQ(error.problems()[1].key, "a");
}

TEST(ConfigError, ReportShowsTheExcerptBelowEachProblem) {
  const ConfigError error(
      {{Refusal::wrong_value, "a", "first", "s.yaml", 1, 1, "    1 | a: x\n      | ^"},
       {Refusal::unknown_key, "b", "second", "s.yaml", 2, 3}});
  EXPECT_EQ(error.report(),
            "s.yaml:1:1: a: first [wrong-value]\n    1 | a: x\n      | ^\n"
            "s.yaml:2:3: b: second [unknown-key]");
  EXPECT_STREQ(error.what(), "s.yaml:1:1: a: first\ns.yaml:2:3: b: second");
}

TEST(ConfigError, OfOneKeyHasNoPlaceYet) {
  const ConfigError error(Refusal::wrong_value, "drive.ramp", "must be >= 0");
  EXPECT_STREQ(error.what(), "drive.ramp: must be >= 0");
  ASSERT_EQ(error.problems().size(), 1u);
  EXPECT_EQ(error.problems()[0].key, "drive.ramp");
  EXPECT_EQ(error.problems()[0].message, "must be >= 0");
  EXPECT_EQ(error.problems()[0].source, "");
  EXPECT_EQ(error.problems()[0].line, 0);
  EXPECT_EQ(error.problems()[0].column, 0);
}

TEST(FileError, NamesFileDatasetAndCause) {
  EXPECT_STREQ(FileError(Refusal::file_damaged, "run.h5", "/time", "has 3 entries").what(),
               "run.h5: dataset /time: has 3 entries");
}

TEST(FileError, KeepsFileDatasetAndCauseApart) {
  const FileError error(Refusal::file_damaged, "run.h5", "/time", "has 3 entries");
  EXPECT_EQ(error.problem().refusal, Refusal::file_damaged);
  EXPECT_EQ(error.problem().source, "run.h5");
  EXPECT_EQ(error.problem().dataset, "/time");
  EXPECT_EQ(error.problem().message, "dataset /time: has 3 entries");
  EXPECT_EQ(error.problem().text(), error.what());
}

TEST(FileError, LeavesOutAnEmptyDataset) {
  EXPECT_STREQ(FileError(Refusal::cannot_read, "run.h5", "", "cannot be opened").what(),
               "run.h5: cannot be opened");
}

TEST(NumericalError, KeepsItsMessage) {
  EXPECT_STREQ(NumericalError(Refusal::diverged, "diverged").what(), "diverged");
}

TEST(Interrupted, KeepsItsMessage) {
  EXPECT_STREQ(Interrupted("stopped at t = 1 s").what(), "stopped at t = 1 s");
}

TEST(Errors, NoDoorCatchesForAnother) {
  // Each leads to an exit code of its own.
  EXPECT_FALSE((std::is_convertible_v<ConfigError*, NumericalError*>));
  EXPECT_FALSE((std::is_convertible_v<ConfigError*, FileError*>));
  EXPECT_FALSE((std::is_convertible_v<FileError*, NumericalError*>));
  EXPECT_FALSE((std::is_convertible_v<Interrupted*, NumericalError*>));
  EXPECT_FALSE((std::is_convertible_v<NumericalError*, ConfigError*>));
}

TEST(Refusals, CodesAreWordsWithHyphensEachOnce) {
  std::set<std::string_view> codes;
  for (const Refusal refusal : all_refusals()) {
    const std::string_view code = code_of(refusal);
    EXPECT_TRUE(codes.insert(code).second) << code;
    EXPECT_EQ(code.find_first_not_of("abcdefghijklmnopqrstuvwxyz-"), std::string_view::npos)
        << code;
  }
  EXPECT_EQ(code_of(Refusal::wrong_value), "wrong-value");
  EXPECT_EQ(code_of(Refusal::internal_error), "internal-error");
}

TEST(Refusals, CodeStandsBehindTheFirstLine) {
  EXPECT_EQ(with_code("is missing", Refusal::missing), "is missing [missing]");
  EXPECT_EQ(with_code("not met:\na\nb", Refusal::expectation_missed),
            "not met [expectation-missed]:\na\nb");
  EXPECT_EQ(with_code("", Refusal::missing), " [missing]");
}

}  // namespace
}  // namespace stridor
