#include "substructures/reduction/recovery.hpp"

#include <gtest/gtest.h>

#include "substructures/reduction/craig_bampton.hpp"
#include "tests/support/full_model.hpp"
#include "tests/support/paper_beams.hpp"

namespace stridor {
namespace {

using namespace test;

BodyMatrices short_beam() {
  BeamParameters parameters = paper_oblique();
  parameters.mesh.along = 4;
  return make_beam(parameters);
}

TEST(Recovery, GivesBackTheMatricesOfTheReduction) {
  const BodyMatrices body = short_beam();
  const std::vector<int> interface = slave_interface(body);
  const Eigen::MatrixXd T = recovery_matrix(body, interface, 6);
  const ReducedBody reduced = make_craig_bampton(body, interface, 6, {});
  ASSERT_EQ(T.rows(), body.num_dofs());
  ASSERT_EQ(T.cols(), reduced.size());
  // Products over some hundred DoFs round by some hundred eps.
  const Eigen::MatrixXd mass = T.transpose() * (body.mass * T);
  EXPECT_LT((mass - reduced.mass).norm(), 1e3 * eps * reduced.mass.norm());
  const Eigen::MatrixXd stiffness = T.transpose() * (body.stiffness * T);
  EXPECT_LT((stiffness - reduced.stiffness).norm(), 1e6 * eps * reduced.stiffness.norm());
}

TEST(Recovery, TranslationMovesEveryNodeAlikeAndHeldOnesNot) {
  const BodyMatrices body = short_beam();
  const Eigen::VectorXcd up = rigid_motion(body, {0.0, 2.0}).cast<std::complex<double>>();
  const Eigen::MatrixX3cd displacement = node_displacements(body, up);
  ASSERT_EQ(displacement.rows(), body.nodes.rows());
  // The guided end follows the drive in x and is free in y.
  for (Eigen::Index node = 0; node < displacement.rows(); ++node) {
    EXPECT_EQ(displacement(node, 0), 0.0);
    EXPECT_EQ(displacement(node, 1), 2.0);
    EXPECT_EQ(displacement(node, 2), 0.0);
  }
  const Eigen::VectorXcd along = rigid_motion(body, {3.0, 0.0}).cast<std::complex<double>>();
  const Eigen::MatrixX3cd sideways = node_displacements(body, along);
  EXPECT_EQ(sideways(body.points.at("tip"), 0), 3.0);
  EXPECT_EQ(sideways(body.points.at("end_top"), 0), 0.0);
}

}  // namespace
}  // namespace stridor
