// Steps of many random bodies in contact that grow by themselves: none missed, none made up.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/step_growth_cases.hpp"

namespace stridor {
namespace {

using namespace test;
using ::testing::IsEmpty;

TEST(StepGrowth, IsFoundInAllOfManyRandomCases) {
  const StepGrowthCases found = uncoupled_cases(1, 4000);
  RecordProperty("cases", found.summary());
  EXPECT_THAT(found.missed, IsEmpty());
  EXPECT_THAT(found.refused, IsEmpty());
  EXPECT_GT(found.cases, 80000) << found.summary();
}

TEST(StepGrowth, OfCoupledBodiesIsFoundInAllOfManyRandomCases) {
  const StepGrowthCases found = coupled_cases(1, 3000);
  RecordProperty("cases", found.summary());
  EXPECT_THAT(found.missed, IsEmpty());
  EXPECT_THAT(found.refused, IsEmpty());
  EXPECT_GT(found.cases, 11000) << found.summary();
}

}  // namespace
}  // namespace stridor
