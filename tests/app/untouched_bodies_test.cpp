// Bodies that nothing touches, as a user would run them: given by matrices, beams, lumped masses.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <complex>
#include <fstream>
#include <functional>
#include <numbers>
#include <string>
#include <vector>

#include "io/run_file/run_file.hpp"
#include "substructures/bodies/annular_plate.hpp"
#include "tests/app/resume_fixture.hpp"
#include "tests/support/eigenvalue_program.hpp"
#include "tests/support/program.hpp"
#include "tests/support/temporary_folder.hpp"

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

/// A scene of a chain of equal masses and springs in a folder, as Matrix Market files.
std::string chain_scene(const TemporaryFolder& folder, int n) {
  for (const std::string name : {"M", "K"}) {
    const bool is_mass = name == "M";
    std::ofstream file((folder / (name + ".mtx")).string());
    file << "%%MatrixMarket matrix coordinate real symmetric\n"
         << n << ' ' << n << ' ' << (is_mass ? n : 2 * n - 1) << '\n';
    for (int i = 1; i <= n; ++i) file << i << ' ' << i << (is_mass ? " 1\n" : " 2\n");
    for (int i = 1; i < n && !is_mass; ++i) file << i + 1 << ' ' << i << " -1\n";
  }
  const std::string path = (folder / "chain.yaml").string();
  std::ofstream(path) << "format: 2\nparameters: {load: 0}\nsubstructures:\n  chain: {type: "
                         "matrices, mass: M.mtx, stiffness: K.mtx, terms: [{role: position, matrix: "
                         "K.mtx, factor: =0*load}]}\n";
  return path;
}

TEST(UntouchedBodies, LargeMatricesAreCountedInTheirWindow) {
  const TemporaryFolder folder;
  constexpr int n = 1200;
  const std::string scene = chain_scene(folder, n);
  const double pi = std::acos(-1.0);
  const auto omega = [&](int k) { return 2.0 * std::sin(0.5 * k * pi / (n + 1)); };
  const Json all =
      json_of({"eig", scene, "--below", std::to_string(0.5 * (omega(6) + omega(7)) / (2.0 * pi))});
  EXPECT_EQ(all["method"], "sparse");
  EXPECT_EQ(all["counted"], 12);
  ASSERT_EQ(all["eigenvalues"].size(), 6U);
  for (int k = 1; k <= 6; ++k) {
    const auto i = static_cast<std::size_t>(k - 1);
    EXPECT_NEAR(all["eigenvalues"][i][1].get<double>(), omega(k), 1e-9 * omega(k));
    EXPECT_LT(all["backward_errors"][i].get<double>(), 1e-8);
  }
  EXPECT_TRUE(all["stable"]);
  const Json lowest = json_of({"eig", scene, "--count", "4", "--explain", "--mode", "2"});
  ASSERT_EQ(lowest["eigenvalues"].size(), 4U);
  EXPECT_NEAR(lowest["window"][1].get<double>(), omega(4) / (2.0 * pi), 1e-9);
  EXPECT_NEAR(lowest["explanation"]["quotients"]["stiffness"].get<double>(), omega(2) * omega(2),
              1e-9 * omega(2) * omega(2));
  EXPECT_NEAR(lowest["explanation"]["frictionless_modes"][0]["share"].get<double>(), 1.0, 1e-9);
  const Json locus = json_of({"locus", scene, "--parameter", "parameters.load", "--from",
                              "0", "--to", "1", "--points", "2", "--count", "4"});
  EXPECT_EQ(locus["eigenvalues"][1], lowest["eigenvalues"]);
  EXPECT_EQ(locus["method"], "sparse");
  EXPECT_TRUE(locus["unstable"].empty());
  const ProgramResult too_many = Program({"eig", scene, "--below", "1 kHz"}).run();
  EXPECT_EQ(too_many.exit_code, 3);
  EXPECT_THAT(too_many.err, HasSubstr("ask for fewer eigenvalues or a lower frequency"));
}

/// One entry in every row: its column and its value.
using RowEntry = std::function<std::pair<int, double>(int row)>;

/// 505 oscillators of two coordinates, in a folder.
class ManyOscillators {
 public:
  static constexpr int size = 1010;

  ManyOscillators() {
    write("M", [](int i) { return std::pair(i, 1.0); });
  }

  void write(const std::string& name, const RowEntry& entry) const {
    std::ofstream file((folder_ / (name + ".mtx")).string());
    file << "%%MatrixMarket matrix coordinate real general\n"
         << size << ' ' << size << ' ' << size << '\n';
    for (int i = 0; i < size; ++i) {
      const auto [column, value] = entry(i);
      file << i + 1 << ' ' << column + 1 << ' ' << value << '\n';
    }
  }
  /// The other coordinate of an oscillator, with the sign of a skew matrix.
  static std::pair<int, double> across(int row, double value) {
    return row % 2 == 0 ? std::pair(row + 1, value) : std::pair(row - 1, -value);
  }
  std::string scene(const std::string& matrices) const {
    const std::string path = (folder_ / "pairs.yaml").string();
    std::ofstream(path) << "format: 2\nparameters: {load: 0, d: 1}\nsubstructures:\n  pairs: "
                           "{type: matrices, mass: M.mtx, "
                        << matrices << "}\n";
    return path;
  }

 private:
  TemporaryFolder folder_;
};

TEST(UntouchedBodies, LargeMatricesHaveLociAndThresholds) {
  // With stiffness i diag(1, 1.4) and damping 0.1, each under the circulatory load: the first one
  // flutters from 0.2280350850 on, the second one from beyond 0.4.
  const ManyOscillators oscillators;
  oscillators.write("D", [](int i) { return std::pair(i, 0.1); });
  oscillators.write("K",
                    [](int i) { return std::pair(i, (i / 2 + 1) * (i % 2 == 0 ? 1.0 : 1.4)); });
  oscillators.write("N", [](int i) { return ManyOscillators::across(i, 1.0); });
  const std::string scene = oscillators.scene(
      "damping: D.mtx, stiffness: K.mtx, terms: [{role: circulatory, matrix: N.mtx, factor: "
      "=load}]");
  const std::vector<std::string> range{
      "--parameter", "parameters.load", "--from", "0",       "--to",
      "0.35",        "--points",        "3",      "--below", "0.3"};
  std::vector<std::string> arguments{"threshold", scene};
  arguments.insert(arguments.end(), range.begin(), range.end());
  const Json threshold = json_of(arguments);
  ASSERT_EQ(threshold["roots"].size(), 1U);
  EXPECT_NEAR(threshold["roots"][0]["value"].get<double>(), 0.2280350850, 1e-8);
  EXPECT_EQ(threshold["method"], "sparse");
  EXPECT_EQ(threshold["window"][1], 0.3);
  arguments[0] = "locus";
  const Json locus = json_of(arguments);
  ASSERT_EQ(locus["unstable"].size(), 1U);
  EXPECT_NEAR(locus["unstable"][0]["from"].get<double>(), 0.2280350850, 1e-8);
  EXPECT_EQ(locus["unstable"][0]["to"], 0.35);
  // At 0.35: s = −0.05 ± sqrt(...) of s² + 0.1 s + 1.2 ± i sqrt(0.35² − 0.2²) = 0.
  const std::complex<double> root =
      -0.05 + std::sqrt(std::complex<double>(0.0025 - 1.2, -std::sqrt(0.35 * 0.35 - 0.04)));
  double largest = -1e300;
  for (const Json& s : locus["eigenvalues"][2]) largest = std::max(largest, s[0].get<double>());
  EXPECT_NEAR(largest, root.real(), 1e-9);
}

TEST(UntouchedBodies, WindowsOfLargeMatricesAreFoundBetweenTheValues) {
  // The load softens one spring of the first oscillator, which is under a circulatory force 0.02:
  // its two frequencies pass each other, and near 0.4 they do not keep apart. With damping d = 0.01
  // they flutter where (0.4 - p)²/4 < 0.02² - d² (2.4 - p)/2.
  const ManyOscillators oscillators;
  oscillators.write("D", [](int i) { return std::pair(i, 0.01); });
  oscillators.write("K",
                    [](int i) { return std::pair(i, (i / 2 + 1) * (i % 2 == 0 ? 1.0 : 1.4)); });
  oscillators.write("N", [](int i) { return ManyOscillators::across(i, 0.02); });
  oscillators.write("L", [](int i) { return std::pair(i, i == 1 ? -1.0 : 0.0); });
  const std::string scene = oscillators.scene(
      "damping: D.mtx, stiffness: K.mtx, circulatory: N.mtx, terms: [{role: stiffness, matrix: "
      "L.mtx, factor: =load}]");
  const Json locus = json_of({"locus", scene, "--parameter", "parameters.load", "--from", "0",
                              "--to", "1", "--points", "3", "--below", "0.25"});
  ASSERT_EQ(locus["eigenvalues"].size(), 3U);
  ASSERT_EQ(locus["unstable"].size(), 1U);
  const double half = std::sqrt(1e-8 + 12e-4);
  EXPECT_NEAR(locus["unstable"][0]["from"].get<double>(), 0.4001 - half, 1e-8);
  EXPECT_NEAR(locus["unstable"][0]["to"].get<double>(), 0.4001 + half, 1e-8);
}

TEST(UntouchedBodies, NarrowWindowsOfLargeMatricesAreFound) {
  // The same without damping under a circulatory force 1e-4: flutter within 2e-4 of 0.4237,
  // where nothing grows or decays elsewhere.
  const ManyOscillators oscillators;
  oscillators.write("K",
                    [](int i) { return std::pair(i, (i / 2 + 1) * (i % 2 == 0 ? 1.0 : 1.4237)); });
  oscillators.write("N", [](int i) { return ManyOscillators::across(i, 1e-4); });
  oscillators.write("L", [](int i) { return std::pair(i, i == 1 ? -1.0 : 0.0); });
  const std::string scene = oscillators.scene(
      "stiffness: K.mtx, circulatory: N.mtx, terms: [{role: stiffness, matrix: L.mtx, factor: "
      "=load}]");
  const Json threshold = json_of({"threshold", scene, "--parameter", "parameters.load", "--from",
                                  "0", "--to", "1", "--points", "6", "--below", "0.25"});
  ASSERT_EQ(threshold["roots"].size(), 2U);
  EXPECT_NEAR(threshold["roots"][0]["value"].get<double>(), 0.4237 - 2e-4, 1e-8);
  EXPECT_NEAR(threshold["roots"][1]["value"].get<double>(), 0.4237 + 2e-4, 1e-8);
  EXPECT_EQ(threshold["unresolved"], 0.0);
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

TEST(UntouchedBodies, LargeMatricesHaveMaps) {
  const ManyOscillators oscillators;
  oscillators.write("D", [](int i) { return std::pair(i, 1.0); });
  oscillators.write("K",
                    [](int i) { return std::pair(i, (i / 2 + 1) * (i % 2 == 0 ? 1.0 : 1.4)); });
  oscillators.write("N", [](int i) { return ManyOscillators::across(i, 1.0); });
  const std::string scene = oscillators.scene(
      "stiffness: K.mtx, terms: [{role: damping, matrix: D.mtx, factor: =d}, "
      "{role: circulatory, matrix: N.mtx, factor: =load}]");
  const Json map = json_of({"map", scene, "--x", "parameters.load", "0.1", "0.3", "2", "--y",
                            "parameters.d", "0.1", "0.2", "2", "--below", "0.25"});
  const auto stable = [&](std::size_t row, std::size_t column) {
    return map["growth"][row][column].get<double>() <= 0.0;
  };
  // 0.04 + 1.2 d² is 0.052 and 0.088.
  EXPECT_TRUE(stable(0, 0));
  EXPECT_FALSE(stable(0, 1));
  EXPECT_TRUE(stable(1, 0));
  EXPECT_FALSE(stable(1, 1));
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

/// A scene of one folder.
std::string scene_of(const TemporaryFolder& folder, const std::string& text) {
  const std::string path = (folder / "scene.yaml").string();
  std::ofstream(path) << "format: 2\n" << text;
  return path;
}

const char* const flutter_body =
    "  oscillator: {type: matrices, mass: [[1, 0], [0, 1]], stiffness: [[1, 0], [0, 1.4]], "
    "terms: [{role: circulatory, matrix: [[0, 1], [-1, 0]], factor: 0.3}], points: {a: {at: [0, "
    "0], x: 1, y: 2}}}\n";
const char* const beam_body =
    "  ruler: {type: beam, length: 0.3, thickness: 2 mm, width: 20 mm, angle: 0, material: "
    "{youngs_modulus: 210 GPa, poissons_ratio: 0.3, density: 7850}, mesh: {along: 20, through: 1}, "
    "supports: {start: clamped}, damping: {alpha: 1, beta: 0}, reduction: "
    "{fixed_interface_modes: 6}}\n";
const char* const weight_body =
    "  weight: {type: lumped, masses: {m: {mass: 2}}, springs: {s: {at: m, direction: 90 deg, "
    "stiffness: 800, damping: 4}}}\n";

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

/// The fluttering pair with the sections of a run.
std::string free_vibration(const std::string& more = "") {
  return "substructures:\n" + std::string(flutter_body) +
         "initial: {state: rest, velocity: [{at: oscillator.a, x: 1e-3, y: 0}]}\n"
         "time: {integrator: exact, step: 0.01, end: 200}\n"
         "record: {interval: 0.01, channels: [oscillator.a.x.displacement]}\n" +
         more;
}

TEST(UntouchedBodies, RunAsTheirEigenvaluesSay) {
  const TemporaryFolder folder;
  const std::string scene = scene_of(folder, free_vibration());
  const std::string file = (folder / "run.h5").string();
  const Json run = json_of({"run", scene, "-o", file});
  EXPECT_EQ(run["status"], "done");
  const RunFileReader reader(file);
  const std::vector<double> time = reader.times(),
                            x = reader.series("/channels/oscillator.a.x.displacement");
  const Json eig = json_of({"eig", scene});
  const double growth = growth_of(eig).largest;
  // The largest displacements of the last periods and of as many before them.
  const double span = 3.0 * 2.0 * std::numbers::pi / eig["eigenvalues"][1][1].get<double>();
  const auto largest = [&](double from, double to) {
    double most = 0.0;
    for (std::size_t i = 0; i < time.size(); ++i)
      if (time[i] >= from && time[i] < to) most = std::max(most, std::abs(x[i]));
    return most;
  };
  const double ratio = largest(200.0 - span, 200.0) / largest(200.0 - 2.0 * span, 200.0 - span);
  EXPECT_NEAR(std::log(ratio) / span, growth, 1e-4 * growth);  // a sample misses the peak by 1e-5
}

TEST(UntouchedBodies, ResumeBitIdentically) {
  const TemporaryFolder folder;
  const std::string scene = scene_of(folder, free_vibration());
  const std::string whole = (folder / "whole.h5").string();
  const std::string broken = (folder / "broken.h5").string();
  ASSERT_EQ(Program({"run", scene, "-o", whole, "--set", "time.step=1e-5"}).run().exit_code, 0);
  ASSERT_EQ(Program({"run", scene, "-o", broken, "--set", "time.step=1e-5", "--max-wall", "0.001"})
                .run()
                .exit_code,
            5);
  ASSERT_EQ(Program({"run", "--resume", broken}).run().exit_code, 0);
  EXPECT_EQ(difference(whole, broken), "");
}

TEST(UntouchedBodies, KeepTheirEnergy) {
  const TemporaryFolder folder;
  const std::string scene = scene_of(
      folder, "substructures:\n" + std::string(weight_body) +
                  "initial: {state: rest, displacement: [{at: weight.m, x: 0, y: 1 mm}]}\n"
                  "time: {integrator: central_difference, step: 1.0e-4, end: 1}\n"
                  "record: {interval: 1.0e-3, channels: [weight.m.y.displacement], energy: true}\n"
                  "measure: {from: 0.1}\n");
  const std::string file = (folder / "run.h5").string();
  const Json run = json_of({"run", scene, "-o", file});
  EXPECT_LT(run["energy_error"].get<double>(), 1e-9);
  const RunFileReader reader(file);
  const std::vector<double> time = reader.times(),
                            y = reader.series("/channels/weight.m.y.displacement");
  const double omega = std::sqrt(399.0);
  for (std::size_t i = 0; i < time.size(); i += 50) {
    const double t = time[i];
    const double exact = 1e-3 * std::exp(-t) * (std::cos(omega * t) + std::sin(omega * t) / omega);
    EXPECT_NEAR(y[i], exact, 2e-3 * 1e-3) << t;  // second order in the step, ω h = 2e-3
  }
  const Json error =
      json_of({"run", scene, "-o", file, "--force", "--error", "--set", "record.energy=false",
               "--set", "record.channels=[weight.m.y.acceleration]"});
  EXPECT_LT(error["error"]["acceleration"].get<double>(), 1e-2);
}

/// A plate that may spin, with a point at rest in space.
std::string plate_text(const std::string& more) {
  return "substructures:\n  disc:\n    type: annular_plate\n    inner_radius: 80 mm\n"
         "    outer_radius: 160 mm\n    thickness: 12 mm\n"
         "    material: {youngs_modulus: 210 GPa, poissons_ratio: 0.3, density: 7850}\n"
         "    nodal_diameters: 3\n    spin: 100\n"
         "    points: {rim: {radius: 150 mm, angle: 0.4}}\n" +
         more;
}

AnnularPlateParameters plate_keys() {
  AnnularPlateParameters plate;
  plate.inner_radius = 0.08;
  plate.outer_radius = 0.16;
  plate.thickness = 0.012;
  plate.material = {2.1e11, 0.3, 7850.0};
  plate.nodal_diameters = 3;
  return plate;
}

TEST(UntouchedBodies, APlateThatSpinsHasWavesThatTurnWithIt) {
  const TemporaryFolder folder;
  const std::string scene = scene_of(folder, plate_text("    damping: {beta: 1.0e-7}\n"));
  const Json eig = json_of({"eig", scene, "--explain", "--mode", "2"});
  EXPECT_TRUE(eig["stable"]);
  std::vector<double> expected, found;
  const AnnularPlate plate(plate_keys());
  for (Eigen::Index i = 0; i < plate.size(); ++i) {
    const auto n = static_cast<double>((i + 1) / 2);
    // s₀ ± i n Ω with s₀² + β ω² s₀ + ω² = 0.
    const double square = plate.omega()(i) * plate.omega()(i);
    const double decay = 0.5e-7 * square;
    expected.push_back(std::sqrt(square - decay * decay) + (i % 2 == 0 ? n : -n) * 100.0);
  }
  for (const Json& s : eig["eigenvalues"]) found.push_back(s[1]);
  std::sort(expected.begin(), expected.end());
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t i = 0; i < found.size(); ++i)
    EXPECT_NEAR(found[i], expected[i], 1e-9 * expected[i]) << i;
  EXPECT_LT(eig["explanation"]["growth"].get<double>(), 0.0);
  const Json locus = json_of({"locus", scene, "--parameter", "substructures.disc.spin", "--from",
                              "0", "--to", "100", "--points", "3"});
  EXPECT_TRUE(locus["unstable"].empty());
  std::vector<double> last;
  for (const Json& s : locus["eigenvalues"].back()) last.push_back(s[1]);
  std::sort(last.begin(), last.end());
  ASSERT_EQ(last.size(), found.size());
  for (std::size_t i = 0; i < found.size(); ++i) EXPECT_NEAR(last[i], found[i], 1e-8 * found[i]);
  // Without the terms of its rotation it stands still.
  const Json still = json_of({"eig", scene, "--set",
                              "terms=[friction, friction_damping, geometric, structural_damping]"});
  EXPECT_NEAR(still["eigenvalues"][1][1].get<double>(), still["eigenvalues"][2][1].get<double>(),
              1e-6);
  EXPECT_GT(json_of({"eig", scene, "--shapes", (folder / "plate").string()})["files"].size(), 1U);
}

/// Displacement of the rim at a time after it was drawn out and let go. With z = q_c + i q_s of n
/// nodal diameters z̈ − 2i n Ω ż + (ω² − n² Ω²) z = 0.
double released_rim(double time, double spin, double drawn) {
  const AnnularPlate plate(plate_keys());
  const Eigen::VectorXd row = plate.rows(0.15, 0.4).w;
  Eigen::VectorXd shape(row.size());
  for (Eigen::Index i = 0; i < row.size(); ++i) {
    const double turn = static_cast<double>((i + 1) / 2) * spin;
    shape(i) = row(i) / (plate.omega()(i) * plate.omega()(i) - turn * turn);
  }
  shape *= drawn / row.dot(shape);
  double sum = 0.0;
  for (Eigen::Index i = 0; i < row.size(); i += i == 0 ? 1 : 2) {
    const double omega = plate.omega()(i);
    const double turn = static_cast<double>((i + 1) / 2) * spin;
    const std::complex<double> z0(shape(i), i == 0 ? 0.0 : shape(i + 1));
    const std::complex<double> forward = std::polar(0.5 * (omega - turn) / omega, omega * time);
    const std::complex<double> backward = std::polar(0.5 * (omega + turn) / omega, -omega * time);
    const std::complex<double> z = z0 * std::polar(1.0, turn * time) * (forward + backward);
    sum += row(i) * z.real() + (i == 0 ? 0.0 : row(i + 1) * z.imag());
  }
  return sum;
}

TEST(UntouchedBodies, APlateThatSpinsRunsAsItsWavesSay) {
  const TemporaryFolder folder;
  const std::string scene =
      scene_of(folder, plate_text("initial: {displacement: [{at: disc.rim, y: 10 um}]}\n"
                                  "time: {integrator: exact, step: 1.0e-6, end: 0.02}\n"
                                  "record: {interval: 1.0e-5, channels: "
                                  "[disc.rim.y.displacement]}\n"));
  const std::string file = (folder / "run.h5").string();
  EXPECT_EQ(json_of({"run", scene, "-o", file})["status"], "done");
  const RunFileReader reader(file);
  const std::vector<double> time = reader.times(),
                            y = reader.series("/channels/disc.rim.y.displacement");
  for (std::size_t i = 100; i + 100 < time.size(); i += 50) {
    // The low-pass of the record leaves waves up to 0.4 of its rate alone to 1e-3.
    EXPECT_NEAR(y[i], released_rim(time[i], 100.0, 1e-5), 2e-3 * 1e-5) << time[i];
  }
  // The ledger is that of central differences, which take no gyroscopic terms.
  const Json still = json_of({"run", scene, "-o", file, "--force", "--set",
                              "substructures.disc.spin=0", "--set",
                              "time.integrator=central_difference", "--set", "record.energy=true"});
  EXPECT_LT(still["energy_error"].get<double>(), 1e-9);
  const ProgramResult across =
      Program({"run", scene, "-o", file, "--force", "--set",
               "record.channels=[disc.rim.z.displacement]"})
          .run();
  EXPECT_EQ(across.exit_code, 2);
  EXPECT_THAT(across.err, HasSubstr("'disc' does not move along z"));
  const ProgramResult without = Program({"run", scene, "-o", file, "--force", "--set",
                                         "terms=[friction, geometric]"})
                                    .run();
  EXPECT_EQ(without.exit_code, 2);
  EXPECT_THAT(without.err, HasSubstr("must not leave out gyroscopic, friction or geometric"));
}

TEST(UntouchedBodies, AMassMovesInSpace) {
  const TemporaryFolder folder;
  const std::string scene = scene_of(
      folder,
      "substructures:\n  weight: {type: lumped, directions: [x, y, z], masses: {m: {mass: 2}}, "
      "springs: {s: {at: m, stiffness: {xx: 300, yy: 500, zz: 800, zx: 100}}}}\n"
      "initial: {displacement: [{at: weight.m, z: 1 mm}]}\n"
      "time: {integrator: exact, step: 1.0e-3, end: 1}\n"
      "record: {interval: 1.0e-2, channels: [weight.m.x.displacement, weight.m.z.displacement]}\n");
  const std::string file = (folder / "run.h5").string();
  ASSERT_EQ(json_of({"run", scene, "-o", file})["status"], "done");
  // Least energy at z = 1 mm: x = −zx/xx z. Then the modes of [[300, 100], [100, 800]]/2.
  Eigen::Matrix2d K;
  K << 150.0, 50.0, 50.0, 400.0;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> modes(K);
  const Eigen::Vector2d start(-1e-3 / 3.0, 1e-3);
  const RunFileReader reader(file);
  const std::vector<double> time = reader.times(),
                            x = reader.series("/channels/weight.m.x.displacement"),
                            z = reader.series("/channels/weight.m.z.displacement");
  for (std::size_t i = 10; i + 10 < time.size(); i += 5) {
    Eigen::Vector2d u = modes.eigenvectors().transpose() * start;
    for (Eigen::Index k = 0; k < 2; ++k)
      u(k) *= std::cos(std::sqrt(modes.eigenvalues()(k)) * time[i]);
    u = (modes.eigenvectors() * u).eval();
    EXPECT_NEAR(x[i], u(0), 2e-6) << time[i];
    EXPECT_NEAR(z[i], u(1), 2e-6) << time[i];
  }
}

TEST(UntouchedBodies, AreSweptAndStudied) {
  const TemporaryFolder folder;
  const std::string text = "substructures:\n" + std::string(weight_body) +
                           "initial: {state: rest, velocity: [{at: weight.m, x: 0, y: 1}]}\n"
                           "time: {integrator: exact, step: 1.0e-4, end: 1}\n"
                           "record: {interval: 1.0e-3, channels: [weight.m.y.acceleration]}\n"
                           "measure: {from: 0.1, band: [1 Hz, 100 Hz]}\n";
  const std::string scene = scene_of(folder, text);
  const Json sweep = json_of({"sweep", scene, "--parameter", "substructures.weight.masses.m.mass",
                              "--from", "1", "--to", "4", "--points", "3"});
  ASSERT_EQ(sweep["rows"].size(), 3U);
  double before = 1e300;
  for (const Json& row : sweep["rows"]) {
    EXPECT_EQ(row["status"], "done");
    const double peak = row["free_end_acceleration"]["peak"].get<double>();
    EXPECT_LT(peak, before);  // ω v falls with the mass
    before = peak;
  }
  const Json study = json_of({"precision", scene, "--points", "2", "--assumptions", "subs_b"});
  EXPECT_GT(study["rows"].size(), 2U);
}

TEST(UntouchedBodies, LargeOnesStandBesideOthersAndAreNotRun) {
  const TemporaryFolder folder;
  const std::string chain = chain_scene(folder, 1200);
  const std::string scene = scene_of(
      folder,
      "substructures:\n  chain: {type: matrices, mass: M.mtx, stiffness: K.mtx}\n"
      "  weight: {type: lumped, masses: {m: {mass: 2}}, springs: {x: {at: m, direction: 0, "
      "stiffness: 800}, y: {at: m, direction: 90 deg, stiffness: 2.0e-5}}}\n");
  const double pi = std::numbers::pi;
  const Json eig = json_of({"eig", scene, "--below", "0.004"});
  EXPECT_EQ(eig["method"], "sparse");
  // ω = 2 sin(k π/2402) < 0.0251: nine of them, and sqrt(1e-5) of the weight.
  ASSERT_EQ(eig["eigenvalues"].size(), 10U);
  EXPECT_NEAR(eig["eigenvalues"][0][1].get<double>(), 2.0 * std::sin(pi / 2402.0), 1e-12);
  EXPECT_NEAR(eig["eigenvalues"][1][1].get<double>(), std::sqrt(1e-5), 1e-12);
  EXPECT_NEAR(eig["eigenvalues"][9][1].get<double>(), 2.0 * std::sin(9.0 * pi / 2402.0), 1e-12);
  const std::vector<std::string> time{"--set", "time={integrator: exact, step: 1e-3, end: 1}"};
  for (const std::string verb : {"run", "check"}) {
    std::vector<std::string> command{verb, scene};
    if (verb == "run") command.insert(command.end(), {"-o", (folder / "x.h5").string()});
    command.insert(command.end(), time.begin(), time.end());
    const ProgramResult result = Program(command).run();
    EXPECT_EQ(result.exit_code, 2);
    EXPECT_THAT(result.err, HasSubstr("substructures.chain.reduction: missing: the bodies have "
                                      "1202 unknowns, too many to keep them all in a run"));
  }
  EXPECT_EQ(Program({"check", scene}).run().exit_code, 0);
  const ProgramResult shapes = Program({"eig", chain, "--count", "2", "--shapes", "x"}).run();
  EXPECT_EQ(shapes.exit_code, 2);
  EXPECT_THAT(shapes.err, HasSubstr("--shapes"));
}

}  // namespace
}  // namespace stridor
