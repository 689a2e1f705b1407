#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "substructures/elements/solid_element.hpp"
#include "tests/support/constants.hpp"

namespace stridor {
namespace {

using Q8Vector = Eigen::Matrix<double, 16, 1>;
using Q8Matrix = ElementStiffness<ElementShape::quad8>;
using Q8Nodes = ElementNodes<ElementShape::quad8>;

using test::eps;
constexpr IsotropicElasticity material{71e9, 0.33};
constexpr double quad8_density = 2770.0;
constexpr double width = 0.01;

/// Rounding of a 16-term product of a matrix summed over 9 Gauss points: a few dozen operations on
/// numbers as large as the largest entries.
constexpr double operations = 64.0;

struct Q8Element {
  Q8Matrix stiffness;
  Q8Matrix mass;  ///< of both directions
};

Q8Element make_q8_element(const Q8Nodes& nodes, double of_width) {
  constexpr auto shape = ElementShape::quad8;
  const ElementSection section{ElasticLaw(material, PlaneState::stress), quad8_density, of_width};
  const auto nodal_mass = element_mass<shape>(nodes, section, 1);
  Q8Element element{element_stiffness<shape>(nodes, section, 1), Q8Matrix::Zero()};
  for (Eigen::Index a = 0; a < 8; ++a)
    for (Eigen::Index b = 0; b < 8; ++b)
      element.mass(2 * a, 2 * b) = element.mass(2 * a + 1, 2 * b + 1) = nodal_mass(a, b);
  return element;
}

using Corners = std::array<Eigen::Vector2d, 4>;

Q8Nodes with_mid_sides(const Corners& corners) {
  Q8Nodes nodes;
  for (int k = 0; k < 4; ++k) {
    const Eigen::Vector2d& here = corners[static_cast<std::size_t>(k)];
    const Eigen::Vector2d& next = corners[static_cast<std::size_t>((k + 1) % 4)];
    nodes.row(k) = here;
    nodes.row(4 + k) = 0.5 * (here + next);
  }
  return nodes;
}

const Corners parallelogram{Eigen::Vector2d{0.3, -0.2}, Eigen::Vector2d{2.3, 0.4},
                            Eigen::Vector2d{3.0, 1.5}, Eigen::Vector2d{1.0, 0.9}};
constexpr double parallelogram_area = 2.0 * 1.1 - 0.6 * 0.7;

/// Nodal values of u(x) = a + G x.
Q8Vector linear_field(const Q8Nodes& nodes, const Eigen::Vector2d& offset,
                      const Eigen::Matrix2d& gradient) {
  Q8Vector field;
  for (int k = 0; k < 8; ++k)
    field.segment<2>(2 * k) = offset + gradient * nodes.row(k).transpose();
  return field;
}

/// Plane stress: σ of a displacement gradient.
Eigen::Matrix2d stress_of(const Eigen::Matrix2d& gradient) {
  const double nu = material.poissons_ratio;
  const Eigen::Matrix2d strain = 0.5 * (gradient + gradient.transpose());
  return material.youngs_modulus / (1.0 - nu * nu) *
         ((1.0 - nu) * strain + nu * strain.trace() * Eigen::Matrix2d::Identity());
}

std::vector<Eigen::Matrix2d> constant_strain_gradients() {
  std::vector<Eigen::Matrix2d> gradients(4);
  gradients[0] << 1e-3, 0.0, 0.0, 0.0;
  gradients[1] << 0.0, 0.0, 0.0, 1e-3;
  gradients[2] << 0.0, 1e-3, 1e-3, 0.0;
  gradients[3] << 3e-4, -7e-4, 2e-4, -5e-4;
  return gradients;
}

double largest(const Q8Matrix& matrix) {
  return matrix.cwiseAbs().maxCoeff();
}

TEST(Quad8Element, ConstantStrainGivesTheNodalForcesOfItsBoundaryTraction) {
  // A uniform traction on a straight side of three nodes goes to them as 1/6, 4/6, 1/6.
  const Q8Nodes nodes = with_mid_sides(parallelogram);
  const Q8Element element = make_q8_element(nodes, width);
  for (const Eigen::Matrix2d& gradient : constant_strain_gradients()) {
    const Q8Vector field = linear_field(nodes, {1e-4, -2e-4}, gradient);
    Q8Vector expected = Q8Vector::Zero();
    for (int k = 0; k < 4; ++k) {
      const int next = (k + 1) % 4;
      const Eigen::Vector2d side = (nodes.row(next) - nodes.row(k)).transpose();
      const Eigen::Vector2d outward{side.y(), -side.x()};  // times the length of the side
      const Eigen::Vector2d force = width * stress_of(gradient) * outward;
      expected.segment<2>(2 * k) += force / 6.0;
      expected.segment<2>(2 * next) += force / 6.0;
      expected.segment<2>(2 * (4 + k)) += 4.0 * force / 6.0;
    }
    const double tolerance =
        operations * eps * largest(element.stiffness) * field.cwiseAbs().maxCoeff();
    EXPECT_LE((element.stiffness * field - expected).cwiseAbs().maxCoeff(), tolerance);
  }
}

TEST(Quad8Element, ConstantStrainStoresItsEnergyDensityTimesTheVolume) {
  const Q8Nodes nodes = with_mid_sides(parallelogram);
  const Q8Element element = make_q8_element(nodes, width);
  for (const Eigen::Matrix2d& gradient : constant_strain_gradients()) {
    const Q8Vector field = linear_field(nodes, Eigen::Vector2d::Zero(), gradient);
    const double energy = 0.5 * field.dot(element.stiffness * field);
    const double expected =
        0.5 * stress_of(gradient).cwiseProduct(gradient).sum() * width * parallelogram_area;
    EXPECT_NEAR(energy, expected,
                operations * eps * largest(element.stiffness) * field.squaredNorm());
  }
}

TEST(Quad8Element, PatchOfDistortedElementsKeepsConstantStrain) {
  // Four elements around a node off the centre, with straight sides: no forces remain at that node
  // and at the mid-sides that meet there. 3x3 Gauss points integrate the forces exactly.
  const std::array<std::array<Eigen::Vector2d, 3>, 3> grid{{
      {{{0.0, 0.0}, {0.9, -0.1}, {2.0, 0.1}}},
      {{{0.1, 1.2}, {1.15, 0.85}, {2.2, 0.9}}},
      {{{-0.2, 2.0}, {0.8, 2.1}, {1.9, 1.8}}},
  }};
  for (const Eigen::Matrix2d& gradient : constant_strain_gradients()) {
    Eigen::Vector2d centre_force = Eigen::Vector2d::Zero();
    std::array<Eigen::Vector2d, 4>
        mid_force;  // on the sides from the centre: up, right, down, left
    mid_force.fill(Eigen::Vector2d::Zero());
    double scale = 0.0;
    for (std::size_t row = 0; row < 2; ++row) {
      for (std::size_t column = 0; column < 2; ++column) {
        const Q8Nodes nodes = with_mid_sides({grid[row][column], grid[row][column + 1],
                                              grid[row + 1][column + 1], grid[row + 1][column]});
        const Q8Element element = make_q8_element(nodes, width);
        const Q8Vector field = linear_field(nodes, Eigen::Vector2d::Zero(), gradient);
        const Q8Vector force = element.stiffness * field;
        scale = std::max(scale, largest(element.stiffness) * field.cwiseAbs().maxCoeff());
        // Local numbers of the centre and of the two mid-sides that end there.
        const int centre = row == 0 ? (column == 0 ? 2 : 3) : (column == 0 ? 1 : 0);
        const int vertical = column == 0 ? 5 : 7;
        const int horizontal = row == 0 ? 6 : 4;
        centre_force += force.segment<2>(2 * centre);
        mid_force[row == 0 ? 2 : 0] += force.segment<2>(2 * vertical);
        mid_force[column == 0 ? 3 : 1] += force.segment<2>(2 * horizontal);
      }
    }
    EXPECT_LE(centre_force.norm(), 4.0 * operations * eps * scale);
    for (const Eigen::Vector2d& force : mid_force)
      EXPECT_LE(force.norm(), 2.0 * operations * eps * scale);
  }
}

TEST(Quad8Element, RigidMotionsGiveNoForce) {
  Eigen::Matrix2d rotation;
  rotation << 0.0, -1.0, 1.0, 0.0;
  const Q8Nodes nodes = with_mid_sides(parallelogram);
  const Q8Element element = make_q8_element(nodes, width);
  for (const Q8Vector& field : {linear_field(nodes, {1.0, 0.0}, Eigen::Matrix2d::Zero()),
                                linear_field(nodes, {0.0, 1.0}, Eigen::Matrix2d::Zero()),
                                linear_field(nodes, {0.0, 0.0}, rotation)}) {
    EXPECT_LE((element.stiffness * field).cwiseAbs().maxCoeff(),
              operations * eps * largest(element.stiffness) * field.cwiseAbs().maxCoeff());
  }
}

TEST(Quad8Element, StiffnessIsSymmetricOfRankThirteen) {
  const Q8Element element = make_q8_element(with_mid_sides(parallelogram), width);
  EXPECT_LE(largest(element.stiffness - element.stiffness.transpose()),
            operations * eps * largest(element.stiffness));
  const Eigen::SelfAdjointEigenSolver<Q8Matrix> solver(element.stiffness);
  const Q8Vector values = solver.eigenvalues();
  const double rounding = 16.0 * operations * eps * values(15);
  for (int i = 0; i < 3; ++i) EXPECT_LE(std::abs(values(i)), rounding) << i;
  // The softest deformation is far above rounding: no hourglass modes.
  EXPECT_GT(values(3), 1e-4 * values(15));
}

TEST(Quad8Element, MassSumsToDensityTimesVolume) {
  const Q8Nodes nodes = with_mid_sides(parallelogram);
  const Q8Element element = make_q8_element(nodes, width);
  const double total = quad8_density * parallelogram_area * width;
  const Q8Vector x = linear_field(nodes, {1.0, 0.0}, Eigen::Matrix2d::Zero());
  const Q8Vector y = linear_field(nodes, {0.0, 1.0}, Eigen::Matrix2d::Zero());
  EXPECT_NEAR(x.dot(element.mass * x), total, operations * eps * total);
  EXPECT_NEAR(y.dot(element.mass * y), total, operations * eps * total);
  EXPECT_EQ(x.dot(element.mass * y), 0.0);
}

TEST(Quad8Element, MassHasTheMomentsOfTheParallelogram) {
  // With s, t uniform in [-1/2, 1/2] and sides a, b: ∫ |x|² dA = A (|c|² + (|a|² + |b|²)/12).
  const Q8Nodes nodes = with_mid_sides(parallelogram);
  const Q8Element element = make_q8_element(nodes, width);
  Eigen::Matrix2d turn;
  turn << 0.0, -1.0, 1.0, 0.0;
  const Q8Vector rotation = linear_field(nodes, Eigen::Vector2d::Zero(), turn);
  const Eigen::Vector2d a = parallelogram[1] - parallelogram[0];
  const Eigen::Vector2d b = parallelogram[3] - parallelogram[0];
  const Eigen::Vector2d centre = parallelogram[0] + 0.5 * (a + b);
  const double inertia = quad8_density * width * parallelogram_area *
                         (centre.squaredNorm() + (a.squaredNorm() + b.squaredNorm()) / 12.0);
  EXPECT_NEAR(rotation.dot(element.mass * rotation), inertia, 4.0 * operations * eps * inertia);
}

TEST(Quad8Element, MassIsSymmetricPositiveDefinite) {
  const Q8Element element = make_q8_element(with_mid_sides(parallelogram), width);
  EXPECT_LE(largest(element.mass - element.mass.transpose()),
            operations * eps * largest(element.mass));
  const Eigen::SelfAdjointEigenSolver<Q8Matrix> solver(element.mass);
  EXPECT_GT(solver.eigenvalues()(0), 1e-3 * solver.eigenvalues()(15));
}

TEST(Quad8Element, TurningTheElementTurnsItsMatrices) {
  const Q8Nodes nodes = with_mid_sides(parallelogram);
  const double angle = 0.7;
  Eigen::Matrix2d turn;
  turn << std::cos(angle), -std::sin(angle), std::sin(angle), std::cos(angle);
  Q8Matrix turn_all = Q8Matrix::Zero();
  for (int k = 0; k < 8; ++k) turn_all.block<2, 2>(2 * k, 2 * k) = turn;
  const Q8Element straight = make_q8_element(nodes, width);
  const Q8Element turned = make_q8_element(nodes * turn.transpose(), width);
  EXPECT_LE(largest(turned.stiffness - turn_all * straight.stiffness * turn_all.transpose()),
            4.0 * operations * eps * largest(straight.stiffness));
  EXPECT_LE(largest(turned.mass - straight.mass), 4.0 * operations * eps * largest(straight.mass));
}

TEST(Quad8Element, MatricesAreProportionalToWidth) {
  const Q8Nodes nodes = with_mid_sides(parallelogram);
  const Q8Element single = make_q8_element(nodes, width);
  const Q8Element fourfold = make_q8_element(nodes, 4.0 * width);
  EXPECT_EQ(fourfold.stiffness, 4.0 * single.stiffness);  // powers of two are exact
  EXPECT_EQ(fourfold.mass, 4.0 * single.mass);
}

}  // namespace
}  // namespace stridor
