#include "app/results/burst_text.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace stridor {
namespace {

using ::testing::HasSubstr;

Json burst_at(double start, double frequency, double peak) {
  return {{"start", start},
          {"end", start + 0.1},
          {"frequency", frequency},
          {"peak", peak},
          {"gain", 3.0}};
}

TEST(BurstText, IsOneLineWithUnits) {
  const Json burst{
      {"start", 0.87512}, {"end", 0.929}, {"frequency", 6406.4}, {"peak", 179.62}, {"gain", 4.607}};
  EXPECT_EQ(burst_text(burst), "0.875 to 0.929 s, 6406 Hz, peak 179.6 m/s^2, gain 4.61");
}

TEST(BurstText, NumberThatIsNotFiniteIsNan) {
  const Json burst{
      {"start", 1}, {"end", 2}, {"frequency", nullptr}, {"peak", 3}, {"gain", nullptr}};
  EXPECT_EQ(burst_text(burst), "1.000 to 2.000 s, nan Hz, peak 3 m/s^2, gain nan");
}

TEST(BurstText, OfManyTheLoudestAreListedInOrderOfTime) {
  Json bursts = Json::array();
  for (int i = 0; i < 20; ++i) bursts.push_back(burst_at(i, 500.0, 10.0 + i));
  EXPECT_EQ(burst_lines(bursts).size(), 20U);
  for (int i = 20; i < 300; ++i) bursts.push_back(burst_at(i, 500.0, i == 150 ? 99.0 : 2.5));
  const auto lines = burst_lines(bursts);
  ASSERT_EQ(lines.size(), 21U);
  EXPECT_EQ(lines[0].first, "burst 2");
  EXPECT_EQ(lines[19].first, "burst 151");
  EXPECT_THAT(lines[0].second, HasSubstr("1.000 to 1.100 s"));
  EXPECT_THAT(lines[18].second, HasSubstr("peak 29 "));
  EXPECT_THAT(lines[19].second, HasSubstr("150.000 to 150.100 s, 500 Hz, peak 99 m/s^2"));
  EXPECT_EQ(lines[20].first, "more bursts");
  EXPECT_EQ(lines[20].second, "280, none with a peak above 10 m/s^2 (--json lists all)");
}

TEST(BurstText, WhatIsAboveTheTrustedFrequencyIsDoubtful) {
  const Json bursts{burst_at(0, 500.0, 1.0), burst_at(1, 1500.0, 1.0), burst_at(2, 2500.0, 1.0)};
  const Json tone{{"frequency", 1800.0}, {"rms", 1.0}, {"share", 0.9}};
  EXPECT_THAT(
      doubtful_text(bursts, tone, 1600.0),
      HasSubstr("the lasting tone and 1 burst above 1600 Hz, more than the bodies resolve"));
  EXPECT_THAT(doubtful_text(nullptr, tone, 1600.0), HasSubstr("the lasting tone above 1600 Hz"));
  EXPECT_THAT(doubtful_text(bursts, nullptr, 1000.0), HasSubstr("2 bursts above 1000 Hz"));
  EXPECT_EQ(doubtful_text(bursts, tone, nullptr), "");
  EXPECT_EQ(doubtful_text(bursts, tone, 3000.0), "");
}

}  // namespace
}  // namespace stridor
