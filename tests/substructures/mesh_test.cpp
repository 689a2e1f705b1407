#include "substructures/elements/mesh.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <numeric>
#include <set>
#include <stdexcept>

#include "substructures/elements/mesh_surfaces.hpp"
#include "tests/support/message_of.hpp"

namespace stridor {
namespace {

using test::message_of;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr ElementShape every_shape[] = {
    ElementShape::tri3,   ElementShape::tri6,   ElementShape::quad4, ElementShape::quad8,
    ElementShape::tet4,   ElementShape::tet10,  ElementShape::hex8,  ElementShape::hex20,
    ElementShape::wedge6, ElementShape::wedge15};

/// Corners of every shape where its natural coordinates have them.
Eigen::MatrixXd corners_of(ElementShape shape) {
  Eigen::MatrixXd corners;
  switch (facts_of(shape).num_corners * 10 + facts_of(shape).dimension) {
    case 32:
      corners.resize(3, 3);
      corners << 0, 0, 0, 1, 0, 0, 0, 1, 0;
      break;
    case 42:
      corners.resize(4, 3);
      corners << -1, -1, 0, 1, -1, 0, 1, 1, 0, -1, 1, 0;
      break;
    case 43:
      corners.resize(4, 3);
      corners << 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1;
      break;
    case 63:
      corners.resize(6, 3);
      corners << 0, 0, -1, 1, 0, -1, 0, 1, -1, 0, 0, 1, 1, 0, 1, 0, 1, 1;
      break;
    default:
      corners.resize(8, 3);
      corners << -1, -1, -1, 1, -1, -1, 1, 1, -1, -1, 1, -1, -1, -1, 1, 1, -1, 1, 1, 1, 1, -1, 1, 1;
  }
  return corners;
}

TEST(ElementShapes, NormalsOfSidesPointOutwards) {
  for (const ElementShape shape : every_shape) {
    const Eigen::MatrixXd corners = corners_of(shape);
    const Eigen::Vector3d middle = corners.colwise().mean().transpose();
    for (const SideNodes& side : facts_of(shape).sides) {
      const Eigen::Vector3d a = corners.row(side.nodes[0]).transpose();
      const Eigen::Vector3d b = corners.row(side.nodes[1]).transpose();
      Eigen::Vector3d normal(b.y() - a.y(), a.x() - b.x(), 0.0);
      if (facts_of(shape).dimension == 3) {
        const Eigen::Vector3d c = corners.row(side.nodes[2]).transpose();
        normal = (b - a).cross(c - b);
      }
      EXPECT_GT(normal.dot(a - middle), 0.0) << facts_of(shape).name;
    }
  }
}

// Every edge of an element belongs to two of its sides, which pass it in opposite directions, and
// both say the same of its middle.
TEST(ElementShapes, SidesOfAVolumeCloseItAndAgreeOnTheMiddlesOfEdges) {
  for (const ElementShape shape : every_shape) {
    if (facts_of(shape).dimension == 2) continue;
    std::set<std::array<int, 3>> passed;
    std::set<int> nodes;
    for (const SideNodes& side : facts_of(shape).sides) {
      const bool has_middles = side.count > side.num_corners;
      for (int i = 0; i < side.num_corners; ++i) {
        const auto node = [&](int k) { return side.nodes[static_cast<std::size_t>(k)]; };
        const int middle = has_middles ? node(side.num_corners + i) : -1;
        EXPECT_TRUE(passed.insert({node(i), node((i + 1) % side.num_corners), middle}).second);
        nodes.insert(node(i));
        if (has_middles) nodes.insert(middle);
      }
    }
    for (const auto& [from, to, middle] : passed)
      EXPECT_TRUE(passed.contains({to, from, middle})) << facts_of(shape).name;
    EXPECT_EQ(static_cast<int>(nodes.size()), facts_of(shape).num_nodes) << facts_of(shape).name;
  }
}

/// Squares of side 1 m in a row along x, quad4.
Mesh squares(int count) {
  Mesh mesh;
  mesh.nodes = Mesh::Nodes::Zero(2 * (count + 1), 3);
  for (int i = 0; i <= count; ++i) {
    mesh.nodes.row(2 * i) << i, 0, 0;
    mesh.nodes.row(2 * i + 1) << i, 1, 0;
  }
  for (int i = 0; i < count; ++i) {
    const int nodes[] = {2 * i, 2 * i + 2, 2 * i + 3, 2 * i + 1};
    mesh.add_element(ElementShape::quad4, nodes, i + 1);
  }
  mesh.node_labels.resize(mesh.num_nodes());
  std::iota(mesh.node_labels.begin(), mesh.node_labels.end(), 1);
  return mesh;
}

std::vector<ElementSide> sides_in_plane(const Mesh& mesh, const Eigen::Vector3d& normal,
                                        double offset) {
  MeshRegion region;
  region.plane = MeshRegion::Plane{normal, offset};
  return sides_within(mesh, outer_sides(mesh), region, 1e-9);
}

TEST(MeshSurfaces, OuterSidesAreThoseOfOneElement) {
  const Mesh mesh = squares(3);
  EXPECT_EQ(outer_sides(mesh).size(), 8u);
  EXPECT_THAT(sides_in_plane(mesh, Eigen::Vector3d::UnitX(), 1.0), IsEmpty());
  EXPECT_THAT(sides_in_plane(mesh, 5.0 * Eigen::Vector3d::UnitX(), 3.0),
              ElementsAre(ElementSide{2, 1}));
}

TEST(MeshSurfaces, OutlinesHaveTheBodyOnTheirRight) {
  const Mesh mesh = squares(3);
  EXPECT_THAT(outline_of(mesh, sides_in_plane(mesh, Eigen::Vector3d::UnitY(), 1.0)),
              ElementsAre(1, 3, 5, 7));
  EXPECT_THAT(outline_of(mesh, sides_in_plane(mesh, Eigen::Vector3d::UnitY(), 0.0)),
              ElementsAre(6, 4, 2, 0));
  const std::vector<int> closed = outline_of(mesh, outer_sides(mesh));
  EXPECT_EQ(closed.size(), 9u);
  EXPECT_EQ(closed.front(), closed.back());
}

TEST(MeshSurfaces, OutlinesThatAreNoChainAreRefused) {
  const Mesh mesh = squares(3);
  EXPECT_THAT(message_of<std::invalid_argument>([&] {
                outline_of(mesh, {ElementSide{0, 0}, ElementSide{2, 0}});
              }),
              HasSubstr("not in one piece: 1 of its 2 edges"));
  EXPECT_THAT(message_of<std::invalid_argument>([&] {
                outline_of(mesh, {ElementSide{0, 1}, ElementSide{1, 0}});
              }),
              HasSubstr("it branches at (1, 0) m"));
  EXPECT_THAT(message_of<std::invalid_argument>([&] { outline_of(mesh, {}); }),
              HasSubstr("no edges"));
}

TEST(MeshSurfaces, RegionsHoldWhatLiesInAllOfTheirParts) {
  MeshRegion region;
  region.cylinder = MeshRegion::Cylinder{{1, 0, 0}, {0, 0, 3}, 2.0};
  EXPECT_TRUE(region.contains({3, 0, 7}, 1e-9));
  EXPECT_FALSE(region.contains({2, 0, 7}, 1e-9));
  EXPECT_TRUE(region.contains({2.999, 0, 7}, 1e-2));
  region.box = MeshRegion::Box{{0, -1, 0}, {4, 1, 6}};
  EXPECT_FALSE(region.contains({3, 0, 7}, 1e-9));
  EXPECT_TRUE(region.contains({3, 0, 6}, 1e-9));
}

TEST(Meshes, OfTwoKindsHaveNoDimension) {
  Mesh mesh = squares(1);
  EXPECT_EQ(mesh.dimension(), 2);
  const int nodes[] = {0, 1, 2, 3};
  mesh.add_element(ElementShape::tet4, nodes, 2);
  EXPECT_THROW(mesh.dimension(), std::invalid_argument);
  EXPECT_THROW(mesh.add_element(ElementShape::tet4, std::span(nodes).first(3), 3),
               std::invalid_argument);
  EXPECT_THROW(Mesh().dimension(), std::invalid_argument);
}

}  // namespace
}  // namespace stridor
