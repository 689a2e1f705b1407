// Bodies of which some motions have no mass, against what is condensed by hand.
#include "substructures/matrices/massless_motions.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <numbers>
#include <numeric>

#include "core/errors.hpp"
#include "substructures/bodies/whole_body.hpp"
#include "substructures/matrices/definiteness.hpp"
#include "substructures/reduction/craig_bampton.hpp"
#include "substructures/reduction/lowest_modes.hpp"
#include "substructures/reduction/modal_body.hpp"
#include "tests/support/message_of.hpp"

namespace stridor {
namespace {

using test::message_of;
using ::testing::HasSubstr;

/// A fixed chain of `count` masses m with a massless joint between neighbours and at both ends, on
/// springs 2k: the joints make springs k of them. Unknowns: joint, mass, joint, ..., mass, joint.
struct JointedChain {
  Eigen::Index count;
  double mass = 2.0, stiffness = 3e4;

  Eigen::Index size() const { return 2 * count + 1; }
  BodyMatrices body() const {
    const auto n = static_cast<int>(size());
    std::vector<Eigen::Triplet<double>> masses, springs;
    for (int i = 1; i < n; i += 2) masses.emplace_back(i, i, mass);
    for (int i = 0; i < n; ++i) {
      springs.emplace_back(i, i, 4.0 * stiffness);
      if (i + 1 == n) continue;
      springs.emplace_back(i, i + 1, -2.0 * stiffness);
      springs.emplace_back(i + 1, i, -2.0 * stiffness);
    }
    BodyMatrices body;
    body.mass.resize(n, n);
    body.stiffness.resize(n, n);
    body.mass.setFromTriplets(masses.begin(), masses.end());
    body.stiffness.setFromTriplets(springs.begin(), springs.end());
    return body;
  }
  /// ω² = 4 k/m sin²(jπ/(2(n + 1))) of the chain of springs k, j from 1.
  double square(Eigen::Index j) const {
    const double angle = 0.5 * std::numbers::pi * static_cast<double>(j) / static_cast<double>(count + 1);
    return 4.0 * stiffness / mass * std::pow(std::sin(angle), 2);
  }
};

TEST(MasslessMotions, FollowTheOthersAtRest) {
  const JointedChain chain{4};
  const BodyMatrices body = chain.body();
  const Eigen::MatrixXd K = body.stiffness;
  const SemidefinitePairs pairs = semidefinite_eigenpairs(K, Eigen::MatrixXd(body.mass), "chain");
  ASSERT_EQ(pairs.values.size(), 4);
  for (Eigen::Index j = 0; j < 4; ++j)
    EXPECT_NEAR(pairs.values(j), chain.square(j + 1), 1e-12 * chain.square(4));
  EXPECT_EQ(pairs.massless.cols(), 5);
  EXPECT_LE((pairs.massless.transpose() * K * pairs.massless - Eigen::MatrixXd::Identity(5, 5)).norm(),
            1e-12);
  // Joints stand in the middle between their neighbours.
  for (Eigen::Index j = 0; j < 4; ++j) {
    const auto x = pairs.vectors.col(j);
    EXPECT_NEAR(x(2), 0.5 * (x(1) + x(3)), 1e-13);
    EXPECT_NEAR(x.dot(body.mass * x), 1.0, 1e-12);
  }
}

// Rounding that makes M slightly indefinite, or definite by chance so that its Cholesky factor
// exists, moves nothing.
TEST(MasslessMotions, DoNotDependOnRoundingOfTheMass) {
  const JointedChain chain{4};
  const BodyMatrices body = chain.body();
  Eigen::MatrixXd turn = Eigen::MatrixXd::Identity(9, 9);
  for (int i = 0; i < 9; ++i)
    for (int j = 0; j < 9; ++j) turn(i, j) += 0.3 * std::sin(1.0 + 3.0 * i + 7.0 * j);
  const Eigen::MatrixXd K = turn.transpose() * body.stiffness * turn;
  const Eigen::MatrixXd M = turn.transpose() * body.mass * turn;
  for (const double error : {-1e-13, 0.0, 1e-15, 1e-13}) {
    const Eigen::MatrixXd mass = M + error * Eigen::MatrixXd(M.diagonal().asDiagonal());
    const SemidefinitePairs pairs = semidefinite_eigenpairs(K, mass, "chain");
    ASSERT_EQ(pairs.values.size(), 4) << error;
    for (Eigen::Index j = 0; j < 4; ++j) {
      // The massless part of 1e-13 is left out, which is as large an error of a mass.
      EXPECT_NEAR(pairs.values(j) / chain.square(j + 1), 1.0, 1e-10) << error;
    }
  }
}

TEST(MasslessMotions, AreRefusedWhereNothingHoldsThem) {
  const Eigen::Matrix2d mass = Eigen::Vector2d(1.0, 0.0).asDiagonal();
  EXPECT_THAT(message_of<NumericalError>([&] {
                semidefinite_eigenpairs(Eigen::Vector2d(5.0, 0.0).asDiagonal().toDenseMatrix(), mass,
                                        "modes");
              }),
              HasSubstr("modes: some motion has neither mass nor stiffness"));
  const Eigen::Matrix2d negative{{1.0, 1.1}, {1.1, 1.0}};
  EXPECT_THAT(message_of<NumericalError>([&] {
                semidefinite_eigenpairs(Eigen::Matrix2d::Identity(), negative, "modes");
              }),
              HasSubstr("the mass is not positive semidefinite; scaled to a unit diagonal its least "
                        "eigenvalue is -0.1"));
}

TEST(Definiteness, TellsRoundingFromANegativeMass) {
  const SparseMatrix mass = JointedChain{3}.body().mass;
  EXPECT_TRUE(is_positive_semidefinite(mass));
  EXPECT_EQ(smallest_pivot_ratio(mass), 0.0);
  const Eigen::Matrix2d singular{{1.0, 1.0}, {1.0, 1.0}};
  const auto sparse = [](const Eigen::Matrix2d& matrix) -> SparseMatrix { return matrix.sparseView(); };
  EXPECT_TRUE(is_positive_semidefinite(sparse(singular - 1e-13 * Eigen::Matrix2d::Identity())));
  EXPECT_FALSE(is_positive_semidefinite(sparse(singular - 1e-8 * Eigen::Matrix2d::Identity())));
  EXPECT_FALSE(is_positive_semidefinite(sparse(Eigen::Matrix2d{{1.0, 0.5}, {0.5, 0.0}})));
  EXPECT_NEAR(smallest_pivot_ratio(sparse(Eigen::Matrix2d{{4.0, 1.0}, {1.0, 1.0}})), 0.75, 1e-15);
}

TEST(MasslessMotions, OfALargeInteriorLeaveItsLowestModes) {
  const JointedChain chain{100};
  const BodyMatrices body = chain.body();
  const SparseCholesky factor(body.stiffness, "the stiffness");
  const Modes modes = lowest_modes(factor, body.stiffness, body.mass, 8);
  for (Eigen::Index j = 0; j < 8; ++j)
    EXPECT_NEAR(modes.omega_squared(j) / chain.square(j + 1), 1.0, 1e-10);
}

TEST(MasslessMotions, LimitTheNumberOfModes) {
  const BodyMatrices body = JointedChain{4}.body();
  const SparseCholesky factor(body.stiffness, "the stiffness");
  EXPECT_EQ(lowest_modes(factor, body.stiffness, body.mass, 4).omega_squared.size(), 4);
  EXPECT_THAT(message_of<NumericalError>(
                  [&] { lowest_modes(factor, body.stiffness, body.mass, 5); }),
              HasSubstr("5 asked, but only 4 of the 9 motions of the interior have mass"));
}

TEST(MasslessMotions, OfACraigBamptonInteriorGiveTheFrequenciesOfTheWhole) {
  const JointedChain chain{6};
  const std::vector<int> interface{6, 7};  // a joint, which has no mass of its own, and a mass
  const ReducedBody reduced = make_craig_bampton(chain.body(), interface, 5, interface);
  const ModalBody modal = make_modal(reduced);
  // All motions with mass are there: one is a constraint mode.
  for (Eigen::Index j = 0; j < 6; ++j)
    EXPECT_NEAR(std::pow(modal.omega(j), 2) / chain.square(j + 1), 1.0, 1e-10);
}

TEST(MasslessMotions, KeepTheirFlexibilityInModes) {
  const JointedChain chain{3};
  const BodyMatrices body = chain.body();
  const std::vector<int> watched{0, 3, 4};
  const ModalBody modal = make_modal(make_whole(body, watched));
  // Two joints are watched: two modes stand for them.
  ASSERT_EQ(modal.size(), 5);
  for (Eigen::Index j = 0; j < 3; ++j)
    EXPECT_NEAR(std::pow(modal.omega(j), 2) / chain.square(j + 1), 1.0, 1e-12);
  const Eigen::MatrixXd flexibility = modal.rows *
                                      modal.omega.array().square().inverse().matrix().asDiagonal() *
                                      modal.rows.transpose();
  const Eigen::MatrixXd whole = Eigen::MatrixXd(body.stiffness).inverse();
  for (Eigen::Index i = 0; i < 3; ++i) {
    for (Eigen::Index j = 0; j < 3; ++j) {
      EXPECT_NEAR(flexibility(i, j),
                  whole(watched[static_cast<std::size_t>(i)], watched[static_cast<std::size_t>(j)]),
                  1e-13 * whole.norm());
    }
  }
}

}  // namespace
}  // namespace stridor
