// Runs that start from the end of another one: `initial: {state: FILE}`.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include "io/run_file/run_file.hpp"
#include "tests/support/program.hpp"

namespace stridor {
namespace {

using namespace test;
using ::testing::HasSubstr;

const std::string bridge = "examples/clamped_bridge.yaml";
const std::vector<std::string> continued{"--set", "drive.ramp=0", "--set", "time.end=0.01"};

std::vector<std::string> run_of(const std::string& scene, const std::string& file,
                                const std::vector<std::string>& options) {
  std::vector<std::string> arguments{"run", scene, "-o", file};
  arguments.insert(arguments.end(), options.begin(), options.end());
  return arguments;
}

void expect_run(const std::string& scene, const std::string& file,
                const std::vector<std::string>& options) {
  const ProgramResult result = Program(run_of(scene, file, options)).run();
  EXPECT_EQ(result.exit_code, 0) << result.err;
}

/// Largest difference of two final motions of a body, over the largest value of the first.
double largest_difference(const RunFileReader& a, const RunFileReader& b,
                          const std::string& dataset) {
  const std::vector<double> x = a.static_array("/final/" + dataset);
  const std::vector<double> y = b.static_array("/final/" + dataset);
  EXPECT_EQ(x.size(), y.size());
  double largest = 0.0;
  double apart = 0.0;
  for (std::size_t i = 0; i < std::min(x.size(), y.size()); ++i) {
    largest = std::max(largest, std::abs(x[i]));
    apart = std::max(apart, std::abs(x[i] - y[i]));
  }
  return apart / largest;
}

struct Continuation {
  const char* name;
  std::vector<std::string> settings;
};

void PrintTo(const Continuation& one, std::ostream* stream) {
  *stream << one.name;
}

class ContinuationTest : public ::testing::TestWithParam<Continuation> {};

TEST_P(ContinuationTest, GoesOnAsTheRunWouldHave) {
  const TemporaryFolder folder;
  const std::string straight = (folder / "straight.h5").string();
  const std::string first = (folder / "first.h5").string();
  const std::string second = (folder / "second.h5").string();
  const std::string scene = scene_path(bridge);
  std::vector<std::string> long_run = GetParam().settings;
  long_run.insert(long_run.end(), {"--set", "time.end=0.06"});
  std::vector<std::string> rest = GetParam().settings;
  rest.insert(rest.end(), continued.begin(), continued.end());
  rest.insert(rest.end(), {"--set", "initial.state=" + first, "--set", "measure.from=0"});
  expect_run(scene, straight, long_run);
  expect_run(scene, first, GetParam().settings);
  expect_run(scene, second, rest);
  const RunFileReader a(straight);
  const RunFileReader b(second);
  // 0.1 m/s over 60 ms, of which the ramp of 20 ms counts half.
  EXPECT_NEAR(a.static_array("/final/drive_displacement").at(0), 5e-3, 1e-12);
  EXPECT_NEAR(b.static_array("/final/drive_displacement").at(0), 5e-3, 1e-12);
  // The first step of the central difference starts from a displacement and a velocity instead of
  // two displacements: an error of second order in the step, (omega h)^2 of what still vibrates.
  for (const char* body : {"arm", "bridge"})
    EXPECT_LT(largest_difference(a, b, std::string(body) + "/displacement"), 1e-6) << body;
}

INSTANTIATE_TEST_SUITE_P(Scenes, ContinuationTest,
                         ::testing::Values(Continuation{"flat", {}},
                                           Continuation{
                                               "sloping, stick and slip",
                                               {"--set", "substructures.bridge.angle=3 deg",
                                                "--set", "contact.assumption=film"}}));

TEST(Continuation, EveryDriveGoesOnFromWhereItWas) {
  const TemporaryFolder folder;
  const std::string scene = scene_path("examples/opposite_drives.yaml");
  const std::string straight = (folder / "straight.h5").string();
  const std::string first = (folder / "first.h5").string();
  const std::string second = (folder / "second.h5").string();
  expect_run(scene, straight, {"--set", "time.end=20"});
  expect_run(scene, first, {});
  std::vector<std::string> rest{"--set", "initial.state=" + first};
  for (const char* drive : {"belt", "feed", "piston"})
    rest.insert(rest.end(), {"--set", std::string("drives.") + drive + ".ramp=0"});
  expect_run(scene, second, rest);
  const RunFileReader a(straight);
  const RunFileReader b(second);
  for (const RunFileReader* file : {&a, &b}) {
    // Less half of the ramp of 0.1 s.
    const std::vector<double> displaced = file->static_array("/final/drive_displacement");
    ASSERT_EQ(displaced.size(), 3);
    EXPECT_NEAR(displaced[0], -0.2 * 19.95, 1e-12);
    EXPECT_NEAR(displaced[1], 0.3 * 19.95, 1e-12);
    EXPECT_EQ(displaced[2], 0.0);
  }
  EXPECT_LT(largest_difference(a, b, "slider/displacement"), 1e-9);
}

TEST(Continuation, PathInASceneIsFromItsFolder) {
  const TemporaryFolder folder;
  const std::string scene = (folder / "scene.yaml").string();
  const std::string text = contents_of(scene_path(bridge));
  write_file(scene, text + "initial: {state: start.h5}\n");
  std::vector<std::string> options = continued;
  options.insert(options.end(), {"--set", "measure.from=0"});
  const ProgramResult missing =
      Program(run_of(scene, (folder / "missing.h5").string(), options)).run();
  EXPECT_EQ(missing.exit_code, 4);
  EXPECT_THAT(missing.err, HasSubstr((folder / "start.h5").string() + ": cannot be opened"));
  EXPECT_EQ(Program({"check", scene, "--set", "drive.ramp=0"}).run().exit_code, 4);

  expect_run(scene_path(bridge), (folder / "start.h5").string(), {});
  expect_run(scene, (folder / "second.h5").string(), options);

  options.insert(options.end(), {"--set", "initial.state=start.h5"});
  const ProgramResult elsewhere =
      Program(run_of(scene, (folder / "third.h5").string(), options)).run();
  EXPECT_EQ(elsewhere.exit_code, 4);
  EXPECT_THAT(elsewhere.err, HasSubstr("start.h5: cannot be opened"));
}

/// @param state of the start; a run that is stopped and goes on finds it no more
void expect_bitwise_resume(const std::string& state) {
  const TemporaryFolder folder;
  const std::string whole = (folder / "whole.h5").string();
  const std::string stopped = (folder / "stopped.h5").string();
  std::vector<std::string> options{"--set", "drive.ramp=0",   "--set", "initial.state=" + state,
                                   "--set", "measure.from=0", "--set", "time.end=0.4"};
  expect_run(scene_path(bridge), whole, options);
  options.insert(options.end(), {"--max-wall", "0.05"});
  EXPECT_EQ(Program(run_of(scene_path(bridge), stopped, options)).run().exit_code, 5);
  std::filesystem::remove(state);
  const ProgramResult resumed = Program({"run", "--resume", stopped}).run();
  ASSERT_EQ(resumed.exit_code, 0) << resumed.err;
  const RunFileReader a(whole);
  const RunFileReader b(stopped);
  EXPECT_EQ(a.series("/contact/contact/position"), b.series("/contact/contact/position"));
  EXPECT_EQ(a.series("/contact/contact/force"), b.series("/contact/contact/force"));
  for (const char* dataset : {"/final/bridge/displacement", "/final/drive_displacement"})
    EXPECT_EQ(a.static_array(dataset), b.static_array(dataset));
}

TEST(Continuation, OtherBodiesAreRefused) {
  const TemporaryFolder folder;
  const auto refusal = [&](const std::string& scene, const std::vector<std::string>& options) {
    const std::string start = (folder / "start.h5").string();
    std::vector<std::string> first = options;
    first.emplace_back("--force");
    expect_run(scene, start, first);
    std::vector<std::string> rest = continued;
    rest.insert(rest.end(), {"--set", "initial.state=" + start, "--set", "measure.from=0"});
    const std::string file = (folder / "second.h5").string();
    const ProgramResult result = Program(run_of(scene_path(bridge), file, rest)).run();
    EXPECT_EQ(result.exit_code, 2);
    EXPECT_FALSE(std::filesystem::exists(file));
    EXPECT_THAT(result.err, HasSubstr("initial.state: " + start + " cannot start '"));
    return result.err;
  };
  EXPECT_THAT(refusal(scene_path(bridge), {"--set", "substructures.bridge.thickness=4.1 mm"}),
              HasSubstr("'bridge': mode 1 of its body has"));
  EXPECT_THAT(refusal(scene_path(bridge),
                      {"--set", "substructures.bridge.reduction.fixed_interface_modes=3"}),
              HasSubstr(" modes, this one "));
  EXPECT_THAT(refusal(scene_path("examples/stick_slip.yaml"), {"--set", "time.end=0.2"}),
              HasSubstr("it holds no body of that name"));
}

TEST(Continuation, IsResumedBitwiseWithoutTheFileItBeganFrom) {
  const TemporaryFolder folder;
  const std::string start = (folder / "start.h5").string();
  expect_run(scene_path(bridge), start, {});
  expect_bitwise_resume(start);
}

TEST(Continuation, RunsFromAnEquilibriumAreResumedBitwise) {
  expect_bitwise_resume("equilibrium");
}

}  // namespace
}  // namespace stridor
