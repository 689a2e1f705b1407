#include "substructures/reduction/interface_modes.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <vector>

#include "core/errors.hpp"
#include "substructures/bodies/beam.hpp"
#include "substructures/reduction/modal_body.hpp"
#include "substructures/reduction/recovery.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/paper_beams.hpp"
#include "tests/support/spring_chain.hpp"

namespace stridor {
namespace {

using namespace test;
using ::testing::HasSubstr;

constexpr int num_fixed = 6;

/// The cantilever of the main scene with every DoF of its top.
struct TopOfBeam {
  BodyMatrices body = make_beam(paper_cantilever());
  std::vector<int> interface;
  TopOfBeam() {
    for (const int node : body.surfaces.at("top")) {
      for (const int dof : body.node_dofs[static_cast<std::size_t>(node)])
        if (dof != BodyMatrices::held) interface.push_back(dof);
    }
  }
  ReducedBody reduced() const { return make_craig_bampton(body, interface, num_fixed, interface); }
};

TEST(InterfaceModes, AllOfThemChangeNothingButTheCoordinates) {
  const TopOfBeam beam;
  const ReducedBody all = beam.reduced();
  const ReducedBody same = with_interface_modes(all, all.num_interface);
  ASSERT_EQ(same.size(), all.size());
  const ModalBody before = make_modal(all), after = make_modal(same);
  for (Eigen::Index i = 0; i < all.size(); ++i)
    EXPECT_NEAR(after.omega(i), before.omega(i), 1e-7 * before.omega(i)) << i;
  // The highest frequencies are 3,000 times the lowest, so rounding is 1e-16 times the square of that.
  // The static displacements of the interface per force on it.
  const auto flexibility = [](const ModalBody& body) -> Eigen::MatrixXd {
    return body.rows * body.omega.cwiseAbs2().cwiseInverse().asDiagonal() * body.rows.transpose();
  };
  const Eigen::MatrixXd expected = flexibility(before);
  EXPECT_LT((flexibility(after) - expected).norm(), 1e-7 * expected.norm());
}

TEST(InterfaceModes, FrequenciesComeDownToThoseOfAllDofs) {
  const TopOfBeam beam;
  const ReducedBody all = beam.reduced();
  const ModalBody whole = make_modal(all);
  Eigen::VectorXd last = Eigen::VectorXd::Constant(5, 1e12);
  for (const Eigen::Index count : {8, 16, 40, 100}) {
    const ReducedBody few = with_interface_modes(all, count);
    EXPECT_EQ(few.size(), count + num_fixed);
    EXPECT_EQ(few.num_interface, count);
    const Eigen::VectorXd omega = make_modal(few).omega.head(5);
    for (Eigen::Index i = 0; i < 5; ++i) {
      EXPECT_GE(omega(i), whole.omega(i) * (1.0 - 1e-7)) << count << " modes, " << i;
      EXPECT_LE(omega(i), last(i) * (1.0 + 1e-7)) << count << " modes, " << i;
    }
    last = omega;
  }
  for (Eigen::Index i = 0; i < 5; ++i) EXPECT_NEAR(last(i), whole.omega(i), 1e-6 * whole.omega(i));
}

TEST(InterfaceModes, AreThoseOfAChainThatIsItsOwnInterface) {
  // Nothing inside: the modes are those of the chain, sin(jπi/(n + 1)).
  constexpr int n = 9;
  const BodyMatrices chain = chain_body(n);
  std::vector<int> interface;
  for (int i = 0; i < n; ++i) interface.push_back(i);
  const ReducedBody few = with_interface_modes(make_craig_bampton(chain, interface, 0, interface), 4);
  for (int j = 1; j <= 4; ++j) {
    EXPECT_NEAR(few.stiffness(j - 1, j - 1), chain_omega_squared(n, j), 1e-12);
    const double sign = few.rows(0, j - 1) > 0.0 ? 1.0 : -1.0;
    for (int i = 0; i < n; ++i) {
      EXPECT_NEAR(sign * few.rows(i, j - 1),
                  std::sqrt(2.0 / (n + 1)) * std::sin(j * std::numbers::pi * (i + 1) / (n + 1)),
                  1e-12);
    }
  }
}

TEST(InterfaceModes, CoordinatesAndDisplacementsGoBothWays) {
  const TopOfBeam beam;
  const ReducedBody all = beam.reduced();
  const ReducedBody few = with_interface_modes(all, 12);
  Eigen::VectorXd p = Eigen::VectorXd::LinSpaced(12, -1.0, 2.0);
  const Eigen::VectorXd moved = few.interface_modes * p;
  EXPECT_LT((interface_coordinates(few, moved) - p).norm(), 1e-9 * p.norm());
  EXPECT_EQ(interface_coordinates(all, moved), moved);
  // Rows are those of the recovery of every DoF.
  const Eigen::MatrixXd T =
      in_interface_modes(few, recovery_matrix(beam.body, beam.interface, num_fixed));
  ASSERT_EQ(T.cols(), few.size());
  for (std::size_t k = 0; k < beam.interface.size(); k += 17) {
    EXPECT_LT((T.row(beam.interface[k]) - few.rows.row(static_cast<Eigen::Index>(k))).norm(),
              1e-9 * few.rows.norm());
  }
}

TEST(InterfaceModes, TermsAndLossOfTheBodyGoAlong) {
  BodyMatrices chain = chain_body(6);
  SparseMatrix skew(6, 6);
  skew.insert(1, 2) = 0.3;
  skew.insert(2, 1) = -0.3;
  chain.velocity = skew;
  chain.circulatory = 2.0 * skew;
  chain.loss_stiffness = 0.1 * chain.stiffness;
  const std::vector<int> interface{0, 1, 2, 3};
  const ReducedBody all = make_craig_bampton(chain, interface, 1, interface);
  const ReducedBody few = with_interface_modes(all, 2);
  Eigen::MatrixXd W = Eigen::MatrixXd::Zero(5, 3);
  W.topLeftCorner(4, 2) = few.interface_modes;
  W(4, 2) = 1.0;
  EXPECT_LT((few.coupled.velocity - W.transpose() * all.coupled.velocity * W).norm(), 1e-14);
  EXPECT_LT((few.coupled.position - W.transpose() * all.coupled.position * W).norm(), 1e-14);
  EXPECT_LT((few.loss_stiffness - W.transpose() * all.loss_stiffness * W).norm(), 1e-14);
  EXPECT_LT((few.mass - W.transpose() * all.mass * W).norm(), 1e-13);
}

TEST(InterfaceModes, RefusesMoreModesThanThereAreDofs) {
  const BodyMatrices chain = chain_body(4);
  const std::vector<int> interface{0, 3};
  const ReducedBody all = make_craig_bampton(chain, interface, 1, interface);
  EXPECT_THAT(message_of<std::invalid_argument>([&] { with_interface_modes(all, 3); }),
              HasSubstr("3 modes asked of 2 DoFs"));
}

}  // namespace
}  // namespace stridor
