#include "app/results/burst_text.hpp"

#include <gtest/gtest.h>

namespace stridor {
namespace {

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

}  // namespace
}  // namespace stridor
