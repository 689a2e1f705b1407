#include "io/imports/gmsh_mesh.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "core/errors.hpp"
#include "tests/io/gmsh_writer.hpp"
#include "tests/support/message_of.hpp"

namespace stridor {
namespace {

using test::gmsh_22;
using test::gmsh_41;
using test::GmshForm;
using test::GmshModel;
using test::message_of;

ImportedMesh read_gmsh(const std::string& text) {
  return read_gmsh_mesh({"m.msh", text});
}

std::string gmsh_failure(const std::string& text) {
  return message_of<ConfigError>([&] { read_gmsh(text); });
}

/// Two tetrahedra on both sides of the triangle 10, 20, 30 in z = 0, nodes with gaps, and a node
/// that nothing uses. Physical groups: both volumes, the upper one, the inner triangle, one outer
/// triangle of each, an edge and a point.
GmshModel two_tetrahedra() {
  GmshModel model;
  model.nodes = {{10, {0, 0, 0}}, {20, {1, 0, 0}},      {30, {0, 1, 0}},
                 {4, {0, 0, 1}},  {50'000, {0, 0, -1}}, {7, {9, 9, 9}}};
  model.blocks = {
      {0, 1, 15, {{1, {20}}}},           {1, 3, 1, {{2, {10, 20}}}},
      {2, 1, 2, {{3, {10, 20, 30}}}},    {2, 2, 2, {{4, {10, 4, 20}}, {5, {50'000, 10, 20}}}},
      {3, 1, 4, {{6, {10, 20, 30, 4}}}}, {3, 2, 4, {{8, {10, 30, 20, 50'000}}}}};
  model.groups = {{{0, 1}, {1}},  {{1, 3}, {5}},      {{2, 1}, {11}},
                  {{2, 2}, {12}}, {{3, 1}, {21, 22}}, {{3, 2}, {21}}};
  model.names = {{{0, 1}, "tip"},
                 {{2, 11}, "inner face"},
                 {{2, 12}, "outside"},
                 {{3, 21}, "everything"},
                 {{3, 22}, "upper"}};
  return model;
}

void expect_equal(const Mesh& one, const Mesh& other) {
  EXPECT_EQ(one.nodes, other.nodes);
  EXPECT_EQ(one.node_labels, other.node_labels);
  EXPECT_EQ(one.shapes, other.shapes);
  EXPECT_EQ(one.first_node, other.first_node);
  EXPECT_EQ(one.connectivity, other.connectivity);
  EXPECT_EQ(one.element_labels, other.element_labels);
  EXPECT_EQ(one.node_sets, other.node_sets);
  EXPECT_EQ(one.element_sets, other.element_sets);
  EXPECT_EQ(one.surfaces, other.surfaces);
}

Eigen::Vector3d normal_of(const Mesh& mesh, const ElementSide& side) {
  const auto element = static_cast<std::size_t>(side.element);
  const SideNodes& facts =
      facts_of(mesh.shapes[element]).sides[static_cast<std::size_t>(side.side)];
  const auto position = [&](std::size_t k) -> Eigen::Vector3d {
    const auto node = mesh.nodes_of(element)[static_cast<std::size_t>(facts.nodes[k])];
    return mesh.nodes.row(node).transpose();
  };
  return (position(1) - position(0)).cross(position(2) - position(0));
}

TEST(GmshMesh, EveryVersionAndFormGivesTheSameMesh) {
  const Mesh mesh = read_gmsh(gmsh_41(two_tetrahedra(), GmshForm::text)).mesh;
  ASSERT_EQ(mesh.num_elements(), 2U);
  expect_equal(read_gmsh(gmsh_41(two_tetrahedra(), GmshForm::binary)).mesh, mesh);
  expect_equal(read_gmsh(gmsh_22(two_tetrahedra(), GmshForm::text)).mesh, mesh);
  expect_equal(read_gmsh(gmsh_22(two_tetrahedra(), GmshForm::binary)).mesh, mesh);
  // Parametric coordinates are passed over.
  expect_equal(read_gmsh(gmsh_41(two_tetrahedra(), GmshForm::text, 1)).mesh, mesh);
  expect_equal(read_gmsh(gmsh_41(two_tetrahedra(), GmshForm::binary, 1)).mesh, mesh);
}

TEST(GmshMesh, LinesMayEndAsOnWindows) {
  std::string text = gmsh_41(two_tetrahedra(), GmshForm::text);
  for (std::size_t i = text.find('\n'); i != std::string::npos; i = text.find('\n', i + 2))
    text.insert(i, "\r");
  expect_equal(read_gmsh(text).mesh, read_gmsh(gmsh_41(two_tetrahedra(), GmshForm::text)).mesh);
}

TEST(GmshMesh, GroupsBecomeSetsAndSurfaces) {
  const ImportedMesh read = read_gmsh(gmsh_22(two_tetrahedra(), GmshForm::text));
  const Mesh& mesh = read.mesh;
  EXPECT_EQ(mesh.node_labels, (std::vector<std::int64_t>{10, 20, 30, 4, 50'000}));
  EXPECT_EQ(mesh.element_labels, (std::vector<std::int64_t>{6, 8}));
  using Sets = std::map<std::string, std::vector<int>>;
  EXPECT_EQ(mesh.element_sets, (Sets{{"everything", {0, 1}}, {"upper", {0}}}));
  EXPECT_EQ(mesh.node_sets, (Sets{{"tip", {1}},
                                  {"group_5", {0, 1}},
                                  {"inner face", {0, 1, 2}},
                                  {"outside", {0, 1, 3, 4}}}));
  ASSERT_EQ(mesh.surfaces.size(), 2U);
  EXPECT_EQ(mesh.surfaces.at("outside").size(), 2U);
  EXPECT_EQ(read.summary.format, "Gmsh 2.2, text");
  EXPECT_EQ(read.summary.num_nodes, 5U);
  EXPECT_EQ(read.summary.dropped_nodes, 1U);
  EXPECT_EQ(read.summary.elements.at(ElementShape::tet4), 2U);
  EXPECT_EQ(read.summary.node_sets.at("outside"), 4U);
  EXPECT_EQ(read.summary.element_sets.at("everything"), 2U);
  EXPECT_EQ(read.summary.surfaces.at("outside"), 2U);
  EXPECT_EQ(read.summary.lowest, (std::array<double, 3>{0, 0, -1}));
  EXPECT_EQ(read.summary.highest, (std::array<double, 3>{1, 1, 1}));
}

TEST(GmshMesh, NormalsOfSurfacesPointOutwards) {
  const Mesh mesh = read_gmsh(gmsh_41(two_tetrahedra(), GmshForm::text)).mesh;
  // Both of the outer triangles lie in y = 0, below the tetrahedra.
  for (const ElementSide& side : mesh.surfaces.at("outside"))
    EXPECT_EQ(normal_of(mesh, side).normalized(), Eigen::Vector3d(0, -1, 0));
}

TEST(GmshMesh, AnInnerFaceBelongsToTheElementThatItsNormalLeaves) {
  GmshModel model = two_tetrahedra();
  // Counter-clockwise seen from above: the normal leaves the lower element.
  Mesh mesh = read_gmsh(gmsh_41(model, GmshForm::text)).mesh;
  EXPECT_EQ(mesh.surfaces.at("inner face"), (std::vector<ElementSide>{{1, 0}}));
  EXPECT_EQ(normal_of(mesh, {1, 0}), Eigen::Vector3d(0, 0, 1));
  model.blocks[2].elements[0].second = {20, 10, 30};
  mesh = read_gmsh(gmsh_41(model, GmshForm::text)).mesh;
  EXPECT_EQ(mesh.surfaces.at("inner face"), (std::vector<ElementSide>{{0, 0}}));
}

TEST(GmshMesh, GroupsOfOneNameMakeOneNodeSet) {
  GmshModel model = two_tetrahedra();
  model.names.push_back({{1, 5}, "outside"});
  model.groups[{0, 1}] = {5};
  const Mesh mesh = read_gmsh(gmsh_41(model, GmshForm::text)).mesh;
  EXPECT_EQ(mesh.node_sets.at("outside"), (std::vector<int>{0, 1, 3, 4}));
  EXPECT_EQ(mesh.node_sets.at("group_5"), (std::vector<int>{1}));
}

TEST(GmshMesh, NodesOfAGroupThatNoElementUsesAreDropped) {
  GmshModel model = two_tetrahedra();
  model.blocks[0].elements[0].second = {7};
  const Mesh mesh = read_gmsh(gmsh_41(model, GmshForm::text)).mesh;
  EXPECT_TRUE(mesh.node_sets.at("tip").empty());
}

TEST(GmshMesh, OtherSectionsAreSkippedAndListed) {
  const std::string extra =
      "$NodeData\n1\n\"x\"\n$End\n$EndNodeData\n$Periodic\n0\n$EndPeriodic\n$Empty\n$EndEmpty\n"
      "$NodeData\n$EndNodeDatabase\n$EndNodeData\n";
  const ImportedMesh read = read_gmsh(gmsh_41(two_tetrahedra(), GmshForm::binary) + extra);
  EXPECT_EQ(read.summary.skipped, (std::vector<std::string>{"$NodeData", "$Periodic", "$Empty"}));
}

TEST(GmshMesh, PlanarMeshesLieInOnePlane) {
  GmshModel model;
  model.nodes = {{1, {0, 0, 3}}, {2, {2, 0, 3}}, {3, {2, 1, 3}}, {4, {0, 1, 3 + 1e-12}}};
  model.blocks = {{1, 1, 1, {{1, {2, 3}}}}, {2, 1, 3, {{2, {1, 2, 3, 4}}}}};
  model.groups = {{{1, 1}, {1}}};
  model.names = {{{1, 1}, "right"}};
  const ImportedMesh read = read_gmsh(gmsh_41(model, GmshForm::text));
  EXPECT_EQ(read.mesh.dimension(), 2);
  EXPECT_EQ(read.mesh.nodes.col(2), Eigen::Vector4d::Zero());
  EXPECT_EQ(read.summary.lowest[2], 3.0);
  EXPECT_EQ(read.mesh.surfaces.at("right"), (std::vector<ElementSide>{{0, 1}}));
  EXPECT_EQ(read.mesh.node_sets.at("right"), (std::vector<int>{1, 2}));
  model.nodes[3].position[2] = 3.1;
  EXPECT_EQ(gmsh_failure(gmsh_22(model, GmshForm::text)),
            "m.msh:13:1: node 4 has z = 3.1, others of this planar mesh 3; expected all in one "
            "plane z = const: curved shells are not supported, turn a plane one");
}

// What the manual of Gmsh says about middle nodes: their edges, by corners, in its order.
using Edges = std::vector<std::pair<int, int>>;
struct QuadraticType {
  int number, num_corners;
  Edges edges;
};
const std::vector<QuadraticType> quadratic_types{
    {9, 3, {{0, 1}, {1, 2}, {2, 0}}},
    {16, 4, {{0, 1}, {1, 2}, {2, 3}, {3, 0}}},
    {11, 4, {{0, 1}, {1, 2}, {2, 0}, {3, 0}, {2, 3}, {1, 3}}},
    {17,
     8,
     {{0, 1},
      {0, 3},
      {0, 4},
      {1, 2},
      {1, 5},
      {2, 3},
      {2, 6},
      {3, 7},
      {4, 5},
      {4, 7},
      {5, 6},
      {6, 7}}},
    {18, 6, {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 4}, {2, 5}, {3, 4}, {3, 5}, {4, 5}}},
};

TEST(GmshMesh, MiddleNodesLieInTheMiddleOfTheEdgesOfTheShape) {
  // Corners in general position, so that no two edges have the same middle.
  const std::vector<std::array<double, 3>> corners{{0, 0, 0},     {1, 0.1, 0},  {1.2, 1, 0},
                                                   {0.3, 1.5, 0}, {0, 0.2, 2},  {1.1, 0, 2.2},
                                                   {1, 1.3, 2.4}, {0.1, 1, 2.6}};
  for (const QuadraticType& type : quadratic_types) {
    GmshModel model;
    std::vector<std::int64_t> tags;
    const auto add = [&](const std::array<double, 3>& position) {
      tags.push_back(static_cast<std::int64_t>(tags.size()) + 1);
      model.nodes.push_back({tags.back(), position});
    };
    for (int k = 0; k < type.num_corners; ++k) {
      auto corner = corners[static_cast<std::size_t>(k)];
      if (type.number == 11 && k == 3) corner[2] = 1.7;
      if (type.number == 18 && k >= 3) corner[2] += 1.7;
      add(corner);
    }
    for (const auto& [from, to] : type.edges) {
      const auto& one = model.nodes[static_cast<std::size_t>(from)].position;
      const auto& other = model.nodes[static_cast<std::size_t>(to)].position;
      add({(one[0] + other[0]) / 2, (one[1] + other[1]) / 2, (one[2] + other[2]) / 2});
    }
    const int dimension = type.num_corners < 5 && type.number != 11 ? 2 : 3;
    model.blocks = {{dimension, 1, type.number, {{1, tags}}}};
    const Mesh mesh = read_gmsh(gmsh_41(model, GmshForm::binary)).mesh;
    const std::span<const int> nodes = mesh.nodes_of(0);
    int middles = 0;
    for (const SideNodes& side : facts_of(mesh.shapes[0]).sides) {
      const int num_edges = side.count - side.num_corners;
      for (int edge = 0; edge < num_edges; ++edge) {
        const auto at = [&](int k) {
          const auto local = static_cast<std::size_t>(side.nodes[static_cast<std::size_t>(k)]);
          return mesh.nodes.row(nodes[local]);
        };
        const auto middle = (at(edge) + at((edge + 1) % side.num_corners)) / 2;
        // Both are sums of the same two numbers, halved.
        EXPECT_EQ(at(side.num_corners + edge), middle) << facts_of(mesh.shapes[0]).name;
        ++middles;
      }
    }
    // Every edge of a volume is one of two sides.
    EXPECT_EQ(middles, static_cast<int>(type.edges.size()) * (dimension == 3 ? 2 : 1));
  }
}

TEST(GmshMesh, QuadraticFacesAreFoundWithTheirMiddleNodes) {
  GmshModel model;
  model.nodes = {{1, {0, 0, 0}}, {2, {2, 0, 0}}, {3, {0, 2, 0}}, {4, {0, 0, 2}}, {5, {1, 0, 0}},
                 {6, {1, 1, 0}}, {7, {0, 1, 0}}, {8, {0, 0, 1}}, {9, {0, 1, 1}}, {10, {1, 0, 1}}};
  model.blocks = {{2, 1, 9, {{1, {2, 3, 4, 6, 9, 10}}}},
                  {3, 1, 11, {{2, {1, 2, 3, 4, 5, 6, 7, 8, 9, 10}}}}};
  model.groups = {{{2, 1}, {3}}};
  const Mesh mesh = read_gmsh(gmsh_41(model, GmshForm::text)).mesh;
  EXPECT_EQ(mesh.surfaces.at("group_3"), (std::vector<ElementSide>{{0, 2}}));
  EXPECT_EQ(mesh.node_sets.at("group_3"), (std::vector<int>{1, 2, 3, 5, 8, 9}));
  model.blocks[0] = {2, 1, 2, {{1, {2, 3, 4}}}};
  EXPECT_NE(gmsh_failure(gmsh_41(model, GmshForm::text))
                .find("element 1 has the corners of a side of element 2, but other nodes between "
                      "them; expected both of the same order"),
            std::string::npos);
}

}  // namespace
}  // namespace stridor
