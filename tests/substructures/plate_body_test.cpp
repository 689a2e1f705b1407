#include "substructures/bodies/plate_body.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "substructures/bodies/whole_body.hpp"
#include "substructures/reduction/modal_body.hpp"

namespace stridor {
namespace {

PlateBodyParameters spinning_plate(double spin) {
  PlateBodyParameters body;
  body.plate.inner_radius = 0.08;
  body.plate.outer_radius = 0.16;
  body.plate.thickness = 0.012;
  body.plate.material = {2.1e11, 0.3, 7850.0};
  body.plate.nodal_diameters = 3;
  body.plate.radial_modes = 2;
  body.spin = spin;
  body.damping = {3.0, 2e-7};
  return body;
}

/// P and Q of M q̈ + P q̇ + Q q = 0 with M = 1.
struct PlateMatrices {
  Eigen::MatrixXd velocity, position;
};

PlateMatrices matrices_of(const BodyMatrices& body) {
  Eigen::MatrixXd velocity = body.damping.alpha * body.mass + body.damping.beta * body.stiffness;
  Eigen::MatrixXd position = body.stiffness;
  if (body.velocity.size() > 0) {
    velocity += body.velocity;
    position += body.circulatory;
  }
  return {velocity, position};
}

std::vector<std::complex<double>> eigenvalues_of(const PlateMatrices& plate) {
  const Eigen::Index n = plate.velocity.rows();
  Eigen::MatrixXd first_order = Eigen::MatrixXd::Zero(2 * n, 2 * n);
  first_order.topRightCorner(n, n).setIdentity();
  first_order.bottomLeftCorner(n, n) = -plate.position;
  first_order.bottomRightCorner(n, n) = -plate.velocity;
  const Eigen::VectorXcd all = first_order.eigenvalues();
  return {all.begin(), all.end()};
}

/// A particle sees s₀ with s₀² + (α + β ω²) s₀ + ω² = 0 whatever the spin; from space a wave of n
/// nodal diameters turns with it or against it: s = s₀ ± i n Ω.
void expect_turned_eigenvalues(const PlateBodyParameters& body) {
  const AnnularPlate plate(body.plate, body.centrifugal ? body.spin : 0.0);
  const auto found = eigenvalues_of(matrices_of(body.make()));
  Eigen::Index i = 0;
  for (int n = 0; n <= body.plate.nodal_diameters; ++n) {
    for (int j = 0; j < body.plate.radial_modes; ++j) {
      const double square = plate.omega()(i) * plate.omega()(i);
      i += n == 0 ? 1 : 2;
      const double c = body.damping.alpha + body.damping.beta * square;
      const std::complex<double> still(-0.5 * c, std::sqrt(square - 0.25 * c * c));
      for (const double turn : {-1.0, 1.0}) {
        const std::complex<double> s = still + std::complex<double>(0.0, turn * n * body.spin);
        double nearest = 1e300;
        for (const auto& other : found) nearest = std::min(nearest, std::abs(other - s));
        // Entries of the matrices reach the square of this.
        const double scale = std::abs(still) + body.plate.nodal_diameters * body.spin;
        EXPECT_LT(nearest, 1e-6 * scale) << n << " " << j << " " << turn;
      }
    }
  }
}

TEST(PlateBody, WavesTurnWithThePlateAndDampingToo) {
  for (const double spin : {0.0, 10.0, 800.0}) expect_turned_eigenvalues(spinning_plate(spin));
  PlateBodyParameters stiffened = spinning_plate(800.0);
  stiffened.centrifugal = true;
  expect_turned_eigenvalues(stiffened);
}

TEST(PlateBody, BeyondCriticalSpeedItsStiffnessIsNegativeAndItsMotionStable) {
  PlateBodyParameters fast = spinning_plate(0.0);
  const double omega = AnnularPlate(fast.plate).omega()(AnnularPlate(fast.plate).size() - 1);
  fast.spin = omega;  // n Ω > ω of most modes
  const BodyMatrices body = fast.make();
  EXPECT_LT(Eigen::MatrixXd(body.stiffness).diagonal().minCoeff(), 0.0);
  expect_turned_eigenvalues(fast);
  // Kept whole the negative part is a coupled term, and both together are the same.
  const ReducedBody whole = make_whole(body, {});
  EXPECT_GE(whole.stiffness.diagonal().minCoeff(), -1e-6);
  const Eigen::MatrixXd sum = whole.stiffness + whole.coupled.position;
  const Eigen::MatrixXd position = matrices_of(body).position;
  EXPECT_LT((sum - position).cwiseAbs().maxCoeff(), 1e-9 * position.cwiseAbs().maxCoeff());
  EXPECT_EQ(make_modal(whole).omega.minCoeff(), 0.0);
}

TEST(PlateBody, TermsThatAreLeftOutAreGone) {
  PlateBodyParameters body = spinning_plate(50.0);
  body.keep_terms({.rotation = false, .damping = true});
  const BodyMatrices at_rest = body.make();
  EXPECT_EQ(at_rest.velocity.size(), 0);
  EXPECT_EQ(at_rest.damping.beta, 2e-7);
  EXPECT_EQ(at_rest.faces.at("top").spin, 50.0);  // contacts slide all the same
  body.keep_terms({.rotation = true, .damping = false});
  const BodyMatrices undamped = body.make();
  const PlateMatrices both = matrices_of(undamped);
  EXPECT_EQ(both.velocity, -both.velocity.transpose());
  EXPECT_EQ(both.position, both.position.transpose());
}

TEST(PlateBody, PointsAndFacesHaveTheRowsOfThePlate) {
  PlateBodyParameters body = spinning_plate(10.0);
  body.points["probe"] = {0.15, 0.7};
  const BodyMatrices made = body.make();
  const PlateRows rows = AnnularPlate(body.plate).rows(0.15, 0.7);
  const auto dense = [&](const DofSum& sum) {
    Eigen::VectorXd all = Eigen::VectorXd::Zero(made.num_dofs());
    for (const DofWeight& dof : sum) all(dof.dof) += dof.weight;
    return all;
  };
  const int node = made.points.at("probe");
  EXPECT_EQ(dense(made.displacement(node, 1)), rows.w);
  EXPECT_TRUE(made.displacement(node, 0).empty());
  EXPECT_FALSE(made.moves(node, 2));
  EXPECT_EQ(dense(made.load("probe.y").value()), rows.w);
  EXPECT_FALSE(made.load("probe.w").has_value());
  EXPECT_FALSE(made.load("nowhere.y").has_value());
  for (const auto& [name, side] : {std::pair("top", 1), std::pair("bottom", -1)}) {
    const BodyFace& face = made.faces.at(name);
    EXPECT_EQ(face.side, side);
    EXPECT_EQ(face.half_thickness, 0.006);
    EXPECT_EQ(face.spin, 10.0);
    const auto sums = face.rows(0.15, 0.7);
    EXPECT_EQ(dense(sums[0]), rows.w);
    EXPECT_EQ(dense(sums[1]), rows.w_r);
    EXPECT_EQ(dense(sums[2]), rows.w_phi);
    EXPECT_EQ(dense(sums[3]), rows.w_r_phi);
    EXPECT_EQ(dense(sums[4]), rows.w_phi_phi);
  }
  // Both edges are drawn once around, the outer one first; its ends are one node.
  ASSERT_EQ(made.outlines.size(), 2U);
  const std::vector<int>& edge = made.outlines.at(0);
  EXPECT_EQ(edge.size(), 49U);
  EXPECT_EQ(edge.front(), edge.back());
  // A quarter of the way around; z is the radius beyond the outer one.
  EXPECT_NEAR(made.nodes(edge[12], 0), 0.5 * std::numbers::pi * 0.16, 1e-12);
  EXPECT_NEAR(made.nodes(edge[12], 2), 0.0, 1e-15);
  EXPECT_NEAR(made.nodes(made.outlines[1][12], 2), -0.08, 1e-15);
  EXPECT_NEAR(made.nodes(node, 2), -0.01, 1e-15);
  body.points["probe"].radius = 0.17;
  std::vector<Problem> problems;
  for (const auto& check : PlateBodyParameters::schema().checks) check(&body, problems);
  ASSERT_EQ(problems.size(), 1U);
  EXPECT_EQ(problems[0].key, "points.probe.radius");
}

// Its elements fill the ring: their areas, rolled into space, are that of the polygons of both
// edges.
TEST(PlateBody, ElementsFillTheRingBetweenItsEdges) {
  const PlateBodyParameters body = spinning_plate(10.0);
  const BodyMatrices made = body.make();
  const std::vector<DrawnElement> elements = body.elements();
  ASSERT_EQ(elements.size(), 48U * 6U);
  double area = 0.0;
  for (const DrawnElement& element : elements) {
    std::vector<Eigen::Vector2d> corners;
    for (const int corner : element.nodes) {
      const double radius = 0.16 + made.nodes(corner, 2);
      const double angle = made.nodes(corner, 0) / 0.16;
      corners.emplace_back(radius * std::cos(angle), radius * std::sin(angle));
      const PlateRows rows = AnnularPlate(body.plate).rows(radius, angle);
      const DofSum sum = made.displacement(corner, 1);
      for (const DofWeight& dof : sum) EXPECT_NEAR(dof.weight, rows.w(dof.dof), 1e-12);
    }
    for (std::size_t k = 0; k < 4; ++k) {
      const Eigen::Vector2d& a = corners[k];
      const Eigen::Vector2d& b = corners[(k + 1) % 4];
      area += 0.5 * (a.x() * b.y() - a.y() * b.x());
    }
  }
  const double polygon = 24.0 * std::sin(2.0 * std::numbers::pi / 48.0);
  EXPECT_NEAR(area, polygon * (0.16 * 0.16 - 0.08 * 0.08), 1e-12);
}

}  // namespace
}  // namespace stridor
