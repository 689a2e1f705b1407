#include "io/imports/matrix_market.hpp"

#include <gtest/gtest.h>

#include <sstream>

#include "core/errors.hpp"
#include "io/imports/matrix_file.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/temporary_folder.hpp"

namespace stridor {
namespace {

using test::message_of;

Eigen::MatrixXd read(const std::string& text) {
  std::istringstream stream(text);
  return read_matrix_market(stream, "m.mtx");
}

std::string failure(const std::string& text) {
  return message_of<ConfigError>([&] { read(text); });
}

TEST(MatrixMarket, ReadsEveryLayout) {
  const Eigen::MatrixXd expected = Eigen::MatrixXd{{1.0, -2.5}, {0.0, 3e-2}};
  EXPECT_EQ(read("%%MatrixMarket matrix coordinate real general\n% a comment\n\n2 2 3\n1 1 1\n"
                 "1 2 -2.5\n2 2 +3e-2\n"),
            expected);
  EXPECT_EQ(read("%%MatrixMarket matrix array real general\n2 2\n1\n0\n-2.5\n0.03\n"), expected);
  const Eigen::MatrixXd symmetric = Eigen::MatrixXd{{4.0, 7.0}, {7.0, 5.0}};
  EXPECT_EQ(read("%%MatrixMarket matrix coordinate integer symmetric\n2 2 3\n1 1 4\n2 1 7\n2 2 5"),
            symmetric);
  EXPECT_EQ(read("%%MatrixMarket MATRIX Array Real Symmetric\r\n2 2\r\n4\r\n7\r\n5\r\n"),
            symmetric);
  const Eigen::MatrixXd skew = Eigen::MatrixXd{{0.0, -7.0}, {7.0, 0.0}};
  EXPECT_EQ(read("%%MatrixMarket matrix coordinate real skew-symmetric\n2 2 1\n2 1 7\n"), skew);
  EXPECT_EQ(read("%%MatrixMarket matrix array real skew-symmetric\n2 2\n7\n"), skew);
}

TEST(MatrixMarket, IntegersAreWhole) {
  const std::string text = "%%MatrixMarket matrix coordinate integer general\n1 1 1\n1 1 1.5\n";
  EXPECT_EQ(failure(text),
            "m.mtx:3:5: expected a whole number, got '1.5': the head of the file says 'integer'; "
            "write 'real' there if it is meant");
}

TEST(MatrixMarket, EntriesBeyondComputationAreRefused) {
  const std::string text = "%%MatrixMarket matrix coordinate real general\n1 1 1\n1 1 -1e308\n";
  EXPECT_EQ(failure(text),
            "m.mtx:3:5: '-1e308' is beyond what can be computed with, up to 1e+100 in magnitude");
}

TEST(MatrixMarket, SaysWhereItIsWrong) {
  const std::string header = "%%MatrixMarket matrix coordinate real general\n";
  EXPECT_EQ(failure("1 2 3\n"),
            "m.mtx:1:1: expected '%%MatrixMarket matrix coordinate|array real|integer "
            "general|symmetric|skew-symmetric'");
  EXPECT_NE(failure("%%MatrixMarket matrix coordinate complex general\n").find("m.mtx:1:34:"),
            std::string::npos);
  EXPECT_EQ(failure(header + "2 2\n"),
            "m.mtx:2:1: expected the numbers of rows, columns and entries");
  EXPECT_EQ(failure(header + "2 0 1\n"),
            "m.mtx:2:3: expected a number of columns from 1 to 1000000, got '0'");
  EXPECT_EQ(failure(header + "2 2 1\n1 3 5\n"),
            "m.mtx:3:3: expected a column from 1 to 2, got '3'");
  EXPECT_EQ(failure(header + "2 2 1\n1 1 five\n"),
            "m.mtx:3:5: expected a finite number, got 'five'");
  EXPECT_EQ(failure(header + "2 2 1\n1 1 nan\n"), "m.mtx:3:5: expected a finite number, got 'nan'");
  EXPECT_EQ(failure(header + "2 2 2\n1 1 1\n1 1 1\n"), "m.mtx:4:1: this entry stands twice");
  EXPECT_EQ(failure(header + "2 2 2\n1 1 1\n"),
            "m.mtx:4:1: the file ends, expected row, column and value of an entry");
  EXPECT_EQ(failure(header + "1 1 1\n1 1 1\n2 2 2\n"),
            "m.mtx:4:1: the matrix is complete, but the file goes on");
  const std::string symmetric = "%%MatrixMarket matrix coordinate real symmetric\n";
  EXPECT_EQ(failure(symmetric + "2 3 0\n"), "m.mtx:2:1: a symmetric matrix must be square");
  EXPECT_EQ(failure(symmetric + "2 2 1\n1 2 1\n"),
            "m.mtx:3:1: an entry above the diagonal of a symmetric matrix");
  EXPECT_EQ(failure("%%MatrixMarket matrix coordinate real skew-symmetric\n2 2 1\n2 2 1\n"),
            "m.mtx:3:1: an entry on the diagonal of a skew-symmetric matrix");
}

TEST(MatrixMarket, FilesThatAreNotThere) {
  const test::TemporaryFolder folder;
  const std::string path = folder / "none.mtx";
  EXPECT_NE(message_of<FileError>([&] { read_matrix_file(path, MatrixPurpose::any); }).find("cannot be opened"),
            std::string::npos);
}

TEST(MatrixRows, AreNumbersSideBySide) {
  EXPECT_EQ(Eigen::MatrixXd(parse_matrix_rows({"1 -2", " 0  3e1 "})),
            (Eigen::MatrixXd{{1.0, -2.0}, {0.0, 30.0}}));
  EXPECT_EQ(message_of<std::invalid_argument>([] {
              parse_matrix_rows({"1 2", "3"});
            }),
            "row 2 has 1 numbers, expected 2");
  EXPECT_EQ(message_of<std::invalid_argument>([] {
              parse_matrix_rows({"1 x", "3 4"});
            }),
            "row 1: expected a finite number, got 'x'");
}

}  // namespace
}  // namespace stridor
