#include "solvers/eigenvalues/sparse_spectrum.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/errors.hpp"
#include "solvers/eigenvalues/dense_eigenvalues.hpp"
#include "solvers/eigenvalues/linear_pencil.hpp"
#include "tests/support/elastic_pads.hpp"
#include "tests/support/message_of.hpp"

namespace stridor {
namespace {

using test::message_of;
using Complex = std::complex<double>;

test::ElasticPads small_pads() {
  test::ElasticPads pads;
  pads.along = 6;
  pads.through = 2;
  pads.nodal_diameters = 4;
  return pads;
}

LinearSystem dense(const SparseSystem& sparse) {
  const Eigen::Index n = sparse.size();
  return {Eigen::MatrixXd(sparse.mass), Eigen::MatrixXd(sparse.velocity),
          Eigen::MatrixXd(sparse.position), Eigen::MatrixXd(0, n), Eigen::MatrixXd(0, n)};
}

/// A system with the same eigenvalues whose P and Q are full: reflected, (1 − 2 w wᵀ) A (1 − 2 w
/// wᵀ).
SparseSystem reflected(const SparseSystem& system) {
  const Eigen::VectorXd w = Eigen::VectorXd::LinSpaced(system.size(), 1.0, 2.0).normalized();
  const Eigen::MatrixXd turn =
      Eigen::MatrixXd::Identity(w.size(), w.size()) - 2.0 * w * w.transpose();
  const auto turned = [&](const SparseMatrix& matrix) -> SparseMatrix {
    return (turn * Eigen::MatrixXd(matrix) * turn).sparseView(1.0, 0.0);
  };
  SparseSystem full;
  full.mass = turned(system.mass);
  full.velocity = turned(system.velocity);
  full.position = turned(system.position);
  return full;
}

class SparsePencilTest : public testing::TestWithParam<bool> {};

INSTANTIATE_TEST_SUITE_P(Matrices, SparsePencilTest, testing::Bool(),
                         [](const auto& test) { return test.param ? "Full" : "Sparse"; });

TEST_P(SparsePencilTest, FactorSolvesAndKnowsItsDeterminant) {
  const SparseSystem system = GetParam() ? reflected(small_pads().system()) : small_pads().system();
  ASSERT_EQ(is_full(system.position), GetParam());
  const SparsePencil pencil(system);
  const Complex s(300.0, 2e4);
  const SparseFactor factor = pencil.factorise(s);
  const Eigen::MatrixXcd P = s * s * Eigen::MatrixXcd(dense(system).mass.cast<Complex>()) +
                             s * Eigen::MatrixXcd(dense(system).velocity.cast<Complex>()) +
                             Eigen::MatrixXcd(dense(system).position.cast<Complex>());
  const Eigen::MatrixXcd x = Eigen::MatrixXcd::Random(system.size(), 3);
  EXPECT_LT((factor.solve(P * x) - x).norm(), 1e-8 * x.norm());
  EXPECT_LT((factor.solve_adjoint(P.adjoint() * x) - x).norm(), 1e-8 * x.norm());
  EXPECT_LT((pencil.multiply(s, x.col(0)) - P * x.col(0)).norm(), 1e-13 * P.norm() * x.norm());
  // The determinant from another factorisation, pivot by pivot.
  const Eigen::PartialPivLU<Eigen::MatrixXcd> lu(P);
  Complex phase = static_cast<double>(lu.permutationP().determinant());
  double size = 0.0;
  for (const Complex& pivot : lu.matrixLU().diagonal()) {
    phase *= pivot / std::abs(pivot);
    size += std::log(std::abs(pivot));
  }
  const Complex logarithm = factor.log_determinant();
  EXPECT_LT(std::abs(std::polar(1.0, logarithm.imag()) - phase), 1e-9);
  EXPECT_NEAR(logarithm.real(), size, 1e-9 * std::abs(size));
  // The slope is the difference quotient.
  const Complex t(-100.0, 1e4);
  EXPECT_LT(((pencil.multiply(t, x.col(0)) - pencil.multiply(s, x.col(0))) / (t - s) -
             pencil.slope(s, t, x.col(0)))
                .norm(),
            1e-11 * pencil.slope(s, t, x.col(0)).norm());
}

TEST(SparsePencil, PairsOfFullMatricesAreThoseOfTheSameSystemInOtherCoordinates) {
  const SparseSystem system = small_pads().system();
  const SparseSpectrum wanted = sparse_spectrum(system, SpectrumWindow::below(8000.0));
  int factorisations = 0;
  TwoSidedPairs guesses = wanted.pairs;
  for (Complex& entry : guesses.right.reshaped())
    entry = {1.0, entry.imag()};  // no vectors of these
  const TwoSidedPairs found = pairs_near(reflected(system), guesses, wanted.rectangle.height,
                                         factorisations, SpectrumWork::Sides::right);
  std::vector<Complex> inside;
  for (const Complex& s : found.s)
    if (wanted.rectangle.contains(s)) inside.push_back(s);
  ASSERT_EQ(inside.size(), wanted.eigenvalues.size());
  for (std::size_t i = 0; i < inside.size(); ++i)
    EXPECT_LT(std::abs(inside[i] - wanted.eigenvalues[i].s), 1e-9 * std::abs(inside[i]));
}

/// The unstable system of the disc with elastic pads against all eigenvalues of the dense problem.
TEST(SparseSpectrum, FindsWhatTheDenseProblemHasBelowAFrequency) {
  const SparseSystem system = small_pads().system();
  const SparseSpectrum found = sparse_spectrum(system, SpectrumWindow::below(8000.0));
  std::vector<Complex> expected;
  for (const Eigenvalue& one :
       dense_eigenvalues(make_pencil(dense(system)), DenseWork::eigenvalues))
    if (found.rectangle.contains(one.s)) expected.push_back(one.s);
  EXPECT_TRUE(found.is_complete);
  EXPECT_EQ(found.num_counted, static_cast<int>(2 * expected.size()));  // none is real
  ASSERT_EQ(found.eigenvalues.size(), expected.size());
  EXPECT_GT(expected.size(), 10U);
  int num_growing = 0;
  for (std::size_t i = 0; i < expected.size(); ++i) {
    const Eigenvalue& one = found.eigenvalues[i];
    // The dense method has an absolute error of the highest frequency, 3e7 rad/s, times rounding.
    EXPECT_LT(std::abs(one.s - expected[i]), 1e-5) << one.frequency();
    EXPECT_LT(found.backward_errors[i], 1e-12);
    EXPECT_LT(one.residual, 1e-8);
    num_growing += one.growth() > 0.0 ? 1 : 0;
  }
  EXPECT_GE(num_growing, 4);
}

TEST(SparseSpectrum, FindsTheLowestWhereACountIsAsked) {
  const SparseSystem system = small_pads().system();
  const SparseSpectrum found = sparse_spectrum(system, SpectrumWindow::lowest(7));
  EXPECT_TRUE(found.is_complete);
  ASSERT_GE(found.eigenvalues.size(), 7U);
  const auto all = dense_eigenvalues(make_pencil(dense(system)), DenseWork::eigenvalues);
  for (std::size_t i = 0; i < 7; ++i) EXPECT_LT(std::abs(found.eigenvalues[i].s - all[i].s), 1e-5);
}

TEST(SparseSpectrum, TellsCoincidingEigenvaluesApart) {
  // Two equal chains side by side, undamped: every eigenvalue is double and on the axis.
  constexpr int n = 200;
  std::vector<Eigen::Triplet<double>> entries;
  for (int chain = 0; chain < 2; ++chain) {
    for (int i = 0; i < n; ++i) {
      const int at = chain * n + i;
      entries.emplace_back(at, at, 2.0);
      if (i + 1 < n) {
        entries.emplace_back(at, at + 1, -1.0);
        entries.emplace_back(at + 1, at, -1.0);
      }
    }
  }
  SparseSystem system;
  system.mass.resize(2 * n, 2 * n);
  system.mass.setIdentity();
  system.velocity.resize(2 * n, 2 * n);
  system.position.resize(2 * n, 2 * n);
  system.position.setFromTriplets(entries.begin(), entries.end());
  const auto omega = [](int k) { return 2.0 * std::sin(0.5 * k * std::numbers::pi / (n + 1.0)); };
  const double between = 0.5 * (omega(10) + omega(11)) / (2.0 * std::numbers::pi);
  const SparseSpectrum found = sparse_spectrum(system, SpectrumWindow::below(between));
  EXPECT_TRUE(found.is_complete);
  ASSERT_EQ(found.eigenvalues.size(), 20U);
  for (int k = 0; k < 20; ++k) {
    const Complex s = found.eigenvalues[static_cast<std::size_t>(k)].s;
    EXPECT_LT(std::abs(s - Complex(0.0, omega(k / 2 + 1))), 1e-10) << k;
  }
}

/// A chain of n masses and springs with free ends.
SparseSystem free_chain(int n) {
  std::vector<Eigen::Triplet<double>> entries;
  for (int i = 0; i + 1 < n; ++i) {
    for (const int k : {i, i + 1}) entries.emplace_back(k, k, 1.0);
    entries.emplace_back(i, i + 1, -1.0);
    entries.emplace_back(i + 1, i, -1.0);
  }
  SparseSystem system;
  system.mass.resize(n, n);
  system.mass.setIdentity();
  system.velocity.resize(n, n);
  system.position.resize(n, n);
  system.position.setFromTriplets(entries.begin(), entries.end());
  return system;
}

TEST(SparseSpectrum, FreeChainHasItsRigidMotionTwice) {
  constexpr int n = 300;
  const auto omega = [](int k) { return 2.0 * std::sin(0.5 * k * std::numbers::pi / n); };
  const double between = 0.5 * (omega(12) + omega(13)) / (2.0 * std::numbers::pi);
  const SparseSpectrum found = sparse_spectrum(free_chain(n), SpectrumWindow::below(between));
  EXPECT_TRUE(found.is_complete);
  EXPECT_EQ(found.num_counted, 26);  // s = 0 is double, the rest are pairs
  // The root of a rounding of eps |K|: 3e-8.
  std::size_t first = 0;
  while (std::abs(found.eigenvalues[first].s) < 1e-6) ++first;
  ASSERT_EQ(found.eigenvalues.size() - first, 12U);
  for (std::size_t k = first; k < found.eigenvalues.size(); ++k) {
    const Complex expected(0.0, omega(static_cast<int>(k - first) + 1));
    EXPECT_LT(std::abs(found.eigenvalues[k].s - expected), 1e-9) << k;
  }
}

/// Between two masses of a chain lies a node without mass: two springs in series, half as stiff.
TEST(SparseSpectrum, NodesWithoutMassCondense) {
  constexpr int n = 299;  // DoFs, every other one without mass, between held ends
  SparseSystem system;
  std::vector<Eigen::Triplet<double>> stiffness, mass;
  for (int i = 0; i < n; ++i) {
    stiffness.emplace_back(i, i, 4.0);
    if (i + 1 < n) stiffness.emplace_back(i, i + 1, -2.0);
    if (i + 1 < n) stiffness.emplace_back(i + 1, i, -2.0);
    if (i % 2 == 1) mass.emplace_back(i, i, 1.0);
  }
  for (SparseMatrix* matrix : {&system.mass, &system.velocity, &system.position})
    matrix->resize(n, n);
  system.mass.setFromTriplets(mass.begin(), mass.end());
  system.position.setFromTriplets(stiffness.begin(), stiffness.end());
  const auto omega = [](int k) { return 2.0 * std::sin(0.5 * k * std::numbers::pi / 150.0); };
  const double between = 0.5 * (omega(9) + omega(10)) / (2.0 * std::numbers::pi);
  const SparseSpectrum found = sparse_spectrum(system, SpectrumWindow::below(between));
  EXPECT_TRUE(found.is_complete);
  ASSERT_EQ(found.eigenvalues.size(), 9U);
  for (int k = 0; k < 9; ++k) {
    EXPECT_LT(
        std::abs(found.eigenvalues[static_cast<std::size_t>(k)].s - Complex(0.0, omega(k + 1))),
        1e-10)
        << k;
  }
}

/// Most of the cost of a count are factorisations.
TEST(SparseSpectrum, FewFactorisationsFindAndCountAll) {
  const SparseSystem system = small_pads().system();
  const SparseSpectrum found = sparse_spectrum(system, SpectrumWindow::below(8000.0));
  EXPECT_TRUE(found.is_complete);
  EXPECT_LE(found.factorisations, 40);
}

TEST(SparseSpectrum, PairsOfBothSidesAreThoseOfTheMatrices) {
  test::ElasticPads pads = small_pads();
  const SpectrumWork work{SpectrumWork::Sides::both, nullptr};
  const SparseSpectrum found = sparse_spectrum(pads.system(), SpectrumWindow::below(8000.0), work);
  pads.friction = 0.4;
  const SparseSystem other = pads.system();
  int factorisations = 0;
  const TwoSidedPairs near =
      pairs_near(other, found.pairs, found.rectangle.height, factorisations);
  EXPECT_LE(factorisations, 3);
  const SparseSpectrum whole = sparse_spectrum(other, SpectrumWindow::below(8000.0));
  const SparsePencil pencil(other);
  std::size_t num_within = 0;
  for (std::size_t i = 0; i < near.s.size(); ++i) {
    const Eigen::VectorXcd x = near.right.col(static_cast<Eigen::Index>(i));
    EXPECT_LT(pencil.scaled_residual(near.s[i], x), 1e-7);
    if (near.s[i].imag() > found.rectangle.height) continue;
    ASSERT_LT(num_within, whole.eigenvalues.size());
    EXPECT_LT(std::abs(near.s[i] - whole.eigenvalues[num_within].s), 1e-9 * std::abs(near.s[i]));
    ++num_within;
    // A left vector sees nothing of the other pairs: yᴴ P'(s) x is of its own.
    const Eigen::VectorXcd y = near.left.col(static_cast<Eigen::Index>(i));
    EXPECT_GT(std::abs(y.dot(pencil.slope(near.s[i], near.s[i], x))), 0.0);
  }
  EXPECT_EQ(num_within, whole.eigenvalues.size());
}

TEST(SparseSpectrum, RejectsWhatItCannotSolve) {
  SparseSystem system = small_pads().system();
  EXPECT_EQ(
      message_of<std::invalid_argument>([&] { sparse_spectrum(system, SpectrumWindow::all()); }),
      "sparse eigenvalues: the window is neither a count nor a frequency");
  system.velocity = SparseMatrix(3, 3);
  EXPECT_EQ(message_of<std::invalid_argument>([&] { SparsePencil{system}; }),
            "sparse pencil: the matrices differ in size");
  system = small_pads().system();
  system.mass = -system.mass;
  EXPECT_THROW(sparse_spectrum(system, SpectrumWindow::below(1000.0)), NumericalError);
}

}  // namespace
}  // namespace stridor
