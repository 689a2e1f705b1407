// Scenes of lumped bodies, moving masters, penalties and regularised friction, as a user would run
// them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/support/program.hpp"
#include "tests/support/temporary_folder.hpp"

namespace stridor {
namespace {

using namespace test;
using ::testing::HasSubstr;
using Json = nlohmann::json;
using Arguments = std::vector<std::string>;

Json law_json(const Arguments& arguments) {
  const ProgramResult result = Program(arguments).run();
  EXPECT_EQ(result.exit_code, 0) << result.err;
  return Json::parse(result.out);
}

const std::string sphere_scene = "viscoelastic_sphere.yaml";

TEST(LawsProgram, MapOfAMassInClosedFormIsThatOfThePencil) {
  for (const auto& [tau0, v] : {std::pair("1e-2", "5e-3"), std::pair("3e-2", "1e-3")}) {
    const Json map = law_json({"map", scene_path(sphere_scene), "--json", "--x", "parameters.tau0",
                               tau0, "0.1", "2", "--y", "parameters.v", v, "1", "2"});
    for (const char* about : {"undeformed", "deformed"}) {
      const Json eig = law_json({"eig", scene_path(sphere_scene), "--about", about, "--json",
                                 "--set", std::string("parameters.tau0=") + tau0, "--set",
                                 std::string("parameters.v=") + v});
      double growth = -1e300;
      for (const Json& s : eig["eigenvalues"]) growth = std::max(growth, s[0].get<double>());
      EXPECT_NEAR(map["growth"][0][0].get<double>(), growth, 1e-10) << about;
    }
  }
}

TEST(LawsProgram, ThresholdOfAMassInClosedFormIsThatOfThePencil) {
  const Arguments range{"--parameter", "parameters.v", "--from", "1e-3", "--to", "1"};
  const auto with_range = [&](Arguments arguments) {
    arguments.insert(arguments.end(), range.begin(), range.end());
    return law_json(arguments);
  };
  const Json own = with_range({"threshold", scene_path(sphere_scene), "--json"});
  const Json locus = with_range({"locus", scene_path(sphere_scene), "--json"});
  ASSERT_EQ(own["roots"].size(), 1u);
  const double expected = own["roots"][0]["value"];
  double last = 0.0;
  for (const Json& window : locus["unstable"]) last = std::max(last, window["to"].get<double>());
  EXPECT_NEAR(last, expected, 1e-9 * expected);
}

TEST(LawsProgram, FixedStepsComeToTheLimitCycleOfTheEvents) {
  // Steps of 2e-3/omega_x err by 2e-3 of the period and of the stick.
  const TemporaryFolder folder;
  const Json cycle = law_json({"cycle", scene_path(sphere_scene), "--json"});
  const Json run = law_json(
      {"run", scene_path("examples/sphere_on_rubber.yaml"), "-o", folder / "sphere.h5", "--json"});
  EXPECT_NEAR(run["stick_fraction"].get<double>(), cycle["stick_fraction"].get<double>(), 5e-3);
}

TEST(LawsProgram, MassOnABeltSticksAndSlipsAsInClosedForm) {
  const TemporaryFolder folder;
  const ProgramResult result = Program({"run", scene_path("examples/mass_on_belt.yaml"), "-o",
                                        folder / "belt.h5", "--verify"})
                                   .run();
  EXPECT_EQ(result.exit_code, 0) << result.out << result.err;
}

TEST(LawsProgram, ABeltBelowABeamDoesWhatDraggingTheBeamDoes) {
  const TemporaryFolder folder;
  const auto run = [&](const std::string& file, const Arguments& more) {
    Arguments arguments{"run",
                        scene_path("examples/stick_slip.yaml"),
                        "-o",
                        folder / file,
                        "--json",
                        "--set",
                        "drive.ramp=0",
                        "--set",
                        "time.end=0.05",
                        "--set",
                        "measure.from=0.01"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return law_json(arguments);
  };
  const Json dragged = run("dragged.h5", {"--set", "drive.velocity=50 mm/s"});
  const Json belt =
      run("belt.h5", {"--set", "drive.moves=contact.master", "--set", "drive.velocity=-50 mm/s"});
  for (const char* extreme : {"min", "max"}) {
    const double force = dragged["contact_force"][extreme];
    EXPECT_NEAR(belt["contact_force"][extreme].get<double>(), force, 1e-6 * force);
  }
  EXPECT_NEAR(belt["stick_fraction"].get<double>(), dragged["stick_fraction"].get<double>(), 1e-5);
  EXPECT_GT(dragged["stick_fraction"].get<double>(), 0.1);
  EXPECT_LT(dragged["stick_fraction"].get<double>(), 1.0);
}

TEST(LawsProgram, ALoadOnAPointBendsTheBodyThere) {
  // The guided end carries no load then, and the tip presses with its own weightless beam alone.
  const std::string scene = scene_path("beam_on_beam.yaml");
  const auto tip_of = [&](const Arguments& more) {
    Arguments arguments{
        "eig", scene, "--about", "deformed", "--json", "--set", "contact.friction.coefficient=0"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return law_json(arguments)["equilibrium"]["force"].get<double>();
  };
  // A force on the tip itself, which is held by the contact alone, goes into the contact.
  EXPECT_NEAR(tip_of({"--set", "drive.load_on=oblique.tip"}), tip_of({}), 2e-3 * tip_of({}));
}

TEST(LawsProgram, RegularisedBeltHasTheEquilibriumOfItsLaw) {
  // With friction that creeps there is no stick, and the mass rests where the spring holds it.
  const TemporaryFolder folder;
  const Json run =
      law_json({"run", scene_path("examples/mass_on_belt.yaml"), "-o", folder / "belt.h5", "--json",
                "--set", "contact.friction={coefficient: 0.3, regularisation: {speed: 0.2}}",
                "--set", "substructures.slider.damping.alpha=3"});
  EXPECT_EQ(run["stick_fraction"].get<double>(), 0.0);
  const Json eig =
      law_json({"eig", scene_path("examples/mass_on_belt.yaml"), "--about", "deformed", "--json",
                "--set", "contact.friction={coefficient: 0.3, regularisation: {speed: 0.2}}"});
  // s² + (μ N s'(v)/m) s + k/m = 0 with v = 0.1, v_ε = 0.2.
  const double slope = 3.0 * (1.0 - std::pow(std::tanh(0.5), 2)) / 0.2;
  const std::complex<double> root =
      -0.5 * slope + std::sqrt(std::complex<double>(0.25 * slope * slope - 100.0, 0.0));
  double nearest = 1e300;
  for (const Json& one : eig["eigenvalues"]) {
    nearest = std::min(
        nearest, std::abs(std::complex<double>(one[0].get<double>(), one[1].get<double>()) - root));
  }
  EXPECT_LT(nearest, 1e-8);
}

TEST(LawsProgram, PenaltyOnBeamsGivesTheSpringsCompression) {
  const std::string scene = scene_path("beam_on_beam.yaml");
  const Arguments penalty{"--set", "contact.normal={law: penalty, stiffness: 1 MN/m}"};
  Arguments eig{"eig", scene, "--about", "deformed", "--json"};
  eig.insert(eig.end(), penalty.begin(), penalty.end());
  const Json state = law_json(eig)["equilibrium"];
  EXPECT_NEAR(state["gap"].get<double>(), -state["force"].get<double>() / 1e6, 1e-15);
  const TemporaryFolder folder;
  Arguments run{"run",
                scene,
                "-o",
                folder / "beams.h5",
                "--json",
                "--set",
                "time.end=0.02",
                "--set",
                "contact.armed_from=0.01",
                "--set",
                "measure.from=0.01",
                "--set",
                "time.step=2e-7"};
  Arguments rigid = run;
  rigid[3] = folder / "rigid.h5";
  run.insert(run.end(), penalty.begin(), penalty.end());
  const double sprung_force = law_json(run)["contact_force"]["max"];
  const double rigid_force = law_json(rigid)["contact_force"]["max"];
  EXPECT_NEAR(sprung_force, rigid_force, 0.1 * rigid_force);
  EXPECT_NE(sprung_force, rigid_force);
}

TEST(LawsProgram, LawsThatDoNotGoTogetherAreRefusedWithTheReason) {
  const auto refusal = [](const std::string& scene, const Arguments& sets) {
    Arguments arguments{"check", scene_path(scene)};
    for (const std::string& set : sets) arguments.insert(arguments.end(), {"--set", set});
    const ProgramResult result = Program(arguments).run();
    EXPECT_EQ(result.exit_code, 2) << result.out;
    return result.out + result.err;
  };
  EXPECT_THAT(
      refusal("examples/mass_on_belt.yaml", {"contact.friction={law: shear, strength: 1}"}),
      HasSubstr("has no area of contact, with which the friction law shear is in proportion"));
  EXPECT_THAT(refusal("examples/mass_on_belt.yaml", {"drive.moves=contact.slave"}),
              HasSubstr("there is no 'contact.slave' to move"));
  EXPECT_THAT(refusal("beam_on_beam.yaml", {"drive.moves=contact.master"}),
              HasSubstr("'cantilever.top' is the surface of a body"));
  EXPECT_THAT(refusal("beam_on_beam.yaml", {"drive.load_on=oblique.tipp"}),
              HasSubstr("did you mean 'tip'"));
  EXPECT_THAT(refusal("examples/beam_on_substrate.yaml", {"contact.master=rigid"}),
              HasSubstr("must be `half_space` with the viscoelastic normal law"));
  EXPECT_THAT(refusal("examples/beam_on_substrate.yaml", {"contact.substrate={radius: 2 mm}"}),
              HasSubstr("substrate"));
}

}  // namespace
}  // namespace stridor
