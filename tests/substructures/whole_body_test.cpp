#include "substructures/bodies/whole_body.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <array>
#include <stdexcept>

#include "tests/support/message_of.hpp"

namespace stridor {
namespace {

using test::message_of;
using ::testing::HasSubstr;

BodyMatrices body_of(const Eigen::MatrixXd& mass, const Eigen::MatrixXd& stiffness) {
  BodyMatrices body;
  body.mass = mass.sparseView();
  body.stiffness = stiffness.sparseView();
  return body;
}

const Eigen::MatrixXd mass{{2.0, 0.5, 0.0}, {0.5, 1.0, 0.0}, {0.0, 0.0, 3.0}};
/// Negative along the first unknown, free along the third.
const Eigen::MatrixXd saddle{{-4.0, 1.0, 0.0}, {1.0, 5.0, 0.0}, {0.0, 0.0, 0.0}};

TEST(WholeBody, KeepsTheMatricesAndTheRowsAskedFor) {
  const Eigen::MatrixXd stiffness{{4.0, 1.0, 0.0}, {1.0, 5.0, 0.0}, {0.0, 0.0, 1.0}};
  BodyMatrices body = body_of(mass, stiffness);
  body.damping.alpha = 0.25;
  body.velocity = Eigen::MatrixXd(Eigen::Vector3d(1.0, 0.0, 0.0).asDiagonal()).sparseView();
  body.circulatory = SparseMatrix(3, 3);
  const ReducedBody whole = make_whole(body, std::array{2, BodyMatrices::held, 0});
  EXPECT_EQ(whole.mass, mass);
  EXPECT_EQ(whole.stiffness, stiffness);
  EXPECT_EQ(whole.damping.alpha, 0.25);
  EXPECT_EQ(whole.coupled.velocity(0, 0), 1.0);
  EXPECT_EQ(whole.num_interface, 3);
  EXPECT_EQ(whole.rows, (Eigen::MatrixXd{{0.0, 0.0, 1.0}, {0.0, 0.0, 0.0}, {1.0, 0.0, 0.0}}));
  EXPECT_THAT(message_of<std::invalid_argument>([&] { make_whole(body, std::array{3}); }),
              HasSubstr("a watched DoF is out of range"));
}

TEST(WholeBody, NegativeStiffnessBecomesACoupledTerm) {
  const ReducedBody whole = make_whole(body_of(mass, saddle), {});
  // The sum is as given, to rounding, and what is left of the stiffness has no negative motion.
  EXPECT_LT((whole.stiffness + whole.coupled.position - saddle).norm(), 1e-14);
  const ModalBody modal = make_modal(whole);
  EXPECT_EQ(modal.omega(0), 0.0);
  EXPECT_EQ(modal.omega(1), 0.0);
  const Eigen::MatrixXd K = modal.coupled.position +
                            Eigen::MatrixXd(modal.omega.cwiseAbs2().asDiagonal());
  const Eigen::VectorXd found = K.selfadjointView<Eigen::Lower>().eigenvalues();
  const Eigen::VectorXd given =
      Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd>(saddle, mass).eigenvalues();
  EXPECT_LT((found - given).norm(), 1e-13);
}

TEST(WholeBody, StandSideBySideInSparseBlocks) {
  BodyMatrices body = body_of(mass, saddle);
  body.damping = {};
  body.damping.alpha = 0.5;
  body.damping.beta = 0.1;
  ModalBody modal;
  modal.omega = Eigen::Vector2d(0.0, 3.0);
  modal.damping.beta = 0.01;
  const SparseSystem both = block_diagonal({make_sparse(body), make_sparse(modal)});
  Eigen::MatrixXd M = Eigen::MatrixXd::Identity(5, 5), P = Eigen::MatrixXd::Zero(5, 5), Q = P;
  M.topLeftCorner(3, 3) = mass;
  P.topLeftCorner(3, 3) = 0.5 * mass + 0.1 * saddle;
  P(4, 4) = 0.09;
  Q.topLeftCorner(3, 3) = saddle;
  Q(4, 4) = 9.0;
  EXPECT_EQ(Eigen::MatrixXd(both.mass), M);
  EXPECT_LT((Eigen::MatrixXd(both.velocity) - P).norm(), 1e-15);
  EXPECT_EQ(Eigen::MatrixXd(both.position), Q);
}

}  // namespace
}  // namespace stridor
