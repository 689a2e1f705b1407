#include "substructures/elements/assembly.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <Eigen/SparseCholesky>
#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

#include "tests/support/constants.hpp"
#include "tests/support/element_meshes.hpp"
#include "tests/support/message_of.hpp"

namespace stridor {
namespace {

using test::box_mesh;
using test::element_shapes;
using test::eps;
using test::message_of;

constexpr double density_of_body = 2770.0;
constexpr double width_of_body = 0.5;
const Eigen::Vector3d box{2.0, 1.5, 1.0};

ElementSection section_of(int dimension, Integration integration = Integration::full) {
  return {ElasticLaw(IsotropicElasticity{71e9, 0.33},
                     dimension == 2 ? PlaneState::stress : PlaneState::none),
          density_of_body, width_of_body, integration};
}

/// Sums of some ten elements at a node, each of up to 60 terms at up to 27 points.
constexpr double rounding_of_sums = 1000.0 * eps;

double largest_value(const SparseMatrix& matrix) {
  return Eigen::Map<const Eigen::VectorXd>(matrix.valuePtr(), matrix.nonZeros())
      .cwiseAbs()
      .maxCoeff();
}

/// Hexahedra beside wedges, on which tetrahedra stand; corners inside are moved.
Mesh mixed_mesh() {
  Mesh mesh = test::linear_grid(
      {4, 3, 4}, {2.0, 1.5, 2.0}, false,
      [](int i, int, int k) {
        if (k >= 2) return ElementShape::tet4;
        return i < 2 ? ElementShape::hex8 : ElementShape::wedge6;
      },
      [](int i, int, int k) { return k < 2 || i >= 2; });
  test::distort_inside(mesh, 0.05);
  return mesh;
}

/// What is left of K u − ∫ N σ n dA for a linear field u, over the rounding of K u: zero where the
/// patch test is passed.
double patch_error(const Mesh& mesh, Integration integration) {
  const int dimension = mesh.dimension();
  const MeshSections sections = one_section(mesh, section_of(dimension, integration));
  const SparseMatrix stiffness = assemble_mesh(mesh, sections).stiffness;
  Eigen::Matrix3d gradient;
  gradient << 3e-4, -7e-4, 1e-4, 2e-4, -5e-4, 6e-4, -2e-4, 4e-4, 1e-4;
  Eigen::VectorXd field(stiffness.rows());
  for (Eigen::Index node = 0; node < mesh.nodes.rows(); ++node)
    field.segment(dimension * node, dimension) =
        (gradient * mesh.nodes.row(node).transpose()).head(dimension);
  Eigen::Matrix3d stress = Eigen::Matrix3d::Zero();
  const auto& law = sections.sections.front().law.matrix();
  if (dimension == 2) {
    const Eigen::Vector3d s =
        law * Eigen::Vector3d(gradient(0, 0), gradient(1, 1), gradient(0, 1) + gradient(1, 0));
    stress << s(0), s(2), 0, s(2), s(1), 0, 0, 0, 0;
  } else {
    Eigen::Matrix<double, 6, 1> strain;
    strain << gradient(0, 0), gradient(1, 1), gradient(2, 2), gradient(0, 1) + gradient(1, 0),
        gradient(1, 2) + gradient(2, 1), gradient(2, 0) + gradient(0, 2);
    const Eigen::Matrix<double, 6, 1> s = law * strain;
    stress << s(0), s(3), s(5), s(3), s(1), s(4), s(5), s(4), s(2);
  }
  Eigen::VectorXd load = Eigen::VectorXd::Zero(field.size());
  for (const ElementSide& side : test::outer_sides(mesh)) {
    const Eigen::Vector3d traction = stress * side_geometry(mesh, sections, side).normal;
    load += traction_load(mesh, sections, std::vector{side}, traction);
  }
  return (stiffness * field - load).cwiseAbs().maxCoeff() /
         (largest_value(stiffness) * field.cwiseAbs().maxCoeff());
}

TEST(Assembly, PatchesOfEveryShapeKeepConstantStrain) {
  for (const ElementShape shape : element_shapes) {
    SCOPED_TRACE(facts_of(shape).name);
    const Mesh mesh = box_mesh(shape, {3, 3, 3}, box, 0.08);
    for (const Integration integration : {Integration::full, Integration::reduced})
      EXPECT_LE(patch_error(mesh, integration), rounding_of_sums);
  }
}

TEST(Assembly, MixedPatchesKeepConstantStrain) {
  const Mesh mesh = mixed_mesh();
  EXPECT_LE(patch_error(mesh, Integration::full), rounding_of_sums);
  EXPECT_LE(patch_error(test::with_middles(mesh), Integration::full), rounding_of_sums);
  EXPECT_LE(patch_error(test::with_middles(mesh), Integration::reduced), rounding_of_sums);
}

TEST(Assembly, IsTheSumOfTheElements) {
  for (const bool is_planar : {true, false}) {
    const Mesh mesh = is_planar ? box_mesh(ElementShape::tri6, {2, 2, 2}, box, 0.05)
                                : test::with_middles(mixed_mesh());
    const int dimension = mesh.dimension();
    // Two sections, one element in three of the second.
    MeshSections sections = one_section(mesh, section_of(dimension));
    sections.sections.push_back(section_of(dimension));
    sections.sections.back().density *= 3.0;
    for (std::size_t e = 0; e < mesh.num_elements(); e += 3) sections.of_element[e] = 1;
    std::vector<Eigen::Triplet<double>> stiffness, mass;
    for (std::size_t e = 0; e < mesh.num_elements(); ++e) {
      const auto nodes = mesh.nodes_of(e);
      Mesh::Nodes places(static_cast<Eigen::Index>(nodes.size()), 3);
      for (std::size_t k = 0; k < nodes.size(); ++k)
        places.row(static_cast<Eigen::Index>(k)) = mesh.nodes.row(nodes[k]);
      const auto element =
          element_matrices(mesh.shapes[e], places, sections.of(e), mesh.element_labels[e]);
      for (int a = 0; a < static_cast<int>(nodes.size()); ++a) {
        for (int b = 0; b < static_cast<int>(nodes.size()); ++b) {
          const int row = dimension * nodes[static_cast<std::size_t>(a)];
          const int column = dimension * nodes[static_cast<std::size_t>(b)];
          for (int i = 0; i < dimension; ++i) {
            mass.emplace_back(row + i, column + i, element.nodal_mass(a, b));
            for (int j = 0; j < dimension; ++j)
              stiffness.emplace_back(row + i, column + j,
                                     element.stiffness(dimension * a + i, dimension * b + j));
          }
        }
      }
    }
    const Eigen::Index num_dofs = dimension * mesh.nodes.rows();
    SparseMatrix k(num_dofs, num_dofs), m(num_dofs, num_dofs);
    k.setFromTriplets(stiffness.begin(), stiffness.end());
    m.setFromTriplets(mass.begin(), mass.end());
    const MeshMatrices matrices = assemble_mesh(mesh, sections);
    EXPECT_TRUE(matrices.stiffness.isCompressed());
    EXPECT_EQ(matrices.stiffness.nonZeros(), k.nonZeros());
    EXPECT_EQ(matrices.mass.nonZeros(), m.nonZeros());
    EXPECT_LE(largest_value(matrices.stiffness - k), rounding_of_sums * largest_value(k));
    EXPECT_LE(largest_value(matrices.mass - m), rounding_of_sums * largest_value(m));
    // Elements add up in the same order in either triangle.
    EXPECT_EQ((matrices.stiffness - SparseMatrix(matrices.stiffness.transpose())).norm(), 0.0);
    EXPECT_EQ((matrices.mass - SparseMatrix(matrices.mass.transpose())).norm(), 0.0);
  }
}

TEST(Assembly, OnlyRigidMotionsGiveNoForce) {
  for (const ElementShape shape : element_shapes) {
    SCOPED_TRACE(facts_of(shape).name);
    const Mesh mesh = box_mesh(shape, {2, 2, 2}, box, 0.05);
    const Eigen::MatrixXd motions = rigid_motions(mesh);
    for (const Integration integration : {Integration::full, Integration::reduced}) {
      if (stiffness_points(shape, integration).size() ==
              stiffness_points(shape, Integration::full).size() &&
          integration == Integration::reduced)
        continue;
      const SparseMatrix stiffness =
          assemble_mesh(mesh, one_section(mesh, section_of(mesh.dimension(), integration)))
              .stiffness;
      EXPECT_LE((stiffness * motions).cwiseAbs().maxCoeff(),
                rounding_of_sums * largest_value(stiffness) * motions.cwiseAbs().maxCoeff());
      // The motions without strain of a single reduced element do not fit its neighbours. As many
      // eigenvalues lie below a shift as the factor of the shifted matrix has negative pivots.
      SparseMatrix shifted = stiffness;
      shifted.diagonal().array() -= 1e-9 * largest_value(stiffness);
      const Eigen::SimplicialLDLT<SparseMatrix::Base> factor(shifted);
      EXPECT_EQ((factor.vectorD().array() < 0.0).count(), motions.cols());
    }
  }
}

TEST(Assembly, MassOfRigidMotionsIsThatOfTheBox) {
  // About the centre of a box: m (b² + c²)/12.
  for (const ElementShape shape : element_shapes) {
    SCOPED_TRACE(facts_of(shape).name);
    Mesh mesh = box_mesh(shape, {2, 3, 2}, box);
    mesh.nodes.rowwise() += Eigen::RowVector3d(1.0, -2.0, mesh.dimension() == 2 ? 0.0 : 3.0);
    const int dimension = mesh.dimension();
    const MeshSections sections = one_section(mesh, section_of(dimension));
    const double across = dimension == 2 ? 0.0 : box.z();
    const double volume = box.x() * box.y() * (dimension == 2 ? width_of_body : box.z());
    const double mass = density_of_body * volume;
    const MassProperties properties = mass_properties(mesh, sections);
    const Eigen::Vector3d centre{2.0, -1.25, dimension == 2 ? 0.0 : 3.5};
    const Eigen::Vector3d squares{box.x() * box.x(), box.y() * box.y(), across * across};
    const Eigen::Matrix3d inertia =
        mass / 12.0 *
        (squares.sum() * Eigen::Vector3d::Ones() - squares).asDiagonal().toDenseMatrix();
    EXPECT_NEAR(properties.volume, volume, rounding_of_sums * volume);
    EXPECT_NEAR(properties.mass, mass, rounding_of_sums * mass);
    EXPECT_LE((properties.centre - centre).norm(), rounding_of_sums * centre.norm());
    EXPECT_LE((properties.inertia - inertia).cwiseAbs().maxCoeff(), rounding_of_sums * mass);

    const SparseMatrix matrix = assemble_mesh(mesh, sections).mass;
    const Eigen::MatrixXd motions = rigid_motions(mesh);
    const Eigen::MatrixXd of_motions = motions.transpose() * (matrix * motions);
    for (int i = 0; i < dimension; ++i)
      for (int j = 0; j < dimension; ++j)
        EXPECT_NEAR(of_motions(i, j), i == j ? mass : 0.0, rounding_of_sums * mass);
  }
}

TEST(Assembly, SidesOfABoxHaveItsAreasAndNormalsAndCarryItsPressure) {
  for (const ElementShape shape : element_shapes) {
    SCOPED_TRACE(facts_of(shape).name);
    const Mesh mesh = box_mesh(shape, {3, 2, 2}, box, 0.05);
    const int dimension = mesh.dimension();
    const MeshSections sections = one_section(mesh, section_of(dimension));
    const Eigen::Vector3d size{box.x(), box.y(), dimension == 2 ? width_of_body : box.z()};
    const Eigen::Vector3d middle =
        dimension == 2 ? Eigen::Vector3d(0.5 * box.x(), 0.5 * box.y(), 0.0) : 0.5 * box;
    std::vector<ElementSide> right;
    double area = 0.0;
    for (const ElementSide& side : test::outer_sides(mesh)) {
      const SideGeometry geometry = side_geometry(mesh, sections, side);
      area += geometry.area;
      // Outwards along an axis.
      EXPECT_NEAR(geometry.normal.cwiseAbs().maxCoeff(), 1.0, rounding_of_sums);
      EXPECT_GT(geometry.normal.dot(geometry.centre - middle), 0.1);
      if (geometry.normal.x() > 0.5) right.push_back(side);
    }
    const double expected =
        dimension == 2 ? 2.0 * size.z() * (size.x() + size.y())
                       : 2.0 * (size.x() * size.y() + size.y() * size.z() + size.z() * size.x());
    EXPECT_NEAR(area, expected, rounding_of_sums * expected);

    const Eigen::VectorXd areas = node_areas(mesh, sections, right);
    EXPECT_NEAR(areas.sum(), size.y() * size.z(), rounding_of_sums);
    EXPECT_NEAR(areas.dot(mesh.nodes.col(1)), areas.sum() * 0.5 * box.y(), rounding_of_sums);
    const Eigen::VectorXd pressure = pressure_load(mesh, sections, right, 3.0);
    const Eigen::VectorXd traction = traction_load(mesh, sections, right, {-3.0, 0.0, 0.0});
    EXPECT_LE((pressure - traction).cwiseAbs().maxCoeff(), rounding_of_sums);
    // An even pressure all around does no work on rigid motions.
    const Eigen::VectorXd around = pressure_load(mesh, sections, test::outer_sides(mesh), 3.0);
    EXPECT_LE((rigid_motions(mesh).transpose() * around).cwiseAbs().maxCoeff(), rounding_of_sums);
  }
}

TEST(Assembly, NodesWithoutElementsAreNamedAndHaveEmptyRows) {
  Mesh mesh = box_mesh(ElementShape::tet4, {1, 1, 1}, box);
  mesh.nodes.conservativeResize(10, 3);
  mesh.nodes.bottomRows(2).setConstant(7.0);
  EXPECT_EQ(nodes_without_elements(mesh), (std::vector{8, 9}));
  const MeshMatrices matrices = assemble_mesh(mesh, one_section(mesh, section_of(3)));
  EXPECT_EQ(matrices.stiffness.rows(), 30);
  EXPECT_EQ(matrices.stiffness.col(24).nonZeros(), 0);
  EXPECT_EQ(matrices.mass.col(29).nonZeros(), 0);
}

std::string assembly_refusal(const Mesh& mesh, const MeshSections& sections) {
  return message_of<std::invalid_argument>([&] { assemble_mesh(mesh, sections); });
}

TEST(Assembly, ElementInsideOutIsNamed) {
  Mesh mesh = box_mesh(ElementShape::hex8, {2, 1, 1}, box);
  mesh.element_labels = {40, 41};
  for (std::size_t k = 0; k < 4; ++k)
    std::swap(mesh.connectivity[8 + k], mesh.connectivity[12 + k]);
  EXPECT_EQ(assembly_refusal(mesh, one_section(mesh, section_of(3))),
            "element 41 (hex8) is degenerate or turned inside out");
}

TEST(Assembly, SectionsThatDoNotFitThrow) {
  const Mesh mesh = box_mesh(ElementShape::hex8, {2, 1, 1}, box);
  MeshSections sections = one_section(mesh, section_of(3));
  sections.of_element.pop_back();
  EXPECT_EQ(assembly_refusal(mesh, sections), "MeshSections: not one section per element");
  sections.of_element.push_back(1);
  EXPECT_EQ(assembly_refusal(mesh, sections),
            "MeshSections: an element has a section that is not there");
  EXPECT_EQ(assembly_refusal(mesh, one_section(mesh, section_of(2))),
            "MeshSections: the law of a section is for another dimension");
  for (const double wrong : {0.0, -1.0, test::not_a_number, test::infinity}) {
    sections = one_section(mesh, section_of(3));
    sections.sections[0].density = wrong;
    EXPECT_EQ(assembly_refusal(mesh, sections),
              "MeshSections: the density of a section is not positive");
    sections = one_section(mesh, section_of(3));
    sections.sections[0].thickness = wrong;
    EXPECT_EQ(assembly_refusal(mesh, sections),
              "MeshSections: the thickness of a section is not positive");
  }
}

TEST(Assembly, SidesThatAreNotThereThrow) {
  Mesh mesh = box_mesh(ElementShape::hex8, {2, 1, 1}, box);
  const MeshSections sections = one_section(mesh, section_of(3));
  const auto message = [&](const ElementSide& side) {
    return message_of<std::invalid_argument>([&] { side_geometry(mesh, sections, side); });
  };
  EXPECT_EQ(message({2, 0}), "a side of an element that is not there");
  EXPECT_EQ(message({-1, 0}), "a side of an element that is not there");
  EXPECT_EQ(message({1, 6}), "element 2 (hex8) has no side 7");
  mesh.nodes.setZero();
  EXPECT_EQ(message({1, 5}), "side 6 of element 2 has no area");
}

}  // namespace
}  // namespace stridor
