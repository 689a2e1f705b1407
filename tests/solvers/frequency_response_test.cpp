#include "solvers/eigenvalues/frequency_response.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <complex>
#include <stdexcept>

#include "solvers/eigenvalues/residual_modes.hpp"
#include "tests/support/pencils.hpp"
#include "tests/support/relative_difference.hpp"

namespace stridor {
namespace {

using namespace test;
using Complex = std::complex<double>;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

constexpr Complex i_unit{0.0, 1.0};

/// [P(s) B_Eᵀ; B_C −c] of all modes and multipliers.
Eigen::MatrixXcd whole_matrix(const Pencil& pencil, Complex s) {
  const Eigen::Index n = pencil.num_modes();
  const Eigen::Index k = pencil.num_constraints();
  Eigen::MatrixXcd matrix = Eigen::MatrixXcd::Zero(n + k, n + k);
  matrix.topLeftCorner(n, n) = dynamic_stiffness(pencil, s);
  matrix.topRightCorner(n, k) = (pencil.equilibrium * pencil.ports).transpose().cast<Complex>();
  matrix.bottomLeftCorner(k, n) = (pencil.compatibility * pencil.ports).cast<Complex>();
  if (pencil.compliance.size() > 0)
    matrix.bottomRightCorner(k, k).diagonal() = -pencil.compliance.cast<Complex>();
  return matrix;
}

Eigen::MatrixXcd whole_response(const Pencil& pencil, const Eigen::MatrixXd& loads,
                                const Eigen::MatrixXd& sensors, Complex s) {
  const Eigen::Index n = pencil.num_modes();
  Eigen::MatrixXcd right = Eigen::MatrixXcd::Zero(n + pencil.num_constraints(), loads.rows());
  right.topRows(n) = loads.transpose().cast<Complex>();
  return sensors.cast<Complex>() * whole_matrix(pencil, s).fullPivLu().solve(right).topRows(n);
}

Eigen::MatrixXd some_rows(Eigen::Index count, Eigen::Index n, double phase) {
  return Eigen::MatrixXd::NullaryExpr(count, n, [&](Eigen::Index i, Eigen::Index j) {
    return std::sin(phase + 1.3 * static_cast<double>(i) + 0.7 * static_cast<double>(j));
  });
}

double difference(const Eigen::MatrixXcd& a, const Eigen::MatrixXcd& b) {
  return (a - b).norm() / b.norm();
}

TEST(FrequencyResponse, OneMassAnswersAsItsClosedForm) {
  const Pencil mass = two_masses({400.0, 900.0}, {0.8, 1.5});
  const Eigen::MatrixXd row = Eigen::RowVector2d(1.0, 0.0);
  const FrequencyResponse response(mass, row, row);
  for (const double omega : {0.0, 3.0, 19.99, 20.0, 20.01, 500.0}) {
    const Complex expected = 1.0 / (400.0 - omega * omega + i_unit * omega * 0.8);
    EXPECT_LT(std::abs(response.at(i_unit * omega)(0, 0) - expected), 1e-14 * std::abs(expected));
  }
}

TEST(FrequencyResponse, TwoMassesThatAContactKeepsTogetherMoveAsOne) {
  // u₁ = u₂: masses 1 + 1, stiffness 400 + 900.
  Pencil pair = two_masses({400.0, 900.0}, {0.0, 0.0});
  pair.compatibility = Eigen::RowVector2d(1.0, -1.0);
  pair.equilibrium = pair.compatibility;
  const Eigen::MatrixXd rows = Eigen::Matrix2d::Identity();
  const FrequencyResponse response(pair, rows, rows);
  // At the resonance of either mass by itself too, where 1/(s² + ω²) is infinite.
  for (const double omega : {0.0, 20.0, 25.0, 30.0, 70.0}) {
    const double expected = 1.0 / (1300.0 - 2.0 * omega * omega);
    const Eigen::MatrixXcd h = response.at(i_unit * omega);
    for (const Complex one : h.reshaped())
      EXPECT_LT(std::abs(one - expected), 1e-13 * std::abs(expected)) << omega;
  }
}

class RandomResponses : public ::testing::TestWithParam<unsigned> {};

TEST_P(RandomResponses, AreThoseOfTheWholeMatrix) {
  const Pencil pencil = awkward_pencil(GetParam());
  const Eigen::MatrixXd loads = some_rows(2, pencil.num_modes(), 0.1);
  const Eigen::MatrixXd sensors = some_rows(3, pencil.num_modes(), 0.9);
  const FrequencyResponse response(pencil, loads, sensors);
  for (const double omega : {0.7, 11.0, 97.0, 1300.0}) {
    const Eigen::MatrixXcd whole = whole_response(pencil, loads, sensors, i_unit * omega);
    EXPECT_LT(difference(response.at(i_unit * omega), whole), 1e-8) << omega << " rad/s";
  }
  // On and beside the pole of a mode.
  for (const double beside : {1.0, 1.0 + 1e-9, 1.0 + 1e-5}) {
    const Complex s = i_unit * (beside * pencil.omega(0));
    if (std::abs(s) < 1e-3) continue;
    const Eigen::MatrixXcd whole = whole_response(pencil, loads, sensors, s);
    // A mode without damping that no contact feels is infinite at its frequency.
    if (!response.at(s).allFinite()) {
      EXPECT_FALSE(whole_matrix(pencil, s).fullPivLu().isInvertible()) << beside;
      continue;
    }
    EXPECT_LT(difference(response.at(s), whole), 1e-7) << beside;
  }
}

INSTANTIATE_TEST_SUITE_P(Seeds, RandomResponses, ::testing::Range(0u, 30u));

TEST(FrequencyResponse, FrictionTakesReciprocityAwayAndNothingElseDoes) {
  Pencil pencil = random_pencil(3, 20, 2, ContactTerms::rows_only);
  const Eigen::MatrixXd rows = some_rows(2, 20, 0.4);
  const auto asymmetry = [&] {
    const Eigen::MatrixXcd h = FrequencyResponse(pencil, rows, rows).at(i_unit * 55.0);
    return std::abs(h(0, 1) - h(1, 0)) / h.norm();
  };
  EXPECT_GT(asymmetry(), 1e-3);
  pencil.equilibrium = pencil.compatibility;
  EXPECT_LT(asymmetry(), 1e-12);
}

TEST(FrequencyResponse, SpringsInContactsGiveWay) {
  Pencil pencil = random_pencil(5, 15, 2, ContactTerms::with_stiffness);
  pencil.compliance = Eigen::Vector2d(1e-4, 0.0);
  const Eigen::MatrixXd rows = some_rows(2, 15, 0.4);
  const FrequencyResponse response(pencil, rows, rows);
  for (const double omega : {5.0, 300.0}) {
    EXPECT_LT(difference(response.at(i_unit * omega),
                         whole_response(pencil, rows, rows, i_unit * omega)),
              1e-9);
  }
}

TEST(FrequencyResponse, ResidualModesKeepTheAnswerBelowTheCutoffAtAddedPorts) {
  const Pencil pencil = random_pencil(7, 60, 1, ContactTerms::with_stiffness);
  const Eigen::MatrixXd rows = some_rows(2, 60, 0.4);
  constexpr double cutoff = 200.0;
  const Pencil few = with_residual_modes(with_ports(pencil, rows), cutoff);
  ASSERT_LT(few.num_modes(), 60);
  const Eigen::MatrixXd few_rows = added_ports(few, 2);
  const FrequencyResponse all(pencil, rows, rows);
  const FrequencyResponse kept(few, few_rows, few_rows);
  // The first term left out is of the order of (ω/cutoff)⁴.
  EXPECT_LT(difference(kept.at(i_unit * 10.0), all.at(i_unit * 10.0)), 1e-4);
  EXPECT_LT(difference(kept.at(i_unit * 50.0), all.at(i_unit * 50.0)), 1e-2);
}

TEST(FrequencyResponse, AddedPortsChangeNothingOfTheMotion) {
  const Pencil pencil = random_pencil(9, 12, 1, ContactTerms::with_stiffness_and_damping);
  const Eigen::MatrixXd rows = some_rows(2, 12, 0.4);
  const Pencil wide = with_ports(pencil, rows);
  EXPECT_EQ(added_ports(wide, 2), rows);
  EXPECT_LT(difference(FrequencyResponse(wide, rows, rows).at(i_unit * 20.0),
                       FrequencyResponse(pencil, rows, rows).at(i_unit * 20.0)),
            1e-13);
}

TEST(FrequencyResponse, RefusesRowsOfAnotherLength) {
  const Pencil mass = two_masses({400.0, 900.0}, {0.8, 1.5});
  EXPECT_THAT([&] { FrequencyResponse(mass, some_rows(1, 3, 0.0), some_rows(1, 2, 0.0)); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("do not fit the modes")));
}

}  // namespace
}  // namespace stridor
