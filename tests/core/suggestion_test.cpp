#include "core/suggestion.hpp"

#include <gtest/gtest.h>

namespace stridor {
namespace {

const std::vector<std::string> kKeys{"length", "thickness", "width", "angle", "youngs_modulus"};

TEST(Suggestion, OneSlipIsFound) {
  EXPECT_EQ(nearest("lenght", kKeys), "length");   // swapped
  EXPECT_EQ(nearest("lengt", kKeys), "length");    // left out
  EXPECT_EQ(nearest("lenngth", kKeys), "length");  // doubled
  EXPECT_EQ(nearest("wodth", kKeys), "width");     // replaced
}

TEST(Suggestion, CaseAndDashAreNoDifference) {
  EXPECT_EQ(nearest("Youngs-Modulus", kKeys), "youngs_modulus");
  EXPECT_EQ(nearest("A", {"b", "a"}), "a");
}

TEST(Suggestion, BeginningOfAKeyIsFound) {
  EXPECT_EQ(nearest("coeff", {"law", "coefficient"}), "coefficient");
}

TEST(Suggestion, NothingNearGivesNothing) {
  EXPECT_EQ(nearest("viscosity", kKeys), "");
  EXPECT_EQ(nearest("", kKeys), "");
  EXPECT_EQ(nearest("x", {"y"}), "");
  EXPECT_EQ(nearest("length", {}), "");
  EXPECT_EQ(nearest(std::string(1000, 'l'), kKeys), "");
}

TEST(Suggestion, NearestWinsAndFirstOfEqualsWins) {
  EXPECT_EQ(nearest("fram", {"framed", "frame"}), "frame");
  EXPECT_EQ(nearest("subs_d", {"subs_a", "subs_b"}), "subs_a");
}

TEST(Suggestion, QuestionIsPhrasedOnlyWhereSomethingIsNear) {
  EXPECT_EQ(did_you_mean("angel", kKeys), ", did you mean 'angle'?");
  EXPECT_EQ(did_you_mean("viscosity", kKeys), "");
}

}  // namespace
}  // namespace stridor
