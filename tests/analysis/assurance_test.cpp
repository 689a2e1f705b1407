#include "analysis/assurance.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace stridor {
namespace {

using Values = std::vector<std::complex<double>>;

TEST(AssuranceCriterion, IsOneAtAnyScaleAndNothingForWhatIsOrthogonal) {
  const Values a{{1.0, 2.0}, {-0.5, 0.25}, {3.0, 0.0}};
  Values scaled = a;
  for (auto& value : scaled) value *= std::complex<double>(0.3, -4.0);
  EXPECT_NEAR(assurance_criterion(a, scaled), 1.0, 1e-15);
  EXPECT_NEAR(assurance_criterion(Values{1.0, 1.0}, Values{1.0, -1.0}), 0.0, 1e-15);
  EXPECT_NEAR(assurance_criterion(Values{1.0, 0.0}, Values{1.0, 1.0}), 0.5, 1e-15);
  EXPECT_EQ(assurance_criterion(Values{0.0, 0.0}, a), 0.0);
}

TEST(ResponseDifference, IsRelativeToTheSecond) {
  EXPECT_NEAR(response_difference(Values{3.0, 4.0}, Values{3.0, 0.0}), 4.0 / 3.0, 1e-15);
  EXPECT_EQ(response_difference(Values{0.0}, Values{0.0}), 0.0);
}

}  // namespace
}  // namespace stridor
