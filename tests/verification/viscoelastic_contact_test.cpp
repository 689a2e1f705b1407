// Boundary-element contacts against closed forms, reference values and their own refinement.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "coupling/laws/viscoelastic_law.hpp"
#include "solvers/half_space/master_curve.hpp"
#include "solvers/half_space/sliding_contact.hpp"

namespace stridor {
namespace {

using std::numbers::pi;

constexpr double e0 = 0.1;

SlidingContact contact(std::int64_t grid, double tolerance = 1e-7) {
  SlidingContactParameters parameters;
  parameters.grid = grid;
  parameters.tolerance = tolerance;
  ProfileParameters profile;
  profile.radius = 1.0;
  return SlidingContact(parameters, IndenterProfile(profile));
}

TEST(ViscoelasticContact, BothElasticEndsAreHertz) {
  // Force to 1e-5 and area to 0.05 % at 256 cells a side, for the rubbery and the glassy modulus.
  SlidingContact solver = contact(256);
  const SlidingContactResult rubbery = solver.indent(1.0, {{1.0 - e0, 0.0}});
  ASSERT_TRUE(rubbery.converged);
  EXPECT_NEAR(rubbery.force / (4.0 / 3.0), 1.0, 1e-5);
  EXPECT_NEAR(rubbery.area / pi, 1.0, 5e-4);
  const SlidingContactResult glassy = solver.indent(1.0, {{1.0 - e0, 1e9}});
  ASSERT_TRUE(glassy.converged);
  EXPECT_NEAR(glassy.force * e0 / (4.0 / 3.0), 1.0, 1e-5);
  EXPECT_NEAR(glassy.area / pi, 1.0, 5e-4);
}

TEST(ViscoelasticContact, HasTheReferenceValues) {
  // Values of an independent program on the same grid, ŷ = 0.01; half a unit of the last digit, and
  // 1e-6 for the tolerance of both. Areas are good to 3 digits.
  SlidingContact solver = contact(256);
  struct Reference {
    double beta, force, area, friction;
  };
  for (const Reference& reference : {Reference{0.1, 1.33802e-3, 2.972e-2, 8.373e-3},
                                     {1.0, 1.62614e-3, 2.0174e-2, 4.1775e-2},
                                     {10.0, 4.65343e-3, 1.8653e-2, 2.7354e-2},
                                     {100.0, 1.01448e-2, 2.6858e-2, 5.745e-3}}) {
    const double y = 0.01;
    const SlidingContactResult result =
        solver.indent(y, {{1.0 - e0, reference.beta * std::sqrt(y)}});
    ASSERT_TRUE(result.converged);
    EXPECT_NEAR(result.force / reference.force, 1.0, 6e-6) << reference.beta;
    EXPECT_NEAR(result.area / reference.area, 1.0, 1e-3) << reference.beta;
    EXPECT_NEAR(result.friction / reference.friction, 1.0, 1.2e-4) << reference.beta;
  }
}

TEST(ViscoelasticContact, ConvergesWithTheGrid) {
  // Sums of the relative errors over eight speeds against the shipped curve of 512 cells, on grids
  // four times as fine as each other: where the edge lies within its cell makes single errors jump.
  const MasterCurve& shipped = shipped_master_curve();
  struct Errors {
    double force = 0.0, friction = 0.0, area = 0.0;
  };
  const auto errors = [&](std::int64_t grid, std::size_t first) {
    SlidingContact solver = contact(grid, 1e-8);
    Errors sums;
    for (std::size_t k = first; k < first + 16; k += 2) {
      const MasterPoint& reference = shipped.points[k];
      const SlidingContactResult result = solver.indent(1.0, {{1.0 - e0, reference.beta}});
      EXPECT_TRUE(result.converged);
      sums.force += std::abs(result.force / reference.force - 1.0);
      sums.friction += std::abs(result.friction / reference.friction - 1.0);
      sums.area += std::abs(result.area / reference.area - 1.0);
    }
    return sums;
  };
  const auto order = [](double coarse, double fine) { return 0.5 * std::log2(coarse / fine); };
  // From β = 0.3 to 18: a constant pressure on every cell is of second order.
  const Errors coarse = errors(32, 20);
  const Errors fine = errors(128, 20);
  EXPECT_NEAR(order(coarse.force, fine.force), 2.0, 0.4);
  // Friction is a ratio, in which part of the error cancels.
  EXPECT_NEAR(order(coarse.friction, fine.friction), 2.5, 0.6);
  // From β = 10 on, where the coarse grid resolves the edge as well.
  EXPECT_NEAR(order(errors(64, 32).area, errors(256, 32).area), 2.2, 0.7);
}

TEST(ViscoelasticContact, ShippedCurveIsWhatTheSolverGives) {
  // Every eighth point on 128 cells; the shipped one was made on 512.
  std::vector<double> betas;
  for (std::size_t k = 16; k < 57; k += 8) betas.push_back(master_curve_betas()[k]);
  SlidingContactParameters parameters;
  parameters.grid = 128;
  const ComputedMasterCurve computed = compute_master_curve(e0, betas, parameters);
  ASSERT_TRUE(computed.converged());
  const MasterCurve& shipped = shipped_master_curve();
  ASSERT_EQ(shipped.points.size(), 57u);
  for (std::size_t k = 0; k < betas.size(); ++k) {
    const MasterPoint& expected = shipped.points[16 + 8 * k];
    const MasterPoint& found = computed.curve.points[k];
    EXPECT_EQ(expected.beta, found.beta);
    EXPECT_NEAR(found.force / expected.force, 1.0, 5e-5);
    EXPECT_NEAR(found.area / expected.area, 1.0, 1e-3);
    EXPECT_NEAR(found.friction / expected.friction, 1.0, 1e-3);
  }
}

}  // namespace
}  // namespace stridor
