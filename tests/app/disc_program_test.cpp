// Discs with pads, as a user would run them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "io/run_file.hpp"
#include "tests/support/eigenvalue_program.hpp"
#include "tests/support/program.hpp"
#include "tests/support/temporary_folder.hpp"

namespace stridor {
namespace {

using namespace test;
using ::testing::HasSubstr;

const std::string brake = scene_path("disc_and_pads.yaml");
const std::string friction = "contact.friction.coefficient";

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

}  // namespace
}  // namespace stridor
