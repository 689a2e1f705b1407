#include "core/errors.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <type_traits>

namespace stridor {
namespace {

TEST(Problem, TextHoldsPlaceKeyAndMessage) {
  const Problem problem{"time.step", "must be > 0", "scene.yaml", 12, 7};
  EXPECT_EQ(problem.text(), "scene.yaml:12:7: time.step: must be > 0");
}

TEST(Problem, TextLeavesOutAnUnknownLine) {
  const Problem problem{"time.step", "must be > 0", "--set time.step=0", 0, 0};
  EXPECT_EQ(problem.text(), "--set time.step=0: time.step: must be > 0");
}

TEST(Problem, TextLeavesOutAnEmptyKey) {
  const Problem problem{"", "is not a map", "scene.yaml", 1, 1};
  EXPECT_EQ(problem.text(), "scene.yaml:1:1: is not a map");
}

TEST(Problem, TextLeavesOutAnUnknownSource) {
  EXPECT_EQ((Problem{"time.step", "is missing", "", 0, 0}.text()), "time.step: is missing");
}

TEST(Problem, TextIsTheMessageWhereNothingElseIsKnown) {
  EXPECT_EQ((Problem{"", "no scene given", "", 0, 0}.text()), "no scene given");
}

TEST(Problem, TextLeavesOutAnUnknownColumn) {
  EXPECT_EQ((Problem{"time.step", "is missing", "scene.yaml", 12, 0}.text()),
            "scene.yaml:12: time.step: is missing");
}

TEST(ConfigError, SaysAllProblemsInOrderOneLineEach) {
  const ConfigError error(
      {{"b", "second key, first line", "s.yaml", 1, 1}, {"a", "first key", "s.yaml", 2, 3}});
  EXPECT_STREQ(error.what(), "s.yaml:1:1: b: second key, first line\ns.yaml:2:3: a: first key");
  ASSERT_EQ(error.problems().size(), 2u);
  EXPECT_EQ(error.problems()[0].key, "b");
  EXPECT_EQ(error.problems()[1].key, "a");
}

TEST(ConfigError, ReportShowsTheExcerptBelowEachProblem) {
  const ConfigError error(
      {{"a", "first", "s.yaml", 1, 1, "    1 | a: x\n      | ^"}, {"b", "second", "s.yaml", 2, 3}});
  EXPECT_EQ(error.report(), "s.yaml:1:1: a: first\n    1 | a: x\n      | ^\ns.yaml:2:3: b: second");
  EXPECT_STREQ(error.what(), "s.yaml:1:1: a: first\ns.yaml:2:3: b: second");
}

TEST(ConfigError, OfOneKeyHasNoPlaceYet) {
  const ConfigError error("drive.ramp", "must be >= 0");
  EXPECT_STREQ(error.what(), "drive.ramp: must be >= 0");
  ASSERT_EQ(error.problems().size(), 1u);
  EXPECT_EQ(error.problems()[0].key, "drive.ramp");
  EXPECT_EQ(error.problems()[0].message, "must be >= 0");
  EXPECT_EQ(error.problems()[0].source, "");
  EXPECT_EQ(error.problems()[0].line, 0);
  EXPECT_EQ(error.problems()[0].column, 0);
}

TEST(FileError, NamesFileDatasetAndCause) {
  EXPECT_STREQ(FileError("run.h5", "/time", "has 3 entries").what(),
               "run.h5: dataset /time: has 3 entries");
}

TEST(FileError, LeavesOutAnEmptyDataset) {
  EXPECT_STREQ(FileError("run.h5", "", "cannot be opened").what(), "run.h5: cannot be opened");
}

TEST(NumericalError, KeepsItsMessage) {
  EXPECT_STREQ(NumericalError("diverged").what(), "diverged");
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

}  // namespace
}  // namespace stridor
