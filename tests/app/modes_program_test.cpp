// Bodies given by modes in sliding scenes, as a user runs them.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numbers>
#include <sstream>
#include <vector>

#include "io/imports/uff_file.hpp"
#include "io/results/uff_writer.hpp"
#include "tests/support/program.hpp"
#include "tests/support/uff_text.hpp"

namespace stridor::test {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::HasSubstr;

/// A plane body of six unknowns, of which 1 and 2 are x and y of its foot and 3 is y of its head.
struct SmallBody {
  Eigen::MatrixXd mass, stiffness;
  double alpha = 3.0, beta = 2e-6;

  SmallBody() {
    Eigen::VectorXd masses(6);
    masses << 0.2, 0.2, 0.3, 0.1, 0.15, 0.12;
    mass = masses.asDiagonal();
    Eigen::MatrixXd B(6, 6);
    B << 3, 1, 0, 0, 1, 0, 0, 4, 2, 1, 0, 0, 1, 0, 5, 0, 1, 2, 0, 2, 0, 6, 0, 1, 1, 0, 1, 0, 7, 0, 2,
        1, 0, 1, 0, 8;
    stiffness = 1e5 * B.transpose() * B;
  }
};

std::string text_of(const Eigen::MatrixXd& matrix) {
  std::string rows = "[";
  for (Eigen::Index i = 0; i < matrix.rows(); ++i) {
    rows += i == 0 ? "[" : ", [";
    for (Eigen::Index j = 0; j < matrix.cols(); ++j)
      rows += fmt::format("{}{:.17g}", j == 0 ? "" : ", ", matrix(i, j));
    rows += "]";
  }
  return rows + "]";
}

std::string list_of(const Eigen::VectorXd& numbers) {
  const std::string text = text_of(numbers.transpose());
  return text.substr(1, text.size() - 2);
}

/// A body pressed on a belt that moves under it.
std::string scene_with(const std::string& body) {
  return "format: 2\nsubstructures:\n  pad:\n" + body +
         "contact:\n  slave: pad.foot\n  master: rigid\n  assumption: subs_b\n  start: 0 mm\n"
         "  friction: {coefficient: 0.4}\n"
         "drive: {velocity: 0.1, load: -5, ramp: 0, moves: contact.master, load_on: pad.foot}\n";
}

std::string by_matrices(const SmallBody& body) {
  return fmt::format("    type: matrices\n    mass: {}\n    stiffness: {}\n    damping: {}\n"
                     "    points: {{foot: {{at: [0, 0], x: 1, y: 2}}, head: {{at: [0, 0.05], y: 3}}}}\n",
                     text_of(body.mass), text_of(body.stiffness),
                     text_of(body.alpha * body.mass + body.beta * body.stiffness));
}

/// The lowest modes of the body, and perhaps the flexibility of the rest.
std::string by_modes(const SmallBody& body, Eigen::Index count, bool has_residual) {
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> all(body.stiffness, body.mass);
  const Eigen::VectorXd omega = all.eigenvalues().cwiseSqrt();
  const Eigen::MatrixXd shapes = all.eigenvectors();
  const Eigen::VectorXd ratio = 0.5 * (body.alpha * omega.cwiseInverse() + body.beta * omega);
  std::string text = fmt::format(
      "    type: modes\n    frequencies: {}\n    damping_ratios: {}\n    ports:\n"
      "      foot: {{at: [0, 0], x: {}, y: {}}}\n      head: {{at: [0, 0.05], y: {}}}\n",
      list_of(omega.head(count) / (2.0 * std::numbers::pi)), list_of(ratio.head(count)),
      list_of(shapes.row(0).head(count)), list_of(shapes.row(1).head(count)),
      list_of(shapes.row(2).head(count)));
  if (!has_residual) return text;
  const Eigen::MatrixXd ports = shapes.topRows(2).rightCols(6 - count);
  const Eigen::MatrixXd F = ports * omega.tail(6 - count).array().square().inverse().matrix().asDiagonal() *
                            ports.transpose();
  return text + "    residual: {on: [foot.x, foot.y], flexibility: " + text_of(F) + "}\n";
}

std::vector<std::complex<double>> eigenvalues_of(const fs::path& folder, const std::string& scene) {
  const fs::path file = folder / "scene.yaml";
  write_file(file, scene);
  const ProgramResult result = Program({"eig", file.string(), "--json", "--count", "3"}).run();
  EXPECT_EQ(result.exit_code, 0) << result.err;
  std::vector<std::complex<double>> values;
  if (result.exit_code != 0) return values;
  const auto object = nlohmann::json::parse(result.out);
  for (const auto& one : object["eigenvalues"]) {
    if (one[1].get<double>() == 0.0) continue;
    values.emplace_back(one[0].get<double>(), one[1].get<double>());
  }
  return values;
}

TEST(ModesProgram, AllModesAreTheBodyAndResidualFlexibilityClosesTheGapOfFewer) {
  const TemporaryFolder folder;
  const SmallBody body;
  const auto full = eigenvalues_of(folder.path(), scene_with(by_matrices(body)));
  const auto whole = eigenvalues_of(folder.path(), scene_with(by_modes(body, 6, false)));
  ASSERT_GE(full.size(), 2u);
  ASSERT_EQ(whole.size(), full.size());
  const double scale = std::abs(full[0]);
  for (std::size_t i = 0; i < full.size(); ++i)
    EXPECT_LT(std::abs(whole[i] - full[i]), 1e-8 * std::abs(full[i])) << i;
  // A model of the same in NumPy has gaps of 2.5e-4 and 2.0e-5 (or 8.4e-4 and 9.4e-5 with the belt
  // running the other way).
  const auto three = eigenvalues_of(folder.path(), scene_with(by_modes(body, 3, false)));
  const auto residual = eigenvalues_of(folder.path(), scene_with(by_modes(body, 3, true)));
  ASSERT_FALSE(three.empty() || residual.empty());
  const double gap = std::abs(three[0] - full[0]);
  const double closed = std::abs(residual[0] - full[0]);
  EXPECT_GT(gap, 1e-4 * scale);
  EXPECT_LT(closed, 0.2 * gap);
}

/// The commands of the page, one after the other.
TEST(ModesProgram, ThePageRunsFromTheFirstLineToTheLast) {
  const TemporaryFolder folder;
  const fs::path root(STRIDOR_SOURCE_DIR);
  std::istringstream page(contents_of(root / "docs/from_modal_test.md"));
  std::string line;
  bool is_shell = false;
  int number = 0;
  while (std::getline(page, line)) {
    if (line.starts_with("```")) {
      is_shell = line == "```sh";
      continue;
    }
    if (!is_shell || !line.starts_with("stridor ")) continue;
    std::istringstream words(line);
    std::vector<std::string> arguments;
    std::string word;
    words >> word;
    while (words >> word) {
      if (word.starts_with("scenes/")) word = (root / word).string();
      const bool is_made =
          !arguments.empty() && (arguments.back() == "-o" || arguments.back() == "--figure" ||
                                 arguments.back() == "--data");
      if (word.find('.') != std::string::npos && !word.starts_with("-") && is_made)
        word = (folder / word).string();
      if (fs::exists(folder / word)) word = (folder / word).string();
      arguments.push_back(word);
    }
    const ProgramResult result = Program(arguments).run();
    EXPECT_EQ(result.exit_code, 0) << line << '\n' << result.err;
    ++number;
  }
  EXPECT_GE(number, 5);
}

nlohmann::json eig_json(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), "eig");
  arguments.emplace_back("--json");
  const ProgramResult result = Program(arguments).run();
  EXPECT_EQ(result.exit_code, 0) << result.err;
  return nlohmann::json::parse(result.out, nullptr, false);
}

// A part of which one place is a port is drawn with all measured nodes that lines join, in their
// measured shapes.
TEST(ShapeFiles, LinesOfATestCarryItsShapesToAllTheirNodes) {
  const TemporaryFolder folder;
  const std::string measured = (folder / "lines.uff").string();
  const std::string reed = contents_of(scene_path("examples/reed.uff"));
  std::ofstream(measured) << reed +
                                 "    -1\n    82\n         1         4         1\nNONE\n"
                                 "         1         2         3         4\n    -1\n";
  const std::string scene = (folder / "reed.yaml").string();
  std::ofstream(scene)
      << "format: 2\nsubstructures:\n  reed:\n    type: modes\n    file: lines.uff\n"
         "    ports:\n      tip: {node: 4}\n";
  const std::string file = (folder / "modes.uff").string();
  eig_json({scene, "--uff", file});
  const ModalTest written = read_uff_file(file);
  EXPECT_EQ(written.nodes.size(), 4u);
  ASSERT_EQ(written.lines.size(), 1u);
  EXPECT_EQ(written.lines[0].size(), 4u);
  // All nodes are matched by place: the shapes are those measured.
  const auto compared = eig_json({scene, "--compare", measured})["comparison"];
  EXPECT_EQ(compared["nodes"], 4);
  for (const auto& mode : compared["modes"]) EXPECT_GT(mode["mac"].get<double>(), 1.0 - 1e-9);
  const fs::path shapes = folder / "shapes";
  eig_json({scene, "--shapes", shapes.string()});
  const auto figure = [&](const std::string& of, const std::string& name) {
    const ProgramResult drawn = Program({"draw", of, "-o", (folder / name).string()}).run();
    EXPECT_EQ(drawn.exit_code, 0) << drawn.err;
    return contents_of(folder / name).size();
  };
  const std::string alone = (folder / "alone.yaml").string();
  std::ofstream(folder / "alone.uff") << reed;
  std::ofstream(alone)
      << "format: 2\nsubstructures:\n  reed:\n    type: modes\n    file: alone.uff\n"
         "    ports:\n      tip: {node: 4}\n";
  EXPECT_GT(figure(scene, "a.svg"), figure(alone, "b.svg"));
}

// The modes of a scene, written as if they had been measured, are those of the scene; with another
// friction they are still alike, at other frequencies.
TEST(ShapeFiles, ModesAreThoseThatWereWritten) {
  const TemporaryFolder folder;
  const std::string file = (folder / "modes.uff").string();
  const std::string scene = scene_path("examples/bracket.yaml");
  const auto written = eig_json({scene, "--count", "8", "--uff", file});
  EXPECT_EQ(written["uff"], file);
  const auto compared = eig_json({scene, "--count", "8", "--compare", file});
  const auto& modes = compared["comparison"]["modes"];
  // Measured frequencies are those without damping, of six digits.
  std::vector<double> undamped;
  for (const auto& one : written["eigenvalues"]) {
    if (one[1].get<double>() > 0.0)
      undamped.push_back(std::hypot(one[0].get<double>(), one[1].get<double>()) / (2.0 * std::numbers::pi));
  }
  EXPECT_LT(compared["comparison"]["farthest"].get<double>(), 1e-9);
  ASSERT_EQ(modes.size(), 8u);
  for (std::size_t i = 0; i < modes.size(); ++i) {
    EXPECT_EQ(modes[i]["mode"], i + 1);
    EXPECT_GT(modes[i]["mac"].get<double>(), 1.0 - 1e-8) << modes[i];
    EXPECT_NEAR(modes[i]["frequency"].get<double>(), undamped.at(i), 1e-9 * undamped[i]);
    EXPECT_EQ(modes[i]["macs"].size(), 8u);
    EXPECT_NEAR(modes[i]["measured_frequency"].get<double>(), undamped.at(i), 1e-5 * undamped[i]);
  }
  EXPECT_EQ(compared["comparison"]["unclear"].size(), 0u);
  const ProgramResult again = Program({"eig", scene, "--uff", file}).run();
  EXPECT_EQ(again.exit_code, 4);
  EXPECT_THAT(again.err, HasSubstr("--force"));
}

TEST(ShapeFiles, MatchNamedNodesWherePlacesDoNotTell) {
  const TemporaryFolder folder;
  const std::string scene = scene_path("examples/reed.yaml");
  const std::string file = scene_path("examples/reed.uff");
  const std::string figure = (folder / "mac.svg").string();
  // The reed of the test lies elsewhere than in the scene; two of its nodes have names there.
  EXPECT_THAT(Program({"eig", scene, "--compare", file, "--node", "4=reed.tip"}).run().err,
              HasSubstr("--node 1=BODY.POINT"));
  const std::string two_nodes = (folder / "two.uff").string();
  const auto shape = [](int number, const char* hertz, const char* middle, const char* tip) {
    std::string lines = "    -1\n    55\nNONE\nNONE\nNONE\nNONE\nNONE\n";
    lines += "         1         2         2         8         2         3\n";
    lines += "         2         4         1" + std::string(9, ' ') + std::to_string(number) + "\n";
    lines += std::string("  ") + hertz + "  1.00000E+00  1.00000E-02  0.00000E+00\n";
    return lines + "         2\n" + middle + "\n         4\n" + tip + "\n    -1\n";
  };
  std::ofstream(two_nodes) << shape(1, "1.00000E+02", "  0.00000E+00  3.00000E-01  0.00000E+00",
                                    "  0.00000E+00  1.00000E+00  0.00000E+00");
  const auto compared = eig_json({scene, "--compare", two_nodes, "--node", "2=reed.middle", "--node", "4=reed.tip",
                                  "--figure", figure});
  EXPECT_EQ(compared["comparison"]["nodes"], 2);
  EXPECT_EQ(compared["comparison"]["farthest"], 0.0);
  EXPECT_EQ(compared["figure"], figure);
  const std::string picture = contents_of(figure);
  EXPECT_THAT(picture, AllOf(HasSubstr("measured (Hz)"), HasSubstr("computed (Hz)")));

  const auto refusal = [&](const std::string& node) {
    const ProgramResult result = Program({"eig", scene, "--compare", two_nodes, "--node", "2=reed.middle", "--node",
                                          "4=reed.tip", "--node", node})
                                     .run();
    EXPECT_EQ(result.exit_code, 2) << node;
    return result.err;
  };
  EXPECT_THAT(refusal("7=reed.tip"), HasSubstr("no mode of"));
  EXPECT_THAT(refusal("2=red.tip"), HasSubstr("no body 'red' has nodes (these have: reed)"));
  EXPECT_THAT(refusal("2=reed.tp"), HasSubstr("did you mean 'tip'"));
  EXPECT_THAT(refusal("two=reed.tip"), HasSubstr("expected NUMBER=BODY.POINT"));
  const ProgramResult alone = Program({"eig", scene, "--figure", figure}).run();
  EXPECT_EQ(alone.exit_code, 2);
  EXPECT_THAT(alone.err, HasSubstr("give it with --compare"));
}

// Where nodes of two bodies coincide a single measured node may be of either.
TEST(ShapeFiles, TellWhereSeveralNodesOfTheSceneStandAtAMeasuredPlace) {
  const TemporaryFolder folder;
  const std::string file = (folder / "modes.uff").string();
  const std::string scene = scene_path("examples/bracket.yaml");
  eig_json({scene, "--count", "1", "--uff", file});
  const ModalTest own = read_uff_file(file);
  std::vector<std::int64_t> there;  // the first two nodes that coincide
  for (const auto& [label, place] : own.nodes) {
    for (const auto& [other, its_place] : own.nodes)
      if (there.empty() && other > label && (place - its_place).norm() < 1e-12)
        there = {label, other};
  }
  ASSERT_EQ(there.size(), 2u) << "the nodes of the bodies do not meet";
  const auto compared_with = [&](const std::vector<std::int64_t>& labels) {
    UffContents contents;
    contents.modes.push_back({.number = 1, .eigenvalue = {-1.0, 1000.0}, .shape = {}});
    for (const std::int64_t label : labels) {
      contents.nodes.push_back({label, "part", own.nodes.at(label)});
      contents.modes[0].shape.push_back({1.0, 2.0, 0.0});
    }
    const std::string measured = (folder / "measured.uff").string();
    write_file(measured, uff_text(contents, "test"));
    return eig_json({scene, "--count", "1", "--compare", measured})["comparison"]["unclear"];
  };
  const auto one = compared_with({there[0]});
  ASSERT_EQ(one.size(), 1u);
  EXPECT_EQ(one[0]["node"], there[0]);
  EXPECT_EQ(one[0]["bodies"].size(), 2u);
  EXPECT_EQ(compared_with(there).size(), 0u);
}

TEST(ShapeFiles, RefusesPlacesThatAreNotThoseOfTheScene) {
  const ProgramResult result =
      Program({"eig", scene_path("examples/reed.yaml"), "--compare", scene_path("examples/reed.uff")}).run();
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.err, AllOf(HasSubstr("node 1 of"), HasSubstr("away from every node of the bodies")));
}

}  // namespace
}  // namespace stridor::test
