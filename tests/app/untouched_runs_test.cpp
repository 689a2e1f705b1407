// Motion of bodies that nothing touches, and of plates that spin.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <string>
#include <vector>

#include "io/run_file/run_file.hpp"
#include "substructures/bodies/annular_plate.hpp"
#include "tests/app/resume_fixture.hpp"
#include "tests/support/eigenvalue_program.hpp"
#include "tests/support/program.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/support/untouched_bodies.hpp"

namespace stridor {
namespace {

using namespace test;
using ::testing::HasSubstr;

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
  const Json still = json_of(
      {"eig", scene, "--set", "terms=[friction, friction_damping, geometric, structural_damping]"});
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
  const Json still =
      json_of({"run", scene, "-o", file, "--force", "--set", "substructures.disc.spin=0", "--set",
               "time.integrator=central_difference", "--set", "record.energy=true"});
  EXPECT_LT(still["energy_error"].get<double>(), 1e-9);
  const ProgramResult across = Program({"run", scene, "-o", file, "--force", "--set",
                                        "record.channels=[disc.rim.z.displacement]"})
                                   .run();
  EXPECT_EQ(across.exit_code, 2);
  EXPECT_THAT(across.err, HasSubstr("'disc' does not move along z"));
  const ProgramResult without =
      Program({"run", scene, "-o", file, "--force", "--set", "terms=[friction, geometric]"}).run();
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

}  // namespace
}  // namespace stridor
