#include "analysis/followed_spectra.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

namespace stridor {
namespace {

using Complex = std::complex<double>;

constexpr int num_oscillators = 120;
constexpr double damping = 0.02;

/// Squares of the frequencies of oscillators: the tenth moves through two others.
double square_of(int i, double value) {
  return i == 9 ? 11.0 + 4.0 * value : 1.5 + 2.0 * i;
}

/// A diagonal matrix in coordinates that a reflection mixes, so that all entries are there.
SparseMatrix mixed(const Eigen::VectorXd& diagonal, double turn = 0.0) {
  Eigen::VectorXd axis(num_oscillators);
  for (int i = 0; i < num_oscillators; ++i) axis(i) = std::sin(1.0 + i * (1.0 + turn));
  axis.normalize();
  const Eigen::MatrixXd mirror =
      Eigen::MatrixXd::Identity(num_oscillators, num_oscillators) - 2.0 * axis * axis.transpose();
  return (mirror * diagonal.asDiagonal() * mirror).sparseView(1.0, 0.0);
}

/// These oscillators in mixed coordinates.
SparseSystem oscillators(double value, double turn = 0.0) {
  Eigen::VectorXd squares(num_oscillators);
  for (int i = 0; i < num_oscillators; ++i) squares(i) = square_of(i, value);
  SparseSystem system;
  for (SparseMatrix* matrix : {&system.mass, &system.velocity})
    matrix->resize(num_oscillators, num_oscillators);
  system.mass.setIdentity();
  system.velocity.setIdentity();
  system.velocity *= damping;
  system.position = mixed(squares, turn);
  return system;
}

/// s² + c s + ω² = 0.
std::vector<Complex> expected_below(double height, double value) {
  std::vector<Complex> expected;
  for (int i = 0; i < num_oscillators; ++i) {
    const Complex s(-0.5 * damping, std::sqrt(square_of(i, value) - 0.25 * damping * damping));
    if (s.imag() <= height) expected.push_back(s);
  }
  std::ranges::sort(expected, {}, [](Complex s) { return s.imag(); });
  return expected;
}

void expect_spectrum(const SampledSpectrum& found, double height, double value) {
  const std::vector<Complex> expected = expected_below(height, value);
  ASSERT_EQ(found.eigenvalues.size(), expected.size()) << value;
  for (std::size_t i = 0; i < expected.size(); ++i)
    EXPECT_LT(std::abs(found.eigenvalues[i] - expected[i]), 1e-9) << value << ' ' << expected[i];
}

TEST(FollowedSpectra, OneThatLeavesTheWindowOrPassesOthersIsNoReasonToSearch) {
  // The edge lies between the squares 13.5 and 15.5; the one that moves crosses it at 0.875.
  const double height = std::sqrt(14.5);
  FollowedSpectra spectra(SpectrumWindow::below(height / (2.0 * std::numbers::pi)));
  for (int i = 0; i <= 20; ++i) {
    const double value = 0.0503 * i;
    const SampledSpectrum found = spectra.at(value, oscillators(value));
    EXPECT_EQ(found.is_counted, i == 0);
    expect_spectrum(found, height, value);
  }
  EXPECT_EQ(spectra.num_searched(), 1);
  EXPECT_EQ(spectra.num_followed(), 20);
  EXPECT_EQ(expected_below(height, 0.0).size(), 8U);
  EXPECT_EQ(expected_below(height, 1.0).size(), 7U);
}

TEST(FollowedSpectra, OneThatCameFromNowhereTakesAWholeSearch) {
  const double height = std::sqrt(14.5);
  FollowedSpectra spectra(SpectrumWindow::below(height / (2.0 * std::numbers::pi)));
  expect_spectrum(spectra.at(0.0, oscillators(0.0)), height, 0.0);
  // Far from the first value, far within the window: the tenth is at the square 1.
  expect_spectrum(spectra.at(-2.5, oscillators(-2.5)), height, -2.5);
  // Far above it: seven are found where eight were.
  expect_spectrum(spectra.at(30.0, oscillators(30.0)), height, 30.0);
  EXPECT_EQ(spectra.num_searched(), 2);
  EXPECT_TRUE(spectra.at(30.0, oscillators(30.0)).is_counted);
}

TEST(FollowedSpectra, CoordinatesMayChangeWithTheValueButNotTheirNumber) {
  const double height = std::sqrt(14.5);
  FollowedSpectra spectra(SpectrumWindow::below(height / (2.0 * std::numbers::pi)));
  for (const double value : {0.0, 0.1, 0.3})
    expect_spectrum(spectra.at(value, oscillators(value, 3.0 * value)), height, value);
  EXPECT_EQ(spectra.num_searched(), 1);
  SparseSystem other;
  for (SparseMatrix* matrix : {&other.mass, &other.velocity, &other.position}) {
    matrix->resize(2, 2);
    matrix->setIdentity();
  }
  other.velocity *= damping;
  EXPECT_EQ(spectra.at(0.4, other).eigenvalues.size(), 2U);
  EXPECT_EQ(spectra.num_searched(), 2);
}

TEST(FollowedSpectra, ACountIsKeptWhereOneLeavesTheWindow) {
  FollowedSpectra spectra(SpectrumWindow::lowest(12));
  for (const double value : {0.0, 0.2, 0.4, 0.6, 0.8}) {
    const SampledSpectrum found = spectra.at(value, oscillators(value));
    ASSERT_GE(found.eigenvalues.size(), 12U) << value;
    const std::vector<Complex> expected = expected_below(10.0, value);
    for (std::size_t i = 0; i < 12; ++i)
      EXPECT_LT(std::abs(found.eigenvalues[i] - expected[i]), 1e-9) << value;
  }
}

/// Of alike bodies: the same oscillators several times, and one that moves.
SparseSystem copies(int num_copies, double value) {
  SparseSystem system = oscillators(value);
  Eigen::VectorXd squares(num_oscillators);
  for (int i = 0; i < num_oscillators; ++i) {
    squares(i) = i == num_oscillators - 1 ? 10.0 + 0.1 * value : 1.5 + 2.0 * (i / num_copies);
  }
  system.position = mixed(squares);
  return system;
}

TEST(FollowedSpectra, NoneOfThoseThatCoincideIsLost) {
  const double height = std::sqrt(24.5);  // twelve levels
  for (const int num_copies : {2, 4, 6}) {
    FollowedSpectra spectra(SpectrumWindow::below(height / (2.0 * std::numbers::pi)));
    for (int i = 0; i <= 8; ++i) {
      const double value = 0.05 * i;
      EXPECT_EQ(spectra.at(value, copies(num_copies, value)).eigenvalues.size(),
                static_cast<std::size_t>(12 * num_copies + 1))
          << num_copies << ' ' << value;
    }
  }
}

/// Two oscillators are damped beyond vibration, and one has no stiffness but what the value takes.
SparseSystem with_real_eigenvalues(double value) {
  SparseSystem system = oscillators(value);
  Eigen::VectorXd squares(num_oscillators), rates(num_oscillators);
  for (int i = 0; i < num_oscillators; ++i) {
    squares(i) = 1.5 + 2.0 * i;
    rates(i) = damping;
  }
  squares(0) = 0.0;
  rates(0) = 0.0;
  rates(1) = 8.0;
  rates(2) = 7.5;
  squares(3) = -1.0 - value;
  system.velocity = mixed(rates);
  system.position = mixed(squares);
  return system;
}

TEST(FollowedSpectra, RealEigenvaluesAreRealAndRigidMotionsDoNotGrow) {
  const double height = std::sqrt(24.5);
  FollowedSpectra spectra(SpectrumWindow::below(height / (2.0 * std::numbers::pi)));
  for (int k = 0; k <= 6; ++k) {
    const double value = 0.1 * k;
    const SampledSpectrum found = spectra.at(value, with_real_eigenvalues(value));
    int num_real = 0, num_growing = 0, num_vibrating = 0;
    for (std::size_t i = 0; i < found.eigenvalues.size(); ++i) {
      const Complex s = found.eigenvalues[i];
      num_real += s.imag() == 0.0 && std::abs(s) > 1e-5 ? 1 : 0;
      num_vibrating += s.imag() > 1e-5 ? 1 : 0;
      num_growing += s.real() > found.rounding[i] ? 1 : 0;
    }
    // Of s² + 8 s + 3.5 and s² + 7.5 s + 5.5 the slow ones lie in the window; s² + 0.02 s − 1 − v
    // has two.
    EXPECT_EQ(num_real, 4) << value;
    EXPECT_EQ(num_growing, 1) << value;
    EXPECT_EQ(num_vibrating, 8) << value;  // squares 9.5 to 23.5
  }
  EXPECT_LE(spectra.num_searched(), 2);
}

}  // namespace
}  // namespace stridor
