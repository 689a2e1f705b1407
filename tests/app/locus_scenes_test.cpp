// Loci and maps of scenes of every kind: other scales, the course of the drive, several pairs,
// equal bodies. Eigenvalues against dimensional analysis and against the dense method; verbs that
// are stopped.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "tests/support/eigenvalue_program.hpp"
#include "tests/support/program.hpp"
#include "tests/support/temporary_folder.hpp"

namespace stridor {
namespace {

using namespace test;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::SizeIs;
using Complex = std::complex<double>;
using Strings = std::vector<std::string>;

/// The main scene in units of length, mass and time other than SI, given in SI.
std::string scaled_scene(double length, double mass, double time) {
  const double pressure = mass / (length * time * time);
  const double density = mass / (length * length * length);
  const auto beam = [&](const char* name, double l, double t, double w, const char* angle, double E,
                        double nu, double rho, double alpha, const char* rest) {
    return fmt::format(
        "  {}:\n    type: beam\n    length: {}\n    thickness: {}\n    width: {}\n"
        "    angle: {}\n    material: {{youngs_modulus: {}, poissons_ratio: {}, density: {}}}\n"
        "    damping: {{alpha: {}, beta: {}}}\n{}"
        "    reduction: {{fixed_interface_modes: 12}}\n",
        name, l * length, t * length, w * length, angle, E * pressure, nu, rho * density,
        alpha / time, 4e-8 * time, rest);
  };
  return "format: 2\nsubstructures:\n" +
         beam("oblique", 0.075, 0.0015, 0.010, "30 deg", 71e9, 0.33, 2770.0, 0.2,
              "    mesh: {along: 20, through: 1}\n    supports: {end: guided}\n") +
         beam("cantilever", 0.1, 0.002, 0.020, "0", 2.38e9, 0.40, 1200.0, 40.0,
              "    mesh: {along: 50, through: 1}\n    supports: {start: clamped}\n") +
         fmt::format(
             "contact: {{slave: oblique.tip, master: cantilever.top, assumption: subs_b, start: "
             "{}, friction: {{coefficient: 0.3}}}}\n"
             "drive: {{velocity: {}, load: {}, ramp: {}}}\ntime: {{step: {}, end: {}}}\n"
             "record: {{interval: {}, channels: [contact.force]}}\n",
             0.030 * length, 0.030 * length / time, -0.2 * mass * length / (time * time),
             0.1 * time, 2e-7 * time, 2.25 * time, 1e-5 * time);
}

TEST(SimilarScenes, HaveTheSameLocusInTheirOwnUnits) {
  // Bodies of 0.8 mm and of 13 m, frequencies of 0.01 Hz and of 40 MHz. Even powers of two, so that
  // the arithmetic is the same: not a threshold in it may have a unit.
  struct Units {
    double length, mass, time;
  };
  const TemporaryFolder folder;
  const std::string scene = (folder / "scene.yaml").string();
  for (const char* about : {"undeformed", "deformed"}) {
    const auto locus = [&](const Units& of) {
      std::ofstream(scene) << scaled_scene(of.length, of.mass, of.time);
      return scene_json({"locus", scene, "--about", about, "--from",
                         fmt::format("{}", 0.07 * of.length), "--to",
                         fmt::format("{}", 0.098 * of.length), "--points", "15"});
    };
    const Json one = locus({1.0, 1.0, 1.0});
    ASSERT_THAT(one["unstable"], Not(IsEmpty()));
    for (const Units& of : {Units{0x1p-7, 0x1p-20, 0x1p-12}, Units{0x1p7, 0x1p20, 0x1p12},
                            Units{0x1p7, 0x1p-10, 0x1p5}}) {
      const Json other = locus(of);
      ASSERT_EQ(other["eigenvalues"].size(), one["eigenvalues"].size());
      for (std::size_t i = 0; i < one["eigenvalues"].size(); ++i) {
        ASSERT_EQ(other["eigenvalues"][i].size(), one["eigenvalues"][i].size());
        for (std::size_t k = 0; k < one["eigenvalues"][i].size(); ++k) {
          const Complex s = complex_of(one["eigenvalues"][i][k]);
          EXPECT_LT(std::abs(of.time * complex_of(other["eigenvalues"][i][k]) - s),
                    1e-11 * std::abs(s));
        }
      }
      ASSERT_EQ(other["unstable"].size(), one["unstable"].size());
      for (std::size_t k = 0; k < one["unstable"].size(); ++k) {
        const auto same = [&](const char* key, double unit, double tolerance) {
          const double expected = one["unstable"][k][key];
          EXPECT_NEAR(other["unstable"][k][key].get<double>() * unit, expected,
                      tolerance * std::abs(expected))
              << key;
        };
        same("from", 1.0 / of.length, 1e-11);
        same("to", 1.0 / of.length, 1e-11);
        same("growth_max", of.time, 1e-11);
        // Where the growth is largest it hardly depends on the place.
        same("frequency", of.time, 1e-8);
        same("growth_integral", of.time / of.length, 1e-9);
        same("from_time", 1.0 / of.time, 1e-9);
        same("gain", 1.0, 1e-9);
      }
    }
  }
}

TEST(PassedWindows, AddUpToTheWholeWhereARunEndsAndAnotherOneStarts) {
  const auto locus = [](const Strings& more) {
    Strings sets{"drive.ramp=0"};
    sets.insert(sets.end(), more.begin(), more.end());
    return scene_json({"locus", scene_path("beam_on_beam.yaml"), "--about", "deformed", "--from",
                       "80 mm", "--to", "83 mm", "--points", "4"},
                      sets);
  };
  const Json whole = locus({"contact.start=79 mm", "time.end=1"});
  const Json first = locus({"contact.start=79 mm", "time.end=0.09"});
  const Json second = locus({"contact.start=81.7 mm", "time.end=1"});
  for (const Json* of : {&whole, &first, &second}) ASSERT_EQ((*of)["unstable"].size(), 1u);
  const auto number = [](const Json& of, const char* key) {
    return of["unstable"][0][key].get<double>();
  };
  EXPECT_GT(number(first, "gain"), 1.0);
  EXPECT_GT(number(second, "gain"), 1.0);
  EXPECT_NEAR(number(first, "gain") + number(second, "gain"), number(whole, "gain"), 0.005);
  EXPECT_NEAR(number(first, "to_time"), 0.09, 1e-6);
  EXPECT_NEAR(number(second, "from_time"), 0.0, 1e-6);
  EXPECT_NEAR(number(second, "to_time"), number(whole, "to_time") - 0.09, 1e-6);
}

TEST(PassedWindows, HaveTheSameTimesAlongTheDriveAsAlongTheMaster) {
  for (const char* about : {"undeformed", "deformed"}) {
    const auto windows = [&](const Strings& range) {
      Strings arguments{"locus", scene_path("beam_on_beam.yaml"), "--about", about, "--points",
                        "9"};
      arguments.insert(arguments.end(), range.begin(), range.end());
      return scene_json(arguments)["unstable"];
    };
    const Json position = windows({"--from", "90.2 mm", "--to", "96 mm"});
    const Json drive =
        windows({"--parameter", "drive.displacement", "--from", "60.3 mm", "--to", "66.1 mm"});
    ASSERT_EQ(position.size(), drive.size());
    ASSERT_FALSE(position.empty());
    for (std::size_t i = 0; i < drive.size(); ++i) {
      for (const char* key : {"from_time", "to_time", "frequency", "growth_max", "gain"}) {
        const double expected = position[i][key];
        EXPECT_NEAR(drive[i][key].get<double>(), expected, 1e-6 * expected) << key;
      }
    }
  }
}

TEST(SeveralPairs, HaveALocusAlongTheDrive) {
  const std::string scene = scene_path("examples/two_pairs.yaml");
  const Json locus = scene_json({"locus", scene, "--from", "0", "--to", "30 mm", "--points", "4"});
  EXPECT_EQ(locus["parameter"], "drive.displacement");
  for (std::size_t i = 0; i < 4; ++i) {
    const Json eig =
        scene_json({"eig", scene}, {fmt::format("contacts.front.start={} mm", 50 + 10 * i),
                                    fmt::format("contacts.rear.start={} mm", 20 + 10 * i)});
    const std::vector<Complex> a = vibrations(locus["eigenvalues"][i]);
    const std::vector<Complex> b = vibrations(eig["eigenvalues"]);
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t k = 0; k < a.size(); ++k)
      EXPECT_LT(std::abs(a[k] - b[k]), 1e-9 * std::abs(a[k]));
  }
  const ProgramResult beyond = Program({"locus", scene, "--from", "0", "--to", "60 mm"}).run();
  EXPECT_EQ(beyond.exit_code, 3);
  EXPECT_THAT(beyond.err, HasSubstr("drive.displacement = 0.06 m: front: the slave point stands "
                                    "beyond the end of the surface cantilever.top"));
}

TEST(PassedWindows, HaveAGainWhereTheDriveGoesBackwards) {
  const Json locus = scene_json({"locus", scene_path("beam_on_beam_leading.yaml"), "--about",
                                 "deformed", "--from", "95 mm", "--to", "97 mm", "--points", "3"},
                                {"drive.velocity=-0.03", "contact.start=97.5 mm"});
  ASSERT_EQ(locus["unstable"].size(), 1u);
  const Json& window = locus["unstable"][0];
  EXPECT_LT(window["from_time"].get<double>(), window["to_time"].get<double>());
  EXPECT_NEAR(window["gain"].get<double>(), window["growth_integral"].get<double>() / 0.03,
              0.02 * window["gain"].get<double>());
}

TEST(MapProgram, HasItsBoundaryUpToWhereThereIsNoEquilibrium) {
  // Without a load that presses it down, a beam that may lift off is free. The growth changes its
  // sign at -0.0358 N, with mu 0.3.
  const Strings sets{"contact.assumption=film", "contact.start=75.2 mm"};
  const Json map = scene_json(
      {"map", scene_path("beam_on_beam.yaml"), "--about", "deformed", "--x", "drive.load", "-0.1",
       "0.05", "16", "--y", "contact.friction.coefficient", "0.29", "0.3", "2"},
      sets);
  EXPECT_FALSE(map["growth"][1][9].is_null());  // -0.01 N
  EXPECT_TRUE(map["growth"][1][12].is_null());  // 0.02 N
  // Why there is none: points that fail alike share a text without their place.
  EXPECT_EQ(map["failure"][1][9], 0);
  const std::size_t number = map["failure"][1][12].get<std::size_t>();
  ASSERT_GE(number, 1u);
  std::size_t num_failed = 0;
  for (const Json& one : map["failures"]) {
    num_failed += one["points"].get<std::size_t>();
    if (one["number"] == number) {
      EXPECT_THAT(one["reason"].get<std::string>(),
                  AllOf(HasSubstr("equilibrium"), HasSubstr("[no-equilibrium]"),
                        Not(HasSubstr("drive.load"))));
    }
  }
  std::size_t num_missing = 0;
  for (const Json& row : map["growth"])
    for (const Json& growth : row) num_missing += growth.is_null() ? 1 : 0;
  EXPECT_EQ(num_failed, num_missing);
  const Json threshold =
      scene_json({"threshold", scene_path("beam_on_beam.yaml"), "--about", "deformed",
                  "--parameter", "drive.load", "--from", "-0.1", "--to", "-0.01"},
                 sets);
  ASSERT_EQ(threshold["roots"].size(), 1u);
  std::vector<double> at_top;
  for (const Json& line : map["boundary"]) {
    for (const Json& point : line)
      if (point[1] == 0.3) at_top.push_back(point[0]);
  }
  ASSERT_THAT(at_top, SizeIs(1));
  EXPECT_NEAR(at_top[0], threshold["roots"][0]["value"].get<double>(), 1e-8);
}

TEST(EqualArms, HaveEveryEigenvalueTwiceAllTheWay) {
  const TemporaryFolder folder;
  const std::string scene = (folder / "scene.yaml").string();
  std::ofstream(scene) << R"(format: 2
substructures:
  a: &arm
    type: beam
    length: 30 mm
    thickness: 6 mm
    width: 10 mm
    angle: 60 deg
    material: {youngs_modulus: 70 GPa, poissons_ratio: 0.33, density: 2700}
    mesh: {along: 10, through: 1}
    damping: {alpha: 2000, beta: 2.0e-7}
    supports: {end: guided}
    reduction: {fixed_interface_modes: 8}
  b: *arm
contacts:
  one: {slave: a.tip, master: rigid, assumption: subs_b, start: 0, friction: &law {law: stribeck, static: 0.9, dynamic: 0.2, decay_velocity: 0.01}}
  two: {slave: b.tip, master: rigid, assumption: subs_b, start: 0, friction: *law}
drive: {velocity: 50 mm/s, load: -30, ramp: 2 ms}
time: {step: 1.0e-7, end: 0.01}
record: {interval: 1.0e-6, channels: [one.force]}
)";
  for (const char* method : {"secular", "dense"}) {
    const Json locus =
        scene_json({"locus", scene, "--parameter", "drive.velocity", "--from", "0.06", "--to",
                    "0.1", "--points", "6", "--count", "6", "--method", method});
    ASSERT_THAT(locus["unstable"], SizeIs(2)) << method;
    for (const char* key : {"from", "to", "growth_max"}) {
      EXPECT_NEAR(locus["unstable"][0][key].get<double>(), locus["unstable"][1][key].get<double>(),
                  1e-6 * locus["unstable"][0][key].get<double>());
    }
    for (const Json& eigenvalues : locus["eigenvalues"]) {
      const std::vector<Complex> pairs = vibrations(eigenvalues);
      ASSERT_THAT(pairs, SizeIs(6));
      for (std::size_t k = 0; k < 6; k += 2)
        EXPECT_LT(std::abs(pairs[k] - pairs[k + 1]), 1e-6 * std::abs(pairs[k]));
    }
  }
  // Equal real ones are real by either.
  for (const char* method : {"secular", "dense"}) {
    const Json eig =
        scene_json({"eig", scene, "--count", "2", "--method", method}, {"drive.velocity=0.004"});
    EXPECT_EQ(eig["eigenvalues"].size(), 6u) << method;
    EXPECT_THAT(vibrations(eig["eigenvalues"]), SizeIs(2)) << method;
  }
  // Friction that falls this steeply drives a real eigenvalue far beyond all frequencies, in both.
  const auto fastest = [&](const char* method) {
    const Json eig =
        scene_json({"eig", scene, "--count", "2", "--method", method}, {"drive.velocity=0.01"});
    std::vector<double> growing;
    for (const Json& one : eig["eigenvalues"])
      if (one[0] > 1e7) growing.push_back(one[0]);
    return growing;
  };
  ASSERT_THAT(fastest("secular"), SizeIs(2));
  ASSERT_THAT(fastest("dense"), SizeIs(2));
  EXPECT_NEAR(fastest("secular")[0], fastest("dense")[0], 1e-5 * fastest("dense")[0]);
}

TEST(StoppedVerbs, WriteNothing) {
  const TemporaryFolder folder;
  const std::string scene = scene_path("beam_on_beam.yaml");
  const std::string output = (folder / "out.h5").string();
  const std::vector<Strings> verbs{
      {"locus", scene, "--from", "30mm", "--to", "98mm", "--points", "100000", "--about",
       "deformed", "-o", output},
      {"map", scene, "--x", "contact.start", "30mm", "98mm", "1000", "--y",
       "contact.friction.coefficient", "0", "1", "1000", "-o", output},
      {"map", scene_path("viscoelastic_sphere.yaml"), "--x", "parameters.v", "1e-5", "1", "3000",
       "--y", "parameters.tau0", "1e-4", "0.1", "3000", "--scale", "log", "-o", output},
      {"threshold", scene, "--from", "30mm", "--to", "98mm", "--points", "100000"}};
  for (const Strings& verb : verbs) {
    Program program(verb);
    program.start();
    usleep(300'000);
    program.send(SIGINT);
    const ProgramResult result = program.wait();
    EXPECT_EQ(result.exit_code, 5) << verb[0];
    EXPECT_THAT(result.err, HasSubstr("nothing has been written"));
    EXPECT_TRUE(result.out.empty()) << result.out;
    EXPECT_TRUE(std::filesystem::is_empty(folder.path())) << verb[0];
  }
}

/// Just behind a node of the master Newton's method finds other zeros at every step, however small.
TEST(StabilityOfScenes, ALocusThatCannotBeFollowedIsTakenFromAllEigenvalues) {
  const TemporaryFolder folder;
  const std::string scene = (folder / "strips.yaml").string();
  std::ofstream(scene) << R"(format: 2
substructures:
  strip:
    type: beam
    length: 80 mm
    thickness: 2 mm
    width: 12 mm
    angle: 120 deg
    material: {youngs_modulus: 110 GPa, poissons_ratio: 0.34, density: 8800}
    mesh: {along: 40, through: 1}
    damping: {alpha: 5, beta: 5.0e-8}
    supports: {end: guided}
    reduction: {fixed_interface_modes: 20}
  blade:
    type: beam
    length: 180 mm
    thickness: 3 mm
    width: 25 mm
    angle: 0 deg
    material: {youngs_modulus: 210 GPa, poissons_ratio: 0.3, density: 7850}
    mesh: {along: 90, through: 1}
    damping: {alpha: 10, beta: 5.0e-8}
    supports: {start: clamped}
    interface: {spacing: 2 mm}
    reduction: {fixed_interface_modes: 25}
contact: {slave: strip.tip, master: blade.top, assumption: film, start: 90 mm, friction: {coefficient: 0.36}}
drive: {velocity: 40 mm/s, load: -5 N, ramp: 50 ms}
time: {integrator: exact, retain: {frequency: 30 kHz}, step: 2.5 us, end: 1.8}
record: {interval: 20 us, channels: [contact.force]}
)";
  const Strings command{"locus",    scene, "--from",  "108mm",    "--to",  "108.5mm",
                        "--points", "3",   "--about", "deformed", "--json"};
  const ProgramResult followed = Program(command).run();
  ASSERT_EQ(followed.exit_code, 0) << followed.err;
  EXPECT_THAT(followed.err, HasSubstr("by the dense method"));
  const Json found = Json::parse(followed.out);
  EXPECT_EQ(found["method"], "dense");
  Strings dense = command;
  dense.insert(dense.end(), {"--method", "dense"});
  EXPECT_EQ(found["values"], Json::parse(Program(dense).run().out)["values"]);
  EXPECT_EQ(found["eigenvalues"], Json::parse(Program(dense).run().out)["eigenvalues"]);
}

}  // namespace
}  // namespace stridor
