#include "substructures/bodies/mesh_body.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <numeric>
#include <stdexcept>
#include <utility>

#include "core/errors.hpp"
#include "substructures/bodies/beam_mesh.hpp"
#include "substructures/elements/mesh_point.hpp"
#include "tests/support/full_model.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/paper_beams.hpp"

namespace stridor {
namespace {

using test::message_of;
using testing::HasSubstr;

/// The mesh of a beam in the frame of its axis, in millimetres.
Mesh mesh_of(BeamParameters beam) {
  beam.angle = 0.0;
  beam.supports = {};
  const BodyMatrices body = make_beam(beam);
  Mesh mesh;
  mesh.nodes = Mesh::Nodes::Zero(body.nodes.rows(), 3);
  mesh.nodes.leftCols<2>() = 1e3 * body.nodes.leftCols<2>();
  mesh.node_labels.resize(mesh.num_nodes());
  std::iota(mesh.node_labels.begin(), mesh.node_labels.end(), 101);
  for (const std::array<int, 8>& nodes : beam_elements(beam.mesh))
    mesh.add_element(ElementShape::quad8, nodes,
                     static_cast<std::int64_t>(mesh.num_elements()) + 1);
  for (int element = 0; element < static_cast<int>(mesh.num_elements()); ++element)
    mesh.element_sets[element % 2 == 0 ? "even" : "odd"].push_back(element);
  mesh.node_sets["corner"] = {0};
  return mesh;
}

MeshSurfaceParameters in_plane(double x, double y, double offset) {
  MeshSurfaceParameters surface;
  surface.plane = MeshPlaneParameters{{x, y}, offset};
  return surface;
}

/// A beam as a body from its mesh, without supports.
MeshBodyParameters meshed(const BeamParameters& beam) {
  MeshBodyParameters body;
  body.length_unit = "mm";
  body.thickness = beam.width;
  body.angle = beam.angle;
  body.material = beam.material;
  body.damping = beam.damping;
  body.surfaces = {{"top", in_plane(0, 1, 0.5 * beam.thickness)},
                   {"bottom", in_plane(0, -1, 0.5 * beam.thickness)},
                   {"start_face", in_plane(-1, 0, 0.0)},
                   {"end_face", in_plane(1, 0, beam.length)}};
  body.mesh = std::make_shared<const Mesh>(mesh_of(beam));
  return body;
}

BeamParameters oblique_beam() {
  BeamParameters beam = test::paper_oblique(0.4);
  beam.mesh = {6, 2};
  beam.supports = {Support::free, Support::guided};
  return beam;
}

MeshBodyParameters oblique_mesh() {
  MeshBodyParameters body = meshed(oblique_beam());
  body.guided = MeshGuideParameters{{"end_face"}};
  return body;
}

void expect_same(const SparseMatrix& a, const SparseMatrix& b, double tolerance) {
  ASSERT_EQ(a.rows(), b.rows());
  const SparseMatrix difference = a - b;
  EXPECT_LE(difference.norm(), tolerance * b.norm());
}

void expect_same(const DofSum& a, const DofSum& b, double tolerance) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].dof, b[i].dof);
    EXPECT_NEAR(a[i].weight, b[i].weight, tolerance);
  }
}

// DoFs are numbered alike, and the matrices are those of the same elements.
TEST(MeshBody, OfABeamIsTheBeam) {
  const BodyMatrices beam = make_beam(oblique_beam());
  const BodyMatrices body = oblique_mesh().make();
  expect_same(body.mass, beam.mass, 1e-13);
  expect_same(body.stiffness, beam.stiffness, 1e-13);
  EXPECT_LE((body.nodes - beam.nodes).norm(), 1e-14);
  EXPECT_EQ(body.node_dofs, beam.node_dofs);
  EXPECT_EQ(body.load_dof, beam.load_dof);
  EXPECT_LE((body.base_inertia - beam.base_inertia).norm(), 1e-13 * beam.base_inertia.norm());
  for (const auto& [name, nodes] : beam.surfaces) EXPECT_EQ(body.surfaces.at(name), nodes) << name;
  for (const auto& [name, load] : beam.loads) expect_same(body.loads.at(name), load, 1e-12);
}

TEST(MeshBody, SupportsHoldDirections) {
  BeamParameters beam = test::paper_cantilever();
  beam.mesh = {8, 1};
  beam.supports = {Support::clamped, Support::free};
  MeshBodyParameters mesh = meshed(beam);
  mesh.supports = {{"root", {{"start_face"}, {}}}};
  expect_same(mesh.make().stiffness, make_beam(beam).stiffness, 1e-13);

  mesh.supports = {{"root", {{"start_face"}, {"x"}}}, {"foot", {{"corner"}, {"y"}}}};
  const BodyMatrices body = mesh.make();
  EXPECT_EQ(body.node_dofs[0], (std::array{BodyMatrices::held, BodyMatrices::held}));
  EXPECT_EQ(body.node_dofs[1][0], BodyMatrices::held);
  EXPECT_NE(body.node_dofs[1][1], BodyMatrices::held);
}

TEST(MeshBody, PointsBetweenNodesMoveAsTheElementDoes) {
  BeamParameters beam = oblique_beam();
  const double at = 0.3 * beam.length / beam.mesh.along;
  beam.points["probe"] = {"bottom", at};
  MeshBodyParameters mesh = oblique_mesh();
  // The bottom begins at the end of the axis.
  mesh.points["probe"].at = {beam.length - at, -0.5 * beam.thickness};
  mesh.points["corner"].node = 101;
  mesh.points["mean"].mean_of = "top";
  const BodyMatrices expected = make_beam(beam);
  const BodyMatrices body = mesh.make();
  const int probe = body.points.at("probe");
  EXPECT_LE((body.nodes.row(probe) - expected.nodes.row(expected.points.at("probe"))).norm(),
            1e-13);
  DofSum weights = body.displacement(probe, 0);
  std::erase_if(weights, [](const DofWeight& dof) { return std::abs(dof.weight) < 1e-12; });
  expect_same(weights, expected.displacement(expected.points.at("probe"), 0), 1e-12);
  EXPECT_EQ(body.points.at("corner"), 0);
  expect_same(body.displacement(body.points.at("mean"), 1), body.loads.at("top.y"), 1e-15);
}

TEST(MeshBody, SpringsOnSurfacesAreThoseOfABeam) {
  BeamParameters beam = oblique_beam();
  beam.springs["bed"].on = "bottom";
  beam.springs["bed"].stiffness.xx = 1e5;
  beam.springs["bed"].stiffness.xy = 2e4;
  MeshBodyParameters mesh = oblique_mesh();
  mesh.springs = beam.springs;
  const BodyMatrices expected = make_beam(beam);
  const BodyMatrices body = mesh.make();
  const SparseMatrix spring = expected.stiffness - make_beam(oblique_beam()).stiffness;
  const SparseMatrix found = body.stiffness - oblique_mesh().make().stiffness;
  const SparseMatrix difference = found - spring;
  EXPECT_LE(difference.norm(), 1e-13 * expected.stiffness.norm());
  expect_same(body.loads.at("bed.y"), expected.loads.at("bed.y"), 1e-8);
}

// A bar of two materials in a row: the mass of each set is its own.
TEST(MeshBody, SetsMayHaveMaterialsOfTheirOwn) {
  const BeamParameters beam = oblique_beam();
  MeshBodyParameters mesh = oblique_mesh();
  mesh.materials["odd"] = beam.material;
  mesh.materials["odd"].density *= 3.0;
  const double ratio = mesh.make().base_inertia.sum() / oblique_mesh().make().base_inertia.sum();
  EXPECT_GT(ratio, 1.5);
  EXPECT_LT(ratio, 2.5);
  mesh.materials["even"] = mesh.materials["odd"];
  EXPECT_NEAR(mesh.make().base_inertia.sum() / oblique_mesh().make().base_inertia.sum(), 3.0,
              1e-12);
}

/// A bar of hex20 along x, of square section, in metres.
Mesh bar(int along, double length, double side) {
  Mesh mesh;
  std::map<std::array<int, 3>, int> numbers;
  std::vector<Eigen::RowVector3d> places;
  const auto node = [&](int i, int j, int k) {
    const auto [found, is_new] =
        numbers.emplace(std::array{i, j, k}, static_cast<int>(places.size()));
    if (is_new)
      places.emplace_back(length * i / (2.0 * along), 0.5 * side * (j - 1), 0.5 * side * (k - 1));
    return found->second;
  };
  for (int e = 0; e < along; ++e) {
    const int a = 2 * e;
    const int b = a + 1;
    const int c = a + 2;
    const std::array nodes{node(a, 0, 0), node(c, 0, 0), node(c, 2, 0), node(a, 2, 0),
                           node(a, 0, 2), node(c, 0, 2), node(c, 2, 2), node(a, 2, 2),
                           node(b, 0, 0), node(c, 1, 0), node(b, 2, 0), node(a, 1, 0),
                           node(b, 0, 2), node(c, 1, 2), node(b, 2, 2), node(a, 1, 2),
                           node(a, 0, 1), node(c, 0, 1), node(c, 2, 1), node(a, 2, 1)};
    mesh.add_element(ElementShape::hex20, nodes, e + 1);
  }
  mesh.nodes.resize(static_cast<Eigen::Index>(places.size()), 3);
  for (std::size_t i = 0; i < places.size(); ++i)
    mesh.nodes.row(static_cast<Eigen::Index>(i)) = places[i];
  mesh.node_labels.resize(places.size());
  std::iota(mesh.node_labels.begin(), mesh.node_labels.end(), 1);
  return mesh;
}

// Bernoulli's cantilever, 1.8751² √(EI/ρA)/L² in both directions; slender enough for 0.5 %.
TEST(MeshBody, InSpaceBendsAsASlenderBeam) {
  constexpr double length = 0.5;
  constexpr double side = 0.01;
  MeshBodyParameters body;
  body.material = {2e11, 0.0, 7800.0};
  body.mesh = std::make_shared<const Mesh>(bar(10, length, side));
  body.surfaces["root"].plane = MeshPlaneParameters{{1, 0, 0}, 0.0};
  body.supports = {{"root", {{"root"}, {}}}};
  body.points["tip"].at = {length, 0.0, 0.0};
  const BodyMatrices matrices = body.make();
  const Eigen::VectorXd spectrum =
      test::dense_spectrum(Eigen::MatrixXd(matrices.stiffness), Eigen::MatrixXd(matrices.mass));
  const double expected =
      std::pow(1.875104, 2) * std::sqrt(2e11 * side * side / 12.0 / 7800.0) / (length * length);
  EXPECT_NEAR(std::sqrt(spectrum(0)), expected, 5e-3 * expected);
  EXPECT_NEAR(std::sqrt(spectrum(1)), expected, 5e-3 * expected);
  // All three directions of the tip, of which the mass is consistent.
  for (const std::size_t direction : {0, 1, 2})
    EXPECT_FALSE(matrices.displacement(matrices.points.at("tip"), direction).empty());
}

TEST(MeshPoint, IsFoundInCurvedElementsOrNot) {
  Mesh mesh = bar(2, 2.0, 1.0);
  mesh.nodes.col(1) += 0.2 * mesh.nodes.col(0).cwiseAbs2();
  const MeshPoint found = find_point(mesh, {0.7, 0.2 * 0.49 + 0.1, -0.3}, 1e-9);
  ASSERT_EQ(found.nodes.size(), 20u);
  Eigen::RowVector3d place = Eigen::RowVector3d::Zero();
  for (std::size_t i = 0; i < found.nodes.size(); ++i)
    place += found.weights[i] * mesh.nodes.row(found.nodes[i]);
  EXPECT_LE((place - Eigen::RowVector3d(0.7, 0.198, -0.3)).norm(), 1e-9);
  EXPECT_EQ(find_point(mesh, mesh.nodes.row(7).transpose(), 1e-9).nodes, std::vector{7});
  const MeshPoint outside = find_point(mesh, {0.7, 0.2 * 0.49 + 0.51, 0.0}, 1e-9);
  EXPECT_TRUE(outside.nodes.empty());
  EXPECT_GT(outside.distance, 0.0);
}

TEST(MeshBody, WhatDoesNotFitTheMeshIsRefusedWithItsKey) {
  const auto refusal = [](const auto& change) {
    MeshBodyParameters body = oblique_mesh();
    change(body);
    return message_of<ConfigError>([&] { body.make(); });
  };
  EXPECT_THAT(refusal([](auto& b) { b.thickness.reset(); }),
              HasSubstr("thickness: is missing: the mesh is planar"));
  EXPECT_THAT(refusal([](auto& b) { b.length_unit = "kg"; }), HasSubstr("length_unit: "));
  EXPECT_THAT(refusal([](auto& b) { b.surfaces["far"] = in_plane(1, 0, 7.0); }),
              HasSubstr("surfaces.far: no outer side of an element lies there; the mesh reaches"));
  EXPECT_THAT(
      refusal([](auto& b) { b.supports["a"].on = {"topp"}; }),
      HasSubstr("supports.a.on: there is no surface or node set 'topp', did you mean 'top'?"));
  EXPECT_THAT(refusal([](auto& b) { b.guided->on = {"rail"}; }),
              HasSubstr("guided.on: there is no"));
  EXPECT_THAT(refusal([](auto& b) {
                b.supports["a"] = {{"top"}, {"z"}};
              }),
              HasSubstr("supports.a.held: a planar body does not move along z"));
  EXPECT_THAT(refusal([](auto& b) { b.materials["steel"] = b.material; }),
              HasSubstr("materials.steel: there is no element set 'steel'"));
  EXPECT_THAT(refusal([](auto& b) { b.points["p"].node = 7; }),
              HasSubstr("points.p.node: no element of the mesh has a node 7"));
  EXPECT_THAT(refusal([](auto& b) {
                b.points["p"].at = {0.0, 1.0};
              }),
              HasSubstr("points.p.at: lies outside of the mesh: its nearest node, "));
  EXPECT_THAT(refusal([](auto& b) { b.points["p"].mean_of = "lid"; }),
              HasSubstr("points.p.mean_of: there is no surface or node set 'lid'"));
  EXPECT_THAT(refusal([](auto& b) { b.points["top"].node = 101; }),
              HasSubstr("points.top: 'top' is a surface; take another name"));
  EXPECT_THAT(refusal([](auto& b) { b.springs["s"].on = "lid"; }),
              HasSubstr("springs.s.on: there is no surface or point 'lid'"));
  EXPECT_THAT(refusal([](auto& b) {
                Mesh mesh = *b.mesh;
                std::swap(mesh.connectivity[0], mesh.connectivity[1]);
                b.mesh = std::make_shared<const Mesh>(mesh);
              }),
              HasSubstr("file: "));
  MeshBodyParameters unread = oblique_mesh();
  unread.mesh.reset();
  EXPECT_THROW(unread.make(), std::invalid_argument);
}

}  // namespace
}  // namespace stridor
