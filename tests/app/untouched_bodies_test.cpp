// Bodies that nothing touches, as a user would run them: given by matrices, beams, lumped masses.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <fstream>
#include <string>
#include <utility>
#include <vector>

#include "tests/support/eigenvalue_program.hpp"
#include "tests/support/program.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/support/untouched_bodies.hpp"

namespace stridor {
namespace {

using namespace test;
using ::testing::HasSubstr;

double example_limit(const std::string& name, const std::string& key, const std::string& to,
                     std::vector<std::string> more) {
  std::vector<std::string> arguments{"threshold",   scene_path("examples/" + name + ".yaml"),
                                     "--parameter", key,
                                     "--from",      "0.05",
                                     "--to",        to};
  arguments.insert(arguments.end(), more.begin(), more.end());
  const Json roots = json_of(arguments)["roots"];
  EXPECT_EQ(roots.size(), 1U) << name;
  return roots.empty() ? 0.0 : roots[0]["value"].get<double>();
}

TEST(UntouchedBodies, ARangeOverManyDecadesHidesNoLimit) {
  const Json threshold = json_of({"threshold", scene_path("examples/flutter.yaml"), "--parameter",
                                  "parameters.load", "--from", "0", "--to", "1e100"});
  ASSERT_EQ(threshold["roots"].size(), 1U);
  EXPECT_NEAR(threshold["roots"][0]["value"].get<double>(), 0.2, 1e-12);
}

TEST(UntouchedBodies, FactorsOfMatricesAreVaried) {
  // Flutter of diag(1, 1.4) under a circulatory force n: from 0.2 on, with damping 0.1 of both from
  // 0.2280350850.
  const TemporaryFolder folder;
  const std::string scene = (folder / "two.yaml").string();
  std::ofstream(scene) << "format: 2\nparameters: {n: 1, d: 0, k: 1}\nsubstructures:\n"
                          "  two: {type: matrices, mass: [[1, 0], [0, 1]], terms: [\n"
                          "    {role: stiffness, matrix: [[1, 0], [0, 1.4]], factor: =k},\n"
                          "    {role: damping, matrix: [[1, 0], [0, 1]], factor: =d},\n"
                          "    {role: circulatory, matrix: [[0, 1], [-1, 0]], factor: =n}]}\n";
  const std::string n = "parameters.n";
  const std::string d = "parameters.d";
  const auto limit = [&](const std::vector<std::string>& more) {
    std::vector<std::string> arguments{"threshold", scene, "--parameter", n,
                                       "--from",    "0",   "--to",        "0.4"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return json_of(arguments)["roots"].at(0)["value"].get<double>();
  };
  EXPECT_NEAR(limit({}), 0.2, 1e-12);
  EXPECT_NEAR(limit({"--set", d + "=0.1"}), 0.2280350850, 1e-10);
  EXPECT_NEAR(limit({"--set", "parameters.k=1.5"}), 0.3, 1e-12);
  const Json map = json_of({"map", scene, "--x", n, "0", "0.4", "5", "--y", d, "0.1", "0.3", "3"});
  // 0.2² + d² 1.2 = n².
  const auto stable = [&](std::size_t row, std::size_t column) {
    return map["growth"][row][column].get<double>() <= 0.0;
  };
  for (std::size_t row = 0; row < 3; ++row) {
    for (std::size_t column = 0; column < 5; ++column) {
      const double at = 0.1 * static_cast<double>(column);
      const double damping = 0.1 + 0.1 * static_cast<double>(row);
      EXPECT_EQ(stable(row, column), at * at < 0.04 + 1.2 * damping * damping) << row << column;
    }
  }
}

TEST(UntouchedBodies, ExamplesHaveTheirClosedForms) {
  EXPECT_NEAR(example_limit("flutter", "parameters.load", "0.4", {}), 0.2, 1e-12);
  EXPECT_NEAR(example_limit("flutter_equal_damping", "parameters.load", "0.4", {}), 0.2280350850,
              1e-10);
  EXPECT_NEAR(example_limit("flutter_ziegler", "parameters.load", "0.4", {}), 0.1732146068, 1e-10);
  EXPECT_NEAR(example_limit("flutter_ziegler", "parameters.load", "0.4",
                            {"--set", "substructures.oscillator.damping=[0.1 0, 0 0.3]"}),
              0.2509980080, 1e-10);
  EXPECT_NEAR(example_limit("two_springs_on_a_belt", "parameters.mu", "1.2", {}), 0.75, 1e-12);
  const auto largest = [](const std::string& name) {
    return growth_of(json_of({"eig", scene_path("examples/" + name + ".yaml")})).largest;
  };
  EXPECT_NEAR(largest("flutter"), 0.1016256896, 1e-10);
  EXPECT_NEAR(largest("flutter_gyroscopic"), 0.0111662740, 1e-10);
  EXPECT_NEAR(largest("gyroscopic"), 0.0, 1e-12);
}

const char* const beam_body =
    "  ruler: {type: beam, length: 0.3, thickness: 2 mm, width: 20 mm, angle: 0, material: "
    "{youngs_modulus: 210 GPa, poissons_ratio: 0.3, density: 7850}, mesh: {along: 20, through: 1}, "
    "supports: {start: clamped}, damping: {alpha: 1, beta: 0}, reduction: "
    "{fixed_interface_modes: 6}}\n";

TEST(UntouchedBodies, StandSideBySideWithTheSpectraOfEach) {
  const TemporaryFolder folder;
  const auto spectrum = [&](const std::string& bodies) {
    std::vector<std::complex<double>> found;
    const Json eig = json_of({"eig", scene_of(folder, "substructures:\n" + bodies)});
    EXPECT_EQ(eig["method"], "dense");
    for (const Json& s : eig["eigenvalues"]) found.emplace_back(s[0], s[1]);
    return found;
  };
  const auto all = spectrum(std::string(flutter_body) + beam_body + weight_body);
  std::size_t num_alone = 0;
  for (const char* body : {flutter_body, beam_body, weight_body}) {
    const auto alone = spectrum(body);
    num_alone += alone.size();
    for (const std::complex<double> s : alone) {
      const auto nearest = std::min_element(all.begin(), all.end(), [&](auto a, auto b) {
        return std::abs(a - s) < std::abs(b - s);
      });
      EXPECT_LT(std::abs(*nearest - s), 1e-9 * std::max(1.0, std::abs(s))) << s;
    }
  }
  EXPECT_EQ(all.size(), num_alone);
  // s² + 2 s + 400 = 0 of the weight, which is free along x.
  const auto weight = spectrum(weight_body);
  ASSERT_EQ(weight.size(), 3U);
  EXPECT_EQ(weight[0], 0.0);
  EXPECT_NEAR(weight[2].real(), -1.0, 1e-12);
  EXPECT_NEAR(weight[2].imag(), std::sqrt(399.0), 1e-11);
}

TEST(UntouchedBodies, MayBeFreeAndFallAwayFromWhereTheyStand) {
  const TemporaryFolder folder;
  const auto eigenvalues = [&](const std::string& stiffness) {
    return json_of({"eig", scene_of(folder,
                                    "substructures:\n  body: {type: matrices, mass: [[2, 0], "
                                    "[0, 1]], stiffness: " +
                                        stiffness + "}\n")});
  };
  // Two masses on a spring between them: 0, 0 and 1.5.
  const Json free = eigenvalues("[[1, -1], [-1, 1]]");
  EXPECT_NEAR(free["eigenvalues"].back()[1].get<double>(), std::sqrt(1.5), 1e-12);
  EXPECT_TRUE(free["stable"]);
  // s² = 3/2 along the first, −4 along the second.
  const Json falling = eigenvalues("[[-3, 0], [0, 4]]");
  EXPECT_FALSE(falling["stable"]);
  EXPECT_NEAR(growth_of(falling).largest, std::sqrt(1.5), 1e-12);
  EXPECT_NEAR(falling["eigenvalues"].back()[1].get<double>(), 2.0, 1e-12);
}

TEST(UntouchedBodies, AreExplainedAndDrawn) {
  const TemporaryFolder folder;
  const std::string scene = scene_of(folder, "substructures:\n" + std::string(flutter_body));
  const Json explanation = json_of({"eig", scene, "--explain"})["explanation"];
  // Without damping all of its growth is the circulatory force's.
  EXPECT_NEAR(explanation["energy"]["growth_by_coupled_terms"].get<double>(),
              explanation["growth"].get<double>(), 1e-12);
  EXPECT_EQ(explanation["energy"]["growth_from_contact"], 0.0);
  EXPECT_NEAR(explanation["quotients"]["gyroscopic"].get<double>(), 0.0, 1e-12);
  EXPECT_GT(json_of({"eig", scene, "--shapes", (folder / "point").string()})["files"].size(), 1U);
  const ProgramResult nowhere =
      Program({"eig", scene_path("examples/flutter.yaml"), "--shapes", (folder / "no").string()})
          .run();
  EXPECT_EQ(nowhere.exit_code, 2);
  EXPECT_THAT(nowhere.err, HasSubstr("--shapes: no body has nodes to draw"));
  const std::string beam = scene_of(folder, "substructures:\n" + std::string(beam_body));
  EXPECT_GT(json_of({"eig", beam, "--shapes", (folder / "beam").string()})["files"].size(), 1U);
}

TEST(UntouchedBodies, AMissingSectionIsAnErrorOfTheVerbThatNeedsIt) {
  const std::string flutter = scene_path("examples/flutter.yaml");
  const std::string key = "parameters.load";
  const TemporaryFolder folder;
  const std::string out = (folder / "x").string();
  const std::vector<std::pair<std::vector<std::string>, std::string>> cases{
      {{"run", flutter, "-o", out + ".h5"}, "time: missing: `run` needs this section"},
      {{"sweep", flutter, "--parameter", key, "--from", "0", "--to", "1"},
       "time: missing: `sweep` needs this section"},
      {{"precision", flutter}, "time: missing: `precision` needs this section"},
      {{"compare", flutter}, "time: missing: `compare` needs this section"},
      {{"compare", flutter, "--set", "time={step: 1e-3, end: 1}"},
       "contact: missing: `compare` needs this section"},
      {{"check", flutter, "--stability"}, "time: missing: `check --stability` needs this section"},
      {{"eig", flutter, "--at", "0.1"}, "contact: missing: `eig --at` needs this section"},
      {{"locus", flutter, "--from", "0", "--to", "1"},
       "--parameter: no place along a path can be varied in this scene"},
      {{"locus", flutter, "--parameter", "drive.displacement", "--from", "0", "--to", "1"},
       "--parameter: 'drive.displacement' moves contacts, and the scene has none"}};
  for (const auto& [command, message] : cases) {
    const ProgramResult result = Program(command).run();
    EXPECT_EQ(result.exit_code, 2) << message;
    EXPECT_THAT(result.err, HasSubstr(message));
  }
}

}  // namespace
}  // namespace stridor
