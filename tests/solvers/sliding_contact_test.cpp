#include "solvers/half_space/sliding_contact.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

#include "core/fft_plan.hpp"
#include "tests/support/message_of.hpp"

namespace stridor {
namespace {

using std::numbers::pi;
using test::message_of;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr double e0 = 0.1;  // E_0/E_∞ of the paper

IndenterProfile paraboloid(double radius = 1.0) {
  ProfileParameters parameters;
  parameters.radius = radius;
  return IndenterProfile(parameters);
}

SlidingContact contact(std::int64_t grid, double tolerance = 1e-8) {
  SlidingContactParameters parameters;
  parameters.grid = grid;
  parameters.tolerance = tolerance;
  return SlidingContact(parameters, paraboloid());
}

TEST(SlidingContact, RestIsHertz) {
  // Force to 1e-4 and area to 0.5 % at 64 cells a side.
  SlidingContact solver = contact(64);
  const SlidingContactResult result = solver.indent(0.01, {});
  ASSERT_TRUE(result.converged);
  EXPECT_NEAR(result.force / (4.0 / 3.0 * std::pow(0.01, 1.5)), 1.0, 1e-4);
  EXPECT_NEAR(result.area / (pi * 0.01), 1.0, 5e-3);
  EXPECT_NEAR(result.friction, 0.0, 1e-12);
  EXPECT_THAT(result.remarks(), IsEmpty());
  // Hertz's pressure 2 (δ/R)^½/π at the middle, from the closest cells; p = p_0 (1 − r²/a²)^½.
  const double side = solver.cell_side();
  const double expected = 2.0 / pi * 0.1 * std::sqrt(1.0 - 0.5 * side * side / 0.01);
  EXPECT_NEAR(solver.pressure()[32] / expected, 1.0, 1e-3);
}

TEST(SlidingContact, FastSlidingIsHertzWithTheGlassyModulus) {
  SlidingContact solver = contact(64);
  const double beta = 1e7;
  const SlidingContactResult result = solver.indent(1.0, {{1.0 - e0, beta}});
  ASSERT_TRUE(result.converged);
  // The remaining memory is of the order ln(β)/β/e0.
  EXPECT_NEAR(result.force / (4.0 / (3.0 * e0)), 1.0, 1e-4);
  EXPECT_NEAR(result.area / pi, 1.0, 5e-3);
  EXPECT_NEAR(result.friction * beta / (0.8 * (1.0 / e0 - 1.0)), 1.0, 0.01);
}

TEST(SlidingContact, SlowSlidingHasTheFrictionOfTheRelaxedContact) {
  // m = (1 − e0) β in the limit; at β = 0.02 on 128 cells the layer is 1.2 cells, its loss about 1
  // %.
  SlidingContact solver = contact(128, 1e-7);
  const double beta = 0.02;
  const SlidingContactResult result = solver.indent(1.0, {{1.0 - e0, beta}});
  ASSERT_TRUE(result.converged);
  EXPECT_NEAR(result.friction / ((1.0 - e0) * beta), 1.0, 0.03);
  EXPECT_LT(result.memory_in_cells, 2.0);
  EXPECT_THAT(result.remarks(), ElementsAre(HasSubstr("1.2 cells wide and not resolved")));
}

TEST(SlidingContact, SlowFrictionOfAnyProfileIsThatOfItsCurvature) {
  // To first order in the speed K = L + Σ w_k l_k ∂L/∂x and the pressure is that at rest; there
  // ∫ p_x (L p_x) = ∫ p f_xx, so that μ = Σ w_k l_k ½⟨f″ + f′/r⟩ with the mean over p. Sphere, two
  // creep times; curvature over the pressures of the contact at rest.
  ProfileParameters parameters;
  parameters.shape = ProfileShape::sphere;
  parameters.radius = 1.0;
  SlidingContactParameters settings;
  settings.grid = 128;
  SlidingContact solver(settings, IndenterProfile(parameters));
  const SlidingContactResult rest = solver.indent(0.3, {});
  ASSERT_TRUE(rest.converged);
  double mean = 0.0;
  const double side = solver.cell_side();
  for (std::size_t k = 0; k < solver.pressure().size(); ++k) {
    const double x = (static_cast<double>(k % 128) - 63.5) * side;
    const double y = (static_cast<double>(k / 128) + 0.5) * side;
    const double height = std::sqrt(std::max(1e-9, 1.0 - x * x - y * y));  // of the centre over it
    mean += 2.0 * solver.pressure()[k] * side * side / rest.force * 0.5 *
            (std::pow(height, -3.0) + 1.0 / height);
  }
  EXPECT_GT(mean, 1.05);  // a paraboloid would have 1
  const double speed = 0.002;
  const SlidingContactResult slow = solver.indent(0.3, {{0.3, speed}, {0.2, 2.0 * speed}});
  ASSERT_TRUE(slow.converged);
  // The edge layers are 0.2 and 0.4 cells. The loss there is of first order in the cell: 0.4 %
  // on the 512 cells of the shipped curve, so 1.7 % here; the next order in the speed is 0.5 %.
  EXPECT_NEAR(slow.friction / ((0.3 + 0.2 * 2.0) * speed * mean), 1.0, 0.025);
}

TEST(SlidingContact, FrictionIsOddAndTheRestEvenInTheSpeed) {
  SlidingContact solver = contact(48);
  for (const double beta : {0.1, 1.0, 10.0}) {
    const SlidingContactResult there = solver.indent(1.0, {{0.9, beta}});
    const std::vector<double> pressure = solver.pressure();
    const SlidingContactResult back = solver.indent(1.0, {{0.9, -beta}});
    ASSERT_TRUE(there.converged && back.converged);
    // Both to the tolerance 1e-8 of the displacements.
    EXPECT_NEAR(there.force / back.force, 1.0, 1e-6);
    EXPECT_NEAR(there.area / back.area, 1.0, 1e-5);
    EXPECT_NEAR(there.friction, -back.friction, 1e-6);
    EXPECT_GT(there.friction, 0.0);
    const double largest = *std::max_element(pressure.begin(), pressure.end());
    for (std::size_t i = 0; i < 48; ++i)
      EXPECT_NEAR(pressure[i], solver.pressure()[47 - i], 1e-4 * largest);
  }
}

TEST(SlidingContact, ParaboloidsCollapseOnOneParameter) {
  // β = v τ/(R δ)^½: F/δ^1.5, A/δ and μ/δ^½ are the same numbers for the same β, to the tolerance.
  SlidingContact solver = contact(48);
  std::array<double, 3> expected{};
  for (const double indentation : {1.0, 0.04, 3e-4}) {
    const double beta = 0.7;
    const SlidingContactResult result =
        solver.indent(indentation, {{0.9, beta * std::sqrt(indentation)}});
    ASSERT_TRUE(result.converged);
    const std::array<double, 3> found{result.force / std::pow(indentation, 1.5),
                                      result.area / indentation,
                                      result.friction / std::sqrt(indentation)};
    if (indentation == 1.0) expected = found;
    for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(found[k] / expected[k], 1.0, 1e-5);
  }
}

TEST(SlidingContact, SpectralDissipationGivesTheSameFriction) {
  // In steady sliding the power of friction is what the material dissipates. With û = K̂ p̂ the
  // tangential force is Σ over wave vectors of Im(k_x K̂) |p̂|²: no slope of the indenter enters.
  // A periodic box of 8 windows lets the spectrum be that of the infinite half-space,
  // K̂ = (2/k)(e0 + (1 − e0)/(1 − i k_x l)), whose k → 0 part carries no dissipation.
  constexpr int n = 64;
  constexpr int box = 8 * n;
  SlidingContact solver = contact(n, 1e-9);
  const double beta = 1.0;
  const SlidingContactResult result = solver.indent(1.0, {{0.9, beta}});
  ASSERT_TRUE(result.converged);
  std::vector<std::complex<double>> lines(static_cast<std::size_t>(box) * (box / 2 + 1));
  RealFft along_x(box);
  for (int j = 0; j < n; ++j) {
    const int row = j < n / 2 ? n / 2 - 1 - j : j - n / 2;
    auto input = along_x.input();
    std::fill(input.begin(), input.end(), 0.0);
    for (int i = 0; i < n; ++i)
      input[static_cast<std::size_t>(i)] = solver.pressure()[static_cast<std::size_t>(row * n + i)];
    along_x.execute();
    for (int m = 0; m <= box / 2; ++m)
      lines[static_cast<std::size_t>(j * (box / 2 + 1) + m)] =
          along_x.output()[static_cast<std::size_t>(m)];
  }
  const double side = solver.cell_side();
  const double length = box * side;
  double power = 0.0;
  for (int m = 1; m < box / 2; ++m) {
    const double kx = 2.0 * pi * m / length;
    for (int q = -box / 2; q < box / 2; ++q) {
      const double ky = 2.0 * pi * q / length;
      std::complex<double> spectrum = 0.0;
      const std::complex<double> turn = std::polar(1.0, -ky * side);
      std::complex<double> phase = 1.0;
      for (int j = 0; j < n; ++j) {
        spectrum += phase * lines[static_cast<std::size_t>(j * (box / 2 + 1) + m)];
        phase *= turn;
      }
      // The pressure is constant on every cell.
      const auto sinc = [&](double k) {
        return k == 0.0 ? 1.0 : std::sin(0.5 * k * side) / (0.5 * k * side);
      };
      spectrum *= side * side * sinc(kx) * sinc(ky);
      const double k = std::hypot(kx, ky);
      const std::complex<double> memory = 0.9 / std::complex<double>(1.0, -kx * beta);
      power += 2.0 * std::norm(spectrum) * kx * 2.0 / k * memory.imag() / (length * length);
    }
  }
  // Piecewise constant pressures have the wrong gradients on a cell, K̂ k_x |p̂|² falls as 1/k² only:
  // first order in the side, about 1 % here. The box is good to (1/8)³.
  EXPECT_NEAR(power / (result.friction * result.force), 1.0, 0.02);
}

TEST(SlidingContact, LoadControlFindsTheIndentation) {
  SlidingContact solver = contact(32);
  for (const double beta : {0.0, 0.3, 3.0}) {
    const CreepLengths creep{{0.9, beta}};
    const SlidingContactResult wanted = solver.indent(0.5, creep);
    const SlidingContactResult found = solver.load(wanted.force, creep, 1e-7);
    ASSERT_TRUE(found.converged);
    EXPECT_NEAR(found.force / wanted.force, 1.0, 1e-7);
    EXPECT_NEAR(found.indentation, 0.5, 1e-6);
  }
}

TEST(SlidingContact, MoreCreepTimesLieBetweenTheirOwnMaterials) {
  SlidingContact solver = contact(32);
  const double fast = solver.indent(1.0, {{0.9, 0.1}}).force;
  const double both = solver.indent(1.0, {{0.45, 0.1}, {0.45, 10.0}}).force;
  const double slow = solver.indent(1.0, {{0.9, 10.0}}).force;
  EXPECT_LT(fast, both);
  EXPECT_LT(both, slow);
  // Two equal times are one.
  EXPECT_NEAR(
      solver.indent(1.0, {{0.4, 1.0}, {0.5, 1.0}}).force / solver.indent(1.0, {{0.9, 1.0}}).force,
      1.0, 1e-6);
}

TEST(SlidingContact, SphereIsTheExactHertzianSphere) {
  // The punch of exact circular section on an elastic half-space has its closed form (Segedin
  // 1957): δ = a artanh(a/R), F = E* ((a² + R²)/2 ln((R + a)/(R − a)) − a R).
  ProfileParameters parameters;
  parameters.shape = ProfileShape::sphere;
  parameters.radius = 2.0;
  SlidingContactParameters settings;
  settings.grid = 64;
  SlidingContact solver(settings, IndenterProfile(parameters));
  const double a = 0.8;
  const SlidingContactResult result = solver.indent(a * std::atanh(a / 2.0), {});
  const double force = 0.5 * (a * a + 4.0) * std::log((2.0 + a) / (2.0 - a)) - 2.0 * a;
  ASSERT_TRUE(result.converged);
  EXPECT_NEAR(result.force / force, 1.0, 2e-4);
  EXPECT_NEAR(result.area / (pi * a * a), 1.0, 5e-3);
}

TEST(SlidingContact, TableOfAParaboloidIsTheParaboloid) {
  ProfileParameters parameters;
  parameters.shape = ProfileShape::table;
  parameters.radius = 1.0;
  for (int i = 0; i <= 60; ++i) {
    parameters.radii.push_back(0.05 * i);
    parameters.heights.push_back(0.5 * std::pow(0.05 * i, 2));
  }
  SlidingContactParameters settings;
  settings.grid = 32;
  SlidingContact table(settings, IndenterProfile(parameters));
  SlidingContact exact(settings, paraboloid());
  const CreepLengths creep{{0.9, 1.0}};
  const SlidingContactResult a = table.indent(1.0, creep);
  const SlidingContactResult b = exact.indent(1.0, creep);
  // The monotone cubic is of third order in the step of the table, (0.05)³.
  EXPECT_NEAR(a.force / b.force, 1.0, 2e-4);
  EXPECT_NEAR(a.friction / b.friction, 1.0, 2e-3);
}

TEST(SlidingContact, GapIsClosedInContactAndOpenBeyond) {
  SlidingContact solver = contact(32);
  ASSERT_TRUE(solver.indent(1.0, {{0.9, 1.0}}).converged);
  const std::vector<double> gap = solver.gap();
  for (std::size_t k = 0; k < gap.size(); ++k) {
    if (solver.pressure()[k] > 0.0) {
      EXPECT_NEAR(gap[k], 0.0, 1e-6);
    } else {
      EXPECT_GT(gap[k], -1e-6);
    }
  }
}

TEST(SlidingContact, WarmAndColdStartsAgree) {
  SlidingContact solver = contact(64);
  (void)solver.indent(1.0, {{0.9, 0.1}});
  const double warm = solver.indent(1.0, {{0.9, 1.0}}).force;
  solver.restart();
  const double cold = solver.indent(1.0, {{0.9, 1.0}}).force;
  EXPECT_NEAR(warm / cold, 1.0, 1e-7);
}

TEST(SlidingContact, TooLargeAModulusRatioIsSaid) {
  // E_∞/E_0 = 1000 near β = 1: the pressure ahead is concentrated in a layer far below a cell.
  SlidingContact solver = contact(64);
  const SlidingContactResult result = solver.indent(1.0, {{0.999, 1.0}});
  EXPECT_FALSE(result.converged);
  EXPECT_TRUE(std::isnan(result.force));
  EXPECT_THAT(result.remarks(), ::testing::Contains(HasSubstr("not converged")));
  // It does not spoil what comes after.
  EXPECT_NEAR(solver.indent(1.0, {}).force / (4.0 / 3.0), 1.0, 1e-4);
}

TEST(SlidingContact, ContactAtTheBorderOfTheWindowIsSaid) {
  // The end of a table is a sharp rim: the elastic radius is short of it, but with a window
  // of 1.001 cells at the border are within the contact.
  SlidingContactParameters settings;
  settings.grid = 32;
  settings.window = 1.001;
  SlidingContact solver(settings, paraboloid());
  const SlidingContactResult result = solver.indent(1.0, {});
  EXPECT_TRUE(result.touches_window);
  EXPECT_THAT(result.remarks(), ::testing::Contains(HasSubstr("border of the window")));
}

TEST(SlidingContact, RefusesWhatItCannotSolve) {
  const auto says = [](auto&& call) { return message_of<std::invalid_argument>(call); };
  const auto with = [&](auto&& change) {
    SlidingContactParameters parameters;
    parameters.grid = 16;
    change(parameters);
    return says([&] { SlidingContact solver(parameters, paraboloid()); });
  };
  EXPECT_THAT(with([](auto& p) { p.grid = 33; }), HasSubstr("grid 33 is not even, 16 to 4096"));
  EXPECT_THAT(with([](auto& p) { p.window = 1.0; }), HasSubstr("window 1 is not in (1, 10]"));
  EXPECT_THAT(with([](auto& p) { p.tolerance = 0.0; }),
              HasSubstr("tolerance 0 is not in (0, 0.1)"));
  EXPECT_THAT(with([](auto& p) { p.max_rounds = 0; }), HasSubstr("max_rounds is not positive"));

  SlidingContact solver = contact(16);
  EXPECT_THAT(says([&] { (void)solver.indent(0.0, {}); }), HasSubstr("indentation 0 m is not > 0"));
  EXPECT_THAT(says([&] { (void)solver.load(-1.0, {}); }), HasSubstr("force -1 m2 is not > 0"));
  EXPECT_THAT(says([&] { (void)solver.load(1.0, {}, 0.0); }), HasSubstr("tolerance of the force"));

  ProfileParameters parameters;
  parameters.shape = ProfileShape::table;
  parameters.radius = 1.0;
  parameters.radii = {0.0, 0.1, 0.2};
  parameters.heights = {0.0, 0.005, 0.02};
  SlidingContactParameters settings;
  settings.grid = 16;
  SlidingContact table(settings, IndenterProfile(parameters));
  EXPECT_THAT(says([&] { (void)table.indent(1.0, {}); }), HasSubstr("in contact up to its end"));
  EXPECT_THAT(says([&] { (void)table.load(1.0, {}); }), HasSubstr("in contact up to its end"));
}

TEST(CreepLengths, AreInRadiiPerFirstCreepTime) {
  const ViscoelasticMaterial material{1.0, 5.0, 0.0, {0.1, 1.0}, {0.25, 0.75}};
  const CreepLengths lengths = creep_lengths(material, 2.0, 3.0);
  ASSERT_EQ(lengths.size(), 2u);
  EXPECT_DOUBLE_EQ(lengths[0].share, 0.2);
  EXPECT_DOUBLE_EQ(lengths[0].length, 6.0);
  EXPECT_DOUBLE_EQ(lengths[1].share, 0.6);
  EXPECT_DOUBLE_EQ(lengths[1].length, 60.0);
}

}  // namespace
}  // namespace stridor
