// Bodies given by matrices that rub on others, as a user would run them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "tests/app/resume_fixture.hpp"
#include "tests/support/program.hpp"

namespace stridor {
namespace {

using namespace test;
using ::testing::HasSubstr;

const std::string support_scene = scene_path("examples/rotating_support.yaml");

/// The scene with its gyroscopic matrix in a file beside it.
std::string scene_with_file(const std::filesystem::path& folder) {
  std::string text = contents_of(support_scene);
  const std::size_t from = text.find("        matrix:\n");
  const std::size_t to = text.find("\n    ", text.find("[0, 0, 0, 0, 0.04, 0]")) + 1;
  text.replace(from, to - from, "        matrix: G.mtx\n");
  std::ofstream(folder / "scene.yaml") << text;
  std::ofstream(folder / "G.mtx") << "%%MatrixMarket matrix coordinate real skew-symmetric\n"
                                     "6 6 3\n2 1 0.04\n4 3 0.04\n6 5 0.04\n";
  return (folder / "scene.yaml").string();
}

TEST(MatrixBodies, OfFilesAreThoseOfRowsAndGoOnBitwise) {
  const TemporaryFolder folder;
  const std::string by_rows = (folder / "rows.h5").string();
  const TemporaryFolder elsewhere;
  const std::string by_file = (elsewhere / "file.h5").string();
  ASSERT_EQ(
      Program({"run", support_scene, "-o", by_rows, "--set", "time.step=5e-7"}).run().exit_code, 0);
  ProgramResult result = Program({"run", scene_with_file(folder.path()), "-o", by_file, "--set",
                                  "time.step=5e-7", "--max-wall", "0.001"})
                             .run();
  ASSERT_EQ(result.exit_code, 5) << result.err;
  result = Program({"run", "--resume", by_file}).run();
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(difference(by_rows, by_file), "");
}

TEST(MatrixBodies, SayWhatTheirCoupledTermsAddToTheGrowth) {
  const std::vector<std::string> held{
      "--set", "contact.sliding=frozen", "--set", "contact.start=90 mm", "--set", "drive.ramp=0"};
  std::vector<std::string> command{"eig",        support_scene, "--about",
                                   "undeformed", "--explain",   "--json"};
  command.insert(command.end(), held.begin(), held.end());
  const ProgramResult eig = Program(command).run();
  ASSERT_EQ(eig.exit_code, 0) << eig.err;
  const auto explanation = nlohmann::json::parse(eig.out)["explanation"];
  const auto& energy = explanation["energy"];
  const double growth = explanation["growth"];
  EXPECT_GT(growth, 3.0);
  EXPECT_GT(std::abs(energy["growth_by_coupled_terms"].get<double>()), 1e-3);
  EXPECT_NEAR(energy["growth_from_contact"].get<double>() +
                  energy["growth_by_damping"].get<double>() +
                  energy["growth_by_coupled_terms"].get<double>(),
              growth, 1e-8 * explanation["frequency"].get<double>());
}

TEST(MatrixBodies, HaveOneSpectrumByBothMethods) {
  const auto eigenvalues = [](std::vector<std::string> more) {
    std::vector<std::string> command{"eig", support_scene, "--json"};
    command.insert(command.end(), more.begin(), more.end());
    const ProgramResult result = Program(command).run();
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return nlohmann::json::parse(result.out);
  };
  const auto chosen = eigenvalues({});
  EXPECT_EQ(chosen["method"], "secular");
  for (const auto& residual : chosen["residuals"]) EXPECT_LT(residual.get<double>(), 1e-8);
  const auto asked = eigenvalues({"--method", "dense"});
  EXPECT_EQ(asked["method"], "dense");
  ASSERT_EQ(asked["eigenvalues"].size(), chosen["eigenvalues"].size());
  for (std::size_t i = 0; i < chosen["eigenvalues"].size(); ++i) {
    const auto secular = chosen["eigenvalues"][i].get<std::array<double, 2>>();
    const auto dense = asked["eigenvalues"][i].get<std::array<double, 2>>();
    EXPECT_NEAR(secular[0], dense[0], 1e-9 * dense[1]) << i;
    EXPECT_NEAR(secular[1], dense[1], 1e-9 * dense[1]) << i;
  }
}

TEST(MatrixBodies, TellWhatTheirDampingIsWhenChecked) {
  ProgramResult result = Program({"check", support_scene}).run();
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("support: damping that is not proportional, gyroscopic or "
                                    "circulatory terms couple its 6 modes"));
  // Five times the mass in place of the damper, and no rotation.
  const TemporaryFolder folder;
  std::string text = contents_of(support_scene);
  const std::size_t from = text.find("    damping:\n      -");
  const std::size_t to = text.find("    stiffness:\n");
  std::string rows;
  for (int i = 0; i < 6; ++i) {
    rows += "      - [";
    for (int j = 0; j < 6; ++j) rows += std::string(j > 0 ? ", " : "") + (i == j ? "0.1" : "0");
    rows += "]\n";
  }
  text.replace(from, to - from, "    damping:\n" + rows);
  const std::string changed = (folder / "scene.yaml").string();
  std::ofstream(changed) << text;
  const std::string still = "parameters.spin=0";
  result = Program({"check", changed, "--set", still}).run();
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("support: damping is proportional, alpha 5 1/s"));
  result = Program({"check", changed, "--set", still, "--json"}).run();
  const auto bodies = nlohmann::json::parse(result.out)["matrix_bodies"];
  EXPECT_EQ(bodies["support"]["damping"], "proportional");
  EXPECT_NEAR(bodies["support"]["alpha"].get<double>(), 5.0, 1e-10);
}

TEST(MatrixBodies, HaveStepsWhoseStabilityIsChecked) {
  const ProgramResult result = Program({"check", "--stability", support_scene}).run();
  EXPECT_EQ(result.exit_code, 0) << result.out << result.err;
}

TEST(MatrixBodies, AreRefusedWhereTheyDoNotFit) {
  const std::vector<std::pair<std::vector<std::string>, std::string>> cases{
      {{"time.integrator=central_difference", "time.step=1e-6"},
       "time.integrator: must be exact: the modes of 'support' are coupled"},
      {{"time.step=1e-3", "record.interval=1e-3", "measure.band=[10 Hz, 100 Hz]"},
       "time.step: the fastest free motion of 'support'"},
      {{"substructures.support.points.left.x=9"}, "there is no unknown 9: the matrices have 6"},
      {{"substructures.support.surfaces.top.points=[left, midle]"},
       "there is no point 'midle', did you mean 'middle'?"},
      {{"substructures.support.stiffness=[[1, 2], [3, 4]]"},
       "substructures.support.stiffness: is 2 x 2, expected 6 x 6 as `mass` is"},
      {{"substructures.support.stiffness=[[1,0,0,0,0,0],[0,1,0,0,0,0],[0,0,1,0,0,0],"
        "[0,0,0,1,0,0],[0,0,0,0,1,0],[0,0,0,0,0,-1]]"},
       "substructures.support: cannot be reduced"},
      {{"record.channels=[support.below.y.acceleration]"}, "'support' has no point 'below'"},
      {{"contact.master=support.bottom"}, "'support' has no surface 'bottom'"}};
  for (const auto& [sets, message] : cases) {
    std::vector<std::string> command{"check", support_scene};
    for (const std::string& set : sets) command.insert(command.end(), {"--set", set});
    const ProgramResult result = Program(command).run();
    EXPECT_EQ(result.exit_code, 2) << message;
    EXPECT_THAT(result.err, HasSubstr(message));
  }
}

}  // namespace
}  // namespace stridor
