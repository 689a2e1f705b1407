#include "substructures/elements/solid_element.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include "tests/support/constants.hpp"
#include "tests/support/element_meshes.hpp"
#include "tests/support/message_of.hpp"

namespace stridor {
namespace {

using test::element_shapes;
using test::eps;
using test::message_of;

constexpr double density = 2770.0;
constexpr double thickness = 0.01;

ElementSection aluminium(int dimension, Integration integration = Integration::full) {
  return {ElasticLaw(IsotropicElasticity{71e9, 0.33},
                     dimension == 2 ? PlaneState::stress : PlaneState::none),
          density, thickness, integration};
}

/// Matrices of up to 60 rows summed over up to 27 points.
constexpr double summing = 200.0;

double largest_entry(const Eigen::MatrixXd& matrix) {
  return matrix.cwiseAbs().maxCoeff();
}

/// An element whose corners are an affine image of the natural ones, or moved further by `most`.
Mesh::Nodes some_nodes(ElementShape shape, double most = 0.0) {
  Eigen::Matrix3d affine;
  affine << 0.9, 0.3, 0.2, -0.1, 1.1, 0.3, 0.2, -0.2, 0.8;
  if (facts_of(shape).dimension == 2) affine.row(2).setZero();
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(-most, most);
  const ElementShape linear = test::linear_shape(shape);
  Mesh::Nodes corners = natural_nodes(linear);
  for (Eigen::Index k = 0; k < corners.rows(); ++k)
    for (Eigen::Index i = 0; i < facts_of(shape).dimension; ++i) corners(k, i) += uniform(random);
  corners = (corners * affine.transpose()).eval();
  Mesh::Nodes nodes(facts_of(shape).num_nodes, 3);
  const auto natural_places = natural_nodes(shape);
  for (Eigen::Index k = 0; k < nodes.rows(); ++k) {
    const auto values = shape_functions(linear, natural_places.row(k).transpose()).values;
    nodes.row(k) = values.transpose() * corners;
  }
  return nodes;
}

Eigen::MatrixXd rigid_motions_of(const Mesh::Nodes& nodes, int dimension) {
  Eigen::MatrixXd motions = Eigen::MatrixXd::Zero(dimension * nodes.rows(), dimension == 2 ? 3 : 6);
  for (Eigen::Index k = 0; k < nodes.rows(); ++k) {
    auto rows = motions.middleRows(dimension * k, dimension);
    rows.leftCols(dimension).setIdentity();
    const Eigen::Vector3d place = nodes.row(k).transpose();
    if (dimension == 2) {
      rows.col(2) << -place.y(), place.x();
    } else {
      for (Eigen::Index axis = 0; axis < 3; ++axis)
        rows.col(3 + axis) = Eigen::Vector3d::Unit(axis).cross(place);
    }
  }
  return motions;
}

int num_zero_eigenvalues(const Eigen::MatrixXd& stiffness) {
  const Eigen::VectorXd values =
      Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(stiffness, Eigen::EigenvaluesOnly)
          .eigenvalues();
  const double largest = values(values.size() - 1);
  EXPECT_GT(values(0), -summing * eps * largest);
  return static_cast<int>((values.array() < 1e-10 * largest).count());
}

TEST(SolidElement, OnlyRigidMotionsGiveNoForce) {
  for (const ElementShape shape : element_shapes) {
    SCOPED_TRACE(facts_of(shape).name);
    const int dimension = facts_of(shape).dimension;
    const Mesh::Nodes nodes = some_nodes(shape, 0.1);
    const Eigen::MatrixXd stiffness =
        element_matrices(shape, nodes, aluminium(dimension), 1).stiffness;
    EXPECT_EQ(stiffness, stiffness.transpose());
    EXPECT_LE(largest_entry(stiffness * rigid_motions_of(nodes, dimension)),
              summing * eps * largest_entry(stiffness));
    EXPECT_EQ(num_zero_eigenvalues(stiffness), dimension == 2 ? 3 : 6);
  }
}

TEST(SolidElement, ReducedIntegrationLeavesMotionsWithoutStrain) {
  // Of 16 or 60 DoFs, 4 x 3 or 8 x 6 strains at points.
  const auto zeros_of = [](ElementShape shape) {
    const int dimension = facts_of(shape).dimension;
    return num_zero_eigenvalues(element_matrices(shape, some_nodes(shape, 0.1),
                                                 aluminium(dimension, Integration::reduced), 1)
                                    .stiffness);
  };
  EXPECT_EQ(zeros_of(ElementShape::quad8), 16 - 12);
  EXPECT_EQ(zeros_of(ElementShape::hex20), 60 - 48);
}

TEST(SolidElement, MassIsPositiveDefiniteAndSumsToDensityTimesVolume) {
  for (const ElementShape shape : element_shapes) {
    SCOPED_TRACE(facts_of(shape).name);
    const int dimension = facts_of(shape).dimension;
    const Eigen::MatrixXd mass =
        element_matrices(shape, some_nodes(shape), aluminium(dimension), 1).nodal_mass;
    EXPECT_EQ(mass, mass.transpose());
    // The determinants of the affine map of some_nodes().
    const double size = dimension == 2
                            ? 0.9 * 1.1 + 0.3 * 0.1
                            : 0.9 * (1.1 * 0.8 + 0.3 * 0.2) - 0.3 * (-0.1 * 0.8 - 0.3 * 0.2) +
                                  0.2 * (0.1 * 0.2 - 1.1 * 0.2);
    const double expected =
        density * size * natural_size(shape) * (dimension == 2 ? thickness : 1.0);
    EXPECT_NEAR(mass.sum(), expected, summing * eps * expected);
    const Eigen::VectorXd values =
        Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(mass, Eigen::EigenvaluesOnly).eigenvalues();
    EXPECT_GT(values(0), 1e-3 * values(values.size() - 1));
  }
}

TEST(SolidElement, ConstantStrainStoresItsEnergy) {
  Eigen::Matrix3d gradient;
  gradient << 3e-4, -7e-4, 1e-4, 2e-4, -5e-4, 6e-4, -2e-4, 4e-4, 1e-4;
  for (const ElementShape shape : element_shapes) {
    for (const Integration integration : {Integration::full, Integration::reduced}) {
      SCOPED_TRACE(facts_of(shape).name);
      const int dimension = facts_of(shape).dimension;
      const ElementSection section = aluminium(dimension, integration);
      const Mesh::Nodes nodes = some_nodes(shape, 0.1);
      const ElementMatrices element = element_matrices(shape, nodes, section, 1);
      Eigen::VectorXd field(dimension * nodes.rows());
      for (Eigen::Index k = 0; k < nodes.rows(); ++k)
        field.segment(dimension * k, dimension) =
            (gradient * nodes.row(k).transpose()).head(dimension);
      Eigen::VectorXd strain(dimension == 2 ? 3 : 6);
      if (dimension == 2) {
        strain << gradient(0, 0), gradient(1, 1), gradient(0, 1) + gradient(1, 0);
      } else {
        strain << gradient(0, 0), gradient(1, 1), gradient(2, 2), gradient(0, 1) + gradient(1, 0),
            gradient(1, 2) + gradient(2, 1), gradient(2, 0) + gradient(0, 2);
      }
      const double size = element.nodal_mass.sum() / density;  // exact, as edges are straight
      const double expected = size * strain.dot(section.law.matrix() * strain);
      EXPECT_NEAR(field.dot(element.stiffness * field), expected,
                  summing * eps * largest_entry(element.stiffness) * field.squaredNorm());
    }
  }
}

TEST(SolidElement, LinearSimplicesHaveTheirClosedForm) {
  // Gradients are constant: K = V Bᵀ D B, M = ρ V/((d + 1)(d + 2)) (1 + δ_ab).
  for (const ElementShape shape : {ElementShape::tri3, ElementShape::tet4}) {
    SCOPED_TRACE(facts_of(shape).name);
    const int d = facts_of(shape).dimension;
    const ElementSection section = aluminium(d);
    const Mesh::Nodes nodes = some_nodes(shape, 0.1);
    // Rows of the inverse of (1, x, y, z): coefficients of the shape functions.
    Eigen::MatrixXd vertices(d + 1, d + 1);
    vertices << Eigen::VectorXd::Ones(d + 1), nodes.leftCols(d);
    const Eigen::MatrixXd gradients = vertices.inverse().bottomRows(d);
    const double size = vertices.determinant() / (d == 2 ? 2.0 : 6.0) * (d == 2 ? thickness : 1.0);
    Eigen::MatrixXd strains = Eigen::MatrixXd::Zero(d == 2 ? 3 : 6, d * (d + 1));
    for (int k = 0; k <= d; ++k) {
      for (int i = 0; i < d; ++i) strains(i, d * k + i) = gradients(i, k);
      for (int shear = 0; shear < (d == 2 ? 1 : 3); ++shear) {
        const int i = shear, j = (shear + 1) % 3;  // xy, yz, zx
        strains(d + shear, d * k + i) = gradients(j, k);
        strains(d + shear, d * k + j) = gradients(i, k);
      }
    }
    const Eigen::MatrixXd stiffness = size * strains.transpose() * section.law.matrix() * strains;
    const Eigen::MatrixXd mass =
        density * size / ((d + 1) * (d + 2)) *
        (Eigen::MatrixXd::Ones(d + 1, d + 1) + Eigen::MatrixXd::Identity(d + 1, d + 1));
    const ElementMatrices element = element_matrices(shape, nodes, section, 1);
    EXPECT_LE(largest_entry(element.stiffness - stiffness),
              summing * eps * largest_entry(stiffness));
    EXPECT_LE(largest_entry(element.nodal_mass - mass), summing * eps * largest_entry(mass));
  }
}

TEST(SolidElement, MassOfABrickIsThatOfItsTrilinearFunctions) {
  // ρV/216 (8, 4, 2 or 1 for nodes that differ along 0, 1, 2 or 3 axes).
  Mesh::Nodes nodes = natural_nodes(ElementShape::hex8);
  const Eigen::RowVector3d half{0.3, 0.2, 0.7};
  nodes.array().rowwise() *= half.array();
  const double volume = 8.0 * half.prod();
  const auto mass = element_matrices(ElementShape::hex8, nodes, aluminium(3), 1).nodal_mass;
  for (int a = 0; a < 8; ++a) {
    for (int b = 0; b < 8; ++b) {
      const auto apart = (nodes.row(a).array() != nodes.row(b).array()).count();
      EXPECT_NEAR(mass(a, b),
                  density * volume / 216.0 * std::ldexp(1.0, 3 - static_cast<int>(apart)),
                  summing * eps * density * volume / 216.0);
    }
  }
}

TEST(SolidElement, MassOfQuadraticElementsIsExact) {
  // ∫ ρ N_a N_b of a tetrahedron of volume V, over ρV/420: 6 for a corner with itself, 1 with
  // another, −4 with the middle of an edge at it, −6 of one that is not, 32 for a middle with
  // itself, 16 with one that shares a corner, 8 with the opposite one. Of a triangle of area A over
  // ρA/180: 6, −1, 0, −4; 32, 16.
  const auto expect = [](ElementShape shape, double unit, const std::array<double, 7>& entries) {
    const Mesh::Nodes nodes = some_nodes(shape);
    const auto element =
        element_matrices(shape, nodes, aluminium(facts_of(shape).dimension), 1).nodal_mass;
    const auto places = natural_nodes(shape);
    const int corners = facts_of(shape).num_corners;
    // Corners of which a node is the middle, as a set of bits.
    const auto bits_of = [&](int node) {
      unsigned bits = 0;
      const auto values =
          shape_functions(test::linear_shape(shape), places.row(node).transpose()).values;
      for (int c = 0; c < corners; ++c)
        if (values(c) > 0.25) bits |= 1U << c;
      return bits;
    };
    for (int a = 0; a < nodes.rows(); ++a) {
      for (int b = 0; b < nodes.rows(); ++b) {
        const bool touch = (bits_of(a) & bits_of(b)) != 0;
        std::size_t kind = 0;
        if (a < corners && b < corners) {
          kind = a == b ? 0 : 1;
        } else if (a < corners || b < corners) {
          kind = touch ? 2 : 3;
        } else {
          kind = a == b ? 4 : touch ? 5 : 6;
        }
        const double total = element.sum();
        EXPECT_NEAR(element(a, b), total / unit * entries[kind], summing * eps * total)
            << a << " " << b;
      }
    }
  };
  expect(ElementShape::tet10, 420.0, {6, 1, -4, -6, 32, 16, 8});
  expect(ElementShape::tri6, 180.0, {6, -1, 0, -4, 32, 16, 0});
}

TEST(SolidElement, BrickBendsAsABeam) {
  // A box under pure bending u_x = x z/R, u_z = −(x² + ν(z² − y²))/(2R), u_y = −ν y z/R has linear
  // stress; the incompatible modes hold the quadratic terms that trilinear functions have not, so
  // the energy of the corner displacements is E I l/(2 R²) exactly. Trilinear functions alone store
  // far more in a slender box.
  const Eigen::RowVector3d half{5.0, 0.5, 0.5};
  Mesh::Nodes nodes = natural_nodes(ElementShape::hex8);
  nodes.array().rowwise() *= half.array();
  constexpr double nu = 0.33, modulus = 71e9;
  Eigen::VectorXd field(24);
  for (Eigen::Index k = 0; k < 8; ++k) {
    const double x = nodes(k, 0), y = nodes(k, 1), z = nodes(k, 2);
    field.segment<3>(3 * k) << x * z, -nu * y * z, -0.5 * (x * x + nu * (z * z - y * y));
  }
  const auto stiffness = element_matrices(ElementShape::hex8, nodes, aluminium(3), 1).stiffness;
  const double second_moment = 2.0 * half(1) * std::pow(2.0 * half(2), 3) / 12.0;
  const double expected = 0.5 * modulus * second_moment * 2.0 * half(0);
  EXPECT_NEAR(0.5 * field.dot(stiffness * field), expected,
              summing * eps * largest_entry(stiffness) * field.squaredNorm());
}

TEST(SolidElement, TurningElementAndMaterialTurnsTheMatrices) {
  const OrthotropicElasticity wood{{12e9, 1e9, 0.6e9}, {0.4, 0.35, 0.5}, {0.7e9, 0.8e9, 0.1e9}};
  for (const ElementShape shape : element_shapes) {
    SCOPED_TRACE(facts_of(shape).name);
    const int dimension = facts_of(shape).dimension;
    const PlaneState state = dimension == 2 ? PlaneState::stress : PlaneState::none;
    const Eigen::Vector3d axis =
        dimension == 2 ? Eigen::Vector3d::UnitZ() : Eigen::Vector3d(1, -2, 3).normalized();
    const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.8, axis).toRotationMatrix();
    const Eigen::Matrix3d axes =
        Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitZ()).toRotationMatrix();
    const Mesh::Nodes nodes = some_nodes(shape, 0.1);
    const auto straight = element_matrices(
        shape, nodes, {ElasticLaw(wood, state, axes), density, thickness, Integration::full}, 1);
    const auto turned = element_matrices(
        shape, nodes * turn.transpose(),
        {ElasticLaw(wood, state, turn * axes), density, thickness, Integration::full}, 1);
    Eigen::MatrixXd turn_all =
        Eigen::MatrixXd::Zero(dimension * nodes.rows(), dimension * nodes.rows());
    for (Eigen::Index k = 0; k < nodes.rows(); ++k)
      turn_all.block(dimension * k, dimension * k, dimension, dimension) =
          turn.topLeftCorner(dimension, dimension);
    // The law is turned twice, with moduli that differ by two powers of ten.
    EXPECT_LE(
        largest_entry(turned.stiffness - turn_all * straight.stiffness * turn_all.transpose()),
        100.0 * summing * eps * largest_entry(straight.stiffness));
    EXPECT_LE(largest_entry(turned.nodal_mass - straight.nodal_mass),
              summing * eps * largest_entry(straight.nodal_mass));
  }
}

TEST(SolidElement, PlanarMatricesAreProportionalToThickness) {
  ElementSection fourfold = aluminium(2);
  fourfold.thickness *= 4.0;
  for (const ElementShape shape : {ElementShape::tri6, ElementShape::quad8}) {
    const auto single = element_matrices(shape, some_nodes(shape, 0.1), aluminium(2), 1);
    const auto four = element_matrices(shape, some_nodes(shape, 0.1), fourfold, 1);
    EXPECT_EQ(four.stiffness, 4.0 * single.stiffness);  // powers of two are exact
    EXPECT_EQ(four.nodal_mass, 4.0 * single.nodal_mass);
  }
}

std::string degenerate_element(ElementShape shape) {
  return std::string("element 17 (") + facts_of(shape).name +
         ") is degenerate or turned inside out";
}

TEST(SolidElement, InsideOutFlatOrUndefinedElementsThrow) {
  for (const ElementShape shape : element_shapes) {
    SCOPED_TRACE(facts_of(shape).name);
    const int dimension = facts_of(shape).dimension;
    Mesh::Nodes mirrored = some_nodes(shape);
    mirrored.col(0) *= -1.0;
    Mesh::Nodes flat = some_nodes(shape);
    flat.col(1).setZero();
    Mesh::Nodes undefined = some_nodes(shape);
    undefined(1, 0) = test::not_a_number;
    for (const Mesh::Nodes& nodes : {mirrored, flat, undefined}) {
      EXPECT_EQ(message_of<std::invalid_argument>(
                    [&] { element_matrices(shape, nodes, aluminium(dimension), 17); }),
                degenerate_element(shape));
      with_shape(shape, [&]<ElementShape of>() {
        const ElementNodes<of> places = nodes.leftCols<ElementSizes<of>::dimension>();
        EXPECT_EQ(message_of<std::invalid_argument>(
                      [&] { element_mass<of>(places, aluminium(dimension), 17); }),
                  degenerate_element(shape));
      });
    }
  }
}

TEST(SolidElement, ReentrantQuadrilateralThrows) {
  Mesh::Nodes dart(4, 3);
  dart << 0, 0, 0, 1, 0, 0, 0.1, 0.1, 0, 0, 1, 0;
  EXPECT_EQ(message_of<std::invalid_argument>(
                [&] { element_matrices(ElementShape::quad4, dart, aluminium(2), 17); }),
            degenerate_element(ElementShape::quad4));
}

TEST(SolidElement, LawOfAnotherDimensionThrows) {
  EXPECT_EQ(message_of<std::invalid_argument>([] {
              element_matrices(ElementShape::tet4, some_nodes(ElementShape::tet4), aluminium(2), 1);
            }),
            "element_stiffness: the law is for another dimension");
}

TEST(SolidElement, WrongNumberOfNodesThrows) {
  EXPECT_EQ(message_of<std::invalid_argument>([] {
              element_matrices(ElementShape::tet10, some_nodes(ElementShape::tet4), aluminium(3),
                               1);
            }),
            "element_matrices: wrong number of nodes");
}

}  // namespace
}  // namespace stridor
