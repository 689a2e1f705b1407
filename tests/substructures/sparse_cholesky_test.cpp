#include "substructures/matrices/sparse_cholesky.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "core/errors.hpp"
#include "tests/support/box_mesh.hpp"
#include "tests/support/full_model.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/paper_beams.hpp"
#include "tests/support/spring_chain.hpp"

namespace stridor {
namespace {

using test::eps;
using test::message_of;

std::string factor_refusal(const SparseMatrix& matrix) {
  return message_of<NumericalError>([&] { SparseCholesky(matrix, "the stiffness"); });
}

std::string not_positive_definite(Eigen::Index size) {
  const std::string n = std::to_string(size);
  return "the stiffness (" + n + " x " + n +
         ") is not positive definite: the supports and the interface leave a rigid motion free, "
         "the body is too slender for its mesh, or the matrix is damaged";
}

SparseMatrix diagonal(const Eigen::VectorXd& entries) {
  return Eigen::MatrixXd(entries.asDiagonal()).sparseView(0.0, 0.0);
}

TEST(SparseCholesky, SolvesTheSpringChain) {
  // Forward error of a Cholesky solve: a small multiple of n eps cond, cond <= 4 (n+1)²/π².
  for (const int n : {1, 2, 7, 100}) {
    const SparseCholesky factor(test::chain_stiffness(n), "the chain");
    EXPECT_EQ(factor.size(), n);
    const Eigen::MatrixXd inverse = factor.solve(Eigen::MatrixXd::Identity(n, n));
    const double tolerance =
        eps * 0.41 * (n + 1) * (n + 1) * test::chain_compliance(n, n / 2, n / 2);
    for (int i = 0; i < n; ++i) {
      for (int k = 0; k < n; ++k)
        EXPECT_NEAR(inverse(i, k), test::chain_compliance(n, i, k), tolerance) << n;
    }
  }
}

TEST(SparseCholesky, LeavesAResidualOfRoundingForTheBeamsOfThePaper) {
  // Backward stability: |K u − f| <= c n eps |K| |u| with a small c.
  for (const BeamParameters& beam : {test::paper_cantilever(), [] {
                                       BeamParameters held = test::paper_oblique();
                                       held.supports.end = Support::clamped;
                                       return held;
                                     }()}) {
    const BodyMatrices body = make_beam(beam);
    const SparseCholesky factor(body.stiffness, "the beam");
    const Eigen::VectorXd force = Eigen::VectorXd::LinSpaced(body.num_dofs(), -1.0, 1.0);
    const Eigen::VectorXd displacement = factor.solve(force);
    const double n = static_cast<double>(body.num_dofs());
    EXPECT_LE((body.stiffness * displacement - force).norm(),
              n * eps * body.stiffness.norm() * displacement.norm());
  }
}

TEST(SparseCholesky, SolvesSeveralRightHandSidesAsOneByOne) {
  const SparseCholesky factor(test::chain_stiffness(20), "the chain");
  const Eigen::MatrixXd forces = Eigen::MatrixXd::Identity(20, 3);
  const Eigen::MatrixXd together = factor.solve(forces);
  ASSERT_EQ(together.cols(), 3);
  for (Eigen::Index i = 0; i < 3; ++i) {
    // Blocked and single solves may add up in a different order.
    EXPECT_LE((together.col(i) - factor.solve(forces.col(i))).norm(), 20.0 * eps * 20.0);
  }
}

TEST(SparseCholesky, SolvesNoRightHandSide) {
  const SparseCholesky factor(test::chain_stiffness(5), "the chain");
  const Eigen::MatrixXd none = factor.solve(Eigen::MatrixXd(5, 0));
  EXPECT_EQ(none.rows(), 5);
  EXPECT_EQ(none.cols(), 0);
}

/// Interior of a beam: several supernodes, of which each right-hand side reaches some.
SparseMatrix held_beam() {
  BeamParameters beam = test::paper_cantilever();
  beam.mesh = {30, 2};
  return make_beam(beam).stiffness;
}

TEST(SparseCholesky, HalfSolvesMakeAWholeOne) {
  const SparseMatrix matrix = held_beam();
  const SparseCholesky factor(matrix, "the beam");
  const Eigen::Index n = matrix.rows();
  const Eigen::MatrixXd forces = Eigen::MatrixXd::Identity(n, n).leftCols(20);
  VectorBlock block = forces;
  factor.solve_lower_in_place(block);
  factor.solve_upper_in_place(block);
  EXPECT_EQ(Eigen::MatrixXd(block), factor.solve(forces));
  // Backward stability: |K u − f| <= c n eps |K| |u| with a small c.
  EXPECT_LE((matrix * block - forces).norm(),
            static_cast<double>(n) * eps * matrix.norm() * block.norm());
}

TEST(SparseCholesky, LowerSolveIsARootOfTheInverse) {
  // (L⁻¹ f)ᵀ (L⁻¹ g) = fᵀ A⁻¹ g, to the forward error of one solve: eps cond, with at most 4 (n +
  // 1)²/π² for a chain.
  const int n = 60;
  const SparseCholesky factor(test::chain_stiffness(n), "the chain");
  VectorBlock root = Eigen::MatrixXd::Identity(n, n);
  factor.solve_lower_in_place(root);
  const Eigen::MatrixXd inverse = root.transpose() * root;
  const double tolerance = eps * 0.41 * (n + 1) * (n + 1) * test::chain_compliance(n, n / 2, n / 2);
  for (int i = 0; i < n; ++i) {
    for (int k = 0; k < n; ++k)
      EXPECT_NEAR(inverse(i, k), test::chain_compliance(n, i, k), tolerance);
  }
}

TEST(SparseCholesky, HalfSolvesLeaveTheOtherColumnsAlone) {
  const SparseMatrix matrix = held_beam();
  const SparseCholesky factor(matrix, "the beam");
  const VectorBlock before = VectorBlock::Constant(matrix.rows(), 7, 1.5);
  VectorBlock block = before;
  factor.solve_lower_in_place(block.middleCols(2, 3));
  factor.solve_upper_in_place(block.middleCols(2, 3));
  VectorBlock alone = before.middleCols(2, 3);
  factor.solve_lower_in_place(alone);
  factor.solve_upper_in_place(alone);
  EXPECT_EQ(VectorBlock(block.middleCols(2, 3)), alone);
  EXPECT_EQ(VectorBlock(block.leftCols(2)), VectorBlock(before.leftCols(2)));
  EXPECT_EQ(VectorBlock(block.rightCols(2)), VectorBlock(before.rightCols(2)));
}

TEST(SparseCholesky, OfAPartSolvesAsThatPartAlone) {
  const BodyMatrices body = make_beam(test::paper_cantilever());
  const auto n = static_cast<int>(body.num_dofs());
  const std::vector<int> left_out{0, 5, 6, 17, n - 1};
  std::vector<int> kept;
  for (int dof = 0; dof < n; ++dof)
    if (std::find(left_out.begin(), left_out.end(), dof) == left_out.end()) kept.push_back(dof);
  const Eigen::MatrixXd part = Eigen::MatrixXd(body.stiffness)(kept, kept);
  const SparseCholesky alone(part.sparseView(), "the part");
  const SparseCholesky within(body.stiffness, "the part", left_out);
  EXPECT_EQ(within.size(), n);
  EXPECT_EQ(within.num_factorised(), n - 5);

  VectorBlock block = VectorBlock::Random(n, 3);
  const VectorBlock given = block;
  within.solve_in_place(block);
  const VectorBlock expected = alone.solve(given(kept, Eigen::all));
  EXPECT_LE((block(kept, Eigen::all) - expected).norm(), 1e-9 * expected.norm());
  EXPECT_EQ(block(left_out, Eigen::all), given(left_out, Eigen::all));
}

TEST(SparseCholesky, OfAPartNeedsOnlyThatPartToBePositiveDefinite) {
  SparseMatrix matrix = test::chain_stiffness(6);
  matrix.coeffRef(2, 2) = -1.0;
  const std::vector<int> left_out{2};
  EXPECT_NO_THROW(SparseCholesky(matrix, "the chain", left_out));
  EXPECT_EQ(factor_refusal(matrix), not_positive_definite(6));
}

TEST(SparseCholesky, DofsOfANodeNeedNotFollowEachOther) {
  // A pattern without groups, and one in which every DoF but the last has the same neighbours.
  Eigen::MatrixXd dense = Eigen::MatrixXd::Constant(5, 5, 0.1);
  dense.diagonal().setConstant(2.0);
  dense.row(4).head(4).setZero();
  dense.col(4).head(4).setZero();
  for (const Eigen::MatrixXd& matrix :
       {dense, Eigen::MatrixXd(Eigen::MatrixXd(dense.diagonal().asDiagonal()))}) {
    const SparseCholesky factor(matrix.sparseView(), "the matrix");
    const Eigen::VectorXd force = Eigen::VectorXd::LinSpaced(5, 1.0, 5.0);
    EXPECT_LE((matrix * factor.solve(force) - force).norm(), 1e-14 * force.norm());
  }
}

TEST(SparseCholesky, StoresNothingAboveTheDiagonal) {
  const int n = 100;
  Eigen::MatrixXd dense = Eigen::MatrixXd::Constant(n, n, 0.1);
  dense.diagonal().setConstant(2.0);
  const SparseCholesky factor(dense.sparseView(), "the matrix");
  EXPECT_EQ(factor.num_entries(), n * (n + 1) / 2);
  EXPECT_EQ(SparseCholesky(diagonal(Eigen::VectorXd::Ones(n)), "the matrix").num_entries(), n);
}

/// Unit springs between all nodes of each element of a mesh, and from each of them to the ground.
SparseMatrix springs_in_elements(const Mesh& mesh) {
  std::vector<Eigen::Triplet<double>> entries;
  for (std::size_t element = 0; element < mesh.num_elements(); ++element) {
    const std::span<const int> nodes = mesh.nodes_of(element);
    for (const int to : nodes) {
      for (const int from : nodes) entries.emplace_back(to, from, -1.0);
      entries.emplace_back(to, to, static_cast<double>(nodes.size() + 1));
    }
  }
  SparseMatrix matrix(mesh.nodes.rows(), mesh.nodes.rows());
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

TEST(SparseCholesky, FillsAPlateLessThanAnOrderByMetis) {
  const Mesh plate =
      test::brick_mesh({{0.044, 0.003, 0.044}, {44, 3, 44}, {}}, ElementShape::hex20);
  const SparseCholesky factor(springs_in_elements(plate), "the plate");
  // The default of CHOLMOD, METIS, leaves 6.09 million, nested dissection to small parts 5.87.
  EXPECT_LE(factor.num_entries(), 5'980'000);
}

TEST(SparseCholesky, OfSizeZeroIsNothing) {
  const SparseCholesky factor(SparseMatrix(0, 0), "nothing");
  EXPECT_EQ(factor.size(), 0);
  const Eigen::MatrixXd solution = factor.solve(Eigen::MatrixXd(0, 4));
  EXPECT_EQ(solution.rows(), 0);
  EXPECT_EQ(solution.cols(), 4);
}

TEST(SparseCholesky, CanBeMoved) {
  SparseCholesky first(test::chain_stiffness(3), "the chain");
  SparseCholesky second(std::move(first));
  EXPECT_EQ(second.size(), 3);
  SparseCholesky third(test::chain_stiffness(8), "the chain");
  third = std::move(second);
  EXPECT_EQ(third.size(), 3);
  EXPECT_NEAR(third.solve(Eigen::VectorXd::Unit(3, 1))(1), 1.0, 8.0 * eps);
}

TEST(SparseCholesky, ScaleOfTheMatrixDoesNotMatter) {
  for (const double scale : {1e-30, 1.0, 1e30}) {
    const SparseCholesky factor(scale * test::chain_stiffness(10), "the chain");
    EXPECT_NEAR(factor.solve(scale * Eigen::VectorXd::Unit(10, 4))(4),
                test::chain_compliance(10, 4, 4), 50.0 * eps * test::chain_compliance(10, 4, 4));
  }
}

TEST(SparseCholesky, FreeBeamThrows) {
  for (const double angle : {0.0, 0.3, test::leading_angle}) {
    BeamParameters beam = test::paper_oblique(angle);
    beam.supports = {};
    const BodyMatrices body = make_beam(beam);
    EXPECT_EQ(factor_refusal(body.stiffness), not_positive_definite(body.num_dofs())) << angle;
  }
}

TEST(SparseCholesky, BeamWithOneRigidMotionLeftThrows) {
  // The last pivot is rounding, positive for about half of these meshes.
  for (const int along : {20, 37, 60, 100, 400}) {
    for (const double angle : {0.0, 0.3, test::trailing_angle, 1.0}) {
      BeamParameters beam = test::paper_oblique(angle);
      beam.mesh = {along, 1};
      const BodyMatrices guided = make_beam(beam);
      EXPECT_EQ(factor_refusal(guided.stiffness), not_positive_definite(guided.num_dofs()))
          << along << " elements at " << angle;
      beam.supports = {Support::pinned, Support::free};
      const BodyMatrices pinned = make_beam(beam);
      EXPECT_EQ(factor_refusal(pinned.stiffness), not_positive_definite(pinned.num_dofs()))
          << along << " elements at " << angle;
    }
  }
}

TEST(SparseCholesky, SlenderCantileverIsAcceptedWhileItsBendingIsKnown) {
  // Bending is softer than the elements by the cube of the slenderness: 1e-9 stands out of
  // a rounding unit of 2e-16 and its sums, 1e-12 no more, as single elements bend softly as well.
  for (const double angle : {0.0, 0.3, test::trailing_angle}) {
    BeamParameters beam = test::paper_cantilever();
    beam.angle = angle;
    beam.thickness = 1e-3 * beam.length;
    EXPECT_EQ(factor_refusal(make_beam(beam).stiffness), "<no exception>") << angle;
    beam.thickness = 1e-4 * beam.length;
    EXPECT_EQ(factor_refusal(make_beam(beam).stiffness), not_positive_definite(500)) << angle;
  }
}

TEST(SparseCholesky, IndefiniteMatrixThrows) {
  EXPECT_EQ(factor_refusal(diagonal(Eigen::Vector3d(1.0, -1.0, 2.0))), not_positive_definite(3));
}

TEST(SparseCholesky, ZeroMatrixThrows) {
  EXPECT_EQ(factor_refusal(diagonal(Eigen::Vector2d::Zero())), not_positive_definite(2));
}

TEST(SparseCholesky, MatrixThatIsNotANumberThrows) {
  const double bad = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(factor_refusal(diagonal(Eigen::Vector2d(1.0, bad))), not_positive_definite(2));
  EXPECT_EQ(factor_refusal(diagonal(Eigen::Vector2d(bad, 1.0))), not_positive_definite(2));
}

}  // namespace
}  // namespace stridor
