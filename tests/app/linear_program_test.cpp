// Discs with pads and bodies given by matrices, as a user would run them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "io/run_file.hpp"
#include "tests/support/program.hpp"
#include "tests/support/temporary_folder.hpp"

namespace stridor {
namespace {

using namespace test;
using ::testing::HasSubstr;
using Json = nlohmann::json;

const std::string brake = scene_path("disc_and_pads.yaml");
const std::string friction = "contact.friction.coefficient";

Json json_of(std::vector<std::string> arguments) {
  arguments.emplace_back("--json");
  const ProgramResult result = Program(arguments).run();
  EXPECT_EQ(result.exit_code, 0) << result.err;
  return Json::parse(result.out);
}

struct Growth {
  int num_unstable = 0;
  double largest = -1e300;
};

Growth growth_of(const Json& eig) {
  Growth growth;
  for (const Json& s : eig["eigenvalues"]) {
    const double re = s[0].get<double>();
    growth.num_unstable += re > 1e-6 ? 1 : 0;
    growth.largest = std::max(growth.largest, re);
  }
  return growth;
}

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
  EXPECT_EQ(damped["equilibrium"]["contacts"][0]["force"], 3000.0);
  EXPECT_NEAR(growth_of(json_of({"eig", brake, "--set", "disc.damping.beta=1e-6", "--set",
                                 "pads.damping.beta=1e-6"}))
                  .largest,
              -46.177, 5e-4);
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
  EXPECT_NEAR(limit({}), 0.3596654112, 1e-10);
  EXPECT_NEAR(limit({"--set", "disc.speed=0"}), 0.3596654112, 1e-10);
  EXPECT_NEAR(limit({"--set", "contact.formulation=penalty", "--set", "contact.penalty=1e9"}),
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
}

TEST(DiscProgram, MapAgreesWithTheThreshold) {
  const Json map = json_of({"map", brake, "--set", "terms=[friction]", "--x", friction, "0.3",
                            "0.4", "3", "--y", "disc.speed", "1", "20", "2"});
  ASSERT_EQ(map["boundary"].size(), 1U);
  for (const Json& point : map["boundary"][0])
    EXPECT_NEAR(point[0].get<double>(), 0.3596654112, 1e-9);
}

TEST(DiscProgram, LocusListsEigenvaluesAndWindows) {
  const Json locus = json_of({"locus", brake, "--set", "terms=[friction]", "--parameter", friction,
                              "--from", "0.3", "--to", "0.4", "--points", "2"});
  ASSERT_EQ(locus["eigenvalues"].size(), 2U);
  EXPECT_EQ(locus["eigenvalues"][0].size(), 17U);
  ASSERT_EQ(locus["unstable"].size(), 1U);
  EXPECT_NEAR(locus["unstable"][0]["from"].get<double>(), 0.3596654112, 1e-10);
}

TEST(DiscProgram, RefusesWhatItHasNot) {
  EXPECT_THAT(Program({"run", scene_path("examples/flutter.yaml"), "-o", "x.h5"}).run().err,
              HasSubstr("has no contacts to run with"));
  EXPECT_THAT(Program({"eig", brake, "--below", "3 m"}).run().err, HasSubstr("--below"));
  EXPECT_THAT(Program({"eig", brake, "--at", "1"}).run().err, HasSubstr("--at"));
  EXPECT_THAT(Program({"eig", brake, "--shapes", "x"}).run().err, HasSubstr("--shapes"));
  const ProgramResult unnamed = Program({"threshold", brake, "--from", "0", "--to", "1"}).run();
  EXPECT_EQ(unnamed.exit_code, 2);
  EXPECT_THAT(unnamed.err, HasSubstr("name a key"));
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
  EXPECT_NEAR(json_of({"map", brake, "--x", friction, "0.3", "0.4", "2", "--y", "disc.speed", "5",
                       "20", "2"})["window"][1]
                  .get<double>(),
              7494.83, 0.01);
  const Json eig = json_of({"eig", brake, "--below", "2 kHz"});
  EXPECT_EQ(eig["window"][1], 2000.0);
  for (const Json& s : eig["eigenvalues"]) EXPECT_LT(s[1].get<double>(), 2.0 * 3.14159266 * 2000.0);
}

TEST(DiscProgram, ElasticPadsInEveryVerbOfSmallMotion) {
  const std::string elastic = scene_path("examples/elastic_pads.yaml");
  const Json eig = json_of({"eig", elastic, "--explain"});
  EXPECT_FALSE(eig["stable"]);
  EXPECT_EQ(eig["equilibrium"]["contacts"].size(), 10U);
  // Friction presses the leading half, and the leaning springs add to the pistons.
  const auto force = [&](std::size_t i) {
    return eig["equilibrium"]["contacts"][i]["force"].get<double>();
  };
  EXPECT_GT(force(0) + force(1), 1.5 * (force(3) + force(4)));
  EXPECT_GT(force(0) + force(1) + force(2) + force(3) + force(4), 3000.0);
  EXPECT_NEAR(force(6), force(1), 1e-9 * force(1));
  const double highest = eig["window"][1].get<double>();
  // Motions above the window grow faster and are not what is explained.
  EXPECT_LT(eig["explanation"]["frequency"].get<double>(), highest);
  EXPECT_GT(eig["explanation"]["growth"].get<double>(), 0.0);
  const std::string few = "pads.elastic.reduction.fixed_interface_modes=4";
  const Json roots = json_of({"threshold", elastic, "--parameter", friction, "--from", "0.1",
                              "--to", "0.5", "--points", "2", "--set", few})["roots"];
  ASSERT_EQ(roots.size(), 1U);
  EXPECT_LT(roots[0]["frequency"].get<double>(), highest);
  const double limit = roots[0]["value"].get<double>();
  for (const auto& [share, is_stable] : {std::pair{1.0 - 1e-4, true}, {1.0 + 1e-4, false}}) {
    EXPECT_EQ(json_of({"eig", elastic, "--set", friction + "=" + std::to_string(share * limit),
                       "--set", few})["stable"],
              is_stable);
  }
  const Json map = json_of({"map", elastic, "--x", friction, "0.1", "0.5", "2", "--y", "disc.speed",
                            "10", "20", "2", "--set", few});
  EXPECT_EQ(map["growth"].size(), 2U);
  const Json locus =
      json_of({"locus", elastic, "--parameter", "pads.elastic.material.youngs_modulus", "--from",
               "10e9", "--to", "20e9", "--points", "2", "--set", few});
  EXPECT_EQ(locus["eigenvalues"].size(), 2U);
}

TEST(DiscProgram, RigidPadsHaveOneRigidContactEach) {
  // Two of them on a mass that does not tilt are redundant: the dense method found B_C of rank 3.
  const std::string rigid = scene_path("disc_and_pads.yaml");
  const std::vector<std::string> check{"check", rigid, "--set", "contact.offsets=[-12 mm, 12 mm]"};
  const ProgramResult refused = Program(check).run();
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_THAT(refused.out + refused.err,
              HasSubstr("contact.offsets: pads that are rigid masses do not tilt"));
  std::vector<std::string> springs = check;
  springs.insert(springs.end(), {"--set", "contact.formulation=penalty"});
  EXPECT_EQ(Program(springs).run().exit_code, 0);
}

TEST(DiscProgram, SaysWhatElasticPadsCannotHave) {
  const std::string elastic = scene_path("examples/elastic_pads.yaml");
  const auto refused = [&](const std::string& set) {
    const ProgramResult result = Program({"check", elastic, "--set", set}).run();
    EXPECT_EQ(result.exit_code, 2) << set;
    return result.out + result.err;
  };
  EXPECT_THAT(refused("pads.mass=0.2"), HasSubstr("an elastic pad has the mass of its material"));
  EXPECT_THAT(refused("contact.offsets=[0, 0.031]"),
              HasSubstr("must lie on the pad, within 0.03 m of its centre, got 0.031 m"));
  EXPECT_THAT(refused("pads.elastic.reduction.fixed_interface_modes=1000"),
              HasSubstr("must not exceed 268"));
  EXPECT_THAT(refused("pads.elastic.material.poissons_ratio=0.7"), HasSubstr("poissons_ratio"));
  EXPECT_THAT(refused("record.channels=[upper_9.force]"), HasSubstr("there is none of this name"));
  EXPECT_THAT(refused("record.channels=[upper_1.gap, upper_1.gap]"), HasSubstr("is listed twice"));
  const TemporaryFolder folder;
  EXPECT_THAT(Program({"run", elastic, "-o", (folder / "x.h5").string(), "--set", "time.step=4e-6",
                       "--set", "record.interval=2e-5"})
                  .run()
                  .err,
              HasSubstr("time.step: motion of face contacts: a step of 4e-06 s is too long"));
  EXPECT_THAT(refused("contact.preload=3000"), HasSubstr("prescribed by contact.preload"));
  EXPECT_THAT(refused("pads.piston.displacement=40um"),
              HasSubstr("expected either `force` or `displacement`"));
  const ProgramResult none = Program({"check", brake, "--set", "pads.mass=-1"}).run();
  EXPECT_EQ(none.exit_code, 2);
}

TEST(DiscProgram, PistonsMakeTheForcesOfTheSlidingState) {
  const TemporaryFolder folder;
  const std::string pressed = (folder / "pressed.yaml").string();
  std::ifstream whole(brake);
  std::ofstream changed(pressed);
  for (std::string line; std::getline(whole, line);) {
    if (line.find("preload:") != std::string::npos) continue;
    changed << line << '\n';
    if (line.starts_with("pads:")) changed << "  piston: {displacement: 40 um}\n";
  }
  changed.close();
  // As SlidingState.SpringsThatComeCloserPress; what bends adds nothing between two pads alike.
  const Json eig = json_of({"eig", pressed});
  const double force = (1e8 - 2e7 * 2e7 / 4e7) * 4e-5 / (1.0 - 0.3 * 2e7 / 4e7);
  for (const Json& contact : eig["equilibrium"]["contacts"]) {
    EXPECT_NEAR(contact["force"].get<double>(), force, 1e-9 * force);
    EXPECT_EQ(contact["closed"], true);
  }
  const ProgramResult jammed =
      Program({"eig", pressed, "--set", "contact.friction.coefficient=2.01"}).run();
  EXPECT_EQ(jammed.exit_code, 3);
  EXPECT_THAT(jammed.err, HasSubstr("no state in which it slides steadily"));
  const ProgramResult locus = Program({"locus", pressed, "--parameter", friction, "--from", "0.1",
                                       "--to", "2.01", "--points", "2"})
                                  .run();
  EXPECT_EQ(locus.exit_code, 3);
  EXPECT_THAT(locus.err, HasSubstr("at contact.friction.coefficient = 2.01: disc: found no state"));
  // A map has no growth there, and goes on.
  const Json map = json_of({"map", pressed, "--x", friction, "1.9", "2.01", "2", "--y",
                            "pads.piston.displacement", "20e-6", "40e-6", "2"});
  for (const Json& row : map["growth"]) {
    EXPECT_TRUE(row[0].is_number());
    EXPECT_TRUE(row[1].is_null());
  }
  const Json run = json_of({"run", pressed, "-o", (folder / "run.h5").string(), "--set",
                            "contact.formulation=penalty", "--set", "time.end=0.002"});
  EXPECT_GT(run["contacts"]["upper"]["contact_force"]["min"].get<double>(), 0.9 * force);
  EXPECT_LT(run["contacts"]["upper"]["contact_force"]["max"].get<double>(), 1.1 * force);
}

TEST(DiscProgram, RunsIntoABoundedCycle) {
  const TemporaryFolder folder;
  const std::string squeal = scene_path("examples/disc_squeal.yaml");
  const Json run =
      json_of({"run", squeal, "-o", (folder / "run.h5").string(), "--set", "time.end=0.04"});
  EXPECT_EQ(run["status"], "done");
  // Without what only run needs.
  const std::string bare = (folder / "bare.yaml").string();
  std::ifstream whole(squeal);
  std::ofstream without(bare);
  for (std::string line; std::getline(whole, line) && !line.starts_with("time:");)
    without << line << '\n';
  without.close();
  const std::string missing = Program({"run", bare, "-o", (folder / "x.h5").string()}).run().err;
  for (const std::string key : {"time", "initial", "record"})
    EXPECT_THAT(missing, HasSubstr(key + ": is required for run"));
  for (const std::string set : {"contact.preload=0", "disc.speed=0"}) {
    const std::string err = Program({"run", squeal, "-o", (folder / "x.h5").string(), "--set", set,
                                     "--set", "terms=[friction]"})
                                .run()
                                .err;
    EXPECT_THAT(err, HasSubstr("must be positive for run")) << set;
  }
  EXPECT_GT(run["perturbation"]["growth"].get<double>(), 100.0);
  EXPECT_GT(run["free_fraction"].get<double>(), 0.05);
  EXPECT_GE(run["contacts"]["upper"]["contact_force"]["min"].get<double>(), 0.0);
  const Json info = json_of({"info", (folder / "run.h5").string()});
  EXPECT_THAT(info.dump(), HasSubstr("pad.upper.z.displacement"));
  EXPECT_THAT(
      Program({"run", squeal, "-o", (folder / "y.h5").string(), "--set", "record.interval=1.5e-6"})
          .run()
          .err,
      HasSubstr("record.interval: must be a whole multiple of time.step"));
  EXPECT_THAT(Program({"run", squeal, "-o", (folder / "y.h5").string(), "--set",
                       "initial.perturbation.eigenvalue=99"})
                  .run()
                  .err,
              HasSubstr("there are 19 modes, got 99"));
}

TEST(DiscProgram, RunsWithRigidContacts) {
  const TemporaryFolder folder;
  const std::string file = (folder / "run.h5").string();
  const std::vector<std::string> rigid{
      "run",   scene_path("examples/disc_squeal.yaml"), "-o", file, "--force",
      "--set", "contact.formulation=lagrange"};
  const auto with = [&](const std::string& set) {
    std::vector<std::string> arguments = rigid;
    arguments.insert(arguments.end(), {"--set", set});
    return arguments;
  };
  const Json run = json_of(rigid);
  EXPECT_NEAR(run["perturbation"]["growth"].get<double>(), 345.387, 0.001);
  // A cycle, and the same in steps of another length.
  const double largest = run["pad_displacement"]["second_half"].get<double>();
  EXPECT_NEAR(run["pad_displacement"]["first_half"].get<double>(), largest, 1e-3 * largest);
  EXPECT_NEAR(json_of(with("time.step=4e-6"))["pad_displacement"]["second_half"].get<double>(),
              largest, 2e-3 * largest);
  EXPECT_NEAR(run["free_fraction"].get<double>(), 0.39, 0.02);
  EXPECT_NEAR(run["stick_fraction"].get<double>(), 0.12, 0.02);
  std::vector<std::string> long_steps = with("time.step=2e-4");
  long_steps.insert(long_steps.end(), {"--set", "record.interval=2e-4"});
  const ProgramResult too_long = Program(long_steps).run();
  EXPECT_EQ(too_long.exit_code, 2);
  EXPECT_THAT(too_long.err,
              HasSubstr("time.step: motion of rigid face contacts: a step of 0.0002 s "
                        "is too long for bodies as stiff as these"));
  // The brake as it is given decays, in steps too.
  EXPECT_LT(json_of({"run", brake, "-o", file, "--force"})["perturbation"]["growth"].get<double>(),
            0.0);
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
  ProgramResult result = run("1");
  EXPECT_EQ(result.exit_code, 3);
  EXPECT_THAT(result.err, HasSubstr("m into the disc at t = "));
  EXPECT_THAT(result.err, HasSubstr("more than half its thickness; a smaller initial.pert"));
  EXPECT_THAT(result.err, HasSubstr(file + " holds everything up to then"));
  EXPECT_EQ(std::get<std::string>(RunFileReader(file).results().at("status")), "failed");
  const ProgramResult resumed = Program({"run", "--resume", file}).run();
  EXPECT_EQ(resumed.exit_code, 4);
  EXPECT_THAT(resumed.err, HasSubstr("holds a run that failed"));
  result = run("1e160");
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.err, HasSubstr("initial.perturbation.amplitude: is beyond what can be"));
}

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
  std::ofstream(path) << "format: 1\nsubstructures:\n  chain: {type: matrices, mass: M.mtx, "
                         "stiffness: K.mtx, load: 0}\n";
  return path;
}

TEST(MatrixProgram, LargeMatricesAreCountedInTheirWindow) {
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
  const Json locus = json_of({"locus", scene, "--parameter", "substructures.chain.load", "--from",
                              "0", "--to", "1", "--points", "2", "--count", "4"});
  EXPECT_EQ(locus["eigenvalues"][1], lowest["eigenvalues"]);
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
    std::ofstream(path) << "format: 1\nsubstructures:\n  pairs: {type: matrices, mass: M.mtx, "
                        << matrices << "}\n";
    return path;
  }

 private:
  TemporaryFolder folder_;
};

TEST(MatrixProgram, LargeMatricesHaveLociAndThresholds) {
  // With stiffness i diag(1, 1.4) and damping 0.1, each under the circulatory load: the first one
  // flutters from 0.2280350850 on, the second one from beyond 0.4.
  const ManyOscillators oscillators;
  oscillators.write("D", [](int i) { return std::pair(i, 0.1); });
  oscillators.write("K",
                    [](int i) { return std::pair(i, (i / 2 + 1) * (i % 2 == 0 ? 1.0 : 1.4)); });
  oscillators.write("N", [](int i) { return ManyOscillators::across(i, 1.0); });
  const std::string scene =
      oscillators.scene("damping: D.mtx, stiffness: K.mtx, load: 0, load_stiffness: N.mtx");
  const std::vector<std::string> range{"--parameter", "substructures.pairs.load",
                                       "--from",      "0",
                                       "--to",        "0.35",
                                       "--points",    "3",
                                       "--below",     "0.3"};
  std::vector<std::string> arguments{"threshold", scene};
  arguments.insert(arguments.end(), range.begin(), range.end());
  const Json threshold = json_of(arguments);
  ASSERT_EQ(threshold["roots"].size(), 1U);
  EXPECT_NEAR(threshold["roots"][0]["value"].get<double>(), 0.2280350850, 1e-8);
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

TEST(MatrixProgram, WindowsOfLargeMatricesAreFoundBetweenTheValues) {
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
      "damping: D.mtx, stiffness: K.mtx, circulatory: N.mtx, load: 0, load_stiffness: L.mtx");
  const Json locus = json_of({"locus", scene, "--parameter", "substructures.pairs.load", "--from",
                              "0", "--to", "1", "--points", "3", "--below", "0.25"});
  ASSERT_EQ(locus["eigenvalues"].size(), 3U);
  ASSERT_EQ(locus["unstable"].size(), 1U);
  const double half = std::sqrt(1e-8 + 12e-4);
  EXPECT_NEAR(locus["unstable"][0]["from"].get<double>(), 0.4001 - half, 1e-8);
  EXPECT_NEAR(locus["unstable"][0]["to"].get<double>(), 0.4001 + half, 1e-8);
}

TEST(MatrixProgram, NarrowWindowsOfLargeMatricesAreFound) {
  // The same without damping under a circulatory force 1e-4: flutter within 2e-4 of 0.4237,
  // where nothing grows or decays elsewhere.
  const ManyOscillators oscillators;
  oscillators.write("K",
                    [](int i) { return std::pair(i, (i / 2 + 1) * (i % 2 == 0 ? 1.0 : 1.4237)); });
  oscillators.write("N", [](int i) { return ManyOscillators::across(i, 1e-4); });
  oscillators.write("L", [](int i) { return std::pair(i, i == 1 ? -1.0 : 0.0); });
  const std::string scene =
      oscillators.scene("stiffness: K.mtx, circulatory: N.mtx, load: 0, load_stiffness: L.mtx");
  const Json threshold = json_of({"threshold", scene, "--parameter", "substructures.pairs.load",
                                  "--from", "0", "--to", "1", "--points", "6", "--below", "0.25"});
  ASSERT_EQ(threshold["roots"].size(), 2U);
  EXPECT_NEAR(threshold["roots"][0]["value"].get<double>(), 0.4237 - 2e-4, 1e-8);
  EXPECT_NEAR(threshold["roots"][1]["value"].get<double>(), 0.4237 + 2e-4, 1e-8);
  EXPECT_EQ(threshold["unresolved"], 0.0);
}

TEST(MatrixProgram, ARangeOverManyDecadesHidesNoLimit) {
  const Json threshold = json_of({"threshold", scene_path("examples/flutter.yaml"), "--parameter",
                                  "substructures.oscillator.load", "--from", "0", "--to", "1e100"});
  ASSERT_EQ(threshold["roots"].size(), 1U);
  EXPECT_NEAR(threshold["roots"][0]["value"].get<double>(), 0.2, 1e-12);
}

TEST(MatrixProgram, FactorsOfMatricesAreVaried) {
  // Flutter of diag(1, 1.4) under a circulatory force n: from 0.2 on, with damping 0.1 of both from
  // 0.2280350850.
  const TemporaryFolder folder;
  const std::string scene = (folder / "two.yaml").string();
  std::ofstream(scene) << "format: 1\nsubstructures:\n  two: {type: matrices, mass: [[1, 0], [0, "
                          "1]], stiffness: [[1, 0], [0, 1.4]], damping: [[1, 0], [0, 1]], "
                          "circulatory: [[0, 1], [-1, 0]], factors: {damping: 0}}\n";
  const std::string n = "substructures.two.factors.circulatory";
  const std::string d = "substructures.two.factors.damping";
  const auto limit = [&](const std::vector<std::string>& more) {
    std::vector<std::string> arguments{"threshold", scene, "--parameter", n,
                                       "--from",    "0",   "--to",        "0.4"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return json_of(arguments)["roots"].at(0)["value"].get<double>();
  };
  EXPECT_NEAR(limit({}), 0.2, 1e-12);
  EXPECT_NEAR(limit({"--set", d + "=0.1"}), 0.2280350850, 1e-10);
  EXPECT_NEAR(limit({"--set", "substructures.two.factors.stiffness=1.5"}), 0.3, 1e-12);
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

TEST(MatrixProgram, LargeMatricesHaveMaps) {
  const ManyOscillators oscillators;
  oscillators.write("D", [](int i) { return std::pair(i, 1.0); });
  oscillators.write("K",
                    [](int i) { return std::pair(i, (i / 2 + 1) * (i % 2 == 0 ? 1.0 : 1.4)); });
  oscillators.write("N", [](int i) { return ManyOscillators::across(i, 1.0); });
  const std::string scene =
      oscillators.scene("damping: D.mtx, stiffness: K.mtx, circulatory: N.mtx");
  const std::string factors = "substructures.pairs.factors.";
  const Json map = json_of({"map", scene, "--x", factors + "circulatory", "0.1", "0.3", "2", "--y",
                            factors + "damping", "0.1", "0.2", "2", "--below", "0.25"});
  const auto stable = [&](std::size_t row, std::size_t column) {
    return map["growth"][row][column].get<double>() <= 0.0;
  };
  // 0.04 + 1.2 d² is 0.052 and 0.088.
  EXPECT_TRUE(stable(0, 0));
  EXPECT_FALSE(stable(0, 1));
  EXPECT_TRUE(stable(1, 0));
  EXPECT_FALSE(stable(1, 1));
}

TEST(MatrixProgram, ExamplesHaveTheirClosedForms) {
  EXPECT_NEAR(example_limit("flutter", "substructures.oscillator.load", "0.4", {}), 0.2, 1e-12);
  EXPECT_NEAR(example_limit("flutter_equal_damping", "substructures.oscillator.load", "0.4", {}),
              0.2280350850, 1e-10);
  EXPECT_NEAR(example_limit("flutter_ziegler", "substructures.oscillator.load", "0.4", {}),
              0.1732146068, 1e-10);
  EXPECT_NEAR(example_limit("flutter_ziegler", "substructures.oscillator.load", "0.4",
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

}  // namespace
}  // namespace stridor
