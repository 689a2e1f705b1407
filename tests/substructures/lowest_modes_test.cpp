#include "substructures/reduction/lowest_modes.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <limits>
#include <stdexcept>
#include <vector>

#include "core/errors.hpp"
#include "tests/support/full_model.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/paper_beams.hpp"
#include "tests/support/spring_chain.hpp"

namespace stridor {
namespace {

using test::eps;
using test::message_of;
using testing::HasSubstr;

Modes modes_of(const SparseMatrix& stiffness, const SparseMatrix& mass, Eigen::Index count) {
  return lowest_modes(SparseCholesky(stiffness, "the stiffness"), stiffness, mass, count);
}

/// Interior of a beam of the paper: what its fixed-interface modes are found from.
struct Interior {
  SparseMatrix stiffness, mass;
};
Interior oblique_interior(double angle) {
  const BodyMatrices body = make_beam(test::paper_oblique(angle));
  const std::vector<int> interior = test::interior_dofs(body, test::slave_interface(body));
  return {test::submatrix(body.stiffness, interior), test::submatrix(body.mass, interior)};
}
Interior cantilever_interior() {
  const BodyMatrices body = make_beam(test::paper_cantilever());
  const std::vector<int> interior = test::interior_dofs(body, test::master_interface(body));
  return {test::submatrix(body.stiffness, interior), test::submatrix(body.mass, interior)};
}
std::vector<Interior> paper_interiors() {
  std::vector<Interior> interiors;
  interiors.push_back(oblique_interior(test::trailing_angle));
  interiors.push_back(oblique_interior(test::leading_angle));
  interiors.push_back(cantilever_interior());
  return interiors;
}

TEST(LowestModes, AreThoseOfTheSpringChainInClosedForm) {
  // 30 masses go to the dense solver, 200 to Lanczos. Backward error n eps λ_max, λ_max <= 4; the
  // inverse that Lanczos works with has the same relative accuracy, n eps cond of the lowest.
  for (const int n : {30, 200}) {
    const Modes modes = modes_of(test::chain_stiffness(n), test::chain_mass(n), 8);
    ASSERT_EQ(modes.omega_squared.size(), 8);
    for (int j = 1; j <= 8; ++j) {
      EXPECT_NEAR(modes.omega_squared(j - 1), test::chain_omega_squared(n, j), 4.0 * n * eps)
          << n << " masses, mode " << j;
    }
  }
}

TEST(LowestModes, NoneIsMissedOfTheBeamsOfThePaper) {
  for (const Interior& interior : paper_interiors()) {
    const Eigen::VectorXd all =
        test::dense_spectrum(Eigen::MatrixXd(interior.stiffness), Eigen::MatrixXd(interior.mass));
    const Modes modes = modes_of(interior.stiffness, interior.mass, 20);
    ASSERT_EQ(modes.omega_squared.size(), 20);
    // The dense solver is the less accurate one: its error is n eps of the largest eigenvalue times
    // the condition of the mass matrix. Neighbours are farther apart than that.
    const double tolerance = static_cast<double>(all.size()) * eps * all(all.size() - 1) *
                             test::condition_number(Eigen::MatrixXd(interior.mass));
    for (Eigen::Index i = 0; i < 20; ++i) {
      EXPECT_NEAR(modes.omega_squared(i), all(i), tolerance) << "mode " << i + 1;
      EXPECT_GT(all(i + 1) - all(i), 4.0 * tolerance) << "the test would not see a missed mode";
    }
  }
}

TEST(LowestModes, EveryModeSolvesItsEquation) {
  for (const Interior& interior : paper_interiors()) {
    const Modes modes = modes_of(interior.stiffness, interior.mass, 20);
    for (Eigen::Index i = 0; i < 20; ++i) {
      const Eigen::VectorXd force = interior.stiffness * modes.shapes.col(i);
      const Eigen::VectorXd residual =
          force - modes.omega_squared(i) * (interior.mass * modes.shapes.col(i));
      EXPECT_LE(residual.norm(), 1e-6 * force.norm()) << "mode " << i + 1;
    }
  }
}

TEST(LowestModes, AreAscendingAndMassNormalised) {
  for (const Interior& interior : paper_interiors()) {
    const Modes modes = modes_of(interior.stiffness, interior.mass, 20);
    const Eigen::MatrixXd product = modes.shapes.transpose() * interior.mass * modes.shapes;
    // Normalised by its own product: diagonal to rounding of an n-term sum. Lanczos works to 1e-12,
    // which bounds what is left between two modes, over their relative distance (> 1e-2 here).
    const double n = static_cast<double>(interior.mass.rows());
    EXPECT_LE((product.diagonal().array() - 1.0).abs().maxCoeff(), n * eps);
    EXPECT_LE((product - Eigen::MatrixXd::Identity(20, 20)).cwiseAbs().maxCoeff(), 1e-10);
    for (Eigen::Index i = 1; i < 20; ++i)
      EXPECT_GT(modes.omega_squared(i), modes.omega_squared(i - 1));
  }
}

TEST(LowestModes, LargestEntryOfAShapeIsPositive) {
  for (const int n : {30, 200}) {
    const Modes modes = modes_of(test::chain_stiffness(n), test::chain_mass(n), 6);
    for (Eigen::Index i = 0; i < 6; ++i) {
      Eigen::Index largest = 0;
      modes.shapes.col(i).cwiseAbs().maxCoeff(&largest);
      EXPECT_GT(modes.shapes(largest, i), 0.0);
    }
  }
}

TEST(LowestModes, AreTheSameEveryTime) {
  const Interior interior = cantilever_interior();
  const Modes first = modes_of(interior.stiffness, interior.mass, 20);
  const Modes second = modes_of(interior.stiffness, interior.mass, 20);
  EXPECT_EQ(first.omega_squared, second.omega_squared);
  EXPECT_EQ(first.shapes, second.shapes);
}

TEST(LowestModes, DoubleEigenvaluesAreFoundTwice) {
  // Two equal chains side by side: every eigenvalue occurs twice.
  const int n = 100;
  SparseMatrix stiffness(2 * n, 2 * n);
  std::vector<Eigen::Triplet<double>> entries;
  const SparseMatrix chain = test::chain_stiffness(n);
  for (Eigen::Index column = 0; column < chain.outerSize(); ++column) {
    for (SparseMatrix::InnerIterator entry(chain, column); entry; ++entry) {
      entries.emplace_back(entry.row(), entry.col(), entry.value());
      entries.emplace_back(n + entry.row(), n + entry.col(), entry.value());
    }
  }
  stiffness.setFromTriplets(entries.begin(), entries.end());
  const Modes modes = modes_of(stiffness, test::chain_mass(2 * n), 8);
  for (int i = 0; i < 8; ++i) {
    EXPECT_NEAR(modes.omega_squared(i), test::chain_omega_squared(n, i / 2 + 1), 8.0 * n * eps)
        << "mode " << i + 1;
  }
}

TEST(LowestModes, AllModesCanBeAsked) {
  for (const int n : {1, 12, 90}) {
    const Modes modes = modes_of(test::chain_stiffness(n), test::chain_mass(n), n);
    ASSERT_EQ(modes.omega_squared.size(), n);
    for (int j = 1; j <= n; ++j)
      EXPECT_NEAR(modes.omega_squared(j - 1), test::chain_omega_squared(n, j), 4.0 * n * eps);
  }
}

TEST(LowestModes, ClusterThatOutgrowsTheKrylovSpaceIsResolved) {
  // Ground springs of 10 move all eigenvalues of the chain up and leave their distances, of which
  // the smallest is 3e-6 of the eigenvalue: the space is filled and restarted several times.
  const int n = 1500;
  SparseMatrix ground(n, n);
  ground.setIdentity();
  const SparseMatrix stiffness = test::chain_stiffness(n) + 10.0 * ground;
  const Modes modes = modes_of(stiffness, test::chain_mass(n), 4);
  for (int j = 1; j <= 4; ++j) {
    EXPECT_NEAR(modes.omega_squared(j - 1), 10.0 + test::chain_omega_squared(n, j),
                4.0 * 14.0 * n * eps)
        << "mode " << j;
  }
}

TEST(LowestModes, EigenvalueOfEveryMultiplicityIsCounted) {
  // One eigenvalue for all: each Krylov space ends at its first block, and others must follow.
  const int n = 200;
  const SparseMatrix mass = test::chain_mass(n);
  const Modes modes = modes_of(2.0 * mass, mass, 20);
  EXPECT_LE((modes.omega_squared.array() - 2.0).abs().maxCoeff(), n * eps);
  EXPECT_LE((modes.shapes.transpose() * modes.shapes - Eigen::MatrixXd::Identity(20, 20)).norm(),
            n * eps);
}

TEST(LowestModes, FineMeshesAreNotRefusedForTheRoundingOfTheirForces) {
  // Neighbouring displacements of 4,000 columns differ so little that K φ is known to 1e-6 of
  // itself at best. The frequencies are those of a coarse mesh, which bends as exactly.
  std::vector<Eigen::VectorXd> squares;
  for (const int along : {50, 4000}) {
    BeamParameters beam = test::paper_oblique();
    beam.mesh = {along, 1};
    const BodyMatrices body = make_beam(beam);
    const std::vector<int> interior = test::interior_dofs(body, test::slave_interface(body));
    squares.push_back(
        modes_of(test::submatrix(body.stiffness, interior), test::submatrix(body.mass, interior), 4)
            .omega_squared);
  }
  for (Eigen::Index i = 0; i < 4; ++i) {
    EXPECT_LT(squares[1](i), squares[0](i));
    EXPECT_NEAR(squares[1](i), squares[0](i), 0.01 * squares[0](i));
  }
}

TEST(LowestModes, CountOfZeroGivesNone) {
  const Modes modes = modes_of(test::chain_stiffness(5), test::chain_mass(5), 0);
  EXPECT_EQ(modes.omega_squared.size(), 0);
  EXPECT_EQ(modes.shapes.rows(), 5);
  EXPECT_EQ(modes.shapes.cols(), 0);
}

TEST(LowestModes, CountOutOfRangeThrows) {
  EXPECT_EQ(message_of<std::invalid_argument>(
                [] { modes_of(test::chain_stiffness(5), test::chain_mass(5), 6); }),
            "lowest_modes: 6 modes asked of 5 DoFs");
  EXPECT_EQ(message_of<std::invalid_argument>(
                [] { modes_of(test::chain_stiffness(5), test::chain_mass(5), -1); }),
            "lowest_modes: -1 modes asked of 5 DoFs");
}

TEST(LowestModes, NegativeMassThrows) {
  const SparseMatrix mass = -test::chain_mass(200);
  EXPECT_EQ(message_of<NumericalError>([&] { modes_of(test::chain_stiffness(200), mass, 5); }),
            "fixed-interface modes: the mass is not positive definite");
}

TEST(LowestModes, MassThatIsNotANumberThrows) {
  SparseMatrix mass = test::chain_mass(200);
  mass.coeffRef(7, 7) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(message_of<NumericalError>([&] { modes_of(test::chain_stiffness(200), mass, 5); }),
            "fixed-interface modes: Lanczos found 0 of 5 eigenpairs");
}

TEST(LowestModes, FactorOfAnotherMatrixThrows) {
  // Lanczos then finds the modes of the factor, and the check of the residuals must see it.
  const SparseMatrix stiffness = test::chain_stiffness(200);
  const SparseCholesky other(2.0 * stiffness, "another stiffness");
  EXPECT_THAT(
      message_of<NumericalError>([&] { lowest_modes(other, stiffness, test::chain_mass(200), 5); }),
      HasSubstr("fixed-interface modes: eigenpair 1 has a residual of"));
}

}  // namespace
}  // namespace stridor
