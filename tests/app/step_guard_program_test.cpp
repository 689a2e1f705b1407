// Runs whose step grows by itself are refused, with a remedy that holds.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/support/program.hpp"

namespace stridor {
namespace {

using namespace test;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;
using Json = nlohmann::json;

/// A mass on two oblique springs that slides on rigid ground: pressed on it, its ω² along x is
/// 100 + 0.8 · 20 (docs/theory.md, 3.7), that of the faster mode of the mass by itself 104.7.
constexpr const char* oblique_springs = R"(format: 2
substructures:
  mass:
    type: matrices
    mass: [[1, 0], [0, 1]]
    damping: [[0.1, 0], [0, 0.1]]
    stiffness: [[100, 20], [20, 20]]
    points:
      foot: {at: [0, 0], x: 1, y: 2}
    guided: {load: 2, translation: [1, 0]}
contact:
  slave: mass.foot
  master: rigid
  assumption: subs_a
  start: 0
  armed_from: 1000
  friction: {coefficient: 0.8}
drive: {velocity: 1 m/s, load: -1, ramp: 1}
time: {step: 0.19, end: 190}
record:
  interval: 0.38
  channels: [mass.foot.x.displacement, contact.force]
measure: {from: 181}
)";

/// The value after a key in a message.
double value_after(const std::string& text, const std::string& key) {
  const std::size_t at = text.find(key);
  return at == std::string::npos ? std::nan("") : std::stod(text.substr(at + key.size()));
}

struct GuardedScene {
  TemporaryFolder folder;
  std::string path = folder / "scene.yaml";

  GuardedScene() { write_file(path, oblique_springs); }
  ProgramResult operator()(const std::string& verb, std::vector<std::string> more) const {
    std::vector<std::string> arguments{verb, path};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return Program(arguments).run();
  }
};

TEST(StepGuard, RefusesARunWhoseStepGrowsThoughItsBodiesDecay) {
  const GuardedScene scene;
  const std::string output = scene.folder / "run.h5";
  const ProgramResult refused = scene("run", {"-o", output});
  EXPECT_EQ(refused.exit_code, 3);
  // z + 1/z (1 − h c) + h c − 2 + h² 116 = 0 with h = 0.19 and c = 0.1.
  const double half = 0.5 * (2.0 - 0.019 - 0.19 * 0.19 * 116.0);
  const double growth = std::log(-half + std::sqrt(half * half - 0.981)) / 0.19;
  EXPECT_NEAR(value_after(refused.err, "grows by "), growth, 1e-3 * growth) << refused.err;
  EXPECT_THAT(
      refused.err,
      AllOf(HasSubstr("time.step: with a step of 0.19 s a motion of 2.632 Hz grows by"),
            HasSubstr("'contact' sliding at 0 m of its master"),
            HasSubstr("the bodies in contact do not grow"), HasSubstr("take time.step: 0.095, ")));
  EXPECT_FALSE(std::filesystem::exists(output));

  const ProgramResult check = scene("check", {});
  EXPECT_EQ(check.exit_code, 3);
  EXPECT_EQ(check.err, refused.err);

  const ProgramResult cured = scene("run", {"-o", output, "--json", "--set", "time.step=0.095"});
  EXPECT_EQ(cured.exit_code, 0) << cured.err;
  // It comes to rest where friction pushes it: λ = 1 + 20 u_x, 100 u_x = −0.8 λ. From the ramp on
  // the rest of the motion decays by e^-9.
  const Json force = Json::parse(cured.out)["contact_force"];
  EXPECT_NEAR(force["min"].get<double>(), 1.0 / 1.16, 1e-3);
  EXPECT_NEAR(force["max"].get<double>(), 1.0 / 1.16, 1e-3);
}

TEST(StepGuard, FailsOnlyTheTransientsOfASweepThatGrow) {
  const GuardedScene scene;
  const std::string output = scene.folder / "sweep";
  const ProgramResult sweep =
      scene("sweep", {"--parameter", "contact.friction.coefficient", "--from", "0", "--to", "0.8",
                      "--points", "2", "-o", output, "--json"});
  EXPECT_THAT(sweep.out, HasSubstr("grows by")) << sweep.err;
}

TEST(StepGuard, RefusesCoarseStepsOfTheTurningSupport) {
  const auto check = [](const std::string& step) {
    return Program({"check", scene_path("examples/rotating_support.yaml"), "--set",
                    "time.step=" + step, "--set", "record.interval=" + step, "--set",
                    "measure.band=[100,1000]"})
        .run();
  };
  const ProgramResult refused = check("4e-4");
  EXPECT_EQ(refused.exit_code, 3);
  EXPECT_NEAR(value_after(refused.err, "grows by "), 12.1, 0.1) << refused.err;
  EXPECT_NEAR(value_after(refused.err, "take time.step: "), 2e-4, 1e-12) << refused.err;
  // At half the step the squeal of 1.12 kHz is that of the bodies.
  const ProgramResult cured = check("2e-4");
  EXPECT_EQ(cured.exit_code, 0) << cured.err;
}

}  // namespace
}  // namespace stridor
