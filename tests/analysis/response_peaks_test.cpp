#include "analysis/response_peaks.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <vector>

namespace stridor {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using Level = std::vector<double>;

TEST(ResponsePeaks, StandOutOfTheHigherOfBothFeet) {
  // Of 6 the feet are 1 and, before 8, 2; of 8 they are 1 and 1, of 4 they are 3 and 1.
  const Level level{1, 6, 2, 8, 3, 4, 1};
  EXPECT_THAT(response_peaks(level, 2.0, 10), ElementsAre(1, 3));
  EXPECT_THAT(response_peaks(level, 1.3, 10), ElementsAre(1, 3, 5));
  EXPECT_THAT(response_peaks(level, 1.3, 1), ElementsAre(3));
  EXPECT_THAT(response_peaks(level, 2.9, 10), ElementsAre(1, 3));
  EXPECT_THAT(response_peaks(level, 3.1, 10), ElementsAre(3));
  EXPECT_THAT(response_peaks(level, 8.1, 10), IsEmpty());
}

TEST(ResponsePeaks, AreInside) {
  EXPECT_THAT(response_peaks(Level{5, 1, 5}, 2.0, 10), IsEmpty());
  EXPECT_THAT(response_peaks(Level{1, 5}, 2.0, 10), IsEmpty());
  EXPECT_THAT(response_peaks(Level{}, 2.0, 10), IsEmpty());
  EXPECT_THAT(response_peaks(Level{0, 0, 0}, 2.0, 10), IsEmpty());
}

TEST(ResponsePeaks, OfEqualValuesTakeTheFirst) {
  EXPECT_THAT(response_peaks(Level{1, 4, 4, 1}, 2.0, 10), ElementsAre(1));
  EXPECT_THAT(response_peaks(Level{0, 3, 0}, 2.0, 10), ElementsAre(1));
}

TEST(ResponsePeaks, ShallowDipsOfAPeakAreNoPeaks) {
  EXPECT_THAT(response_peaks(Level{1, 7, 6.9, 7.1, 6.8, 7.0, 1}, 2.0, 10), ElementsAre(3));
}

}  // namespace
}  // namespace stridor
