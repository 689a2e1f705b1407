// Discs with pads, as a user would run them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "io/run_file/run_file.hpp"
#include "tests/support/annulus_mesh.hpp"
#include "tests/support/eigenvalue_program.hpp"
#include "tests/support/program.hpp"
#include "tests/support/temporary_folder.hpp"

namespace stridor {
namespace {

using namespace test;
using ::testing::HasSubstr;

const std::string brake = scene_path("disc_and_pads.yaml");
const std::string friction = "parameters.mu";
const std::string spin = "substructures.disc.spin";

TEST(DiscProgram, EveryModellingStepIsARunOfOneScene) {
  const std::string all = "gyroscopic, friction, friction_damping, geometric";
  const auto run = [](const std::string& terms) {
    return json_of({"eig", brake, "--set", "terms=[" + terms + "]"});
  };
  for (const std::string terms : {"", "gyroscopic"}) {
    const Json eig = run(terms);
    EXPECT_EQ(growth_of(eig).num_unstable, 0) << terms;
    EXPECT_TRUE(eig["stable"]) << terms;
    EXPECT_EQ(eig["eigenvalues"].size(), 17U);
  }
  const Json circulatory = run("gyroscopic, friction");
  EXPECT_EQ(growth_of(circulatory).num_unstable, 8);
  EXPECT_NEAR(growth_of(circulatory).largest, 4.649547, 1e-6);
  EXPECT_FALSE(circulatory["stable"]);
  EXPECT_EQ(growth_of(run(all)).num_unstable, 4);
  EXPECT_NEAR(growth_of(run(all)).largest, 2.165453, 1e-6);
  const Json damped = json_of({"eig", brake});
  EXPECT_NEAR(growth_of(damped).largest, -4.590691, 1e-6);
  EXPECT_TRUE(damped["stable"]);
  EXPECT_NEAR(damped["window"][1].get<double>(), 7494.83, 0.01);
  EXPECT_NEAR(damped["equilibrium"]["contacts"]["upper"]["force"].get<double>(), 3000.0, 3e-9);
  EXPECT_NEAR(growth_of(json_of({"eig", brake, "--set",
                                 "substructures.disc.damping.beta=1e-6", "--set",
                                 "substructures.upper.damping.beta=1e-6", "--set",
                                 "substructures.lower.damping.beta=1e-6"}))
                  .largest,
              -46.177, 5e-4);
}

/// A disc with rounded pads, one on each face, as a plate and as a body of bricks about y. The pads are masses on
/// springs that join circumference and axis.
std::string plate_and_pads() {
  return R"(format: 2
substructures:
  disc: {type: annular_plate, inner_radius: 80 mm, outer_radius: 160 mm, thickness: 6 mm,
         material: {youngs_modulus: 210 GPa, poissons_ratio: 0.3, density: 7850}, nodal_diameters: 8, radial_modes: 3,
         radial_terms: 10, spin: 30, damping: {beta: 1.0e-7}}
  upper: &pad
    type: lumped
    directions: [x, y, z]
    masses: {block: {mass: 0.25}}
    springs: {backing: {at: block, stiffness: {xx: 4.0e+7, yy: 1.0e+8, zz: 6.0e+7, xy: 2.0e+7}}}
    damping: {beta: 1.0e-7}
  lower: *pad
contacts:
  upper: {slave: upper.block, master: disc.top, assumption: film, start: {radius: 120 mm},
                   normal: {law: penalty, stiffness: 2.0e+8}, friction: {coefficient: 0.4}}
  lower: {slave: lower.block, master: disc.bottom, assumption: film, start: {radius: 120 mm},
          normal: {law: penalty, stiffness: 2.0e+8}, friction: {coefficient: 0.4}}
drive: {load: -3000, load_on: [upper.block, lower.block], ramp: 0}
)";
}

std::string bricks_and_pads() {
  return R"(format: 2
substructures:
  disc:
    type: mesh
    file: disc.inp
    material: {youngs_modulus: 210 GPa, poissons_ratio: 0.3, density: 7850}
    surfaces:
      bore: {cylinder: {axis: [0, 1, 0], radius: 80 mm}}
      top: {box: {lowest: [0.105, 0.0029, -0.02], highest: [0.145, 0.0031, 0.02]}}
      bottom: {box: {lowest: [0.105, -0.0031, -0.02], highest: [0.145, -0.0029, 0.02]}}
    supports: {hub: {on: bore}}
    spin: {speed: 30, about: {direction: [0, 1, 0]}, centrifugal: false}
    damping: {alpha: 0, beta: 1.0e-7}
    reduction: {fixed_interface_modes: 40}
  upper:
    type: lumped
    directions: [x, y, z]
    masses: {block: {mass: 0.25}}
    springs: {backing: {at: block, stiffness: {xx: 6.0e+7, yy: 1.0e+8, zz: 4.0e+7, yz: -2.0e+7}}}
    damping: {beta: 1.0e-7}
  lower:
    type: lumped
    directions: [x, y, z]
    masses: {block: {mass: 0.25}}
    springs: {backing: {at: block, stiffness: {xx: 6.0e+7, yy: 1.0e+8, zz: 4.0e+7, yz: 2.0e+7}}}
    damping: {beta: 1.0e-7}
contacts:
  upper: {slave: upper.block, master: disc.top, assumption: film, start: {at: [0.12, 0.003, 0]},
          normal: {law: penalty, stiffness: 2.0e+8}, friction: {coefficient: 0.4}}
  lower: {slave: lower.block, master: disc.bottom, assumption: film, start: {at: [0.12, -0.003, 0]},
          normal: {law: penalty, stiffness: 2.0e+8}, friction: {coefficient: 0.4}}
drives:
  above: {load: -3000, load_on: [upper.block], ramp: 0}
  below: {load: 3000, load_on: [lower.block], ramp: 0}
)";
}

/// A mesh about y, as a file of Abaqus.
void write_bricks(const std::filesystem::path& path) {
  const Mesh mesh = annulus_mesh({0.08, 0.16, 0.006, {4, 48, 2}}, ElementShape::hex20);
  std::ofstream file(path);
  file.precision(12);
  file << "*NODE\n";
  for (Eigen::Index node = 0; node < mesh.nodes.rows(); ++node)
    file << node + 1 << ", " << mesh.nodes(node, 0) << ", " << mesh.nodes(node, 2) << ", "
         << -mesh.nodes(node, 1) << '\n';
  file << "*ELEMENT, TYPE=C3D20\n";
  for (std::size_t element = 0; element < mesh.num_elements(); ++element) {
    file << element + 1;
    int count = 0;
    for (const int node : mesh.nodes_of(element)) file << (++count == 16 ? ",\n" : ", ") << node + 1;
    file << '\n';
  }
}

TEST(DiscProgram, ADiscOfBricksBetweenPadsHasTheEigenvaluesOfAPlate) {
  const TemporaryFolder folder;
  write_bricks(folder.path() / "disc.inp");
  std::ofstream(folder.path() / "plate.yaml") << plate_and_pads();
  std::ofstream(folder.path() / "bricks.yaml") << bricks_and_pads();
  const auto vibrations = [&](const char* scene) {
    std::vector<std::pair<double, double>> found;  // rad/s, 1/s
    const Json eig = json_of({"eig", (folder.path() / scene).string(), "--count", "8"});
    for (const Json& one : eig["eigenvalues"])
      if (one[1].get<double>() > 0.0)
        found.emplace_back(one[1].get<double>(), one[0].get<double>());
    return found;
  };
  const auto plate = vibrations("plate.yaml");
  const auto bricks = vibrations("bricks.yaml");
  ASSERT_EQ(plate.size(), 8U);
  ASSERT_EQ(bricks.size(), 8U);
  // Shear, and bricks that give way below a point, are not in the plate. The waves of a pair decay differently
  // by a factor of up to 15, with and against the rotation.
  for (std::size_t i = 0; i < 8; ++i) {
    EXPECT_NEAR(bricks[i].first, plate[i].first, 0.025 * plate[i].first) << i;
    EXPECT_NEAR(bricks[i].second, plate[i].second, 0.25 * std::abs(plate[i].second)) << i;
  }
}

TEST(DiscProgram, ThresholdsOfMultipliersAndPenalty) {
  const auto limit = [](std::vector<std::string> more) {
    std::vector<std::string> arguments{"threshold", brake,  "--parameter", friction,
                                       "--from",    "0.25", "--to",        "0.45",
                                       "--points",  "2",    "--set",       "terms=[friction]"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const Json roots = json_of(arguments)["roots"];
    EXPECT_EQ(roots.size(), 1U);
    return roots.empty() ? 0.0 : roots[0]["value"].get<double>();
  };
  // The dense eigenvalues of 0.3596654111 are on the axis, one of 0.35966541115 grows.
  EXPECT_NEAR(limit({}), 0.35966541114, 1e-10);
  EXPECT_NEAR(limit({"--set", "substructures.disc.spin=0"}), 0.35966541114, 1e-10);
  const std::string penalty = "normal={law: penalty, stiffness: 1e9, preload: 3000}";
  EXPECT_NEAR(limit({"--set", "contacts.upper." + penalty, "--set", "contacts.lower." + penalty}),
              0.3544503, 6e-8);
}

TEST(DiscProgram, ExplainsAModeByWhatItSees) {
  // Rotation alone is neither damped nor circulatory.
  const Json turning =
      json_of({"eig", brake, "--set", "terms=[gyroscopic]", "--explain", "--mode", "2"});
  const Json& gyroscopic = turning["explanation"]["quotients"];
  EXPECT_NEAR(gyroscopic["damping"].get<double>(), 0.0, 1e-9);
  EXPECT_NEAR(gyroscopic["circulatory"].get<double>(), 0.0,
              1e-12 * gyroscopic["stiffness"].get<double>());
  EXPECT_GT(std::abs(gyroscopic["gyroscopic"].get<double>()), 1e-3);  // not rounding

  const Json eig =
      json_of({"eig", brake, "--set", "terms=[gyroscopic, friction]", "--explain", "--mode", "1"});
  const Json& seen = eig["explanation"]["quotients"];
  // It grows, so the sufficient criterion cannot hold.
  EXPECT_GT(eig["explanation"]["growth"].get<double>(), 0.0);
  EXPECT_EQ(seen["suffices"], false);
  EXPECT_LT(seen["residual"].get<double>(), 1e-12);
  const double d = seen["damping"].get<double>();
  const double g = seen["gyroscopic"].get<double>();
  const double k = seen["stiffness"].get<double>();
  const double n = seen["circulatory"].get<double>();
  EXPECT_NEAR(seen["margin"].get<double>(), k * d * d + n * d * g - n * n,
              1e-9 * std::max(n * n, k * d * d));
  EXPECT_GT(eig["explanation"]["frictionless_modes"][0]["share"].get<double>(), 0.5);
  const ProgramResult text = Program({"eig", brake, "--explain"}).run();
  EXPECT_THAT(text.out, HasSubstr("stable between 0 and 7494.83 Hz"));
  EXPECT_THAT(text.out, HasSubstr("would suffice for decay"));
  EXPECT_THAT(text.out, HasSubstr("upper               at radius 0.13 m and 0 rad of disc.top, "
                                  "force 3000 N, friction 900 N, sliding at 1.3 m/s"));
}

TEST(DiscProgram, MapAgreesWithTheThreshold) {
  const Json map = json_of({"map", brake, "--set", "terms=[friction]", "--x", friction, "0.3",
                            "0.4", "3", "--y", spin, "1", "20", "2"});
  ASSERT_EQ(map["boundary"].size(), 1U);
  EXPECT_EQ(map["method"], "dense");
  for (const Json& point : map["boundary"][0])
    EXPECT_NEAR(point[0].get<double>(), 0.3596654112, 1e-9);
}

TEST(DiscProgram, LocusListsEigenvaluesAndWindows) {
  const Json locus = json_of({"locus", brake, "--set", "terms=[friction]", "--parameter", friction,
                              "--from", "0.3", "--to", "0.4", "--points", "2"});
  ASSERT_EQ(locus["eigenvalues"].size(), 2U);
  EXPECT_EQ(locus["eigenvalues"][0].size(), 17U);
  EXPECT_EQ(locus["method"], "dense");
  ASSERT_EQ(locus["unstable"].size(), 1U);
  EXPECT_NEAR(locus["unstable"][0]["from"].get<double>(), 0.35966541114, 1e-10);
}

TEST(DiscProgram, RefusesWhatItHasNot) {
  EXPECT_THAT(Program({"eig", brake, "--below", "3 m"}).run().err, HasSubstr("--below"));
  EXPECT_THAT(Program({"eig", brake, "--at", "1"}).run().err, HasSubstr("--at"));
  const ProgramResult unnamed = Program({"threshold", brake, "--from", "0", "--to", "1"}).run();
  EXPECT_EQ(unnamed.exit_code, 2);
  EXPECT_THAT(unnamed.err, HasSubstr("name a key: 'parameters.mu', "));
  EXPECT_EQ(Program({"check", brake}).run().exit_code, 0);
  EXPECT_EQ(Program({"check", brake, "--set", "terms=[x]"}).run().exit_code, 2);
}

TEST(DiscProgram, EveryVerbStatesItsWindow) {
  const std::vector<std::string> range{"--parameter", friction, "--from",   "0.3",
                                       "--to",        "0.4",    "--points", "2"};
  for (const std::string verb : {"locus", "threshold"}) {
    const auto window_of = [&](std::vector<std::string> more) {
      std::vector<std::string> arguments{verb, brake};
      arguments.insert(arguments.end(), range.begin(), range.end());
      arguments.insert(arguments.end(), more.begin(), more.end());
      return json_of(arguments)["window"][1].get<double>();
    };
    EXPECT_NEAR(window_of({}), 7494.83, 0.01) << verb;  // what the plate leaves out
    EXPECT_EQ(window_of({"--below", "2 kHz"}), 2000.0) << verb;
    EXPECT_LT(window_of({"--count", "3"}), 1700.0) << verb;  // the third of 17
  }
  EXPECT_NEAR(json_of({"map", brake, "--x", friction, "0.3", "0.4", "2", "--y", spin, "5",
                       "20", "2"})["window"][1]
                  .get<double>(),
              7494.83, 0.01);
  const Json eig = json_of({"eig", brake, "--below", "2 kHz"});
  EXPECT_EQ(eig["window"][1], 2000.0);
  for (const Json& s : eig["eigenvalues"]) EXPECT_LT(s[1].get<double>(), 2.0 * 3.14159266 * 2000.0);
}

TEST(DiscProgram, WhereNothingLiesBelowAFrequencyNothingIsDrawn) {
  const TemporaryFolder folder;
  const ProgramResult drawn =
      Program({"locus", brake, "--parameter", friction, "--from", "0.3", "--to", "0.4", "--points",
               "2", "--below", "1 Hz", "--figure", (folder / "locus.png").string(), "-o",
               (folder / "locus.h5").string()})
          .run();
  EXPECT_EQ(drawn.exit_code, 2);
  EXPECT_THAT(drawn.err, HasSubstr("--below: there is no eigenvalue to draw"));
  EXPECT_FALSE(std::filesystem::exists(folder / "locus.h5"));
}

TEST(DiscProgram, ElasticPadsInEveryVerbOfSmallMotion) {
  const std::string elastic = scene_path("examples/elastic_pads.yaml");
  const Json eig = json_of({"eig", elastic, "--explain"});
  EXPECT_FALSE(eig["stable"]);
  EXPECT_EQ(eig["equilibrium"]["contacts"].size(), 10U);
  // Two modes grow, as independent assemblies of the same brake have it.
  EXPECT_EQ(json_of({"eig", elastic, "--set", "parameters.mu=0.5"})["stable"], false);
  // Friction presses the leading half, and the leaning springs add to the pistons.
  const auto force = [&](std::size_t i) {
    const std::string name = (i < 5 ? "upper[" : "lower[") + std::to_string(i % 5) + "]";
    return eig["equilibrium"]["contacts"][name]["force"].get<double>();
  };
  EXPECT_GT(force(0) + force(1), 1.5 * (force(3) + force(4)));
  EXPECT_GT(force(0) + force(1) + force(2) + force(3) + force(4), 3000.0);
  EXPECT_NEAR(force(6), force(1), 1e-9 * force(1));
  const double highest = eig["window"][1].get<double>();
  // Motions above the window grow faster and are not what is explained.
  EXPECT_LT(eig["explanation"]["frequency"].get<double>(), highest);
  EXPECT_GT(eig["explanation"]["growth"].get<double>(), 0.0);
  const auto with_few_modes = [](std::vector<std::string> arguments) {
    for (const std::string pad : {"upper", "lower"}) {
      arguments.insert(arguments.end(),
                       {"--set", "substructures." + pad + ".reduction.fixed_interface_modes=4"});
    }
    return json_of(arguments);
  };
  const Json roots = with_few_modes({"threshold", elastic, "--parameter", friction, "--from", "0.1",
                                     "--to", "0.5", "--points", "2"})["roots"];
  ASSERT_EQ(roots.size(), 1U);
  EXPECT_LT(roots[0]["frequency"].get<double>(), highest);
  const double limit = roots[0]["value"].get<double>();
  for (const auto& [share, is_stable] : {std::pair{1.0 - 1e-4, true}, {1.0 + 1e-4, false}}) {
    EXPECT_EQ(with_few_modes({"eig", elastic, "--set",
                              friction + "=" + std::to_string(share * limit)})["stable"],
              is_stable);
  }
  const Json map = with_few_modes({"map", elastic, "--x", friction, "0.1", "0.5", "2", "--y", spin,
                                   "10", "20", "2"});
  EXPECT_EQ(map["growth"].size(), 2U);
  const Json locus = with_few_modes({"locus", elastic, "--parameter", "parameters.E", "--from",
                                     "10e9", "--to", "20e9", "--points", "2"});
  EXPECT_EQ(locus["eigenvalues"].size(), 2U);
}

TEST(DiscProgram, SaysWhatPadsCannotHave) {
  const std::string elastic = scene_path("examples/elastic_pads.yaml");
  const auto refused = [](const std::string& scene, const std::string& set) {
    const ProgramResult result = Program({"check", scene, "--set", set}).run();
    EXPECT_EQ(result.exit_code, 2) << set;
    return result.out + result.err;
  };
  EXPECT_THAT(refused(elastic, "substructures.upper.points.p0.at=61 mm"),
              HasSubstr("points.p0.at: 0.061 m lies beyond the surface 'bottom' of 0.06 m"));
  EXPECT_THAT(refused(elastic, "substructures.upper.reduction.fixed_interface_modes=1000"),
              HasSubstr("fixed_interface_modes"));
  EXPECT_THAT(refused(elastic, "substructures.upper.material.poissons_ratio=0.7"),
              HasSubstr("poissons_ratio"));
  EXPECT_THAT(refused(elastic, "record.channels=[uper.force]"), HasSubstr("did you mean 'upper"));
  EXPECT_THAT(refused(elastic, "record.channels=[upper.gap, upper.gap]"), HasSubstr("twice"));
  EXPECT_THAT(refused(brake, "substructures.upper.masses.block.mass=-1"), HasSubstr("mass"));
}

TEST(DiscProgram, NamesTheNewKeyOfEveryFormerOne) {
  const TemporaryFolder folder;
  const std::string scene = (folder / "former.yaml").string();
  std::ofstream(scene) << "format: 2\ndisc: {inner_radius: 80 mm, speed: 10}\n"
                          "pads: {mass: 0.25, stiffness: {normal: 1.0e+8}, piston: {force: 1}}\n"
                          "contact: {formulation: penalty, penalty: 1.0e+10}\n";
  const ProgramResult result = Program({"check", scene}).run();
  EXPECT_EQ(result.exit_code, 2);
  for (const std::string message :
       {"disc.inner_radius: is now `inner_radius` of substructures.disc, of type annular_plate",
        "disc.speed: is now substructures.disc.spin", "pads.mass: is now substructures.UPPER",
        "pads.stiffness.normal: is now substructures.UPPER.springs.backing.stiffness.yy",
        "pads.piston.force: is now a drive with load", "contact.formulation: is now contacts.UPPER",
        "contact.penalty: is now contacts.UPPER.normal.stiffness",
        "disc: is no longer a kind of scene of its own"})
    EXPECT_THAT(result.err, HasSubstr(message));
}

/// disc_and_pads.yaml with pads that are pressed on by what a drive says.
std::string pressed_scene(const TemporaryFolder& folder, const std::string& normal) {
  const std::string path = (folder / "pressed.yaml").string();
  std::ifstream whole(brake);
  std::ofstream changed(path);
  for (std::string line; std::getline(whole, line);) {
    const std::size_t preload = line.find("normal: {law: multiplier, preload: =preload}");
    if (preload != std::string::npos) line = line.substr(0, preload) + "normal: " + normal;
    if (line.starts_with("parameters:")) line = "parameters: {mu: 0.3, d: 40 um}";
    changed << line << '\n';
  }
  changed << "drive: {displacement: =-d, displaces: [upper.backing, lower.backing], ramp: 0}\n";
  return path;
}

TEST(DiscProgram, PistonsMakeTheForcesOfTheSlidingState) {
  const TemporaryFolder folder;
  const std::string pressed = pressed_scene(folder, "{law: multiplier}");
  // As SlidingState.SpringsThatComeCloserPress; what bends adds nothing between two pads alike.
  const Json eig = json_of({"eig", pressed});
  const double force = (1e8 - 2e7 * 2e7 / 4e7) * 4e-5 / (1.0 - 0.3 * 2e7 / 4e7);
  for (const Json& contact : eig["equilibrium"]["contacts"]) {
    EXPECT_NEAR(contact["force"].get<double>(), force, 1e-9 * force);
    EXPECT_EQ(contact["closed"], true);
  }
  const ProgramResult jammed = Program({"eig", pressed, "--set", "parameters.mu=2.01"}).run();
  EXPECT_EQ(jammed.exit_code, 3);
  EXPECT_THAT(jammed.err, HasSubstr("no sliding equilibrium"));
  const ProgramResult locus = Program({"locus", pressed, "--parameter", friction, "--from", "0.1",
                                       "--to", "2.01", "--points", "2"})
                                  .run();
  EXPECT_EQ(locus.exit_code, 3);
  EXPECT_THAT(locus.err, HasSubstr("no sliding equilibrium at parameters.mu = 2.01"));
  // A map has no growth there, and goes on.
  const Json map = json_of({"map", pressed, "--x", friction, "1.9", "2.01", "2", "--y",
                            "parameters.d", "20e-6", "40e-6", "2"});
  for (const Json& row : map["growth"]) {
    EXPECT_TRUE(row[0].is_number());
    EXPECT_TRUE(row[1].is_null());
  }
  const std::string springs = pressed_scene(folder, "{law: penalty, stiffness: 1.0e+10}");
  const Json run = json_of({"run", springs, "-o", (folder / "run.h5").string(), "--set",
                            "time.end=0.002"});
  EXPECT_GT(run["contacts"]["upper"]["contact_force"]["min"].get<double>(), 0.9 * force);
  EXPECT_LT(run["contacts"]["upper"]["contact_force"]["max"].get<double>(), 1.1 * force);
}

TEST(DiscProgram, RunsIntoABoundedCycle) {
  const TemporaryFolder folder;
  const std::string squeal = scene_path("examples/disc_squeal.yaml");
  const std::string file = (folder / "run.h5").string();
  const Json run = json_of({"run", squeal, "-o", file});
  EXPECT_EQ(run["status"], "done");
  EXPECT_NEAR(run["perturbation"]["growth"].get<double>(), 346.133, 0.01);
  EXPECT_GT(run["free_fraction"].get<double>(), 0.05);
  EXPECT_EQ(run["contacts"]["upper"]["contact_force"]["min"].get<double>(), 0.0);
  const RunFileReader reader(file);
  const std::vector<double> y = reader.series("/channels/upper.block.y.displacement");
  double largest = 0.0;
  for (std::size_t i = y.size() / 2; i < y.size(); ++i) largest = std::max(largest, std::abs(y[i]));
  EXPECT_NEAR(largest, 4.1e-4, 1e-4);
  EXPECT_THAT(json_of({"info", file}).dump(), HasSubstr("upper.block.y.displacement"));
  EXPECT_THAT(
      Program({"run", squeal, "-o", (folder / "y.h5").string(), "--set", "record.interval=1.5e-6"})
          .run()
          .err,
      HasSubstr("must be a whole multiple"));
  EXPECT_THAT(Program({"run", squeal, "-o", (folder / "y.h5").string(), "--set",
                       "initial.perturbation.eigenvalue=99"})
                  .run()
                  .err,
              HasSubstr("99 is more than the 19 eigenvalues with positive frequency"));
}

TEST(DiscProgram, RunsWithRigidContacts) {
  const TemporaryFolder folder;
  const std::string file = (folder / "run.h5").string();
  const auto moved = [&](const std::string& step, Json& run) {
    std::vector<std::string> arguments{"run",  scene_path("examples/disc_squeal.yaml"),
                                       "-o",   file,
                                       "--force", "--set",
                                       "time.step=" + step};
    for (const std::string pad : {"upper", "lower"}) {
      arguments.insert(arguments.end(),
                       {"--set", "contacts." + pad + ".normal={law: multiplier, preload: 3000}"});
    }
    run = json_of(arguments);
    const RunFileReader reader(file);
    const std::vector<double> y = reader.series("/channels/upper.block.y.displacement");
    double largest = 0.0;
    for (std::size_t i = y.size() / 2; i < y.size(); ++i)
      largest = std::max(largest, std::abs(y[i]));
    return largest;
  };
  // A cycle, and the same in steps of another length.
  Json run, coarse;
  const double largest = moved("2e-6", run);
  EXPECT_NEAR(largest, 1.334e-4, 0.007e-4);
  EXPECT_NEAR(moved("4e-6", coarse), largest, 1e-2 * largest);
  EXPECT_NEAR(run["perturbation"]["growth"].get<double>(), 345.387, 0.001);
  EXPECT_NEAR(run["stick_fraction"].get<double>(), 0.12, 0.02);
  // The brake as it is given decays, in steps too.
  EXPECT_LT(json_of({"run", brake, "-o", file, "--force"})["perturbation"]["growth"].get<double>(),
            0.0);
}

TEST(DiscProgram, HasWhatOtherScenesHave) {
  const TemporaryFolder folder;
  const std::string squeal = scene_path("examples/disc_squeal.yaml");
  const std::vector<std::string> brief{"--set", "time.end=0.004", "--set", "time.step=4e-6",
                                       "--set", "initial.perturbation.amplitude=20 um"};
  const auto with = [&](std::vector<std::string> arguments) {
    arguments.insert(arguments.end(), brief.begin(), brief.end());
    return json_of(arguments);
  };
  const Json run = with({"run", squeal, "-o", (folder / "run.h5").string(), "--error"});
  EXPECT_TRUE(run["error"]["failure"].is_null()) << run["error"];
  EXPECT_LT(run["error"]["force"].get<double>(), 0.05);
  // The plate bends out of its plane, seen from above.
  const std::string shapes = (folder / "shapes").string();
  EXPECT_EQ(json_of({"eig", brake, "--shapes", shapes})["files"].size(), 27U);  // two of each of 13 modes, and their list
  const Json sweep = with({"sweep", squeal, "--parameter", friction, "--from", "0.3", "--to", "0.5",
                           "--points", "3"});
  EXPECT_EQ(sweep["rows"].size(), 3U) << sweep;
}

TEST(DiscProgram, StopsWhereAPadGoesThroughTheDisc) {
  const TemporaryFolder folder;
  const std::string file = (folder / "run.h5").string();
  const auto run = [&](const std::string& amplitude) {
    return Program({"run", scene_path("examples/disc_squeal.yaml"), "-o", file, "--force", "--set",
                    "time.end=0.02", "--set", "initial.perturbation.amplitude=" + amplitude})
        .run();
  };
  // The disc is 12 mm thick. 5 mm are no small motion, but the pads stay on their sides.
  EXPECT_EQ(run("5 mm").exit_code, 0);
  const ProgramResult result = run("1");
  EXPECT_EQ(result.exit_code, 3);
  EXPECT_THAT(result.err, HasSubstr("more than half its thickness"));
  EXPECT_THAT(result.err, HasSubstr("m into disc."));
}

}  // namespace
}  // namespace stridor
