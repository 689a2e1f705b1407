// The number of threads changes no bit of a result, and neither does a second run.
#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "tests/support/program.hpp"

namespace stridor {
namespace {

using namespace test;

struct Case {
  std::string name;
  std::vector<std::string> arguments;
};

class Determinism : public ::testing::TestWithParam<Case> {};

/// What the verb prints; numbers are printed with all their digits.
std::string printed(const Case& one, const std::string& threads) {
  std::vector<std::string> arguments = one.arguments;
  arguments.insert(arguments.end(), {"--json", "--threads", threads});
  const ProgramResult result = Program(arguments).run();
  EXPECT_EQ(result.exit_code, 0) << result.err;
  return result.out;
}

TEST_P(Determinism, ThreadsDoNotChangeTheResult) {
  const std::string alone = printed(GetParam(), "1");
  ASSERT_GT(alone.size(), 300u);
  for (const char* threads : {"2", "2", "5"}) EXPECT_EQ(printed(GetParam(), threads), alone);
  EXPECT_EQ(printed(GetParam(), "1"), alone);
}

const std::string beams = scene_path("beam_on_beam.yaml");
const std::string sphere = scene_path("viscoelastic_sphere.yaml");
const std::string disc = scene_path("disc_and_pads.yaml");

INSTANTIATE_TEST_SUITE_P(
    Verbs, Determinism,
    ::testing::Values(
        Case{"locus_of_beams",
             {"locus", beams, "--from", "30mm", "--to", "98mm", "--points", "40"}},
        Case{"locus_of_deformed_beams",
             {"locus", beams, "--from", "60mm", "--to", "64mm", "--points", "5", "--about",
              "deformed"}},
        Case{"map_of_beams",
             {"map", beams, "--x", "contact.start", "40mm", "60mm", "5", "--y",
              "contact.friction.coefficient", "0.1", "0.5", "4"}},
        Case{"map_of_deformed_beams",
             {"map", beams, "--x", "contact.start", "60mm", "98mm", "8", "--y",
              "contact.friction.coefficient", "0.1", "0.5", "5", "--about", "deformed"}},
        Case{"map_of_the_sphere",
             {"map", sphere, "--x", "sphere.speed", "1e-5", "1", "9", "--y",
              "sphere.shear_strength", "1e-4", "0.1", "8", "--scale", "log"}},
        Case{"sweep_of_the_sphere",
             {"sweep", sphere, "--parameter", "sphere.shear_strength", "--from", "5e-3", "--to",
              "2e-2", "--points", "4", "--set", "time.settle=50"}},
        Case{"sweep_up_and_down",
             {"sweep", sphere, "--parameter", "sphere.shear_strength", "--from", "5e-3", "--to",
              "2e-2", "--points", "3", "--up-down", "--set", "time.settle=50"}},
        Case{"locus_of_the_disc",
             {"locus", disc, "--parameter", "contact.friction.coefficient", "--from", "0.1", "--to",
              "0.5", "--points", "5"}},
        Case{"map_of_the_disc",
             {"map", disc, "--x", "contact.friction.coefficient", "0.1", "0.5", "4", "--y",
              "disc.speed", "1", "20", "3"}}),
    [](const auto& test) { return test.param.name; });

}  // namespace
}  // namespace stridor
