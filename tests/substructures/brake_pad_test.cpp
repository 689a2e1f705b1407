#include "tests/support/brake_pad.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>

#include "tests/support/message_of.hpp"

namespace stridor {
namespace {

using test::message_of;

constexpr PadStiffness springs{6e7, 4e7, 1e8, 2e7};

ElasticPadParameters pad_of(double youngs_modulus, int num_modes) {
  ElasticPadParameters pad;
  pad.length = 0.06;
  pad.thickness = 0.015;
  pad.width = 0.04;
  pad.material = {youngs_modulus, 0.3, 2500.0};
  pad.mesh = {6, 2};
  pad.reduction.fixed_interface_modes = num_modes;
  return pad;
}

Eigen::VectorXd omegas(const Eigen::MatrixXd& stiffness, const Eigen::MatrixXd& mass) {
  return Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd>(stiffness, mass,
                                                                   Eigen::EigenvaluesOnly)
      .eigenvalues()
      .cwiseSqrt();
}

TEST(BrakePad, StiffPadIsARigidBodyOnItsSprings) {
  const ElasticPadParameters stiff = pad_of(1e16, 5);
  const PadBody pad = make_elastic_pad(stiff, springs, {0.0});
  const double L = stiff.length;
  const double H = stiff.thickness;
  const double m = 2500.0 * L * H * stiff.width;
  // u − θ y along, v + θ x away from the disc; the back is at y = H/2, and Σ x = 0 there.
  Eigen::Matrix3d K;
  const double k = springs.circumferential;
  const double c = springs.coupling;
  K << k, c, -k * H / 2, c, springs.normal, -c * H / 2, -k * H / 2, -c * H / 2,
      k * H * H / 4 + springs.normal * L * L / 12;
  const Eigen::Matrix3d M = Eigen::Vector3d(m, m, m * (L * L + H * H) / 12).asDiagonal();
  Eigen::VectorXd expected(4);
  expected << omegas(K, M), std::sqrt(springs.radial / m);
  std::sort(expected.begin(), expected.end());
  const Eigen::VectorXd found = omegas(pad.stiffness, pad.mass);
  for (Eigen::Index i = 0; i < 4; ++i) EXPECT_NEAR(found(i), expected(i), 1e-6 * expected(i)) << i;
  EXPECT_GT(found(4), 1000.0 * expected(3));
}

TEST(BrakePad, AllModesAreTheWholeMesh) {
  ElasticPadParameters elastic = pad_of(1e10, 0);
  const std::vector<double> offsets{-0.02, 0.0, 0.013};  // the last one between nodes
  const int all = num_interior_dofs(elastic, offsets);
  elastic.reduction.fixed_interface_modes = all;
  const PadBody pad = make_elastic_pad(elastic, springs, offsets);
  EXPECT_TRUE(std::isinf(pad.highest_kept));

  // The mesh by itself, with the springs as a quadrature of fifth order of quadratic shapes would
  // have them at its nodes: Simpson's weights.
  BeamParameters beam;
  beam.length = elastic.length;
  beam.thickness = elastic.thickness;
  beam.width = elastic.width;
  beam.material = elastic.material;
  beam.mesh = elastic.mesh;
  const BodyMatrices mesh = make_beam(beam);
  Eigen::MatrixXd K = mesh.stiffness;
  for (const int node : mesh.surfaces.at("top")) {
    const double place = mesh.nodes(node, 0) / elastic.length * 6.0;
    const bool is_middle = std::abs(place - std::floor(place) - 0.5) < 0.1;
    const bool is_end = place < 0.1 || place > 5.9;
    const double share = (is_middle ? 4.0 : is_end ? 1.0 : 2.0) / 36.0;
    const auto& [x, y] = mesh.node_dofs[static_cast<std::size_t>(node)];
    K(x, x) += share * springs.circumferential;
    K(y, y) += share * springs.normal;
    K(x, y) += share * springs.coupling;
    K(y, x) += share * springs.coupling;
  }
  const Eigen::VectorXd expected = omegas(K, Eigen::MatrixXd(mesh.mass));
  const Eigen::VectorXd found =
      omegas(pad.stiffness.bottomRightCorner(pad.size() - 1, pad.size() - 1),
             pad.mass.bottomRightCorner(pad.size() - 1, pad.size() - 1));
  ASSERT_EQ(found.size(), expected.size());
  for (Eigen::Index i = 0; i < found.size(); ++i)
    EXPECT_NEAR(found(i), expected(i), 1e-9 * expected(i)) << i;
}

TEST(BrakePad, FrequenciesComeDownToThoseOfTheMeshWithMoreModes) {
  const std::vector<double> offsets{-0.02, 0.02};
  const auto lowest = [&](int num_modes) {
    const PadBody pad = make_elastic_pad(pad_of(1e10, num_modes), springs, offsets);
    return Eigen::VectorXd(omegas(pad.stiffness, pad.mass).head(8));
  };
  const Eigen::VectorXd exact = lowest(num_interior_dofs(pad_of(1e10, 0), offsets));
  double last = 1e300;
  for (const int num_modes : {4, 8, 16, 32}) {
    const Eigen::ArrayXd excess = lowest(num_modes).array() / exact.array() - 1.0;
    EXPECT_GT(excess.minCoeff(), -1e-10) << num_modes;
    EXPECT_LT(excess.maxCoeff(), 0.5 * last) << num_modes;
    last = excess.maxCoeff();
  }
  EXPECT_LT(last, 1e-4);
}

TEST(BrakePad, SpringsThatComeCloserCarryThePadAlong) {
  for (const PadBody& pad : {make_rigid_pad(0.25, springs, 1),
                             make_elastic_pad(pad_of(1e10, 12), springs, {0.0, 0.02, 0.011})}) {
    const Eigen::VectorXd q = pad.stiffness.ldlt().solve(1e-4 * pad.advanced);
    for (const PadPoint& point : pad.points) {
      EXPECT_NEAR(point.normal.dot(q), -1e-4, 1e-12);
      EXPECT_NEAR(point.circumferential.dot(q), 0.0, 1e-12);
      EXPECT_EQ(point.radial.dot(q), 0.0);
    }
  }
}

TEST(BrakePad, EvenPressureOnTheBackMovesThePadAsAWhole) {
  PadStiffness upright = springs;
  upright.coupling = 0.0;
  const PadBody pad = make_elastic_pad(pad_of(1e10, 12), upright, {-0.03, 0.0, 0.011});
  const Eigen::VectorXd q = pad.stiffness.ldlt().solve(500.0 * pad.pushed);
  for (const PadPoint& point : pad.points)
    EXPECT_NEAR(point.normal.dot(q), -500.0 / springs.normal, 1e-10 * 500.0 / springs.normal);
}

TEST(BrakePad, RejectsWhatCannotBe) {
  EXPECT_EQ(message_of<std::invalid_argument>(
                [] { make_elastic_pad(pad_of(1e10, 2), springs, {0.031}); }),
            "brake pad: a contact point 0.031 m from the centre lies beyond a pad of 0.06 m");
  EXPECT_THROW(make_elastic_pad(pad_of(1e10, 500), springs, {0.0}), std::invalid_argument);
}

}  // namespace
}  // namespace stridor
