#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/errors.hpp"
#include "io/imports/inp_mesh.hpp"
#include "tests/support/message_of.hpp"

namespace stridor {
namespace {

using ::testing::HasSubstr;

std::string inp_refusal(const std::string& text, const IncludeReader& reader = {}) {
  return test::message_of<ConfigError>([&] { read_inp_mesh({"m.inp", text}, reader); });
}

const std::string square_nodes = "*NODE\n1, 0, 0\n2, 1, 0\n3, 1, 1\n4, 0, 1\n";
const std::string one_square = square_nodes + "*ELEMENT, TYPE=CPS4, ELSET=E\n1, 1, 2, 3, 4\n";

TEST(InpRefusals, OtherFormats) {
  EXPECT_EQ(inp_refusal("\x1f\x8b\x08"),
            "m.inp:1:1: this is a gzip archive; unpack it first; expected an input of Abaqus or "
            "CalculiX");
  EXPECT_THAT(inp_refusal("$MeshFormat\n"), HasSubstr("this is a Gmsh mesh; name it .msh"));
  EXPECT_EQ(inp_refusal("hello\n"), "m.inp:1:1: expected a keyword such as *NODE, got 'hello'");
  EXPECT_EQ(inp_refusal(std::string("*NODE\n1, 0\0", 11)),
            "m.inp:2:5: a byte 0; expected an input of Abaqus or CalculiX, a text");
  EXPECT_EQ(
      inp_refusal(square_nodes),
      "m.inp:6:1: the file has no elements of surfaces or volumes; expected a mesh with some");
}

TEST(InpRefusals, Nodes) {
  EXPECT_EQ(inp_refusal("*NODE\n0, 1, 2\n"),
            "m.inp:2:1: expected the number of a node, an integer from 1, got '0'");
  EXPECT_EQ(inp_refusal("*NODE\n1, 1, x\n"),
            "m.inp:2:7: expected a coordinate, a finite number, got 'x'");
  EXPECT_THAT(inp_refusal("*NODE\n1, 1, 1e999\n"), HasSubstr("got '1e999'"));
  EXPECT_EQ(inp_refusal("*NODE\n1, 1, 2, 3, 4, 5, 6, 7\n"),
            "m.inp:2:22: expected the number of a node and three coordinates");
  EXPECT_EQ(inp_refusal("*NODE, SYSTEM=C\n"),
            "m.inp:1:1: *NODE with SYSTEM=C is not supported; expected rectangular coordinates");
  EXPECT_EQ(inp_refusal("*NODE, NSET\n"), "m.inp:1:1: *NODE without NSET=");
  EXPECT_EQ(inp_refusal("*NODE, FILE=3\n"),
            "m.inp:1:1: *NODE with FILE is not supported; expected NSET, INPUT, SYSTEM");
  EXPECT_EQ(inp_refusal("*NODE, NSET=a, NSET=b\n"), "m.inp:1:1: NSET stands twice");
  EXPECT_EQ(inp_refusal(one_square + "*NODE\n3, 1, 1\n"),
            "m.inp:9:1: node 3 stands twice; expected numbers that differ");
}

TEST(InpRefusals, Elements) {
  EXPECT_EQ(inp_refusal("*ELEMENT\n"), "m.inp:1:1: *ELEMENT without TYPE=");
  EXPECT_EQ(inp_refusal("*ELEMENT, TYPE=B31\n"),
            "m.inp:1:1: elements of type B31 are not supported; expected C3D4, C3D10, C3D6, C3D15, "
            "C3D8, C3D20, or CPS3, CPS6, CPS4, CPS8 and their variants");
  EXPECT_THAT(inp_refusal("*ELEMENT, TYPE=t3d2\n"),
              HasSubstr("Gmsh writes its curves so, save the mesh as .msh instead"));
  EXPECT_EQ(inp_refusal(square_nodes + "*ELEMENT, TYPE=CPS4\n1, 1, 2, 3\n2, 1, 2, 3, 4\n"),
            "m.inp:7:1: element 1 (CPS4) has 3 nodes, expected 4; a line that goes on in the next "
            "one ends with a comma");
  EXPECT_THAT(inp_refusal(square_nodes + "*ELEMENT, TYPE=CPS4\n1, 1, 2, 3,\n"),
              HasSubstr("element 1 (CPS4) has 3 nodes"));
  EXPECT_EQ(inp_refusal(square_nodes + "*ELEMENT, TYPE=CPS4\n1, 1, 2, 3, 4, 5\n"),
            "m.inp:7:16: element 1 (CPS4) has more than 4 nodes");
  EXPECT_EQ(inp_refusal(square_nodes + "*ELEMENT, TYPE=CPS4\n1, 1, 2, 3, 9\n"),
            "m.inp:7:1: element 1 (quad4) has node 9, which the file does not define");
  EXPECT_THAT(inp_refusal(square_nodes + "*ELEMENT, TYPE=CPS4\n1, 1, 2, 3, 3\n"),
              HasSubstr("element 1 (quad4) has node 3 twice"));
  EXPECT_EQ(inp_refusal(one_square + "1, 1, 2, 3, 4\n"),
            "m.inp:8:1: element 1 stands twice; expected numbers that differ");
  EXPECT_EQ(inp_refusal("*NODE\n1, 0, 0\n2, 1, 0\n3, 1, 1\n4, 0, 1, 1\n*ELEMENT, TYPE=C3D4\n"
                        "1, 1, 2, 3, 4\n*ELEMENT, TYPE=S3\n2, 1, 2, 3\n"),
            "m.inp:9:1: element 2 is planar (tri3), beside volumes (tet4); shells on volumes are "
            "not supported: delete them; of a mesh of Gmsh, save the .msh instead");
  EXPECT_THAT(inp_refusal("*NODE\n1, 0, 0\n2, 1, 0\n3, 1, 1\n4, 0, 1, 1\n*ELEMENT, TYPE=S3\n"
                          "2, 1, 2, 3\n*ELEMENT, TYPE=C3D4\n1, 1, 2, 3, 4\n"),
              HasSubstr("m.inp:7:1: element 2 is planar (tri3), beside volumes (tet4)"));
}

TEST(InpRefusals, KeywordsThatMakeNodes) {
  EXPECT_EQ(inp_refusal("*NGEN, NSET=a\n1, 5\n"),
            "m.inp:1:1: *NGEN makes or moves nodes or elements; expected them as *NODE and "
            "*ELEMENT: write the input anew from the finished mesh");
  EXPECT_THAT(inp_refusal("*Symmetric  Model Generation\n"), HasSubstr("*SYMMETRIC MODEL GENER"));
}

TEST(InpRefusals, Sets) {
  EXPECT_EQ(inp_refusal(one_square + "*NSET\n1\n"), "m.inp:8:1: *NSET without NSET=");
  EXPECT_EQ(inp_refusal(one_square + "*NSET, NSET=a\n1, 77\n"),
            "m.inp:9:4: node 77 of set 'a' is not defined in this file");
  EXPECT_EQ(inp_refusal(one_square + "*ELSET, ELSET=a\n77\n"),
            "m.inp:9:1: element 77 of set 'a' is not defined in this file");
  EXPECT_EQ(inp_refusal(one_square + "*NSET, NSET=a\n1, b\n"),
            "m.inp:9:4: expected a number, or the name of a set that is defined above this line, "
            "got 'b'");
  EXPECT_EQ(inp_refusal(one_square + "*NSET, NSET=a\na\n"), "m.inp:9:1: the set 'a' within itself");
  EXPECT_EQ(inp_refusal(one_square + "*NSET, NSET=a\n-1\n"),
            "m.inp:9:1: expected a number or the name of a set, an integer from 1, got '-1'");
  EXPECT_EQ(inp_refusal(one_square + "*NSET, NSET=a, GENERATE\n5, 900000000000\n"),
            "m.inp:9:1: no node from 5 to 900000000000 of set 'a' is defined in this file");
  const std::string generate =
      "m.inp:9:1: expected first, last and step after GENERATE, first not beyond last";
  EXPECT_EQ(inp_refusal(one_square + "*NSET, NSET=a, GENERATE\n5\n"), generate);
  EXPECT_EQ(inp_refusal(one_square + "*NSET, NSET=a, GENERATE\n5, 4\n"), generate);
  EXPECT_THAT(
      inp_refusal(one_square + "*NSET, NSET=a, GENERATE\n1, 4, 0\n"),
      HasSubstr("expected first, last and step after GENERATE, an integer from 1, got '0'"));
  EXPECT_EQ(inp_refusal(one_square + "*NSET, NSET=a, GENERATE\n1, 4, 1, 1\n"),
            "m.inp:9:10: expected first, last and step after GENERATE");
  EXPECT_THAT(inp_refusal(one_square + "*NSET, NSET=a, ELSET=E\n"),
              HasSubstr("*NSET with ELSET is not supported; expected NSET, GENERATE"));
}

TEST(InpRefusals, Surfaces) {
  EXPECT_EQ(inp_refusal(one_square + "*SURFACE\n"), "m.inp:8:1: *SURFACE without NAME=");
  EXPECT_EQ(inp_refusal(one_square + "*SURFACE, NAME=s\nE\n"),
            "m.inp:9:1: expected an element or a set of elements and the name of a side: S1 to S6");
  EXPECT_EQ(inp_refusal(one_square + "*SURFACE, NAME=s\nE, S5\n"),
            "m.inp:9:1: expected a side from S1 to S4 of elements like quad4, got 'S5'");
  EXPECT_EQ(
      inp_refusal(square_nodes + "*ELEMENT, TYPE=S4\n1, 1, 2, 3, 4\n*SURFACE, NAME=s\n1, S1\n"),
      "m.inp:9:1: expected a side from E1 to E4 of elements like quad4 (a shell), got 'S1'");
  EXPECT_EQ(inp_refusal(one_square + "*SURFACE, NAME=s\n5, S1\n"),
            "m.inp:9:1: element 5 of surface 's' is not defined in this file");
  EXPECT_THAT(inp_refusal(one_square + "*SURFACE, NAME=s\nF, S1\n"),
              HasSubstr("the name of a set that is defined above this line, got 'F'"));
  EXPECT_EQ(inp_refusal(one_square + "*SURFACE, NAME=s\n1, S1\n*SURFACE, NAME=S\n1, S1\n"),
            "m.inp:10:1: surface 'S' stands twice; expected another name");
  EXPECT_EQ(inp_refusal(one_square + "*NSET, NSET=s\n1\n*SURFACE, NAME=S, TYPE=NODE\n1\n"),
            "m.inp:10:1: the surface 'S' of nodes has the name of a node set; expected another "
            "name");
  EXPECT_THAT(inp_refusal(one_square + "*SURFACE, NAME=s, COMBINE=UNION\n"),
              HasSubstr("*SURFACE with COMBINE is not supported"));
}

TEST(InpRefusals, SeveralBodies) {
  const std::string remedy =
      "expected one part with one instance at its place: export every body by itself";
  EXPECT_EQ(inp_refusal("*PART\n"), "m.inp:1:1: *PART without NAME=");
  EXPECT_EQ(inp_refusal("*PART, NAME=a\n*END PART\n*PART, NAME=b\n"),
            "m.inp:3:1: a second part, 'b' beside 'a'; " + remedy);
  const std::string instance = "*PART, NAME=a\n*END PART\n*ASSEMBLY\n*INSTANCE, NAME=i, PART=a\n";
  EXPECT_EQ(inp_refusal(instance + "*END INSTANCE\n*INSTANCE, NAME=j, PART=a\n"),
            "m.inp:6:1: a second instance, 'j' beside 'i'; " + remedy);
  EXPECT_EQ(inp_refusal(instance + "0, 0, 2.5\n"),
            "m.inp:5:1: the instance 'i' is moved or turned; " + remedy);
  EXPECT_EQ(inp_refusal(instance + "0, z\n"),
            "m.inp:5:4: expected a number of the position of the instance, got 'z'");
  EXPECT_EQ(inp_refusal("*INSTANCE, NAME=i, PART=b\n"),
            "m.inp:1:1: an instance of the part 'b', which is not defined above");
  EXPECT_THAT(inp_refusal("*INSTANCE, INSTANCE=i\n"), HasSubstr("*INSTANCE without NAME="));
  EXPECT_EQ(inp_refusal(instance + "*END INSTANCE\n*NSET, NSET=s, INSTANCE=k\n"),
            "m.inp:6:1: the instance 'k' is not defined above");
}

TEST(InpRefusals, IncludedFiles) {
  EXPECT_EQ(inp_refusal("*INCLUDE, INPUT=a.inc\n"), "m.inp:1:1: 'a.inc' cannot be included here");
  EXPECT_EQ(inp_refusal("*INCLUDE\n"), "m.inp:1:1: expected INPUT=FILE");
  const auto itself = [](const std::string&, const std::string& file) {
    return SourceText{file, "\n*INCLUDE, INPUT=" + file + "\n"};
  };
  EXPECT_EQ(inp_refusal("*INCLUDE, INPUT=a.inc\n", itself), "a.inc:2:1: 'a.inc' includes itself");
  EXPECT_EQ(inp_refusal("*INCLUDE, INPUT=m.inp\n", itself), "m.inp:1:1: 'm.inp' includes itself");
  const auto deeper = [](const std::string&, const std::string& file) {
    return SourceText{file, "*INCLUDE, INPUT=" + file + "x\n"};
  };
  EXPECT_EQ(inp_refusal("*INCLUDE, INPUT=a\n", deeper),
            "axxxxxxxxxxxxxx:1:1: files are included 16 deep or 1000 of them; expected fewer");
  const auto absent = [](const std::string&, const std::string& file) -> SourceText {
    throw FileError(Refusal::cannot_read, file, "", "cannot be opened");
  };
  EXPECT_EQ(inp_refusal("*INCLUDE, INPUT=a\n", absent),
            "m.inp:1:1: cannot include a file: a: cannot be opened");
  const auto wrong = [](const std::string&, const std::string& file) {
    return SourceText{file, "1, 0, 0\n2, x\n"};
  };
  EXPECT_EQ(inp_refusal("*NODE, INPUT=a\n", wrong),
            "a:2:4: expected a coordinate, a finite number, got 'x'");
}

}  // namespace
}  // namespace stridor
