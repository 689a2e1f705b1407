#include "app/stability/locus_progress.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/activity.hpp"

namespace stridor {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

/// Pencils that take no time.
class EmptyFamily : public StabilityFamily {
 public:
  Pencil pencil(std::span<const double>) override { return {}; }
  double trusted_frequency(std::span<const double>) override { return 1.0; }
};

class LocusProgressTest : public testing::Test {
 protected:
  std::string text_after(std::initializer_list<double> values) {
    Pencil pencil;
    for (const double value : values) family_along_.place(value, pencil);
    return progress_.progress().text(std::chrono::steady_clock::now());
  }

  EmptyFamily family_;
  KeyRange range_{{"contact.start", "m", Range::any()}, {0.0, 0.5, 1.0}};
  LocusProgress progress_{"locus", family_, range_};
  PencilFamily family_along_ = family_.along(0, {0.0}, 0.0, 1.0);
};

TEST_F(LocusProgressTest, TellsHowFarAlongTheRangeItHasCome) {
  EXPECT_THAT(text_after({0.0, 0.25}), HasSubstr("locus: contact.start = 0.25 m, 25 %"));
  EXPECT_THAT(text_after({0.2, 0.5, 0.4}), HasSubstr("50 %"));
}

TEST_F(LocusProgressTest, PromisesNoEndWhileWindowsAreRefined) {
  EXPECT_THAT(text_after({0.5, 1.0}), HasSubstr("100 %"));
  const std::string refining = text_after({0.3, 0.31, 0.305});
  EXPECT_THAT(refining,
              HasSubstr("locus, refining windows: 3 values, contact.start = 0.305 m, 0 s so far"));
  EXPECT_THAT(refining, Not(HasSubstr("%")));
  EXPECT_THAT(refining, Not(HasSubstr("left")));
}

TEST_F(LocusProgressTest, TellsThePartAtWorkWhileWindowsAreRefined) {
  EXPECT_THAT(text_after({0.5, 1.0}), HasSubstr("100 %"));
  {
    const Activity refining("interval 3 of 7");
    const std::string text = text_after({0.3});
    EXPECT_THAT(text, HasSubstr("refining windows: interval 3 of 7, contact.start = 0.3 m, 0 s"));
    EXPECT_THAT(text, Not(HasSubstr("%")));
  }
  // That many branches stay that many: the share of them is told.
  Activity refining("branch 4 of 6");
  refining.report(0.5);
  EXPECT_THAT(text_after({0.31}), HasSubstr("branch 4 of 6, contact.start = 0.31 m, 50 %"));
}

TEST(Progress, OfTheNextPhaseBeginsAnew) {
  Progress progress("check");
  progress.report(0.9, "place 9 of 10");
  progress.begin("a stable step");
  EXPECT_THAT(progress.text(std::chrono::steady_clock::now()),
              HasSubstr("check, a stable step: 0 s so far"));
}

}  // namespace
}  // namespace stridor
