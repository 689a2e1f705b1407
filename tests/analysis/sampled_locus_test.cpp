#include "analysis/sampled_locus.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "solvers/eigenvalues/dense_eigenvalues.hpp"
#include "tests/support/constants.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/reference_brake.hpp"

namespace stridor {
namespace {

using Complex = std::complex<double>;

using test::message_of;
using test::pencil_of;
using test::reference_brake;

using test::two_pi;

PencilFamily brake_family(const DiscModelParameters& brake) {
  PencilFamily family;
  family.place = [brake](double friction, Pencil& pencil) {
    DiscModelParameters at = brake;
    at.contact.friction.coefficient = friction;
    pencil = pencil_of(at);
  };
  return family;
}

std::vector<double> hundred_values(double from, double to) {
  std::vector<double> values;
  for (int i = 0; i <= 100; ++i) values.push_back(from + (to - from) * i / 100.0);
  return values;
}

/// The friction from which on the brake is unstable.
Crossing limit_of(const DiscModelParameters& brake) {
  const Locus locus = sample_locus(brake_family(brake), {0.2, 0.45});
  EXPECT_EQ(locus.unresolved, 0.0);
  EXPECT_FALSE(locus.crossings.empty());
  if (locus.crossings.empty()) return {};
  EXPECT_EQ(locus.crossings.front().direction, 1);
  return locus.crossings.front();
}

TEST(SampledLocus, StabilityAloneTakesFewSpectra) {
  DiscModelParameters brake = reference_brake({"friction", "structural_damping"});
  brake.disc.damping.alpha = brake.pads.damping.alpha = 50.0;
  int num_spectra = 0;
  PencilFamily family = brake_family(brake);
  family.place = [&num_spectra, place = family.place](double value, Pencil& pencil) {
    ++num_spectra;
    place(value, pencil);
  };
  const Locus found = sample_locus(family, {0.2, 0.45}, {}, stability_effort);
  const int num_few = num_spectra;
  num_spectra = 0;
  const Locus all = sample_locus(family, {0.2, 0.45});
  EXPECT_LT(3 * num_few, num_spectra);
  ASSERT_EQ(found.crossings.size(), 1U);
  EXPECT_NEAR(found.crossings[0].value, all.crossings.front().value, 1e-9);
  EXPECT_NEAR(found.crossings[0].frequency, all.crossings.front().frequency, 1e-4);
  EXPECT_EQ(found.eigenvalues, all.eigenvalues);
  ASSERT_EQ(found.unstable.size(), 1U);
  EXPECT_EQ(found.unstable[0].to, 0.45);
}

TEST(SampledLocus, SparingEffortFindsTheSameEndWithFewSpectra) {
  // One eigenvalue whose real part is not linear: it crosses zero at 0.3.
  int num_spectra = 0;
  SpectrumFamily family;
  family.at = [&](double value) {
    ++num_spectra;
    return SampledSpectrum{{{-1.0, 5.0}, {std::exp(value) - std::exp(0.3), 20.0}}, {0.0, 0.0}};
  };
  const Locus locus = sample_locus(family, {0.0, 0.5, 1.0}, {}, sparing_effort);
  ASSERT_EQ(locus.crossings.size(), 1U);
  EXPECT_NEAR(locus.crossings[0].value, 0.3, 1e-9);
  EXPECT_NEAR(locus.crossings[0].frequency, 20.0 / two_pi, 1e-12);
  ASSERT_EQ(locus.unstable.size(), 1U);
  EXPECT_EQ(locus.unstable[0].to, 1.0);
  EXPECT_EQ(locus.num_places, 33);
  EXPECT_LT(num_spectra, 65);
}

/// One that hardly decays, one that always grows slowly, and two that meet at p = 0.3: squares
/// −(4 ± sqrt(0.09 − p²)), with a little damping.
SampledSpectrum flutter_among_others(double p) {
  SampledSpectrum spectrum{{{-1e-7, 1.0}, {1e-4, 1.5}}, {0.0, 0.0}};
  const Complex root = std::sqrt(Complex(0.09 - p * p, 0.0));
  for (const double sign : {-1.0, 1.0}) {
    Complex s = std::sqrt(-(4.0 + sign * root));
    if (s.imag() < 0.0) s = -s;
    spectrum.eigenvalues.push_back(s - 1e-3);
    spectrum.rounding.push_back(0.0);
  }
  if (spectrum.eigenvalues[2].imag() > spectrum.eigenvalues[3].imag())
    std::swap(spectrum.eigenvalues[2], spectrum.eigenvalues[3]);
  return spectrum;
}

TEST(SampledLocus, TheEndOfAFlutterWindowTakesFewSpectra) {
  // Re sqrt(−4 − i √(p² − 0.09)) = 1e-3, squared: 4 (1e-3)² (4 + (1e-3)²) = p² − 0.09.
  const double expected = std::sqrt(0.09 + 4.0 * 1e-6 * (4.0 + 1e-6));
  int num_near = 0;
  SpectrumFamily family;
  family.at = flutter_among_others;
  family.near = [&](double p) {
    ++num_near;
    return flutter_among_others(p);
  };
  family.around = [](double p, Complex) { return flutter_among_others(p); };
  const Locus locus = sample_locus(family, {0.0, 0.5, 1.0}, {}, sparing_effort);
  ASSERT_EQ(locus.crossings.size(), 1U);
  EXPECT_NEAR(locus.crossings[0].value, expected, 2e-9);
  EXPECT_LE(num_near, 10);
  EXPECT_EQ(locus.unstable.size(), 2U);
}

TEST(SampledLocus, SparingEffortIntegratesSmoothGrowthFromValuesAtHand) {
  int num_around = 0;
  const auto grow = [](double x) { return SampledSpectrum{{{std::sin(x) - 0.2, 20.0}}, {0.0}}; };
  SpectrumFamily family{grow, grow, [&](double x, Complex) {
                          ++num_around;
                          return grow(x);
                        }};
  const Locus locus = sample_locus(family, {0.0, 1.0, 2.0}, {}, sparing_effort);
  ASSERT_EQ(locus.unstable.size(), 1U);
  const double from = std::asin(0.2);
  const double integral = std::cos(from) - std::cos(2.0) - 0.2 * (2.0 - from);
  EXPECT_NEAR(locus.unstable[0].growth_integral, integral, 1e-6 * integral);
  EXPECT_LT(num_around, 20);  // 8 towards the top, and two or three for the integral
}

TEST(SampledLocus, SpectraThatWereNotCountedAreAmongTheValuesNotVerified) {
  SpectrumFamily family;
  family.at = [](double x) {
    return SampledSpectrum{{{x - 0.25, 20.0}}, {0.0}, x == 0.0 || x == 1.0};
  };
  const Locus locus = sample_locus(family, {0.0, 0.5, 1.0}, {}, {2});
  EXPECT_EQ(locus.unverified, std::vector<double>{0.5});
  ASSERT_EQ(locus.unstable.size(), 1U);
  EXPECT_NEAR(locus.unstable[0].from, 0.25, 1e-9);
}

TEST(SampledLocus, CirculatoryBrakeFluttersFromItsCriticalFriction) {
  const Crossing found = limit_of(reference_brake({"friction"}));
  EXPECT_NEAR(found.value, 0.3596654112, 1e-10);
  EXPECT_NEAR(found.frequency, 1895.537, 1e-3);
}

TEST(SampledLocus, PenaltyConvergesToMultipliersWithFirstOrder) {
  DiscModelParameters brake = reference_brake({"friction"});
  brake.contact.formulation = ContactFormulation::penalty;
  const double limit = 0.3596654112;
  std::vector<double> errors;
  for (const auto& [penalty, expected] :
       {std::pair(1e9, 0.3544503), std::pair(1e10, 0.3591312), std::pair(1e11, 0.3596119)}) {
    brake.contact.penalty = penalty;
    const double found = limit_of(brake).value;
    EXPECT_NEAR(found, expected, 6e-8) << penalty;
    errors.push_back(limit - found);
  }
  for (std::size_t i = 1; i < errors.size(); ++i)
    EXPECT_NEAR(std::log10(errors[i - 1] / errors[i]), 1.0, 0.02);
}

TEST(SampledLocus, DampingMovesTheLimitOfTheBrake) {
  DiscModelParameters brake = reference_brake({"friction", "structural_damping"});
  brake.disc.damping.alpha = brake.pads.damping.alpha = 50.0;
  EXPECT_NEAR(limit_of(brake).value, 0.3601300, 6e-8);
  brake.disc.damping = {0.0, 1e-8};
  brake.pads.damping = {0.0, 0.0};
  // The growth passes zero so slowly, by 3 1/s per unit of friction, that the last digit depends on
  // what is taken for zero.
  EXPECT_NEAR(limit_of(brake).value, 0.3027757, 1e-7);
  std::swap(brake.disc.damping, brake.pads.damping);
  EXPECT_NEAR(limit_of(brake).value, 0.3227976, 6e-8);
  brake.disc.damping = {0.0, 1e-8};
  EXPECT_NEAR(limit_of(brake).value, 0.3596658, 6e-8);
}

TEST(SampledLocus, EveryModeOfTheBrakeThatGrowsHasItsOwnWindow) {
  DiscModelParameters brake = reference_brake({"friction", "structural_damping"});
  brake.disc.damping = {0.0, 0.0};
  brake.pads.damping = {0.0, 1e-8};
  const Locus locus = sample_locus(brake_family(brake), {0.2, 0.45});
  Pencil pencil;
  brake_family(brake).place(0.45, pencil);
  const auto at_the_end = dense_eigenvalues(pencil);
  ASSERT_EQ(locus.unstable.size(), 2U);
  for (const UnstableWindow& window : locus.unstable) {
    EXPECT_EQ(window.to, 0.45);
    EXPECT_TRUE(std::any_of(at_the_end.begin(), at_the_end.end(), [&](const Eigenvalue& one) {
      return std::abs(one.frequency() - window.frequency) < 1e-3 &&
             std::abs(one.growth() - window.growth_max) < 1e-6;
    }));
  }
}

/// k1 = 1, k2 = 1.4 with M = 1, and p [[0, 1], [−1, 0]].
PencilFamily sampled_flutter(const Eigen::Matrix2d& velocity) {
  PencilFamily family;
  family.place = [velocity](double load, Pencil& pencil) {
    LinearSystem system;
    system.mass = Eigen::Matrix2d::Identity();
    system.velocity = velocity;
    system.position = Eigen::Matrix2d{{1.0, load}, {-load, 1.4}};
    system.gaps = system.forces = Eigen::MatrixXd(0, 2);
    pencil = make_pencil(system);
  };
  return family;
}

double flutter_limit(const Eigen::Matrix2d& velocity) {
  const Locus locus = sample_locus(sampled_flutter(velocity), hundred_values(0.0, 0.4));
  EXPECT_EQ(locus.crossings.size(), 1U);
  return locus.crossings.empty() ? 0.0 : locus.crossings.front().value;
}

TEST(SampledLocus, TwoDegreesOfFreedomFlutterAsTheirClosedForms) {
  const auto diagonal = [](double a, double b) {
    return Eigen::Matrix2d(Eigen::Vector2d(a, b).asDiagonal());
  };
  EXPECT_NEAR(flutter_limit(Eigen::Matrix2d::Zero()), 0.2, 1e-12);
  EXPECT_NEAR(flutter_limit(diagonal(0.1, 0.1)), 0.2280350850, 1e-10);
  EXPECT_NEAR(flutter_limit(diagonal(0.001, 0.003)), 0.1732146068, 1e-10);
  EXPECT_NEAR(flutter_limit(diagonal(0.1, 0.3)), 0.2509980080, 1e-10);
}

TEST(SampledLocus, EigenvaluesOfTwoDegreesOfFreedom) {
  const auto growth = [](const Eigen::Matrix2d& velocity, double load) {
    Pencil pencil;
    sampled_flutter(velocity).place(load, pencil);
    const auto found = dense_eigenvalues(pencil);
    return std::pair(std::min(found[0].growth(), found[1].growth()),
                     std::max(found[0].growth(), found[1].growth()));
  };
  const auto [down, up] = growth(Eigen::Matrix2d::Zero(), 0.3);
  EXPECT_NEAR(up, 0.1016256896, 1e-10);
  EXPECT_NEAR(down, -0.1016256896, 1e-10);
  const auto [falling, rising] = growth(Eigen::Matrix2d{{0.0, 0.1}, {-0.1, 0.0}}, 0.05);
  EXPECT_NEAR(rising, 0.0111662740, 1e-10);
  EXPECT_NEAR(falling, -0.0111662740, 1e-10);
}

/// s² + s (x² − 1) + 1 = 0, which grows with (1 − x²)/2 between −1 and 1.
PencilFamily parabola() {
  PencilFamily family;
  family.place = [](double x, Pencil& pencil) {
    LinearSystem system;
    system.mass = system.position = Eigen::MatrixXd::Identity(1, 1);
    system.velocity = Eigen::MatrixXd::Constant(1, 1, x * x - 1.0);
    system.gaps = system.forces = Eigen::MatrixXd(0, 1);
    pencil = make_pencil(system);
  };
  return family;
}

TEST(SampledLocus, WindowsHoldTheIntegralOfTheGrowth) {
  const PencilFamily family = parabola();
  const Locus locus = sample_locus(family, {-3.0, 2.0});
  ASSERT_EQ(locus.unstable.size(), 1U);
  EXPECT_NEAR(locus.unstable[0].from, -1.0, 1e-12);
  EXPECT_NEAR(locus.unstable[0].to, 1.0, 1e-12);
  EXPECT_NEAR(locus.unstable[0].growth_max, 0.5, 1e-9);
  EXPECT_NEAR(locus.unstable[0].value_max, 0.0, 1e-4);
  EXPECT_NEAR(locus.unstable[0].growth_integral, 2.0 / 3.0, 1e-9);
  EXPECT_NEAR(locus.unstable[0].frequency, std::sqrt(0.75) / two_pi, 1e-9);
  EXPECT_EQ(locus.eigenvalues.size(), 2U);
}

TEST(SampledLocus, EigenvaluesAreConnectedToBranches) {
  const PencilFamily family = parabola();
  const Locus locus = sample_locus(family, {-1.5, 0.1, 1.5});
  ASSERT_EQ(locus.branches.size(), 1U);
  const Branch& branch = locus.branches[0];
  EXPECT_GT(branch.values.size(), 60U);
  EXPECT_EQ(branch.values.front(), -1.5);
  EXPECT_EQ(branch.values.back(), 1.5);
  for (std::size_t i = 0; i < branch.values.size(); ++i) {
    const double growth = 0.5 * (1.0 - branch.values[i] * branch.values[i]);
    EXPECT_NEAR(branch.s[i].real(), growth, 1e-13);
    EXPECT_NEAR(branch.s[i].imag(), std::sqrt(1.0 - growth * growth), 1e-13);
  }
  ASSERT_EQ(locus.unstable.size(), 1U);
  EXPECT_EQ(locus.unstable[0].branch, 0);
  // Where stability alone is looked for there are none.
  EXPECT_TRUE(sample_locus(family, {-1.5, 0.1, 1.5}, {}, stability_effort).branches.empty());
}

TEST(SampledLocus, AWindowKnowsItsBranchWhereTwoEigenvaluesMeet) {
  const Locus locus =
      sample_locus(sampled_flutter(Eigen::Matrix2d::Zero()), hundred_values(0.0, 0.4));
  ASSERT_EQ(locus.branches.size(), 2U);
  ASSERT_EQ(locus.unstable.size(), 1U);
  const auto& growing = locus.branches[static_cast<std::size_t>(locus.unstable[0].branch)];
  const auto& decaying = locus.branches[static_cast<std::size_t>(1 - locus.unstable[0].branch)];
  EXPECT_NEAR(growing.s.back().real(), locus.unstable[0].growth_max, 1e-12);
  EXPECT_NEAR(decaying.s.back().real(), -locus.unstable[0].growth_max, 1e-12);
  // Before they meet the squares of the frequencies are 1.2 -+ sqrt(0.04 - p^2).
  for (std::size_t i = 0; i < growing.values.size(); ++i) {
    if (growing.values[i] > 0.199) break;
    const double apart = std::sqrt(0.04 - growing.values[i] * growing.values[i]);
    const double sum = std::norm(growing.s[i]) + std::norm(decaying.s[i]);
    EXPECT_NEAR(sum, 2.4, 1e-12);
    EXPECT_NEAR(std::abs(std::norm(growing.s[i]) - std::norm(decaying.s[i])), 2.0 * apart, 1e-9);
  }
}

TEST(SampledLocus, ANarrowWindowBetweenTwoValuesIsFound) {
  // Growth 1e-4 − x² around 0, with 0 far from every value looked at.
  PencilFamily family;
  family.place = [](double x, Pencil& pencil) {
    LinearSystem system;
    system.mass = system.position = Eigen::MatrixXd::Identity(1, 1);
    system.velocity = Eigen::MatrixXd::Constant(1, 1, 2.0 * (x * x - 1e-4));
    system.gaps = system.forces = Eigen::MatrixXd(0, 1);
    pencil = make_pencil(system);
  };
  const Locus locus = sample_locus(family, {-3.05, 3.0});
  ASSERT_EQ(locus.unstable.size(), 1U);
  EXPECT_NEAR(locus.unstable[0].from, -0.01, 1e-12);
  EXPECT_NEAR(locus.unstable[0].to, 0.01, 1e-12);
}

TEST(SampledLocus, RejectsWhatIsNoRange) {
  EXPECT_EQ(message_of<std::invalid_argument>([] { sample_locus({}, {1.0}); }),
            "locus: there is no family");
  const PencilFamily family = sampled_flutter(Eigen::Matrix2d::Zero());
  EXPECT_EQ(message_of<std::invalid_argument>([&] { sample_locus(family, {}); }),
            "locus: there are no values");
  EXPECT_EQ(message_of<std::invalid_argument>([&] {
              sample_locus(family, {1.0, 1.0});
            }),
            "locus: the values must ascend");
  LocusOptions none;
  none.window.count = 0;
  EXPECT_EQ(message_of<std::invalid_argument>([&] { sample_locus(family, {1.0}, none); }),
            "locus: 0 eigenvalues are none");
}

}  // namespace
}  // namespace stridor
