#include "analysis/law_fit.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "tests/support/message_of.hpp"

namespace stridor {
namespace {

using test::message_of;
using ::testing::HasSubstr;

const std::vector<double> speeds{1e-3, 1e-2, 3e-2, 0.1, 0.3, 1.0, 10.0};
const std::vector<double> indentations{1e-3, 1e-2, 0.1};

TEST(LawFit, FindsTheCoefficientsThatMadeTheSamples) {
  FitCoefficients truth = published_coefficients();
  truth.force[0] *= 1.1;
  truth.area[3] += 0.2;
  truth.friction[3] *= 0.9;
  const std::vector<LawSample> samples = law_samples(FittedLaw(truth), speeds, indentations);
  const LawFit fit = fit_law(published_coefficients(), samples);
  ASSERT_TRUE(fit.converged);
  // Sums of squares vanish to rounding, coefficients to about its root.
  for (std::size_t k = 0; k < 5; ++k) {
    EXPECT_NEAR(fit.coefficients.force[k], truth.force[k], 1e-5);
    EXPECT_NEAR(fit.coefficients.area[k], truth.area[k], 1e-5);
  }
  for (std::size_t k = 0; k < 4; ++k)
    EXPECT_NEAR(fit.coefficients.friction[k], truth.friction[k], 1e-5);
  const PerQuantity r2 = determination(FittedLaw(fit.coefficients), samples);
  EXPECT_NEAR(r2.force, 1.0, 1e-10);
  EXPECT_NEAR(r2.area, 1.0, 1e-10);
  EXPECT_NEAR(r2.friction, 1.0, 1e-10);
}

TEST(LawFit, ShiftMovesTheSpeedAxis) {
  const FittedLaw law(published_coefficients());
  const FittedLaw moved(shifted(published_coefficients(), {1.0, 2.0, -1.0}));
  const ViscoelasticContact at = moved.at(0.01, 0.05);
  EXPECT_NEAR(at.force.value, law.at(0.01, 0.005).force.value, 1e-15);
  EXPECT_NEAR(at.area.value, law.at(0.01, 0.0005).area.value, 1e-15);
  EXPECT_NEAR(at.friction.value, law.at(0.01, 0.5).friction.value, 1e-15);
}

TEST(LawFit, BestShiftIsFound) {
  const PerQuantity decades{1.3, -0.7, 2.2};
  const std::vector<LawSample> samples =
      law_samples(FittedLaw(shifted(published_coefficients(), decades)), speeds, indentations);
  const PerQuantity found = best_shift(published_coefficients(), samples, 4.0);
  EXPECT_NEAR(found.force, decades.force, 1e-6);
  EXPECT_NEAR(found.area, decades.area, 1e-6);
  EXPECT_NEAR(found.friction, decades.friction, 1e-6);
}

TEST(LawFit, DeterminationOfTheMeanIsZero) {
  // A law that says the same everywhere: samples whose mean it is.
  const FittedLaw law(published_coefficients());
  const ViscoelasticContact at = law.at(0.01, 0.1);
  std::vector<LawSample> samples;
  for (const double deviation : {-0.1, 0.1}) {
    samples.push_back({0.1, 0.01, at.force.value * (1.0 + deviation),
                       at.area.value * (1.0 + deviation), at.friction.value * (1.0 + deviation)});
  }
  const PerQuantity r2 = determination(law, samples);
  EXPECT_NEAR(r2.force, 0.0, 1e-12);
  EXPECT_NEAR(r2.area, 0.0, 1e-12);
  EXPECT_NEAR(r2.friction, 0.0, 1e-12);
}

TEST(LawFit, PublishedFitsAreTwoDecadesOffTheBoundaryElements) {
  std::vector<double> wide;
  for (int k = -18; k <= 18; ++k) wide.push_back(std::pow(10.0, k / 6.0));
  const std::vector<LawSample> samples =
      law_samples(BoundaryElementLaw(shipped_master_curve()), wide, {1e-4, 1e-3, 1e-2, 0.1, 0.3});
  const PerQuantity shift = best_shift(published_coefficients(), samples, 4.0);
  EXPECT_NEAR(shift.force, 2.0, 0.1);
  EXPECT_NEAR(shift.area, 2.0, 0.1);
  EXPECT_NEAR(shift.friction, 2.0, 0.1);
  const PerQuantity moved =
      determination(FittedLaw(shifted(published_coefficients(), {2.0, 2.0, 2.0})), samples);
  EXPECT_GT(moved.force, 0.99);
  EXPECT_GT(moved.area, 0.99);
  EXPECT_GT(moved.friction, 0.98);
  EXPECT_LT(determination(FittedLaw(published_coefficients()), samples).friction, 0.0);
}

TEST(LawFit, RefusesTooFewSamples) {
  const std::vector<LawSample> few(1);
  EXPECT_THAT(message_of<std::invalid_argument>(
                  [&] { (void)determination(FittedLaw(published_coefficients()), few); }),
              HasSubstr("fewer than two samples"));
  EXPECT_THAT(message_of<std::invalid_argument>([&] { (void)fit_law({}, few); }),
              HasSubstr("more than five samples"));
}

}  // namespace
}  // namespace stridor
