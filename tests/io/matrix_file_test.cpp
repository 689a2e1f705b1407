// Matrices as programs write them, and what is refused of them.
#include "io/imports/matrix_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <map>

#include "core/errors.hpp"
#include "io/imports/unknown_tables.hpp"
#include "tests/support/message_of.hpp"

namespace stridor {
namespace {

using test::message_of;
using ::testing::HasSubstr;

const std::string data = std::string(STRIDOR_SOURCE_DIR) + "/tests/data/calculix/";
const std::string examples = std::string(STRIDOR_SOURCE_DIR) + "/scenes/examples/";

LabelledMatrix read(const std::string& text, MatrixPurpose purpose = MatrixPurpose::any) {
  return read_matrix_text({"m", text}, purpose);
}

std::string refusal(const std::string& text, MatrixPurpose purpose = MatrixPurpose::any) {
  return message_of<ConfigError>([&] { read(text, purpose); });
}

/// Entries by what their rows and columns are.
using Entries = std::map<std::pair<NodeUnknown, NodeUnknown>, double>;
Entries entries_of(const SparseMatrix& matrix, const std::vector<NodeUnknown>& unknowns) {
  Entries entries;
  for (Eigen::Index column = 0; column < matrix.outerSize(); ++column) {
    for (SparseMatrix::InnerIterator entry(matrix, column); entry; ++entry) {
      entries[{unknowns[static_cast<std::size_t>(entry.row())],
               unknowns[static_cast<std::size_t>(column)]}] = entry.value();
    }
  }
  return entries;
}

void expect_same(const Entries& found, const Entries& expected, double tolerance) {
  ASSERT_EQ(found.size(), expected.size());
  double largest = 0.0;
  for (const auto& [place, value] : expected) largest = std::max(largest, std::abs(value));
  for (const auto& [place, value] : expected) {
    const auto entry = found.find(place);
    ASSERT_NE(entry, found.end()) << place.first.node << "." << place.first.direction;
    EXPECT_NEAR(entry->second, value, tolerance * largest);
  }
}

/// The matrix of a file of CalculiX, with zeros that it writes left out.
Entries of_calculix(const std::string& name, const std::string& ending) {
  const LabelledMatrix matrix = read_matrix_file(data + name + ending, MatrixPurpose::any);
  return entries_of(matrix.matrix, read_unknown_file(data + name + ".dof").unknowns);
}

TEST(MatrixFile, OfCalculixIsTheUpperTriangle) {
  const LabelledMatrix matrix = read("1 1  2.0e+00\n1 2 -1.5e+00\n2 2  3.0e+00\n");
  EXPECT_EQ(Eigen::MatrixXd(matrix.matrix), (Eigen::Matrix2d{{2.0, -1.5}, {-1.5, 3.0}}));
  EXPECT_EQ(matrix.stored, StoredPart::upper);
  EXPECT_TRUE(matrix.unknowns.empty());
  EXPECT_TRUE(matrix.is_open);
}

TEST(MatrixFile, WithBothTrianglesIsTakenAsItIsUpToRounding) {
  const LabelledMatrix matrix = read("1 1 2\n1 2 -1.5\n2 1 -1.5000000001\n2 2 3\n");
  EXPECT_EQ(matrix.stored, StoredPart::full);
  EXPECT_NEAR(matrix.symmetry_error, 1.414e-10 / 4.183, 1e-13);
  EXPECT_EQ(matrix.matrix.coeff(0, 1), matrix.matrix.coeff(1, 0));
  EXPECT_THAT(refusal("1 1 2\n1 2 -1.5\n2 1 -1.6\n2 2 3\n"),
              HasSubstr("m:1:1: the matrix has both triangles, which differ by 3."));
}

TEST(MatrixFile, OfOneEntryPerPairInAnyOrderIsCompleted) {
  // Node 9 comes first in the file, so that neither triangle is filled once nodes are in order.
  const LabelledMatrix matrix = read("9,1, 9,1, 1.\n9,1, 3,1, 2.\n3,1, 3,1, 3.\n3,1, 10,1, 4.\n10,1,10,1,5.\n");
  EXPECT_EQ(matrix.stored, StoredPart::half);
  EXPECT_EQ(Eigen::MatrixXd(matrix.matrix),
            (Eigen::Matrix3d{{3, 2, 4}, {2, 1, 0}, {4, 0, 5}}));
  EXPECT_EQ(matrix.unknowns, (std::vector<NodeUnknown>{{3, 1}, {9, 1}, {10, 1}}));
}

TEST(MatrixFile, OfAllProgramsIsThatOfCalculix) {
  const Entries stiffness = of_calculix("tet_clip", ".sti");
  const Entries mass = of_calculix("tet_clip", ".mas");
  ASSERT_EQ(mass.size(), 138U);
  const auto of = [](const std::string& file, MatrixPurpose purpose) {
    const LabelledMatrix read = read_matrix_file(examples + file, purpose);
    return entries_of(read.matrix, read.unknowns);
  };
  // Written with 16 digits of the 14 of CalculiX; the punch has ten.
  expect_same(of("from_abaqus/clip_STIF1.mtx", MatrixPurpose::stiffness), stiffness, 1e-15);
  expect_same(of("from_abaqus/clip_MASS1.mtx", MatrixPurpose::mass), mass, 1e-15);
  expect_same(of("from_nastran/clip.pch", MatrixPurpose::stiffness), stiffness, 1e-9);
  expect_same(of("from_nastran/clip.pch", MatrixPurpose::mass), mass, 1e-9);
  const auto unknowns = read_unknown_file(examples + "from_ansys/clip.mapping").unknowns;
  for (const auto& [file, expected] :
       {std::pair("clip_stiff.matrix", stiffness), std::pair("clip_mass.matrix", mass)}) {
    const LabelledMatrix read =
        read_matrix_file(examples + "from_ansys/" + file, MatrixPurpose::any);
    EXPECT_EQ(read.stored, StoredPart::lower);
    expect_same(entries_of(read.matrix, unknowns), expected, 1e-15);
  }
}

TEST(MatrixFile, OfNastranHasThePlacesOfItsGridPoints) {
  const LabelledMatrix matrix =
      read_matrix_file(examples + "from_nastran/clip.pch", MatrixPurpose::mass);
  EXPECT_EQ(matrix.nodes.labels.size(), 12U);
  EXPECT_EQ(matrix.nodes.positions.row(11), Eigen::RowVector3d(40, 0, 5));
}

TEST(MatrixFile, OfNastranTakesNarrowAndFreeFields) {
  const std::string narrow =
      "GRID           7           1.-1     2.5      -3\n"
      "DMIG         KAA       0       6       2       0                       2\n"
      "DMIG         KAA       7       1               7       1   2.+1\n"
      "DMIG,KAA,7,2,,7,1,-1.5D0,,7,2,3.\n";
  const LabelledMatrix matrix = read(narrow, MatrixPurpose::stiffness);
  EXPECT_EQ(matrix.nodes.positions.row(0), Eigen::RowVector3d(0.1, 2.5, -3.0));
  EXPECT_EQ(matrix.matrix.coeff(0, 0), 20.0);
  EXPECT_EQ(matrix.matrix.coeff(1, 0), -1.5);
}

TEST(MatrixFile, OfAMarketSaysItsTriangle) {
  const LabelledMatrix matrix =
      read("%%MatrixMarket matrix coordinate real symmetric\n2 2 2\n1 1 4\n2 1 1\n");
  EXPECT_EQ(matrix.stored, StoredPart::lower);
  EXPECT_FALSE(matrix.is_open);
}

TEST(MatrixFileRefusals, OtherFormats) {
  EXPECT_THAT(refusal("hello world\n"),
              HasSubstr("m:1:1: the file begins with 'hello world'; expected a matrix: Matrix "
                        "Market, CalculiX"));
  EXPECT_THAT(refusal("\x1f\x8b\x08"), HasSubstr("this is a gzip archive"));
  EXPECT_THAT(refusal("  \n \n"), HasSubstr("the file is blank"));
  EXPECT_THAT(refusal(" ,,\n"), HasSubstr("the file is blank"));
  EXPECT_THAT(refusal(", \nhello\n"), HasSubstr("m:2:1: the file begins with 'hello'"));
  EXPECT_THAT(refusal(std::string("1 1 2\0", 6)), HasSubstr("m:1:6: a byte 0"));
}

TEST(MatrixFileRefusals, Coordinates) {
  EXPECT_EQ(refusal("1 1 2\n1 2\n"), "m:2:1: expected 'row column value', got 2 words");
  EXPECT_THAT(refusal("1 1 2\n0 2 1\n"),
              HasSubstr("m:2:1: expected the number of a row from 1 to 20000000, got '0'"));
  EXPECT_THAT(refusal("1 1 2\n1 2 1e999\n"), HasSubstr("m:2:5: expected an entry, a number"));
  EXPECT_THAT(refusal("1 1 2\n20000000 1 1\n"), HasSubstr("in a file as short as this"));
}

TEST(MatrixFileRefusals, Abaqus) {
  EXPECT_THAT(refusal("1,1, 1,1, 5.\n1,1, 1\n"), HasSubstr("m:2:1: expected 'node, degree"));
  EXPECT_THAT(refusal("1,1, 1,1, 5.\n1,0, 1,1, 5.\n"),
              HasSubstr("m:2:3: expected a degree of freedom from 1"));
  EXPECT_THAT(refusal("**\n"), HasSubstr("the file ends without an entry"));
}

std::string harwell_boeing(const std::string& type, const std::string& rest) {
  return "title\n 4 1 1 2 0\n" + type + "\n(8I10) (8I10) (2E20.10)\n" + rest;
}

TEST(MatrixFileRefusals, HarwellBoeing) {
  const std::string pointers = "         1         3         4\n";
  const std::string rows = "         1         2         2\n";
  const std::string values =
      "    2.0000000000E+00    1.0000000000E+00\n    3.0000000000E+00\n";
  const std::string whole = pointers + rows + values;
  EXPECT_EQ(Eigen::MatrixXd(read(harwell_boeing("RSA 2 2 3 0", whole)).matrix),
            (Eigen::Matrix2d{{2, 1}, {1, 3}}));
  EXPECT_THAT(refusal(harwell_boeing("CSA 2 2 3 0", whole)), HasSubstr("m:3:1: a matrix of type 'CSA'"));
  EXPECT_THAT(refusal(harwell_boeing("RSA 2 3 3 0", whole)), HasSubstr("expected as many columns"));
  EXPECT_THAT(refusal(harwell_boeing("RSA 2 2 3000 0", whole)), HasSubstr("the file is too short"));
  EXPECT_THAT(refusal(harwell_boeing("RSA 2 2 3 0", pointers + rows)),
              HasSubstr("the file ends, expected more numbers"));
  EXPECT_THAT(refusal(harwell_boeing("RSA 2 2 3 0", "         1         1         9\n" + rows)),
              HasSubstr("expected where a column begins from 1 to 4, got '9'"));
  EXPECT_THAT(refusal("title\n 4 1 1 2 0\nRSA 2 2 3 0\n(8I10) (8J10) (2E20.10)\n" + whole),
              HasSubstr("expected three Fortran formats"));
  EXPECT_THAT(
      refusal(harwell_boeing("RSA 2 2 3 0", pointers + "         1\n")),
      HasSubstr("m:6:1: the line has 1 numbers, expected 3"));
}

TEST(MatrixFileRefusals, Nastran) {
  const std::string head = "DMIG         KAA       0       6       2       0                       2\n";
  const std::string entry = "DMIG         KAA       7       1               7       1      2.\n";
  EXPECT_THAT(refusal(head + entry, MatrixPurpose::mass),
              HasSubstr("0 matrices of DMIG entries come into question; expected one whose name "
                        "begins with M (there are: kaa)"));
  EXPECT_THAT(refusal(entry), HasSubstr("of which no entry says the form"));
  EXPECT_THAT(refusal(head + head + entry), HasSubstr("is said twice"));
  EXPECT_THAT(refusal(head), HasSubstr("has no entry"));
  EXPECT_THAT(refusal("DMIG         KAA       0       6       4       0                       2\n" +
                      entry),
              HasSubstr("is complex or not square"));
  EXPECT_THAT(refusal("GRID           7       3      1.\n" + head + entry),
              HasSubstr("grid point 7 is placed in coordinate system 3"));
}

UnknownTable unknowns(const std::string& text) {
  return read_unknown_table({"t", text});
}

TEST(UnknownTables, OfEveryKindAreRead) {
  EXPECT_EQ(unknowns("2.1\n2.3\n10.2\n").unknowns,
            (std::vector<NodeUnknown>{{2, 1}, {2, 3}, {10, 2}}));
  EXPECT_EQ(unknowns("Matrix Eqn  Node  DOF\n 2 1 UX\n 1 4 ROTZ\n").unknowns,
            (std::vector<NodeUnknown>{{4, 6}, {1, 1}}));
  const UnknownTable placed = unknowns("# mine\nnode,direction,x,y,z\n5,x,1,2,3\n5,y,1,2,3\n4,3,0,0,1\n");
  EXPECT_EQ(placed.unknowns, (std::vector<NodeUnknown>{{5, 1}, {5, 2}, {4, 3}}));
  EXPECT_EQ(placed.nodes.labels, (std::vector<std::int64_t>{4, 5}));
  EXPECT_EQ(placed.nodes.positions.row(1), Eigen::RowVector3d(1, 2, 3));
  EXPECT_EQ(unknowns(",\nnode,direction\n2,1\n,\n2,3\n ,\n").unknowns,
            (std::vector<NodeUnknown>{{2, 1}, {2, 3}}))
      << "empty rows of a spreadsheet";
}

TEST(UnknownTables, RefuseWhatIsWrong) {
  const auto refused = [](const std::string& text) {
    return message_of<ConfigError>([&] { unknowns(text); });
  };
  EXPECT_EQ(refused("2.1\n2.1\n"),
            "t:2:1: node 2 has direction 1 already, in row 1; expected each of them once");
  EXPECT_THAT(refused("2.7\n"), HasSubstr("t:1:3: expected a direction, 1 to 6 or x"));
  EXPECT_THAT(refused("hello\n"), HasSubstr("t:1:1: the file begins with 'hello'"));
  EXPECT_THAT(refused("2 1\n2 1 3\n"), HasSubstr("t:2:1: expected 'node, direction' or"));
  EXPECT_THAT(refused("2 1 0 0 0\n2 2\n"), HasSubstr("a line without a place"));
  EXPECT_THAT(refused("2 1 0 0 0\n2 2 0 0 1\n"), HasSubstr("at another place further up"));
  EXPECT_THAT(refused("Matrix Eqn Node DOF\n1 1 UX\n3 1 UY\n"), HasSubstr("equation 3 is too large"));
  EXPECT_THAT(refused("Matrix Eqn Node DOF\n1 1 UX\n1 1 UY\n"), HasSubstr("equation 1 stands twice"));
}

TEST(NodeTables, AreReadAndRefused) {
  const NodeTable nodes = read_node_table({"t", " NODE X Y Z THXY THYZ THZX\n3 1 2 0 0 0 0\n\n NODE X Y\n1 0 5\n"});
  EXPECT_EQ(nodes.labels, (std::vector<std::int64_t>{1, 3}));
  EXPECT_EQ(nodes.positions.row(0), Eigen::RowVector3d(0, 5, 0));
  EXPECT_EQ(read_node_table({"t", ",,,\nnode,x,y,z\n,,,\n4,1,2,3\n,,,\n"}).labels,
            (std::vector<std::int64_t>{4}));
  const auto refused = [](const std::string& text) {
    return message_of<ConfigError>([&] { read_node_table({"t", text}); });
  };
  EXPECT_THAT(refused("1 2\n"), HasSubstr("expected 'node, x, y, z', got 2 words"));
  EXPECT_THAT(refused("1 2 3 4 90 0 0\n"), HasSubstr("node 1 has displacements in directions of its own"));
  EXPECT_THAT(refused("1 2 3 x\n"), HasSubstr("t:1:7: expected a coordinate"));
}

}  // namespace
}  // namespace stridor
