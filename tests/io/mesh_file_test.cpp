#include "io/imports/mesh_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <filesystem>

#include "core/errors.hpp"
#include "io/imports/source_text.hpp"
#include "tests/io/gmsh_writer.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/temporary_folder.hpp"

namespace stridor {
namespace {

using test::message_of;
using ::testing::HasSubstr;

test::GmshModel gmsh_square() {
  test::GmshModel model;
  model.nodes = {{1, {0, 0, 0}}, {2, {1, 0, 0}}, {3, {1, 1, 0}}, {4, {0, 1, 0}}};
  model.blocks = {{2, 1, 3, {{1, {1, 2, 3, 4}}}}};
  return model;
}

const std::string inp_square =
    "** a square\n*NODE\n1, 0, 0\n2, 1, 0\n3, 1, 1\n4, 0, 1\n"
    "*ELEMENT, TYPE=CPS4\n1, 1, 2, 3, 4\n";

std::string mesh_file_failure(const std::filesystem::path& path) {
  return message_of<FileError>([&] { read_mesh_file(path.string()); });
}

TEST(MeshFile, ContentsComeBeforeTheEnding) {
  const test::TemporaryFolder folder;
  for (const std::string ending : {".msh", ".inp", ".dat", ""}) {
    const auto path = folder / ("mesh" + ending);
    test::write_file(path, test::gmsh_41(gmsh_square(), test::GmshForm::binary));
    EXPECT_EQ(read_mesh_file(path.string()).summary.format, "Gmsh 4.1, binary");
    test::write_file(path, "\n" + inp_square);
    EXPECT_EQ(read_mesh_file(path.string()).summary.format, "Abaqus or CalculiX");
  }
  test::write_file(folder / "other.MSH", "hello");
  EXPECT_THAT(message_of<ConfigError>([&] { read_mesh_file(folder / "other.MSH"); }),
              HasSubstr("other.MSH:1:1: expected a Gmsh mesh, which begins with $MeshFormat"));
  test::write_file(folder / "other.inp", "hello");
  EXPECT_THAT(message_of<ConfigError>([&] { read_mesh_file(folder / "other.inp"); }),
              HasSubstr("other.inp:1:1: expected a keyword such as *NODE, got 'hello'"));
  test::write_file(folder / "old.dat", "$NOD\n");
  EXPECT_THAT(message_of<ConfigError>([&] { read_mesh_file(folder / "old.dat"); }),
              HasSubstr("a Gmsh mesh of version 1.0"));
}

TEST(MeshFile, OtherFilesAreNamed) {
  const test::TemporaryFolder folder;
  const std::string expected = "expected a mesh of Gmsh (.msh) or of Abaqus or CalculiX (.inp)";
  EXPECT_THAT(mesh_file_failure(folder / "none.msh"), HasSubstr("cannot be opened; " + expected));
  EXPECT_THAT(mesh_file_failure(folder.path()), HasSubstr("is a folder, expected a regular file"));
  ASSERT_EQ(mkfifo((folder / "fifo.msh").c_str(), 0600), 0);
  EXPECT_THAT(mesh_file_failure(folder / "fifo.msh"), HasSubstr("is a FIFO (named pipe)"));
  test::write_file(folder / "empty.msh", "");
  EXPECT_THAT(mesh_file_failure(folder / "empty.msh"), HasSubstr("is empty; " + expected));
  test::write_file(folder / "a.msh", "\x89HDF\r\n\x1a\n and more");
  EXPECT_THAT(
      mesh_file_failure(folder / "a.msh"),
      HasSubstr("is an HDF5 file (MED, CGNS or results?); export a mesh from it; expected"));
  test::write_file(folder / "a.inp", "ISO-10303-21;\n");
  EXPECT_THAT(mesh_file_failure(folder / "a.inp"), HasSubstr("is a STEP file"));
  test::write_file(folder / "a.txt", "\n hello\nworld");
  EXPECT_THAT(mesh_file_failure(folder / "a.txt"), HasSubstr("begins with 'hello'; " + expected));
}

TEST(MeshFile, IncludedFilesAreFoundBesideTheOneThatNamesThem) {
  const test::TemporaryFolder folder;
  std::filesystem::create_directory(folder / "parts");
  test::write_file(folder / "main.inp", "*INCLUDE, INPUT=parts/mesh.inc\n");
  test::write_file(folder / "parts/mesh.inc",
                   "*NODE, INPUT=nodes.inc\n*ELEMENT, TYPE=CPS4\n1, 1, 2, 3, 4\n");
  test::write_file(folder / "parts/nodes.inc", "1, 0, 0\n2, 1, 0\n3, 1, 1\n4, 0, 1\n");
  EXPECT_EQ(read_mesh_file(folder / "main.inp").mesh.num_nodes(), 4U);
  test::write_file(folder / "parts/nodes.inc", "*INCLUDE, INPUT=../main.inp\n");
  EXPECT_THAT(message_of<ConfigError>([&] { read_mesh_file(folder / "main.inp"); }),
              HasSubstr("parts/nodes.inc:1:1: "));
  std::filesystem::remove(folder / "parts/nodes.inc");
  EXPECT_THAT(message_of<ConfigError>([&] { read_mesh_file(folder / "main.inp"); }),
              HasSubstr("parts/mesh.inc:1:1: cannot include a file: "));
}

TEST(SourceText, NumbersAreWholeWords) {
  EXPECT_EQ(integer_in("+12"), 12);
  EXPECT_EQ(integer_in("-3"), -3);
  for (const char* word : {"", "+", "+-3", "1.0", "1x", "99999999999999999999"})
    EXPECT_EQ(integer_in(word), std::nullopt) << word;
  EXPECT_EQ(real_in("+1.5"), 1.5);
  EXPECT_EQ(real_in("-.5D-1"), -0.05);
  EXPECT_EQ(real_in("1.d2"), 100.0);
  EXPECT_EQ(real_in("1e-999"), 0.0);
  for (const char* word :
       {"", "+", "D1", "1D", "1e", "nan", "inf", "1e999", "1D999", "1.0x", "1 2"})
    EXPECT_EQ(real_in(word), std::nullopt) << word;
  EXPECT_EQ(real_in(std::string(500, '9')), std::nullopt);
}

TEST(SourceText, WhatIsShownIsShortAndPrintable) {
  EXPECT_EQ(shown("a\x01\xff\xc3\xa4"), "a??\xc3\xa4");
  EXPECT_EQ(shown(std::string(41, 'x')), std::string(40, 'x') + "...");
}

TEST(SourceText, ProblemsShowTheirLine) {
  const SourceText source{"m.inp", "one\r\ntwo words\r\n"};
  try {
    refuse_at({&source, 9}, "wrong");
    FAIL();
  } catch (const ConfigError& error) {
    EXPECT_EQ(error.problems().at(0).text(), "m.inp:2:5: wrong");
    EXPECT_EQ(error.problems().at(0).excerpt, "    2 | two words\n      |     ^");
  }
}

}  // namespace
}  // namespace stridor
