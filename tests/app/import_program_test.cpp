// What files of meshes and matrices hold, as a user asks for it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "tests/support/program.hpp"

namespace stridor {
namespace {

using namespace test;
using nlohmann::json;
using ::testing::AllOf;
using ::testing::HasSubstr;

const std::string data = std::string(STRIDOR_SOURCE_DIR) + "/tests/data/calculix/";

std::vector<std::string> of_calculix(const std::string& name) {
  const std::string path = data + name;
  return {"import",       path + ".sti", path + ".mas",  path + ".dof", path + ".inp",
          "--length-unit", "mm",          "--json"};
}

json report(const std::vector<std::string>& command) {
  const ProgramResult result = Program(command).run();
  EXPECT_EQ(result.exit_code, 0) << result.err;
  return json::parse(result.out);
}

/// As *FREQUENCY of CalculiX 2.20 prints them: half a unit of the seventh digit behind the point, of
/// numbers from 0.1, is 5e-7.
void expect_frequencies(const json& found, const std::vector<double>& expected) {
  ASSERT_GE(found.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i)
    EXPECT_NEAR(found[i].get<double>() / expected[i], 1.0, 5e-7) << i;
}

TEST(Import, OfCalculixHasItsFrequencies) {
  expect_frequencies(report(of_calculix("c3d10"))["matrices"]["frequencies"],
                     {17692.34, 20695.92, 42497.75, 68092.30, 89217.77, 89410.42});
  const json reduced = report(of_calculix("c3d20r"))["matrices"];
  // Eight integration points leave motions without mass.
  EXPECT_EQ(reduced["mass"], "positive semidefinite");
  EXPECT_LT(std::abs(reduced["smallest_pivot"].get<double>()), 1e-12);
  expect_frequencies(reduced["frequencies"], {16538.65, 19398.76, 39729.31, 65523.77});
  const json linear = report(of_calculix("c3d4"))["matrices"];
  EXPECT_EQ(linear["mass"], "positive definite");
  expect_frequencies(linear["frequencies"], {27483.43, 32120.66, 70751.63, 105578.2});
  EXPECT_EQ(linear["rigid_motions"], 0);
  EXPECT_EQ(linear["rigid_motions_expected"], 0);
}

TEST(Import, OfAFreeBodyHasItsMassAndSixRigidMotions) {
  const json all = report(of_calculix("c3d4_free"));
  const json& matrices = all["matrices"];
  EXPECT_EQ(matrices["rigid_motions"], 6);
  EXPECT_EQ(matrices["rigid_motions_expected"], 6);
  EXPECT_EQ(matrices["stiffness"], "positive semidefinite");
  EXPECT_EQ(matrices["nodes_without_unknowns"], 0);
  EXPECT_EQ(matrices["files"][0]["stored"], "upper triangle");
  // 20 x 10 x 8 mm of 7850 kg/m³, to the 14 digits of the file.
  for (const json& mass : matrices["masses"]) {
    EXPECT_NEAR(mass["mass"].get<double>(), 1.6e-6 * 7850.0, 1e-13);
    EXPECT_NEAR(mass["centre"][0].get<double>(), 0.01, 1e-13);
    EXPECT_NEAR(mass["centre"][1].get<double>(), 0.005, 1e-13);
    EXPECT_NEAR(mass["centre"][2].get<double>(), 0.004, 1e-13);
  }
  const json& mesh = all["mesh"];
  EXPECT_NEAR(mesh["volume"].get<double>(), 1.6e-6, 1e-18);
  EXPECT_EQ(mesh["elements"]["tet4"], 6);
  EXPECT_EQ(mesh["node_sets"]["ROOT"], 4);
  const json& sole = mesh["surfaces"]["SOLE"];
  EXPECT_EQ(sole["sides"], 2);
  EXPECT_NEAR(sole["area"].get<double>(), 1.6e-4, 1e-16);
  EXPECT_NEAR(sole["normal"][1].get<double>(), -1.0, 1e-12);
}

TEST(Import, SaysWhatASceneNeeds) {
  std::vector<std::string> command = of_calculix("c3d10");
  command.pop_back();
  const ProgramResult result = Program(command).run();
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("K"));
  EXPECT_THAT(result.out, HasSubstr("rigid motions            0 found, 0 expected"));
  EXPECT_THAT(result.out, HasSubstr("    unknowns: " + data + "c3d10.dof\n"));
  EXPECT_THAT(result.out, HasSubstr("    length_unit: mm\n"));
}

TEST(Import, DrawsAMesh) {
  const TemporaryFolder folder;
  const std::string figure = (folder / "mesh.svg").string();
  const ProgramResult result =
      Program({"import", data + "c3d4_free.inp", "-o", figure}).run();
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const std::string drawn = contents_of(figure);
  EXPECT_THAT(drawn, HasSubstr("SOLE"));
  // What exists is not drawn over.
  EXPECT_EQ(Program({"import", data + "c3d4_free.inp", "-o", figure}).run().exit_code, 4);
}

TEST(Import, SaysWhatAUniversalFileHolds) {
  const std::string reed = scene_path("examples/reed.uff");
  const json held = report({"import", reed, "--json"})["universal"];
  EXPECT_EQ(held["nodes"], 4);
  EXPECT_EQ(held["units"]["length"], 1e-3);  // the file is in mm
  ASSERT_GE(held["modes"].size(), 2u);
  EXPECT_GT(held["modes"][0]["frequency"].get<double>(), 0.0);
  EXPECT_EQ(held["modes"][0]["nodes"], 4);
  const ProgramResult said = Program({"import", reed}).run();
  EXPECT_EQ(said.exit_code, 0) << said.err;
  for (const char* text : {"dataset 2411", "nodes", "mode 1", "Hz, damping ratio", "type: modes",
                           "stridor eig SCENE.yaml --compare"})
    EXPECT_THAT(said.out, HasSubstr(text));

  const TemporaryFolder folder;
  const std::string hit = (folder / "hit.uff").string();
  ASSERT_EQ(Program({"frf", scene_path("examples/reed.yaml"), "--input", "reed.middle.y", "--from",
                     "100", "--to", "500", "--points", "5", "-o", hit})
                .run()
                .exit_code,
            0);
  const json functions = report({"import", hit, "--json"})["universal"]["functions"];
  ASSERT_EQ(functions.size(), 1u);
  EXPECT_EQ(functions[0]["type"], "frequency response");
  EXPECT_EQ(functions[0]["quantity"], "acceleration");
  EXPECT_EQ(functions[0]["per"], "force");
  EXPECT_EQ(functions[0]["values"], 5);
  EXPECT_EQ(functions[0]["from"], 100.0);
  EXPECT_EQ(functions[0]["to"], 500.0);
  EXPECT_THAT(
      Program({"import", hit}).run().out,
      AllOf(HasSubstr("1 y per 1 y"), HasSubstr("5 complex values at a frequency of 100 to 500"),
            HasSubstr("stridor frf SCENE.yaml")));
}

TEST(Import, DrawsNodesLinesAndElementsOfAUniversalFile) {
  const TemporaryFolder folder;
  const std::string file = (folder / "lines.uff").string();
  std::ofstream(file)
      << contents_of(scene_path("examples/reed.uff")) +
             "    -1\n    82\n         1         4         1\nNONE\n"
             "         1         2         3         4\n    -1\n"
             "    -1\n  2412\n         1        91         1         1         7         3\n"
             "         1         2         4\n    -1\n";
  const json held = report({"import", file, "--json"})["universal"];
  EXPECT_EQ(held["lines"], 1);
  EXPECT_EQ(held["elements"], 1);
  const std::string figure = (folder / "a.svg").string();
  const ProgramResult drawn = Program({"import", file, "-o", figure}).run();
  EXPECT_EQ(drawn.exit_code, 0) << drawn.err;
  EXPECT_THAT(contents_of(figure), HasSubstr("lines.uff: 4 nodes, 1 lines, 1 elements."));
  EXPECT_EQ(Program({"import", scene_path("examples/reed.uff"), "-o", (folder / "b.svg").string()})
                .run()
                .exit_code,
            0);
  EXPECT_GT(contents_of(figure).size(), contents_of((folder / "b.svg").string()).size());
}

TEST(Import, RefusesWhatItCannotTell) {
  const auto refused = [](std::vector<std::string> files) {
    files.insert(files.begin(), "import");
    const ProgramResult result = Program(files).run();
    EXPECT_EQ(result.exit_code, 2) << result.out;
    return result.err;
  };
  EXPECT_THAT(refused({data + "c3d4.sti"}), HasSubstr("there is no mass; give mass=FILE too"));
  EXPECT_THAT(refused({data + "c3d4.dof"}), HasSubstr("hold neither a mesh nor matrices"));
  EXPECT_THAT(refused({"a.matrix"}), HasSubstr("cannot tell what 'a.matrix' is"));
  EXPECT_THAT(refused({data + "c3d4.sti", data + "c3d10.sti"}), HasSubstr("would both be stiffness"));
  EXPECT_THAT(refused({data + "c3d4.sti", data + "c3d4.mas", data + "c3d4.inp"}),
              HasSubstr("mesh: needs to know which rows of the matrices are which nodes"));
  EXPECT_THAT(refused({data + "c3d4.sti", data + "c3d4.mas", data + "c3d4.dof"}),
              HasSubstr("where the nodes are is not known"));
  EXPECT_THAT(refused({data + "c3d4.sti", data + "c3d4.mas", data + "c3d10.dof", data + "c3d10.inp"}),
              HasSubstr("stiffness: is 24 x 24, expected 54 x 54 as `unknowns` says"));
  EXPECT_THAT(refused({data + "c3d4.inp", "--length-unit", "kg"}), HasSubstr("--length-unit"));
  const std::string reed = scene_path("examples/reed.uff");
  EXPECT_THAT(refused({reed, data + "c3d4.inp"}),
              HasSubstr("is a universal file, which is given alone"));
  const TemporaryFolder folder;
  const std::string bare = (folder / "bare.uff").string();
  std::ofstream(bare) << "    -1\n   151\nhead\n    -1\n";
  EXPECT_THAT(refused({bare, "-o", (folder / "a.png").string()}),
              HasSubstr("has no nodes to draw (datasets 15, 2411)"));
}

TEST(Import, NamesTheKeysWhereOneIsUnknown) {
  const ProgramResult result = Program({"import", "mas=body.mtx", "--json"}).run();
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(
      result.err,
      HasSubstr("files: 'mas=body.mtx' has the unknown key 'mas', did you mean 'mass'? (there "
                "are: mass, damping, stiffness, unknowns, mesh, nodes, universal)"));
  EXPECT_EQ(json::parse(result.out)["errors"][0]["code"], "unknown-key");
  // A name may hold the sign.
  const TemporaryFolder folder;
  EXPECT_EQ(Program({"import", folder / "a=b.msh"}).run().exit_code, 4);
}

TEST(Check, SaysWhatTheFilesOfBodiesHold) {
  const json checked = report({"check", scene_path("examples/from_calculix.yaml"), "--json"});
  EXPECT_EQ(checked["errors"].size(), 0U);
  const json& clip = checked["imports"]["clip"];
  expect_frequencies(clip["matrices"]["frequencies"], {2816.534, 4373.270, 18963.35, 21663.70});
  EXPECT_EQ(clip["mesh"]["elements"]["tet10"], 12);
}

}  // namespace
}  // namespace stridor
