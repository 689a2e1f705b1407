#include "solvers/decoupling.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <random>
#include <unsupported/Eigen/MatrixFunctions>

#include "solvers/exponential_propagator.hpp"
#include "solvers/port_rows.hpp"
#include "tests/support/face_contacts.hpp"

namespace stridor {
namespace {

Eigen::MatrixXd random_matrix(Eigen::Index rows, Eigen::Index cols, unsigned seed) {
  std::mt19937 generator(seed);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  return Eigen::MatrixXd::NullaryExpr(rows, cols, [&] { return uniform(generator); });
}

DiscModel decoupled_brake() {
  DiscModelParameters brake = test::with_elastic_pads(test::squealing_brake());
  return make_disc_model(brake);
}

TEST(Decoupling, SpinningPlateFallsIntoPairsAndPadsIntoModes) {
  const LinearSystem bodies = decoupled_brake().bodies;
  const DecoupledSystem apart = decouple(bodies);
  const Eigen::Index n = bodies.size();
  Eigen::Index pairs = 0, single = 0, next = 0;
  for (const CoordinateGroup& group : apart.groups) {
    EXPECT_EQ(group.first, next);
    next += group.size;
    (group.size == 1 ? single : pairs) += 1;
    EXPECT_LE(group.size, 2);
  }
  EXPECT_EQ(next, n);
  EXPECT_EQ(pairs, 6);  // nodal diameters 1 to 6; 0 is alone
  EXPECT_EQ(single, n - 12);
  const Eigen::MatrixXd& T = apart.motion;
  EXPECT_LT((apart.inverse * T - Eigen::MatrixXd::Identity(n, n)).norm(), 1e-10);
  const auto error = [&](const Eigen::MatrixXd& of_q, const Eigen::MatrixXd& of_z) {
    return (T.transpose() * of_q * T - of_z).norm() / of_z.norm();
  };
  EXPECT_LT(error(bodies.mass, apart.system.mass), 1e-12);
  EXPECT_LT(error(bodies.velocity, apart.system.velocity), 1e-12);
  EXPECT_LT(error(bodies.position, apart.system.position), 1e-12);
}

TEST(Decoupling, WhatIsCoupledStaysTogether) {
  // Coordinates 0, 2 and 4 are coupled by damping that is not proportional, 1 and 3 by stiffness.
  LinearSystem system;
  system.mass = Eigen::MatrixXd::Identity(5, 5);
  system.velocity = system.position = Eigen::MatrixXd::Zero(5, 5);
  system.position.diagonal() << 1.0, 2.0, 3.0, 4.0, 5.0;
  system.position(1, 3) = system.position(3, 1) = -1.0;
  system.velocity(0, 2) = system.velocity(2, 0) = system.velocity(4, 4) = 0.1;
  system.velocity(2, 4) = 1e-9;
  system.gaps = system.forces = Eigen::MatrixXd(0, 5);
  const DecoupledSystem apart = decouple(system);
  ASSERT_EQ(apart.groups.size(), 3U);
  EXPECT_EQ(apart.groups[0].size, 3);
  EXPECT_EQ(apart.groups[1].size, 1);
  EXPECT_EQ(apart.groups[2].size, 1);
  EXPECT_EQ(apart.system.velocity(1, 2), 1e-9);
  EXPECT_NEAR(apart.system.position(3, 3), 3.0 - std::sqrt(2.0), 1e-14);
}

TEST(Decoupling, PropagationOfGroupsIsThatOfTheWhole) {
  const LinearSystem bodies = decoupled_brake().bodies;
  const Eigen::Index n = bodies.size();
  constexpr double step = 1e-6;
  const ExponentialPropagator propagator(bodies, step);
  // exp(A h) of all coordinates at once, velocities over h as in the propagator.
  const Eigen::PartialPivLU<Eigen::MatrixXd> mass(bodies.mass);
  Eigen::MatrixXd generator = Eigen::MatrixXd::Zero(2 * n, 2 * n);
  generator.topRightCorner(n, n).setIdentity();
  generator.bottomLeftCorner(n, n) = -step * step * mass.solve(bodies.position);
  generator.bottomRightCorner(n, n) = -step * mass.solve(bodies.velocity);
  const Eigen::MatrixXd whole = generator.exp();
  Eigen::VectorXd q = random_matrix(n, 1, 1), v = random_matrix(n, 1, 2) / step;
  Eigen::VectorXd state(2 * n);
  state << q, step * v;
  for (int i = 0; i < 100; ++i) {
    propagator.advance(q, v);
    state = whole * state;
  }
  EXPECT_LT((q - state.head(n)).norm(), 1e-10 * state.norm());
  EXPECT_LT((step * v - state.tail(n)).norm(), 1e-10 * state.norm());
}

TEST(PaddedMatrix, ProductsAreThoseOfTheDenseMatrix) {
  for (const auto& [rows, cols] :
       {std::pair{1, 1}, {3, 7}, {8, 8}, {31, 2}, {33, 5}, {75, 55}, {150, 75}}) {
    const Eigen::MatrixXd matrix = random_matrix(rows, cols, 3);
    const Eigen::VectorXd x = random_matrix(cols, 1, 4);
    Eigen::VectorXd y = Eigen::VectorXd::Ones(static_cast<Eigen::Index>(padded_size(rows)));
    PaddedMatrix(matrix).add_product(x.data(), y.data());
    const Eigen::VectorXd expected = Eigen::VectorXd::Ones(rows) + matrix * x;
    EXPECT_LT((y.head(rows) - expected).lpNorm<Eigen::Infinity>(), 1e-13) << rows << ' ' << cols;
    EXPECT_EQ(y.tail(8), Eigen::VectorXd::Ones(8)) << rows << ' ' << cols;
  }
}

TEST(GroupDiagonal, IsTheDenseMatrixWithinGroups) {
  const std::vector<CoordinateGroup> groups{{0, 1}, {1, 2}, {3, 1}, {4, 1}, {5, 9}, {14, 1}};
  const Eigen::MatrixXd dense = random_matrix(15, 15, 5);
  const GroupDiagonal diagonal(dense, groups);
  Eigen::MatrixXd expected = Eigen::MatrixXd::Zero(15, 15);
  for (const auto& [first, size] : groups)
    expected.block(first, first, size, size) = dense.block(first, first, size, size);
  EXPECT_EQ(diagonal.dense(), expected);
  const Eigen::VectorXd x = random_matrix(23, 1, 6);
  Eigen::VectorXd y = Eigen::VectorXd::Zero(23);
  diagonal.add_product(x.data(), y.data());
  EXPECT_LT((y.head(15) - expected * x.head(15)).norm(), 1e-14);
}

TEST(PortRows, GatherAndScatterAsTheirMatrix) {
  // Two bodies, the second with a row that moves nothing.
  Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(9, 20);
  rows.block(0, 1, 4, 8) = random_matrix(4, 8, 7);
  rows.block(4, 9, 2, 11) = random_matrix(2, 11, 8);
  rows.block(7, 12, 2, 8) = random_matrix(2, 8, 9);
  const PortRows ports(rows);
  const Eigen::VectorXd z = random_matrix(28, 1, 10), p = random_matrix(17, 1, 11);
  Eigen::VectorXd y = p, f = z;
  ports.gather(z.data(), y.data());
  ports.scatter(p.data(), f.data());
  EXPECT_LT((y.head(9) - rows * z.head(20)).norm(), 1e-14);
  EXPECT_LT((f.head(20) - rows.transpose() * p.head(9)).norm(), 1e-14);
}

}  // namespace
}  // namespace stridor
