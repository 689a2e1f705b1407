#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/errors.hpp"
#include "io/imports/gmsh_mesh.hpp"
#include "tests/io/gmsh_writer.hpp"
#include "tests/support/message_of.hpp"

namespace stridor {
namespace {

using test::gmsh_22;
using test::gmsh_41;
using test::GmshForm;
using test::GmshModel;
using ::testing::HasSubstr;
using ::testing::StartsWith;

std::string gmsh_refusal(const std::string& text) {
  return test::message_of<ConfigError>([&] { read_gmsh_mesh({"m.msh", text}); });
}

std::string replaced(std::string text, const std::string& what, const std::string& by) {
  const std::size_t found = text.find(what);
  EXPECT_NE(found, std::string::npos) << what;
  return text.replace(found, what.size(), by);
}

GmshModel one_tetrahedron() {
  GmshModel model;
  model.nodes = {{1, {0, 0, 0}}, {2, {1, 0, 0}}, {3, {0, 1, 0}}, {4, {0, 0, 1}}, {5, {3, 3, 3}}};
  model.blocks = {{2, 1, 2, {{1, {1, 2, 3}}}}, {3, 1, 4, {{2, {1, 2, 3, 4}}}}};
  model.groups = {{{2, 1}, {1}}};
  return model;
}

const std::string text_41 = gmsh_41(one_tetrahedron(), GmshForm::text);
const std::string text_22 = gmsh_22(one_tetrahedron(), GmshForm::text);
const std::string bytes_41 = gmsh_41(one_tetrahedron(), GmshForm::binary);
const std::string bytes_22 = gmsh_22(one_tetrahedron(), GmshForm::binary);

TEST(GmshRefusals, OtherFormatsAndVersionsAreNamed) {
  EXPECT_EQ(gmsh_refusal("\x89HDF\r\n\x1a\n"),
            "m.msh:1:1: this is an HDF5 file (MED, CGNS or results?); export a mesh from it; "
            "expected a Gmsh mesh");
  EXPECT_EQ(gmsh_refusal("\x1f\x8b\x08"),
            "m.msh:1:1: this is a gzip archive; unpack it first; expected a Gmsh mesh");
  EXPECT_THAT(gmsh_refusal("ISO-10303-21;\nHEADER;"), HasSubstr("a STEP file"));
  EXPECT_EQ(gmsh_refusal("$NOD\n1\n"),
            "m.msh:1:1: a Gmsh mesh of version 1.0; expected 4.1 or 2.2: save it as 4.1: gmsh FILE "
            "-save -format msh41 -o NEW.msh");
  EXPECT_EQ(gmsh_refusal("$MeshFormat\n4 0 8\n$EndMeshFormat\n"),
            "m.msh:2:1: a Gmsh mesh of version 4; expected 4.1 or 2.2: save it as 4.1: gmsh FILE "
            "-save -format msh41 -o NEW.msh");
  EXPECT_EQ(gmsh_refusal("hello"),
            "m.msh:1:1: expected a Gmsh mesh, which begins with $MeshFormat");
  EXPECT_THAT(gmsh_refusal("\n \n"), HasSubstr("begins with $MeshFormat"));
  EXPECT_EQ(gmsh_refusal("$MeshFormat\n4.1 2 8\n"),
            "m.msh:2:1: expected 0 (text) or 1 (binary) after the version, got '2'");
  EXPECT_THAT(gmsh_refusal("$MeshFormat\n4.1 0 4\n"), StartsWith("m.msh:2:1: numbers of 4 bytes"));
}

TEST(GmshRefusals, ByteOrder) {
  const std::string marker{'\1', '\0', '\0', '\0'};
  EXPECT_EQ(gmsh_refusal(replaced(bytes_41, marker, std::string{'\0', '\0', '\0', '\1'})),
            "m.msh: byte 20: numbers with the most significant byte first; expected little-endian "
            "ones: save it as 4.1: gmsh FILE -save -format msh41 -o NEW.msh, on this machine");
  EXPECT_EQ(gmsh_refusal(replaced(bytes_41, marker, std::string{'\2', '\0', '\0', '\0'})),
            "m.msh: byte 20: expected the marker 1 of the byte order, got 2");
}

TEST(GmshRefusals, Sections) {
  const std::string head = "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n";
  EXPECT_EQ(gmsh_refusal("$MeshFormat\n4.1 0 8\n$Nodes\n"),
            "m.msh:3:1: expected $EndMeshFormat after as many records as declared, got '$Nodes'");
  EXPECT_EQ(gmsh_refusal("$MeshFormat\n4.1 0 8\n"),
            "m.msh:3:1: the file ends, expected $EndMeshFormat");
  EXPECT_EQ(gmsh_refusal(head), "m.msh:4:1: the file ends, expected a section $Nodes");
  EXPECT_EQ(gmsh_refusal(head + "$Nodes\n0 0 0 0\n$EndNodes\n"),
            "m.msh:7:1: the file ends, expected a section $Elements");
  EXPECT_EQ(gmsh_refusal(head + "$Nodes\n0 0 0 0\n$EndNodes\n$Elements\n0 0 0 0\n$EndElements\n"),
            "m.msh:10:1: the file has no elements of surfaces or volumes; expected a mesh with "
            "some");
  EXPECT_EQ(gmsh_refusal(text_41 + "$Nodes\n"), "m.msh:31:1: a second section $Nodes");
  EXPECT_THAT(gmsh_refusal(text_41 + "$Elements\n"), HasSubstr(":1: a second section $Elements"));
  EXPECT_THAT(gmsh_refusal(text_41 + "$MeshFormat\n"), HasSubstr(":1: a second section $MeshForm"));
  EXPECT_THAT(gmsh_refusal(text_41 + "rubbish\n"),
              HasSubstr(":1: expected a section such as $Nodes, got 'rubbish'"));
  EXPECT_THAT(gmsh_refusal(text_41 + "$EndX\n"), HasSubstr("$EndX without its beginning"));
  EXPECT_THAT(gmsh_refusal(text_41 + "$NodeData\n1\n"),
              HasSubstr("section $NodeData has no $EndNodeData"));
  EXPECT_THAT(gmsh_refusal(head + "$PartitionedEntities\n"), HasSubstr("a partitioned mesh"));
  EXPECT_THAT(gmsh_refusal(head + "$ParametricNodes\n"), HasSubstr("Mesh.SaveParametric = 0"));
}

TEST(GmshRefusals, Names) {
  const auto names = [](const std::string& lines) {
    return "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n" + lines + "$EndPhysicalNames\n";
  };
  EXPECT_EQ(gmsh_refusal(names("2\n2 1 \"a\"\n2 1 \"b\"\n")),
            "m.msh:7:1: physical group 1 of dimension 2 has two names");
  EXPECT_EQ(gmsh_refusal(names("1\n4 1 \"a\"\n")),
            "m.msh:6:1: expected a dimension from 0 to 3, got 4");
  EXPECT_THAT(gmsh_refusal(names("1000\n2 1 \"a\"\n")),
              HasSubstr("1000 names are declared, but only"));
  EXPECT_THAT(gmsh_refusal(names("-1\n")), HasSubstr("expected a number of names, got -1"));
  GmshModel model = one_tetrahedron();
  model.blocks[0].elements.push_back({3, {1, 2, 4}});
  model.blocks.push_back({2, 2, 2, {{4, {2, 3, 4}}}});
  model.groups = {{{2, 1}, {1}}, {{2, 2}, {2}}};
  model.names = {{{2, 1}, "a"}, {{2, 2}, "a"}};
  EXPECT_THAT(gmsh_refusal(gmsh_41(model, GmshForm::text)),
              HasSubstr("two physical groups of the same dimension have the name 'a'"));
  model = one_tetrahedron();
  model.blocks.push_back({1, 1, 1, {{4, {1, 2}}}});
  model.groups = {{{2, 1}, {1}}, {{1, 1}, {1}}};
  EXPECT_THAT(gmsh_refusal(gmsh_41(model, GmshForm::text)),
              HasSubstr("physical groups 1 of dimension 1 and 1 of dimension 2 are both 'group_1'; "
                        "give them names that differ"));
  model = one_tetrahedron();
  model.blocks.push_back({3, 2, 4, {{4, {1, 2, 3, 5}}}});
  model.groups = {{{3, 1}, {1}}, {{3, 2}, {2}}};
  model.names = {{{3, 1}, "a"}, {{3, 2}, "a"}};
  EXPECT_THAT(gmsh_refusal(gmsh_41(model, GmshForm::text)), HasSubstr("have the name 'a'"));
}

TEST(GmshRefusals, NumbersOfText) {
  EXPECT_EQ(gmsh_refusal(replaced(text_41, "1 0 0 \n", "1 x 0 \n")),
            "m.msh:19:3: expected a coordinate, a finite number, got 'x'");
  EXPECT_EQ(gmsh_refusal(replaced(text_41, "1 0 0 \n", "1 inf 0 \n")),
            "m.msh:19:3: expected a coordinate, a finite number, got 'inf'");
  EXPECT_EQ(gmsh_refusal(replaced(text_41, "1 0 0 \n", "1 0\n")),
            "m.msh:19:4: the line ends, expected a coordinate");
  EXPECT_EQ(gmsh_refusal(replaced(text_41, "1 0 0 \n", "1 0 0 0\n")),
            "m.msh:19:7: expected the end of the line after the coordinates of a node");
  EXPECT_EQ(gmsh_refusal(replaced(text_41, "\n2 1 2 3 4", "\n2 1 2.5 3 4")),
            "m.msh:29:5: expected a node tag of an element, an integer, got '2.5'");
  EXPECT_THAT(gmsh_refusal(replaced(text_41, "\n2 1 2 3 4", "\n2 1 -2 3 4")),
              HasSubstr("expected a node tag of an element, which is not negative, got -2"));
  EXPECT_THAT(gmsh_refusal(replaced(text_22, "\n2 4 2 ", "\n2 4 -2 ")),
              HasSubstr("expected a number of tags, got -2"));
  EXPECT_THAT(gmsh_refusal(replaced(text_22, "\n2 4 2 ", "\n-2 4 2 ")),
              HasSubstr("expected an element number, which is not negative, got -2"));
  EXPECT_THAT(gmsh_refusal(replaced(text_22, "$Nodes\n5\n", "$Nodes\n5 5\n")),
              HasSubstr("expected the end of the line after a number of nodes"));
  EXPECT_THAT(gmsh_refusal(replaced(text_22, "\n2 4 2 0", "\n2 4 2 -9223372036854775808")),
              HasSubstr("a tag of a physical group is out of range"));
  EXPECT_THAT(gmsh_refusal(replaced(text_41, "\n1 0 0.5 1 1.5 2 2.5 1 1 ",
                                    "\n1 0 0.5 1 1.5 2 2.5 1 -9223372036854775808 ")),
              HasSubstr("a tag of a physical group is out of range"));
}

TEST(GmshRefusals, NumbersOfBytes) {
  const std::string far(8, '\xff');
  const std::size_t last = bytes_41.find("\n$EndElements");
  std::string text = bytes_41;
  text.replace(last - 8, 8, far);
  EXPECT_EQ(gmsh_refusal(text), "m.msh: byte " + std::to_string(last - 8) +
                                    ": expected a node tag of an element, got more than 2^63");
  text = bytes_41;
  const std::size_t nodes_end = bytes_41.find("\n$EndNodes");
  text.replace(nodes_end - 8, 8, far);
  EXPECT_EQ(gmsh_refusal(text), "m.msh: byte " + std::to_string(nodes_end - 8) +
                                    ": expected a coordinate, a finite number, got -nan");
  EXPECT_THAT(gmsh_refusal(bytes_22.substr(0, bytes_22.find("\n$EndElements") - 4)),
              HasSubstr("elements of a block are declared, but only"));
}

TEST(GmshRefusals, DeclaredCountsAreNotTrusted) {
  EXPECT_THAT(gmsh_refusal(replaced(text_41, "\n2 1 0 4", "\n2 1 0 4000000000000")),
              HasSubstr("4000000000000 nodes of a block are declared, but only"));
  EXPECT_THAT(gmsh_refusal(replaced(text_41, "\n3 1 4 1", "\n3 1 4 1000000")),
              HasSubstr("1000000 elements of a block are declared, but only"));
  EXPECT_EQ(gmsh_refusal(replaced(text_41, "\n2 5 1 99", "\n2 6 1 99")),
            "m.msh:10:1: 6 nodes are declared, the blocks hold 5");
  EXPECT_THAT(gmsh_refusal(replaced(text_41, "\n2 2 1 99", "\n2 3 1 99")),
              HasSubstr("3 elements are declared, the blocks hold 2"));
  EXPECT_THAT(gmsh_refusal(replaced(text_22, "$Nodes\n5\n", "$Nodes\n999999\n")),
              HasSubstr("999999 nodes are declared, but only"));
  EXPECT_THAT(gmsh_refusal(replaced(text_22, "$Elements\n2\n", "$Elements\n999999\n")),
              HasSubstr("999999 elements are declared, but only"));
  EXPECT_THAT(gmsh_refusal(replaced(text_22, "$Elements\n2\n", "$Elements\n1\n")),
              HasSubstr("expected $EndElements after as many records as declared, got '2 4"));
  EXPECT_THAT(gmsh_refusal(replaced(bytes_22, "$Elements\n2\n", "$Elements\n0\n")),
              HasSubstr("expected $EndElements"));
}

TEST(GmshRefusals, Blocks) {
  EXPECT_THAT(gmsh_refusal(replaced(text_41, "\n2 1 0 4", "\n5 1 0 4")),
              HasSubstr("expected a dimension from 0 to 3, got 5"));
  EXPECT_THAT(gmsh_refusal(replaced(text_41, "\n2 1 0 4", "\n2 1 3 4")),
              HasSubstr("expected 0 or 1 for parametric nodes, got 3"));
  EXPECT_THAT(gmsh_refusal(replaced(text_41, "\n3 1 4 1", "\n2 1 4 1")),
              HasSubstr("elements of type 4 have dimension 3, their entity 2"));
  GmshModel model = one_tetrahedron();
  std::string twice = gmsh_41(model, GmshForm::text);
  twice = replaced(twice, "\n0 0 1 1", "\n0 0 2 1");
  const std::string entity = "1 0 0.5 1 1.5 2 2.5 1 1 2 1 -2 \n";
  EXPECT_THAT(gmsh_refusal(replaced(twice, entity, entity + entity)),
              HasSubstr("entity 1 of dimension 2 stands twice"));
  EXPECT_THAT(gmsh_refusal(replaced(bytes_22, std::string("\4\0\0\0\1\0\0\0\2\0\0\0", 12),
                                    std::string("\4\0\0\0\7\0\0\0\2\0\0\0", 12))),
              HasSubstr("expected a block of 1 to 1 elements, got 7"));
}

TEST(GmshRefusals, ElementTypes) {
  const auto with_type = [](int type) {
    return gmsh_refusal(replaced(text_41, "\n3 1 4 1", "\n3 1 " + std::to_string(type) + " 1"));
  };
  EXPECT_EQ(with_type(12),
            "m.msh:28:1: hexahedra of 27 nodes (type 12) have nodes inside of faces or volumes; "
            "mesh with Mesh.ElementOrder = 2 and Mesh.SecondOrderIncomplete = 1");
  EXPECT_THAT(with_type(10), HasSubstr("quadrangles of 9 nodes (type 10)"));
  EXPECT_THAT(with_type(13), HasSubstr("prisms of 18 nodes (type 13)"));
  EXPECT_THAT(with_type(7), HasSubstr("pyramids (type 7) are not supported"));
  EXPECT_THAT(with_type(29), HasSubstr("elements of type 29 are not supported"));
  EXPECT_THAT(gmsh_refusal(replaced(text_22, "\n2 4 2 ", "\n2 12 2 ")), HasSubstr("(type 12)"));
}

TEST(GmshRefusals, NodesAndElements) {
  EXPECT_EQ(gmsh_refusal(replaced(text_41, "\n2 1 2 3 4", "\n2 1 2 3 77")),
            "m.msh:29:1: element 2 (tet4) has node 77, which the file does not define");
  EXPECT_EQ(gmsh_refusal(replaced(text_41, "\n1 1 2 3", "\n1 1 2 77")),
            "m.msh:27:1: element 1 has node 77, which the file does not define");
  EXPECT_EQ(gmsh_refusal(replaced(text_41, "\n2 1 2 3 4", "\n2 1 2 3 1")),
            "m.msh:29:1: element 2 (tet4) has node 1 twice; expected nodes that differ: mesh it "
            "without degenerate elements");
  GmshModel model = one_tetrahedron();
  model.nodes[4].tag = 4;
  EXPECT_EQ(gmsh_refusal(gmsh_22(model, GmshForm::text)),
            "m.msh:10:1: node 4 stands twice; expected numbers that differ");
  model = one_tetrahedron();
  model.blocks[1].elements.push_back({2, {1, 2, 3, 5}});
  EXPECT_EQ(gmsh_refusal(gmsh_41(model, GmshForm::text)),
            "m.msh:30:1: element 2 stands twice; expected numbers that differ");
  model.blocks[1].elements.back() = {3, {1, 2, 3, 4}};
  EXPECT_EQ(gmsh_refusal(gmsh_41(model, GmshForm::text)),
            "m.msh:30:1: element 3 has the nodes of element 2; expected it once");
  model.groups[{3, 1}] = {9};
  EXPECT_EQ(gmsh_refusal(gmsh_41(model, GmshForm::text)),
            "m.msh:29:1: element 2 stands twice, in the same physical group");
}

TEST(GmshRefusals, SidesOfNoElement) {
  GmshModel model = one_tetrahedron();
  model.nodes.push_back({6, {1, 1, 0}});
  model.blocks[0].elements[0].second = {1, 2, 5};
  EXPECT_EQ(gmsh_refusal(gmsh_41(model, GmshForm::text)),
            "m.msh:29:1: element 1 (3 nodes of dimension 2) is in a physical group, but no side of "
            "any element; expected a mesh that ends there: fragment or embed the geometry before "
            "it is meshed");
  model.blocks[1].elements.push_back({3, {2, 3, 4, 5}});
  EXPECT_THAT(gmsh_refusal(gmsh_41(model, GmshForm::text)),
              HasSubstr("element 1 (3 nodes of dimension 2) is in a physical group, but no side"));
  // Outside of groups it does not matter.
  model.groups.clear();
  EXPECT_EQ(gmsh_refusal(gmsh_41(model, GmshForm::text)), "<no exception>");
}

TEST(GmshRefusals, SidesOfSeveralElements) {
  GmshModel model = one_tetrahedron();
  // Both on the same side of the triangle.
  model.blocks[1].elements.push_back({3, {1, 2, 3, 5}});
  model.blocks[0].elements[0].second = {1, 2, 3};
  EXPECT_EQ(gmsh_refusal(gmsh_41(model, GmshForm::text)),
            "m.msh:27:1: element 1 is a side of 2 elements, among them 2 and 3; expected one, or "
            "two with opposite normals");
}

}  // namespace
}  // namespace stridor
