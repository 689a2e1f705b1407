#include "io/imports/gmsh_program.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <string>

#include "core/errors.hpp"
#include "core/helper_program.hpp"
#include "io/imports/mesh_file.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/temporary_folder.hpp"

namespace stridor {
namespace {

using test::message_of;
using testing::HasSubstr;

constexpr const char* square =
    "DefineConstant[ mesh_size = 0.1 ];\n"
    "Point(1) = {0, 0, 0, mesh_size}; Point(2) = {1, 0, 0, mesh_size};\n"
    "Point(3) = {1, 1, 0, mesh_size}; Point(4) = {0, 1, 0, mesh_size};\n"
    "Line(1) = {1, 2}; Line(2) = {2, 3}; Line(3) = {3, 4}; Line(4) = {4, 1};\n"
    "Curve Loop(1) = {1, 2, 3, 4}; Plane Surface(1) = {1};\n"
    "Physical Surface(\"plate\") = {1}; Physical Curve(\"foot\") = {1};\n";

class GmshProgram : public testing::Test {
 protected:
  void SetUp() override {
    const std::string log = (folder_ / "log").string();
    if (run_helper({"gmsh", "--version"}, log, log).spawn_error != 0)
      GTEST_SKIP() << "gmsh is not installed";
    std::filesystem::remove(folder_ / "log");
    test::write_file(folder_ / "square.geo", square);
  }
  std::string mesh(double size, int order = 2) {
    return mesh_with_gmsh((folder_ / "square.geo").string(), {size, order});
  }
  std::string complaint() {
    return message_of<FileError>([&] { mesh(0.3); });
  }
  test::TemporaryFolder folder_;
};

TEST_F(GmshProgram, MakesAMeshOfTheSizeAndOrderWithItsNames) {
  const Mesh coarse = read_mesh_file(mesh(0.5)).mesh;
  const Mesh fine = read_mesh_file(mesh(0.1)).mesh;
  EXPECT_GT(fine.num_elements(), 10 * coarse.num_elements());
  EXPECT_EQ(coarse.shapes.front(), ElementShape::tri6);
  EXPECT_TRUE(coarse.surfaces.contains("foot"));
  EXPECT_EQ(read_mesh_file(mesh(0.5, 1)).mesh.shapes.front(), ElementShape::tri3);
}

TEST_F(GmshProgram, KeepsTheMeshAsLongAsTheGeometryIsTheSame) {
  const std::string first = mesh(0.5);
  EXPECT_THAT(test::contents_of(first), HasSubstr("$Comments\ngmsh "));
  // It is not made anew: whatever stands there is taken.
  test::write_file(first, "kept");
  EXPECT_EQ(mesh(0.5), first);
  EXPECT_EQ(test::contents_of(first), "kept");
  EXPECT_NE(mesh(0.4), first);
  test::write_file(folder_ / "part.geo", "x = 1;\n");
  test::write_file(folder_ / "square.geo", std::string(square) + "Include \"part.geo\";\n");
  const std::string second = mesh(0.5);
  EXPECT_NE(second, first);
  test::write_file(folder_ / "part.geo", "x = 2;\n");
  EXPECT_NE(mesh(0.5), second);
}

TEST_F(GmshProgram, FailuresSayWhatGmshSaid) {
  test::write_file(folder_ / "square.geo", "Line(1) = {1, ;\n");
  EXPECT_THAT(complaint(), HasSubstr("gmsh failed: "));
  EXPECT_THAT(complaint(), HasSubstr("syntax error"));
  EXPECT_THAT(folder_.files(), testing::UnorderedElementsAre("square.geo"));
  std::filesystem::remove(folder_ / "square.geo");
  EXPECT_THAT(complaint(), HasSubstr("square.geo"));
}

TEST_F(GmshProgram, KeepsTheMeshInTheCacheOfAUserWhoMayNotWriteBesideTheGeometry) {
  namespace fs = std::filesystem;
  constexpr uid_t nobody = 65534;
  fs::create_directory(folder_ / "cache");
  fs::permissions(folder_ / "cache", fs::perms::all);
  fs::permissions(folder_.path(), fs::perms(0555));
  setenv("XDG_CACHE_HOME", (folder_ / "cache").c_str(), 1);
  // root may write everywhere.
  const bool is_root = geteuid() == 0;
  ASSERT_TRUE(!is_root || seteuid(nobody) == 0);
  const std::string first = mesh(0.5);
  const std::string second = mesh(0.5);
  ASSERT_TRUE(!is_root || seteuid(0) == 0);
  unsetenv("XDG_CACHE_HOME");
  fs::permissions(folder_.path(), fs::perms(0755));
  EXPECT_EQ(fs::path(first).parent_path(), folder_ / "cache" / "stridor");
  EXPECT_EQ(second, first);
  EXPECT_GT(read_mesh_file(first).mesh.num_elements(), 0);
}

TEST_F(GmshProgram, ThatIsMissingIsNamedWithItsPackage) {
  const std::string path = std::getenv("PATH");
  setenv("PATH", folder_.path().c_str(), 1);
  const std::string message = complaint();
  setenv("PATH", path.c_str(), 1);
  EXPECT_THAT(message, HasSubstr("install the package gmsh, or name a mesh"));
}

}  // namespace
}  // namespace stridor
