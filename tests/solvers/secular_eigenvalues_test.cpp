#include "solvers/eigenvalues/secular_eigenvalues.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "core/errors.hpp"
#include "solvers/eigenvalues/dense_eigenvalues.hpp"
#include "solvers/eigenvalues/residual_modes.hpp"
#include "tests/support/full_model.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/paper_model.hpp"
#include "tests/support/pencils.hpp"

namespace stridor {
namespace {

using test::eps;
using test::message_of;
using ::testing::HasSubstr;
using Complex = std::complex<double>;

/// Largest distance between the two sets, each member matched once, relative to its size plus
/// `floor`.
double largest_difference(const std::vector<Eigenvalue>& found, std::vector<Eigenvalue> reference,
                          double floor = 0.0) {
  double largest = 0.0;
  for (const Eigenvalue& eigenvalue : found) {
    if (reference.empty()) return INFINITY;
    const auto nearest = std::min_element(
        reference.begin(), reference.end(), [&](const Eigenvalue& a, const Eigenvalue& b) {
          return std::abs(a.s - eigenvalue.s) < std::abs(b.s - eigenvalue.s);
        });
    largest =
        std::max(largest, std::abs(nearest->s - eigenvalue.s) / (std::abs(eigenvalue.s) + floor));
    reference.erase(nearest);
  }
  return largest;
}

int count_below(const std::vector<Eigenvalue>& eigenvalues, double height) {
  int count = 0;
  for (const Eigenvalue& eigenvalue : eigenvalues) {
    if (SecularFunction::height_of(eigenvalue.s) < height)
      count += eigenvalue.s.imag() > 0.0 ? 2 : 1;
  }
  return count;
}

TEST(SecularFunction, CountsZerosBelowALineAsTheDenseMethodDoes) {
  for (unsigned seed = 0; seed < 6; ++seed) {
    const auto terms = static_cast<test::ContactTerms>(seed % 3);
    const Pencil pencil = test::random_pencil(seed, 20, 1 + seed % 2, terms);
    const auto dense = dense_eigenvalues(pencil, DenseWork::eigenvalues);
    SecularFunction function(pencil);
    int num_lines = 0;
    for (double height = 1.0; height < 1500.0; height *= 1.21) {
      const auto count = function.count_zeros_below(height);
      if (!count) continue;
      EXPECT_EQ(*count, count_below(dense, height)) << "seed " << seed << ", height " << height;
      ++num_lines;
    }
    EXPECT_GT(num_lines, 30);
    EXPECT_EQ(function.num_zeros(), count_below(dense, INFINITY));
  }
}

TEST(SecularFunction, DoesNotCountWhereALineMeetsAZero) {
  const Pencil pencil = test::random_pencil(2, 20, 1, test::ContactTerms::rows_only);
  Pencil undamped = pencil;
  undamped.damping.setZero();
  undamped.equilibrium = undamped.compatibility;
  SecularFunction function(undamped);
  const double height = secular_eigenvalues(undamped, SpectrumWindow::lowest(4)).back().s.imag();
  EXPECT_FALSE(function.count_zeros_below(function.pole_heights()[4]).has_value());
  EXPECT_EQ(function.count_zeros_below(height * (1.0 - 1e-6)).value(), 6);
  EXPECT_EQ(function.count_zeros_below(height * (1.0 + 1e-6)).value(), 8);
}

TEST(SecularFunction, LogSlopeIsThatOfTheCharacteristicPolynomial) {
  // P(s) for one constraint and two modes: w1 d2 + w2 d1.
  const Pencil pencil =
      test::constrained_modes(Eigen::Vector2d(3.0, 7.0), Eigen::Vector2d(0.1, 0.2),
                              Eigen::RowVector2d(1.0, 2.0), Eigen::RowVector2d(0.5, 0.4));
  SecularFunction function(pencil);
  int hint = -1;
  for (const Complex s : {Complex(-0.3, 2.0), Complex(0.1, 6.9), Complex(-2.0, 0.0)}) {
    const Complex d1 = s * s + 0.1 * s + 9.0;
    const Complex d2 = s * s + 0.2 * s + 49.0;
    const Complex expected =
        (0.5 * (2.0 * s + 0.2) + 0.8 * (2.0 * s + 0.1)) / (0.5 * d2 + 0.8 * d1);
    const auto slope = function.log_slope_below(s, INFINITY, hint);
    EXPECT_LT(std::abs(slope.value - expected), 100 * eps * std::abs(expected));
  }
}

TEST(SecularFunction, TakesOverOtherRowsAndOtherModes) {
  const Pencil first = test::random_pencil(1, 20, 1, test::ContactTerms::with_stiffness);
  Pencil second = first;
  second.equilibrium *= -0.7;
  const Pencil third = test::random_pencil(3, 25, 2, test::ContactTerms::rows_only);
  SecularFunction function(first);
  for (const Pencil& pencil : {second, third, first}) {
    function.assign(pencil);
    SecularFunction fresh(pencil);
    int hint = -1;
    int fresh_hint = -1;
    const Complex s(-0.1, 40.0);
    EXPECT_EQ(function.log_slope(s, hint).value, fresh.log_slope(s, fresh_hint).value);
    EXPECT_EQ(function.count_zeros_below(31.0), fresh.count_zeros_below(31.0));
  }
}

TEST(SecularEigenvalues, AgreeWithTheDenseOnesForManyContactsAndAllTerms) {
  for (unsigned seed = 0; seed < 12; ++seed) {
    const auto terms = static_cast<test::ContactTerms>(seed % 3);
    const Pencil pencil = test::random_pencil(seed, 24, 1 + seed % 4, terms);
    const auto dense = dense_eigenvalues(pencil, DenseWork::eigenvalues);
    const auto all = secular_eigenvalues(pencil, SpectrumWindow::all());
    ASSERT_EQ(all.size(), dense.size()) << "seed " << seed;
    // The dense ones have an absolute error of the order of eps times the largest, 1000 rad/s.
    EXPECT_LT(largest_difference(all, dense, 1.0), 1e-9) << "seed " << seed;
    const auto lowest = secular_eigenvalues(pencil, SpectrumWindow::lowest(6));
    ASSERT_LE(lowest.size(), all.size());
    for (std::size_t i = 0; i < lowest.size(); ++i) {
      EXPECT_LT(std::abs(lowest[i].s - all[i].s), 1e-10 * std::abs(all[i].s) + 1e-12);
      EXPECT_LT(lowest[i].residual, 1e-11);
    }
  }
}

/// With conjugates.
std::vector<Complex> both_halves(const std::vector<Complex>& upper) {
  std::vector<Complex> all = upper;
  for (const Complex s : upper)
    if (s.imag() > 0.0) all.push_back(std::conj(s));
  return all;
}

TEST(SecularEigenvalues, WhatIsCalledCompleteIsWhatTheDenseMethodFinds) {
  constexpr unsigned num_pencils = 1000;
  int num_complete = 0;
  for (unsigned seed = 0; seed < num_pencils; ++seed) {
    const Pencil pencil = test::awkward_pencil(seed);
    SecularFunction function(pencil);
    const SecularSpectrum spectrum =
        secular_spectrum(function, SpectrumWindow::lowest(1 + static_cast<int>(seed % 12)));
    if (!spectrum.is_complete) continue;
    ++num_complete;
    std::vector<Complex> dense;
    double largest = 0.0;
    for (const Eigenvalue& one : dense_eigenvalues(pencil, DenseWork::eigenvalues)) {
      dense.push_back(one.s);
      largest = std::max(largest, std::abs(one.s));
    }
    std::vector<Complex> rest = both_halves(dense);
    const std::vector<Complex> found = both_halves(spectrum.found);
    ASSERT_LE(found.size(), rest.size()) << "seed " << seed;
    // Two eigenvalues that coincide are known to the root of what the dense method rounds by.
    for (const Complex s : found) {
      const auto nearest = std::min_element(rest.begin(), rest.end(), [&](Complex a, Complex b) {
        return std::abs(a - s) < std::abs(b - s);
      });
      EXPECT_LT(std::abs(*nearest - s), 1e-6 * largest) << "seed " << seed;
      rest.erase(nearest);
    }
    // And none below the line is missing, but for those that rounding may put on either side.
    for (const Complex s : rest) {
      EXPECT_GT(SecularFunction::height_of(s), spectrum.height - 1e-6 * largest) << seed;
    }
  }
  // The others are almost jammed: B_C S Sᵀ B_Eᵀ is singular but for rounding.
  EXPECT_GT(num_complete, 0.99 * num_pencils);
}

TEST(SecularEigenvalues, EqualBodiesThatFrictionDrivesApartGrowAlike) {
  // Each alone: s² + 1 and s² + 100 under one contact whose friction falls with the velocity,
  // H = −h along b: real eigenvalues far to the right of all poles, as many as there are bodies.
  const auto bodies = [](int count) {
    const Eigen::Index n = 3 * count;
    Pencil pencil;
    pencil.omega.resize(n);
    pencil.damping = Eigen::VectorXd::Zero(n);
    pencil.ports = Eigen::MatrixXd::Zero(2 * count, n);
    pencil.compatibility = Eigen::MatrixXd::Zero(count, 2 * count);
    for (int i = 0; i < count; ++i) {
      pencil.omega.segment(3 * i, 3) << 1.0, 4.0, 10.0;
      pencil.ports.block(2 * i, 3 * i, 2, 3) << 1.0, 0.4, 0.7, 0.3, -1.0, 0.6;
      pencil.compatibility(i, 2 * i) = 1.0;
    }
    pencil.equilibrium = pencil.compatibility;
    pencil.port_damping = Eigen::MatrixXd::Zero(2 * count, 2 * count);
    for (int i = 0; i < count; ++i) pencil.port_damping(2 * i + 1, 2 * i + 1) = -1e4;
    return pencil;
  };
  const auto one = secular_eigenvalues(bodies(1), SpectrumWindow::lowest(1));
  ASSERT_EQ(one[1].s.imag(), 0.0);
  const double fastest = one[1].s.real();
  EXPECT_GT(fastest, 1e3);
  for (const int count : {2, 3}) {
    const auto all = secular_eigenvalues(bodies(count), SpectrumWindow::lowest(1));
    EXPECT_EQ(std::count_if(all.begin(), all.end(),
                            [&](const Eigenvalue& found) {
                              return std::abs(found.s - fastest) < 1e-4 * fastest;
                            }),
              count);
  }
}

TEST(SecularEigenvalues, ABodyThatIsFreeHasEigenvaluesOfZero) {
  // Two rigid modes, of which the contact holds one combination.
  const Eigen::VectorXd omega{{0.0, 0.0, 3.0, 50.0}};
  const Eigen::MatrixXd rows{{1.0, 2.0, 0.5, 0.1}};
  for (const double friction : {0.0, 0.3}) {
    const Pencil pencil =
        test::constrained_modes(omega, Eigen::VectorXd::Zero(4), rows,
                                rows + friction * Eigen::MatrixXd{{0.2, -0.1, 0.3, 0.4}});
    const auto found = secular_eigenvalues(pencil, SpectrumWindow::all());
    const auto dense = dense_eigenvalues(pencil);
    EXPECT_EQ(count_below(found, 1000.0), count_below(dense, 1000.0));
    // A double zero comes out to the root of the rounding, real or as a pair.
    EXPECT_LT(std::abs(found.front().s), 1e-7 * 3.0);
    EXPECT_NEAR(std::abs(found.back().s), std::abs(dense.back().s), 1e-9);
  }
}

class PaperSpectrum : public ::testing::TestWithParam<double> {
 protected:
  static Pencil at(double position, double friction) {
    const System& system = model().system;
    Pencil pencil = make_modal_pencil(system);
    place_undeformed(pencil, system, position - 0.030, friction, 1.0);
    return pencil;
  }
  static const Model& model() {
    static const Model trailing = test::make_paper_model(test::paper_model());
    static const Model leading = test::make_paper_model(test::paper_model(test::leading_angle));
    return GetParam() == test::trailing_angle ? trailing : leading;
  }
};

INSTANTIATE_TEST_SUITE_P(BothScenes, PaperSpectrum,
                         ::testing::Values(test::trailing_angle, test::leading_angle),
                         [](const auto& scene) {
                           return scene.param == test::trailing_angle ? "Trailing" : "Leading";
                         });

struct Expected {
  double position;
  std::vector<std::pair<double, double>> lowest;    ///< growth 1/s and frequency Hz
  std::vector<std::pair<double, double>> unstable;  ///< below 12 kHz
};

TEST_P(PaperSpectrum, HasTheKnownEigenvalues) {
  // From an independent calculation with all modes and μ = 0.3, printed to the digits shown.
  const std::vector<Expected> trailing{
      {0.048,
       {{-15.28, 40.13},
        {-5.60, 141.92},
        {-13.24, 288.88},
        {-20.25, 792.16},
        {-7.13, 1120.30},
        {-16.77, 1562.40}},
       {{20.40, 10572.2}}},
      {0.0955,
       {{-5.85, 24.79}, {-12.19, 191.85}, {-12.04, 289.45}, {-18.51, 738.73}, {-8.65, 1290.80}},
       {{41.79, 6950.6}}},
      {0.0565, {}, {}}};
  const std::vector<Expected> leading{
      {0.048,
       {{-15.46, 40.23},
        {-6.55, 160.38},
        {-10.26, 290.50},
        {-20.19, 790.72},
        {-8.63, 1097.20},
        {-15.86, 1563.95}},
       {{6.79, 10556.4}}},
      {0.0565, {{-13.36, 37.43}, {-7.93, 173.83}, {-11.21, 289.96}}, {}}};
  for (const Expected& expected : GetParam() == test::trailing_angle ? trailing : leading) {
    const auto found = secular_eigenvalues(at(expected.position, 0.3), SpectrumWindow::below(12e3));
    ASSERT_GE(found.size(), expected.lowest.size());
    for (std::size_t i = 0; i < expected.lowest.size(); ++i) {
      EXPECT_NEAR(found[i].growth(), expected.lowest[i].first, 0.0051);
      EXPECT_NEAR(found[i].frequency(), expected.lowest[i].second, 0.0051);
    }
    std::vector<Eigenvalue> unstable;
    for (const Eigenvalue& eigenvalue : found) {
      EXPECT_LT(eigenvalue.residual, 1e-12);
      if (eigenvalue.growth() > 0.0) unstable.push_back(eigenvalue);
    }
    ASSERT_EQ(unstable.size(), expected.unstable.size()) << "at " << expected.position;
    for (std::size_t i = 0; i < unstable.size(); ++i) {
      EXPECT_NEAR(unstable[i].growth(), expected.unstable[i].first, 0.0051);
      EXPECT_NEAR(unstable[i].frequency(), expected.unstable[i].second, 0.051);
    }
  }
}

TEST_P(PaperSpectrum, AgreesWithTheDenseOneAtRandomPositionsAndFriction) {
  // With the modes above 60 kHz as residual, so that the dense method takes milliseconds; all
  // modes are compared in tests/verification/.
  std::mt19937 engine(20);
  std::uniform_real_distribution<double> position(0.0005, 0.0995);
  std::uniform_real_distribution<double> friction(0.0, 2.0);
  for (int i = 0; i < 40; ++i) {
    Pencil pencil =
        with_residual_modes(at(position(engine), friction(engine)), 2.0 * std::numbers::pi * 60e3);
    if (i % 2 == 1) pencil.damping.setZero();
    const auto dense = dense_eigenvalues(pencil, DenseWork::eigenvalues);
    SecularFunction function(pencil);
    const SecularSpectrum lowest = secular_spectrum(function, SpectrumWindow::lowest(20));
    EXPECT_TRUE(lowest.is_complete);
    EXPECT_EQ(count_below(dense, lowest.height), lowest.num_counted);
    EXPECT_LT(largest_difference(lowest.eigenvalues, dense), 1e-8);
  }
}

TEST_P(PaperSpectrum, WithoutFrictionNothingGrows) {
  for (const double position : {0.0113, 0.048, 0.0955}) {
    const Pencil pencil = at(position, 0.0);
    const auto found = secular_eigenvalues(pencil, SpectrumWindow::lowest(40));
    EXPECT_EQ(found.size(), 40);
    for (const Eigenvalue& eigenvalue : found) EXPECT_LT(eigenvalue.growth(), 0.0);
    Pencil undamped = pencil;
    undamped.damping.setZero();
    for (const Eigenvalue& eigenvalue : secular_eigenvalues(undamped, SpectrumWindow::lowest(40))) {
      EXPECT_NEAR(eigenvalue.growth(), 0.0, 100 * eps * std::abs(eigenvalue.s));
    }
  }
}

TEST(SecularEigenvalues, ModesThatTheContactDoesNotFeelStayWhatTheyAre) {
  // Mode 2 has b_C = 0, mode 3 b_E = 0; both leave f, and are eigenvalues by themselves.
  Eigen::VectorXd omega(5);
  omega << 1.0, 2.0, 3.0, 4.0, 5.0;
  Eigen::RowVectorXd compatibility(5), equilibrium(5);
  compatibility << 1.0, 0.0, 0.7, 1.2, 0.4;
  equilibrium << 0.8, 0.5, 0.0, 1.0, 0.6;
  const double c = 0.02;
  const Pencil pencil =
      test::constrained_modes(omega, Eigen::VectorXd::Constant(5, c), compatibility, equilibrium);
  const auto all = secular_eigenvalues(pencil, SpectrumWindow::all());
  ASSERT_EQ(all.size(), 4);
  for (const double own : {2.0, 3.0}) {
    const Complex pole(-0.5 * c, std::sqrt(own * own - 0.25 * c * c));
    const auto nearest = std::min_element(all.begin(), all.end(), [&](auto& a, auto& b) {
      return std::abs(a.s - pole) < std::abs(b.s - pole);
    });
    EXPECT_LT(std::abs(nearest->s - pole), 4 * eps * own);
  }
  EXPECT_LT(largest_difference(all, dense_eigenvalues(pencil)), 1e-12);
  // A mode that is felt very little is displaced very little.
  Pencil weak = pencil;
  weak.compatibility(0, 1) = 1e-13;
  const auto displaced = secular_eigenvalues(weak, SpectrumWindow::all());
  EXPECT_LT(largest_difference(displaced, all), 1e-12);
}

TEST(SecularEigenvalues, TwinBodiesKeepTheirCommonFrequencies) {
  // Two equal sets of modes in one contact: each frequency remains as the motion in which the
  // contact does not take part, and the set as a whole behaves as one body with the sum of weights.
  Eigen::VectorXd omega(6), twins(12);
  omega << 1.0, 1.7, 2.9, 4.1, 5.3, 7.7;
  Eigen::RowVectorXd row(6), both(12);
  row << 1.0, -0.8, 0.6, 0.9, -1.1, 0.5;
  twins << omega, omega;
  both << row, -1.5 * row;
  const Eigen::VectorXd damping = 0.01 * omega;
  Eigen::VectorXd both_damping(12);
  both_damping << damping, damping;
  const Pencil single = test::constrained_modes(omega, damping, row, row);
  const Pencil pair = test::constrained_modes(twins, both_damping, both, both);
  auto expected = secular_eigenvalues(single, SpectrumWindow::all());
  for (Eigen::Index i = 0; i < 6; ++i) {
    const double half = 0.5 * damping(i);
    expected.push_back({Complex(-half, std::sqrt(omega(i) * omega(i) - half * half)), 0.0});
  }
  const auto found = secular_eigenvalues(pair, SpectrumWindow::all());
  ASSERT_EQ(found.size(), expected.size());
  EXPECT_LT(largest_difference(found, expected), 1e-13);
  // Almost equal: the same to that accuracy.
  Pencil almost = pair;
  almost.omega.tail(6) *= 1.0 + 1e-9;
  const auto close = secular_eigenvalues(almost, SpectrumWindow::all());
  ASSERT_EQ(close.size(), expected.size());
  EXPECT_LT(largest_difference(close, expected), 1e-8);
}

TEST(SecularEigenvalues, TwinBodiesInTwoContactsMoveOnTheirOwn) {
  // Equal frequencies, other rows: both contacts take part in every motion. With poles 1e-13 apart,
  // multiplying out one of a pair only would leave no digits.
  Pencil pencil = test::random_pencil(9, 12, 2, test::ContactTerms::rows_only);
  for (const double detuning : {0.0, 1e-13, 1e-9, 1e-6}) {
    pencil.omega.tail(6) = (1.0 + detuning) * pencil.omega.head(6);
    pencil.damping.tail(6) = pencil.damping.head(6);
    const auto found = secular_eigenvalues(pencil, SpectrumWindow::all());
    const auto dense = dense_eigenvalues(pencil, DenseWork::eigenvalues);
    ASSERT_EQ(found.size(), dense.size());
    EXPECT_LT(largest_difference(found, dense, 1.0), 1e-10) << detuning;
    for (const Eigenvalue& eigenvalue : found) EXPECT_LT(eigenvalue.residual, 1e-11);
  }
}

TEST(SecularEigenvalues, WithoutContactTheModes) {
  Pencil pencil = test::two_masses({4.0, 9.0}, {0.1, 8.0});
  const auto found = secular_eigenvalues(pencil, SpectrumWindow::all());
  ASSERT_EQ(found.size(), 3);
  // s² + 8 s + 9 = 0 is overdamped.
  EXPECT_NEAR(found[0].s.real(), -4.0 - std::sqrt(7.0), 100 * eps);
  EXPECT_NEAR(found[1].s.real(), -4.0 + std::sqrt(7.0), 100 * eps);
  EXPECT_EQ(found[1].s.imag(), 0.0);
  EXPECT_LT(std::abs(found[2].s - Complex(-0.05, std::sqrt(4.0 - 0.0025))), 100 * eps);
}

TEST(SecularEigenvalues, OverdampedModesAreFoundOnTheRealAxis) {
  for (unsigned seed = 0; seed < 8; ++seed) {
    Pencil pencil = test::random_pencil(seed, 16, 1, test::ContactTerms::rows_only);
    pencil.damping.array() += 0.02 * pencil.omega.array().square();  // overdamped from 100 rad/s
    const auto dense = dense_eigenvalues(pencil, DenseWork::eigenvalues);
    const auto num_real = std::count_if(dense.begin(), dense.end(),
                                        [](auto& found) { return found.s.imag() == 0.0; });
    const auto all = secular_eigenvalues(pencil, SpectrumWindow::all());
    ASSERT_EQ(all.size(), dense.size()) << "seed " << seed;
    EXPECT_EQ(
        std::count_if(all.begin(), all.end(), [](auto& found) { return found.s.imag() == 0.0; }),
        num_real);
    // Damping of up to 2e4 1/s is the largest entry.
    EXPECT_LT(largest_difference(all, dense, 1.0), 1e-8) << "seed " << seed;
    // All real ones belong to every window.
    const auto lowest = secular_eigenvalues(pencil, SpectrumWindow::lowest(2));
    EXPECT_EQ(lowest.size(), static_cast<std::size_t>(num_real) + 2);
  }
}

TEST(SecularEigenvalues, AMeetingOfTwoIsFoundAsTwo) {
  // K = [[2, 1 − 4μ/3], [1, 2]] of Hoffmann's model: s² = −2 ± √(1 − 4μ/3), double at μ = 0.75.
  Pencil pencil = test::two_masses({2.0, 2.0}, {0.0, 0.0});
  for (const double friction : {0.5, 0.75 - 1e-9, 0.75, 0.75 + 1e-9, 0.9}) {
    pencil.port_stiffness = Eigen::Matrix2d{{0.0, 1.0 - 4.0 * friction / 3.0}, {1.0, 0.0}};
    const auto found = secular_eigenvalues(pencil, SpectrumWindow::all());
    ASSERT_EQ(found.size(), 2) << friction;
    const Complex root = std::sqrt(Complex(1.0 - 4.0 * friction / 3.0, 0.0));
    std::vector<Eigenvalue> expected;
    for (const double sign : {-1.0, 1.0}) {
      Complex s = std::sqrt(-2.0 + sign * root);
      if (s.imag() < 0.0) s = -s;
      expected.push_back({s, 0.0});
    }
    // A double zero is known to the root of the rounding.
    EXPECT_LT(largest_difference(found, expected), friction == 0.75 ? 1e-7 : 1e-11) << friction;
  }
}

TEST(SecularEigenvalues, WindowsCutTheSpectrumWhereTheySay) {
  const Pencil pencil = test::random_pencil(11, 30, 1, test::ContactTerms::rows_only);
  const auto all = secular_eigenvalues(pencil, SpectrumWindow::all());
  const auto same = [](const std::vector<Eigenvalue>& found, const std::vector<Eigenvalue>& of,
                       std::size_t size) {
    EXPECT_EQ(found.size(), size);
    return found.size() == size &&
           largest_difference(found, {of.begin(), of.begin() + static_cast<std::ptrdiff_t>(size)}) <
               1e-12;
  };
  EXPECT_TRUE(same(secular_eigenvalues(pencil, SpectrumWindow::lowest(5)), all, 5));
  EXPECT_TRUE(same(secular_eigenvalues(pencil, SpectrumWindow::lowest(1000)), all, all.size()));
  const double between = 0.5 * (all[9].frequency() + all[10].frequency());
  EXPECT_TRUE(same(secular_eigenvalues(pencil, SpectrumWindow::below(between)), all, 10));
  EXPECT_TRUE(same(secular_eigenvalues(pencil, {4, between}), all, 4));
  EXPECT_TRUE(same(secular_eigenvalues(pencil, {20, between}), all, 10));
  EXPECT_TRUE(same(secular_eigenvalues(pencil, SpectrumWindow::below(1e9)), all, all.size()));
  for (std::size_t i = 1; i < all.size(); ++i) EXPECT_LE(all[i - 1].s.imag(), all[i].s.imag());
}

TEST(SecularEigenvalues, EmptyWindowsAreRefused) {
  const Pencil pencil = test::random_pencil(11, 30, 1, test::ContactTerms::rows_only);
  EXPECT_EQ(message_of<std::invalid_argument>(
                [&] { secular_eigenvalues(pencil, SpectrumWindow::lowest(0)); }),
            "secular eigenvalues: 0 eigenvalues are none");
  EXPECT_EQ(message_of<std::invalid_argument>(
                [&] { secular_eigenvalues(pencil, SpectrumWindow::below(-1.0)); }),
            "secular eigenvalues: no eigenvalues below -1 Hz");
  EXPECT_EQ(message_of<std::invalid_argument>(
                [&] { secular_eigenvalues(Pencil{}, SpectrumWindow::all()); }),
            "pencil: 0 constraints leave nothing of 0 modes");
}

TEST(SecularEigenvalues, LowestOnesAreFoundBesideStronglyDampedHighModes) {
  // Damping in proportion to stiffness, as of a fine mesh: ζ of the highest mode from 0.5 to 2.
  constexpr Eigen::Index n = 200;
  Eigen::VectorXd omega(n);
  Eigen::MatrixXd row(1, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto x = static_cast<double>(i);
    omega(i) = 500.0 * std::pow(1.0 + x, 1.9);
    row(0, i) = std::sin(1.0 + 2.7 * x);
  }
  const Eigen::MatrixXd forces = row + 0.3 * row.reverse();
  for (const double ratio : {0.5, 0.6, 0.7, 0.72, 0.8, 0.9, 1.0, 1.3, 2.0}) {
    const double beta = 2.0 * ratio / omega(n - 1);
    const Pencil pencil =
        test::constrained_modes(omega, beta * omega.array().square().matrix(), row, forces);
    SecularFunction function(pencil);
    const SecularSpectrum spectrum = secular_spectrum(function, SpectrumWindow::lowest(10));
    ASSERT_TRUE(spectrum.is_complete) << ratio;
    if (ratio < 1.0) {
      EXPECT_LT(spectrum.evaluations, 4000) << ratio;
    }
    std::vector<Eigenvalue> dense;
    for (const Eigenvalue& one : dense_eigenvalues(pencil, DenseWork::eigenvalues))
      if (one.s.imag() > 0.0) dense.push_back(one);
    std::vector<Eigenvalue> found;
    for (const Eigenvalue& one : spectrum.eigenvalues)
      if (one.s.imag() > 0.0) found.push_back(one);
    ASSERT_EQ(found.size(), 10u) << ratio;
    for (std::size_t i = 0; i < 10; ++i)
      EXPECT_LT(std::abs(found[i].s - dense[i].s), 1e-12 * omega(n - 1)) << ratio << ", " << i;
  }
}

TEST(SecularEigenvalues, SaysWhereThereAreFewerThanThereShouldBe) {
  // f = 1/(s² + 1) − 1/(s² + 4) has no zeros: the contact jams, and one pair is at infinity.
  const Pencil jammed =
      test::constrained_modes(Eigen::Vector3d(1, 2, 3), Eigen::Vector3d::Zero(),
                              Eigen::RowVector3d(1, 1, 0), Eigen::RowVector3d(1, -1, 0));
  EXPECT_THAT(
      message_of<NumericalError>([&] { secular_eigenvalues(jammed, SpectrumWindow::all()); }),
      HasSubstr("the search for 4 eigenvalues did not converge; use the dense method"));
}

}  // namespace
}  // namespace stridor
