#include "io/imports/inp_mesh.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <map>

#include "core/errors.hpp"
#include "tests/support/message_of.hpp"

namespace stridor {
namespace {

using NodeSets = std::map<std::string, std::vector<int>>;

ImportedMesh read_inp(const std::string& text) {
  return read_inp_mesh({"m.inp", text});
}

/// A unit cube and a second one above it.
const std::string two_cubes =
    "*Heading\nTwo cubes, one above the other\n** a comment\n"
    "*NODE, NSET=Nall\n"
    " 1, 0., 0, 0\n 2, 1., 0, 0\n 3, 1.0E0, 1D0, 0.\n 4, 0, +1.,0\n"
    " 5, 0, 0, 1\n 6, 1, 0, 1\n 7, 1, 1, 1\n 8, 0, 1, 1\n"
    "11, , , 2\n12, 1, 0, 2\n13, 1, 1, 2,\n14, 0, 1, 2, 0., 0., 1.\n99, 5, 5, 5\n"
    "*element, type=c3d8r,\n elset=Eall\n"
    "1, 1, 2, 3, 4,\n5, 6, 7, 8\n2, 5, 6, 7, 8, 11, 12, 13, 14,\n";

TEST(InpMesh, NodesAndElements) {
  const ImportedMesh read = read_inp(two_cubes);
  const Mesh& mesh = read.mesh;
  ASSERT_EQ(mesh.num_elements(), 2U);
  EXPECT_EQ(mesh.shapes[0], ElementShape::hex8);
  EXPECT_EQ(mesh.node_labels, (std::vector<std::int64_t>{1, 2, 3, 4, 5, 6, 7, 8, 11, 12, 13, 14}));
  EXPECT_EQ(mesh.nodes.row(2), Eigen::RowVector3d(1, 1, 0));
  EXPECT_EQ(mesh.nodes.row(8), Eigen::RowVector3d(0, 0, 2));
  EXPECT_EQ(mesh.connectivity,
            (std::vector<int>{0, 1, 2, 3, 4, 5, 6, 7, 4, 5, 6, 7, 8, 9, 10, 11}));
  EXPECT_EQ(mesh.node_sets.at("Nall").size(), 12U);
  EXPECT_EQ(mesh.element_sets, (NodeSets{{"Eall", {0, 1}}}));
  EXPECT_EQ(read.summary.dropped_nodes, 1U);
  EXPECT_EQ(read.summary.skipped, (std::vector<std::string>{"*HEADING"}));
  EXPECT_EQ(read.summary.highest, (std::array<double, 3>{1, 1, 2}));
}

TEST(InpMesh, EveryTypeHasTheNodesOfItsShape) {
  const std::map<std::string, ElementShape> types{
      {"CPS3", ElementShape::tri3},    {"CPE6", ElementShape::tri6},
      {"CPS4R", ElementShape::quad4},  {"CPE8", ElementShape::quad8},
      {"C3D4", ElementShape::tet4},    {"C3D10", ElementShape::tet10},
      {"C3D8I", ElementShape::hex8},   {"C3D20R", ElementShape::hex20},
      {"C3D6", ElementShape::wedge6},  {"C3D15", ElementShape::wedge15},
      {"C3D10M", ElementShape::tet10}, {"S4R", ElementShape::quad4}};
  for (const auto& [name, shape] : types) {
    std::string nodes = "*NODE\n";
    std::string element = "*ELEMENT, TYPE=" + name + "\n7";
    for (int k = 1; k <= facts_of(shape).num_nodes; ++k) {
      nodes += std::to_string(k) + ", " + std::to_string(k) + ", " + std::to_string(k * k) +
               (facts_of(shape).dimension == 3 ? ", " + std::to_string(k * k * k) : "") + "\n";
      element += (k == 10 ? ",\n " : ", ") + std::to_string(k);
    }
    const Mesh mesh = read_inp(nodes + element + "\n").mesh;
    ASSERT_EQ(mesh.shapes, std::vector<ElementShape>{shape}) << name;
    for (int k = 0; k < facts_of(shape).num_nodes; ++k)
      EXPECT_EQ(mesh.connectivity[static_cast<std::size_t>(k)], k);
  }
}

TEST(InpMesh, Sets) {
  const Mesh mesh = read_inp(two_cubes +
                             "*NSET, NSET=Bottom\n4, 3,\n2, 1\n"
                             "*NSET, NSET=top, GENERATE\n11, 14, 1\n"
                             "*NSET, NSET=odd, GENERATE, INTERNAL\n1, 1000, 2\n"
                             "*NSET, NSET=both, UNSORTED\nbottom, TOP\n5\n"
                             "*NSET, NSET=bottom\n5\n"
                             "*NSET, NSET=\"with, comma\"\n1\n*NSET, NSET=c\n\"With, Comma\", 2\n"
                             "*NSET, NSET=loose\n99\n"
                             "*ELSET, ELSET=Upper\n2\n*ELSET, ELSET=all\nUpper, 1\n"
                             "*ELSET, ELSET=g, GENERATE\n1, 2\n")
                        .mesh;
  EXPECT_EQ(mesh.node_sets.at("Bottom"), (std::vector<int>{0, 1, 2, 3, 4}));
  EXPECT_EQ(mesh.node_sets.at("top"), (std::vector<int>{8, 9, 10, 11}));
  EXPECT_EQ(mesh.node_sets.at("odd"), (std::vector<int>{0, 2, 4, 6, 8, 10}));
  EXPECT_EQ(mesh.node_sets.at("both"), (std::vector<int>{0, 1, 2, 3, 4, 8, 9, 10, 11}));
  EXPECT_EQ(mesh.node_sets.at("with, comma"), (std::vector<int>{0}));
  EXPECT_EQ(mesh.node_sets.at("c"), (std::vector<int>{0, 1}));
  EXPECT_TRUE(mesh.node_sets.at("loose").empty());
  EXPECT_EQ(mesh.element_sets.at("Upper"), (std::vector<int>{1}));
  EXPECT_EQ(mesh.element_sets.at("all"), (std::vector<int>{0, 1}));
  EXPECT_EQ(mesh.element_sets.at("g"), (std::vector<int>{0, 1}));
}

Eigen::Vector3d inp_normal(const Mesh& mesh, const ElementSide& side) {
  const auto element = static_cast<std::size_t>(side.element);
  const SideNodes& facts =
      facts_of(mesh.shapes[element]).sides[static_cast<std::size_t>(side.side)];
  const auto position = [&](std::size_t k) -> Eigen::Vector3d {
    const auto node = mesh.nodes_of(element)[static_cast<std::size_t>(facts.nodes[k])];
    return mesh.nodes.row(node).transpose();
  };
  return (position(1) - position(0)).cross(position(2) - position(0));
}

TEST(InpMesh, Surfaces) {
  const Mesh mesh = read_inp(two_cubes +
                             "*SURFACE, NAME=top\n2, S2\n"
                             "*SURFACE, NAME=front, TYPE=ELEMENT\nEall, s3\n2, S3\n"
                             "*NSET, NSET=low\n1, 2\n"
                             "*SURFACE, NAME=nodes, TYPE=NODE\nlow, 1.\n3\n")
                        .mesh;
  EXPECT_EQ(mesh.surfaces.at("top"), (std::vector<ElementSide>{{1, 1}}));
  EXPECT_EQ(mesh.surfaces.at("front"), (std::vector<ElementSide>{{0, 2}, {1, 2}}));
  EXPECT_EQ(inp_normal(mesh, {1, 1}), Eigen::Vector3d(0, 0, 1));
  for (const ElementSide& side : mesh.surfaces.at("front"))
    EXPECT_EQ(inp_normal(mesh, side), Eigen::Vector3d(0, -1, 0));
  EXPECT_EQ(mesh.node_sets.at("nodes"), (std::vector<int>{0, 1, 2}));
}

TEST(InpMesh, EdgesOfPlanarElements) {
  const std::string nodes = "*NODE\n1, 0, 0\n2, 1, 0\n3, 1, 1\n4, 0, 1\n";
  Mesh mesh =
      read_inp(nodes + "*ELEMENT, TYPE=CPS4\n1, 1, 2, 3, 4\n*SURFACE, NAME=s\n1, S4\n").mesh;
  EXPECT_EQ(mesh.surfaces.at("s"), (std::vector<ElementSide>{{0, 3}}));
  mesh = read_inp(nodes + "*ELEMENT, TYPE=S4\n1, 1, 2, 3, 4\n*SURFACE, NAME=s\n1, E4\n").mesh;
  EXPECT_EQ(mesh.surfaces.at("s"), (std::vector<ElementSide>{{0, 3}}));
}

TEST(InpMesh, OtherKeywordsAreSkippedAndListed) {
  const ImportedMesh read =
      read_inp(two_cubes +
               "*MATERIAL, NAME=steel\n*ELASTIC\n210e9, 0.3\n"
               "*Surface, name=r, type=CYLINDER\n1, 2\n"
               "*STEP\n*FREQUENCY\n10\n*NODE   OUTPUT\nU\n*END STEP\n*ELASTIC\n");
  EXPECT_EQ(
      read.summary.skipped,
      (std::vector<std::string>{"*HEADING", "*MATERIAL", "*ELASTIC", "*SURFACE, TYPE=CYLINDER",
                                "*STEP", "*FREQUENCY", "*NODE OUTPUT", "*END STEP"}));
}

TEST(InpMesh, OnePartWithOneInstance) {
  const std::string part =
      "*Part, name=Part-1\n*Node\n1, 0, 0\n2, 1, 0\n3, 1, 1\n4, 0, 1\n"
      "*Element, type=CPS4\n1, 1, 2, 3, 4\n*Nset, nset=Set-1\n1, 2\n*Nset, nset=held\n3\n"
      "*Elset, elset=all\n1\n*Surface, name=s\nall, S1\n*End Part\n";
  const std::string assembly =
      "*Assembly, name=Assembly\n*Instance, name=Part-1-1, part=Part-1\n0., 0., 0.\n*End Instance\n"
      "*Node\n1, 7, 7, 7\n*Nset, nset=ref\n1\n*Nset, nset=ref2, generate\n1, 1\n"
      "*Nset, nset=Set-1, instance=Part-1-1\n4,\n*Nset, nset=x\nPart-1-1.Set-1, PART-1-1.3\n"
      "*Nset, nset=held, instance=part-1-1\nheld\n"
      "*Elset, elset=_s2_S3, internal, instance=Part-1-1\n1\n*Surface, name=s2\n_s2_S3, S3\n"
      "*Surface, name=s\nPart-1-1.all, S2\n*End Assembly\n";
  const ImportedMesh read = read_inp(part + assembly);
  EXPECT_EQ(read.mesh.node_sets, (NodeSets{{"Part-1-1.Set-1", {0, 1}},
                                           {"Part-1-1.held", {2}},
                                           {"Set-1", {3}},
                                           {"held", {2}},
                                           {"ref", {}},
                                           {"ref2", {}},
                                           {"x", {0, 1, 2}}}));
  EXPECT_EQ(read.mesh.surfaces.at("s2"), (std::vector<ElementSide>{{0, 2}}));
  EXPECT_EQ(read.mesh.surfaces.at("s"), (std::vector<ElementSide>{{0, 1}}));
  EXPECT_EQ(read.mesh.surfaces.at("Part-1-1.s"), (std::vector<ElementSide>{{0, 0}}));
  EXPECT_EQ(read.summary.skipped,
            (std::vector<std::string>{"*NODE of the assembly", "*NSET of nodes of the assembly"}));
  EXPECT_EQ(read_inp(part).mesh.node_sets, (NodeSets{{"Set-1", {0, 1}}, {"held", {2}}}));
}

TEST(InpMesh, IncludedFilesAreReadInTheirPlace) {
  const std::map<std::string, std::string> files{
      {"nodes.inc", "1, 0, 0\n2, 1, 0\n"},
      {"more.inc", "3, 1, 1\n*INCLUDE, INPUT=last.inc\n"},
      {"last.inc", "4, 0, 1"}};
  std::vector<std::string> includers;
  const auto reader = [&](const std::string& including, const std::string& file) {
    includers.push_back(including);
    return SourceText{file, files.at(file)};
  };
  const Mesh mesh =
      read_inp_mesh({"m.inp",
                     "*NODE, NSET=all, INPUT=nodes.inc\n*INCLUDE, INPUT=\"more.inc\"\n"
                     "*ELEMENT, TYPE=CPS4\n1, 1, 2, 3, 4\n"},
                    reader)
          .mesh;
  EXPECT_EQ(mesh.node_sets, (NodeSets{{"all", {0, 1, 2, 3}}}));
  EXPECT_EQ(includers, (std::vector<std::string>{"m.inp", "m.inp", "more.inc"}));
}

// The comma asks for another line, behind which the file has ended.
TEST(InpMesh, AFileIsIncludedFromTheLastLineWithACommaTooMany) {
  const auto reader = [](const std::string& including, const std::string& file) {
    EXPECT_EQ(including, "m.inp");
    return SourceText{
        file, "*NODE, NSET=all\n1, 0, 0\n2, 1, 0\n3, 0, 1\n*ELEMENT, TYPE=CPS3\n1, 1, 2, 3\n"};
  };
  for (const char* text :
       {"*INCLUDE, INPUT=a.inc,", "*INCLUDE, INPUT=a.inc,\n", "*INCLUDE, INPUT=a.inc, \n**\n"})
    EXPECT_EQ(read_inp_mesh({"m.inp", text}, reader).mesh.node_sets, (NodeSets{{"all", {0, 1, 2}}}))
        << text;
  const std::string itself = message_of<ConfigError>([&] {
    (void)read_inp_mesh({"m.inp", "*INCLUDE, INPUT=m.inp,\n"}, reader);
  });
  EXPECT_NE(itself.find("'m.inp' includes itself"), std::string::npos) << itself;
}

}  // namespace
}  // namespace stridor
