// Bodies given by matrices whose rows are displacements of nodes: those of a mesh are the body from
// the mesh.
#include "substructures/bodies/nodal_body.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <numeric>

#include "core/errors.hpp"
#include "substructures/elements/assembly.hpp"
#include "tests/support/message_of.hpp"

namespace stridor {
namespace {

using test::message_of;
using ::testing::HasSubstr;

constexpr double sheet_thickness = 0.01;

/// Six squares of 5 mm in a row of three and two layers, in mm, with labels of their own.
Mesh squares() {
  Mesh mesh;
  mesh.nodes = Mesh::Nodes::Zero(12, 3);
  for (int i = 0; i < 12; ++i) {
    mesh.nodes.row(i) << 5.0 * (i % 4), 5.0 * (i / 4), 0.0;
    mesh.node_labels.push_back(100 - 7 * i);
  }
  for (int e = 0; e < 6; ++e) {
    const int first = e % 3 + 4 * (e / 3);
    mesh.add_element(ElementShape::quad4, std::array{first, first + 1, first + 5, first + 4}, e + 1);
  }
  mesh.node_sets["corner"] = {0};
  return mesh;
}

MeshSurfaceParameters side_in_plane(double x, double y, double offset) {
  MeshSurfaceParameters surface;
  surface.plane = MeshPlaneParameters{{x, y}, offset};
  return surface;
}

MeshBodyParameters meshed() {
  MeshBodyParameters body;
  body.mesh = std::make_shared<const Mesh>(squares());
  body.length_unit = "mm";
  body.thickness = sheet_thickness;
  body.material = {7e10, 0.3, 2700.0};
  body.surfaces = {{"left", side_in_plane(-1, 0, 0.0)}, {"top", side_in_plane(0, 1, 0.01)}};
  body.supports = {{"foot", {{"corner"}, {"y"}}}};
  body.guided = MeshGuideParameters{{"left"}};
  body.points = {{"node", {{}, 79, ""}}, {"place", {{0.012, 0.006}, {}, ""}}, {"mean", {{}, {}, "top"}}};
  return body;
}

/// The same by its matrices in mm, N and s, rows backwards.
TouchedMatrixBodyParameters by_matrices(const MeshBodyParameters& mesh) {
  Mesh in_metres = *mesh.mesh;
  in_metres.nodes *= 1e-3;
  const ElementSection section{ElasticLaw(IsotropicElasticity{7e10, 0.3}, PlaneState::stress), 2700.0,
                               sheet_thickness};
  const MeshMatrices all = assemble_mesh(in_metres, one_section(in_metres, section));
  const Eigen::Index n = all.mass.rows();
  Eigen::PermutationMatrix<Eigen::Dynamic> backwards(n);
  for (Eigen::Index i = 0; i < n; ++i) backwards.indices()(i) = static_cast<int>(n - 1 - i);
  auto matrices = std::make_shared<NamedMatrices>();
  // 1 N/mm is 1000 N/m; 1 N s²/mm is 1000 kg.
  matrices->mass = 1e-3 * (backwards * all.mass * backwards.transpose());
  matrices->stiffness = 1e-3 * (backwards * all.stiffness * backwards.transpose());
  matrices->damping = matrices->gyroscopic = matrices->circulatory = SparseMatrix(n, n);
  for (Eigen::Index i = n; i-- > 0;) {
    const auto node = static_cast<std::size_t>(i / 2);
    matrices->unknowns.push_back({in_metres.node_labels[node], static_cast<int>(i % 2) + 1});
  }
  matrices->mesh = *mesh.mesh;
  TouchedMatrixBodyParameters body;
  body.matrices = matrices;
  body.nodes.length_unit = "mm";
  body.supports = mesh.supports;
  body.angle = mesh.angle;
  for (const auto& [name, surface] : mesh.surfaces)
    body.surfaces[name] = {{}, surface.plane, surface.cylinder, surface.box, surface.tolerance};
  for (const auto& [name, point] : mesh.points)
    body.points[name] = {point.at, 0, 0, point.node, point.mean_of};
  if (mesh.guided) body.guided = MatrixGuideParameters{0, {}, mesh.guided->on};
  return body;
}

void expect_same(const BodyMatrices& found, const BodyMatrices& expected) {
  ASSERT_EQ(found.num_dofs(), expected.num_dofs());
  EXPECT_LE(SparseMatrix(found.mass - expected.mass).norm(), 1e-14 * expected.mass.norm());
  EXPECT_LE(SparseMatrix(found.stiffness - expected.stiffness).norm(),
            1e-14 * expected.stiffness.norm());
  EXPECT_EQ(found.node_dofs, expected.node_dofs);
  EXPECT_EQ(found.load_dof, expected.load_dof);
  EXPECT_LE((found.base_inertia - expected.base_inertia).norm(), 1e-14 * expected.base_inertia.norm());
  EXPECT_EQ(found.surfaces, expected.surfaces);
  EXPECT_EQ(found.points, expected.points);
  for (const auto& [name, load] : expected.loads) {
    const DofSum& same = found.loads.at(name);
    ASSERT_EQ(same.size(), load.size()) << name;
    for (std::size_t i = 0; i < load.size(); ++i) EXPECT_NEAR(same[i].weight, load[i].weight, 1e-14);
  }
}

TEST(NodalBody, OfAMeshIsTheBodyFromTheMesh) {
  MeshBodyParameters mesh = meshed();
  expect_same(by_matrices(mesh).make(), mesh.make());
  mesh.angle = 0.4;
  mesh.supports.clear();
  expect_same(by_matrices(mesh).make(), mesh.make());
}

TEST(NodalBody, ReportsWhatItIs) {
  TouchedMatrixBodyParameters body = by_matrices(meshed());
  const MatrixFacts facts = matrix_facts(*body.matrices, body.body, body.nodes, 6);
  const double mass = 0.015 * 0.01 * sheet_thickness * 2700.0;
  ASSERT_EQ(facts.masses.size(), 2U);
  for (const DirectionMass& direction : facts.masses) {
    EXPECT_NEAR(direction.mass, mass, 1e-13 * mass);
    EXPECT_LE((direction.centre - Eigen::Vector3d(0.0075, 0.005, 0.0)).norm(), 1e-15);
  }
  EXPECT_EQ(facts.num_rigid, 3);
  EXPECT_EQ(facts.num_rigid_expected, 3);
  EXPECT_EQ(facts.mass, Definiteness::positive);
  EXPECT_EQ(facts.stiffness, Definiteness::semidefinite);
  EXPECT_TRUE(facts.missing.empty());
}

TEST(NodalBody, RefusesWhatDoesNotGoWithNodes) {
  const auto refused = [](const auto& change) {
    TouchedMatrixBodyParameters body = by_matrices(meshed());
    change(body);
    return message_of<ConfigError>([&] { (void)body.make(); });
  };
  EXPECT_THAT(refused([](auto& body) { body.points["node"].x = 3; }),
              HasSubstr("points.node.x: is not used: it is known which rows are which nodes"));
  EXPECT_THAT(refused([](auto& body) { body.points["node"].node = 99; }),
              HasSubstr("points.node.node: no element of the mesh has a node 99"));
  EXPECT_THAT(refused([](auto& body) { body.guided = MatrixGuideParameters{1, {1.0}, {}}; }),
              HasSubstr("guided.load: is not used"));
  EXPECT_THAT(refused([](auto& body) { body.nodes.force_unit = "m"; }), HasSubstr("force_unit"));
  const auto without = [](TouchedMatrixBodyParameters& body, int row) {
    auto matrices = std::make_shared<NamedMatrices>(*body.matrices);
    matrices->unknowns[static_cast<std::size_t>(row)] = {-1, 0};
    body.matrices = matrices;
  };
  EXPECT_THAT(refused([&](auto& body) { without(body, 1); }),
              HasSubstr("guided.on: the matrices hold node 23 along x"));
  EXPECT_THAT(refused([&](auto& body) {
                without(body, 0);
                body.angle = 0.1;
              }),
              HasSubstr("angle: the matrices hold node 23 along or about y alone"));
}

TEST(MatrixBody, NeedsNodesForKeysOfAMesh) {
  TouchedMatrixBodyParameters body = by_matrices(meshed());
  auto matrices = std::make_shared<NamedMatrices>(*body.matrices);
  matrices->unknowns.clear();
  body.matrices = matrices;
  EXPECT_THAT(message_of<ConfigError>([&] { (void)body.make(); }),
              HasSubstr("points.mean.mean_of: needs to know which rows of the matrices are which "
                        "nodes; give `unknowns`"));
}

}  // namespace
}  // namespace stridor
