// Bodies that nothing touches, of so many unknowns that only a window of eigenvalues is found.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <fstream>
#include <functional>
#include <numbers>
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
  std::ofstream(path)
      << "format: 2\nparameters: {load: 0}\nsubstructures:\n  chain: {type: "
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
  const Json locus = json_of({"locus", scene, "--parameter", "parameters.load", "--from", "0",
                              "--to", "1", "--points", "2", "--count", "4"});
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
