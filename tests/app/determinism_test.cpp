// The number of threads changes no bit of a result, and neither does a second run. These are also
// what the thread sanitizer runs: all that starts threads (core/tasks.hpp), in cases small enough
// for it.
#include <gtest/gtest.h>

#include <csignal>
#include <ostream>
#include <regex>
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

void PrintTo(const Case& one, std::ostream* stream) {
  *stream << one.name;
}

class Determinism : public ::testing::TestWithParam<Case> {};

/// Output of the verb, without the time taken; numbers are printed with all their digits.
std::string printed(const Case& one, const std::string& threads) {
  std::vector<std::string> arguments = one.arguments;
  arguments.insert(arguments.end(), {"--json", "--threads", threads});
  const ProgramResult result = Program(arguments).run();
  EXPECT_EQ(result.exit_code, 0) << result.err;
  static const std::regex cost("\"(wall_s|setup_s|output_s|step_ns)\": [^,\\n]*");
  return std::regex_replace(result.out, cost, "");
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

/// The main scene with few elements and modes, for 10 ms.
Case coarse_beams(std::string name, std::vector<std::string> arguments) {
  for (const char* set :
       {"substructures.oblique.mesh.along=6", "substructures.cantilever.mesh.along=10",
        "substructures.cantilever.interface.spacing=10mm",
        "substructures.oblique.reduction.fixed_interface_modes=6",
        "substructures.cantilever.reduction.fixed_interface_modes=6", "time.integrator=exact",
        "time.step=5e-6", "time.end=0.01", "measure.from=5e-3"}) {
    arguments.insert(arguments.end(), {"--set", set});
  }
  arguments.insert(arguments.begin() + 1, beams);
  return {std::move(name), std::move(arguments)};
}

INSTANTIATE_TEST_SUITE_P(
    CoarseBeams, Determinism,
    ::testing::Values(
        coarse_beams("map", {"map", "--x", "contact.start", "40mm", "60mm", "4", "--y",
                             "contact.friction.coefficient", "0.1", "0.5", "3"}),
        // A load that lifts leaves no equilibrium: a line then goes on value by value.
        coarse_beams("map_with_gaps", {"map", "--x", "drive.load", "-0.1", "0.05", "3", "--y",
                                       "contact.friction.coefficient", "0.2", "0.3", "2", "--about",
                                       "deformed", "--set", "contact.assumption=film"}),
        coarse_beams("map_of_bodies",
                     {"map", "--x", "substructures.cantilever.material.density", "1100", "1300",
                      "2", "--y", "contact.friction.coefficient", "0.1", "0.5", "2"}),
        coarse_beams("sweep_in_batches", {"sweep", "--parameter", "drive.load", "--from", "-0.3",
                                          "--to", "-0.1", "--points", "24"}),
        coarse_beams("sweep_with_lift_off",
                     {"sweep", "--parameter", "drive.load", "--from", "-0.3", "--to", "-0.1",
                      "--points", "6", "--set", "contact.assumption=film"}),
        coarse_beams("sweep_with_failures",
                     {"sweep", "--parameter", "contact.friction.coefficient", "--from", "0.3",
                      "--to", "6", "--points", "6", "--set", "drive.ramp=1ms"}),
        coarse_beams("sweep_of_shapes",
                     {"sweep", "--parameter", "substructures.cantilever.thickness", "--from",
                      "1.8mm", "--to", "2.2mm", "--points", "6"})),
    [](const auto& test) { return test.param.name; });

INSTANTIATE_TEST_SUITE_P(
    Spheres, Determinism,
    ::testing::Values(Case{"map",
                           {"map", sphere, "--x", "parameters.v", "1e-5", "1", "9", "--y",
                            "parameters.tau0", "1e-4", "0.1", "8", "--scale", "log"}},
                      Case{"sweep",
                           {"sweep", sphere, "--parameter", "parameters.tau0", "--from", "5e-3",
                            "--to", "2e-2", "--points", "4", "--set", "cycle.settle=1.25"}},
                      Case{"sweep_up_and_down",
                           {"sweep", sphere, "--parameter", "parameters.tau0", "--from", "5e-3",
                            "--to", "2e-2", "--points", "3", "--up-down", "--set",
                            "cycle.settle=1.25"}}),
    [](const auto& test) { return test.param.name; });

// Too slow for the sanitizer, or in one thread whatever is asked for.
INSTANTIATE_TEST_SUITE_P(
    Verbs, Determinism,
    ::testing::Values(Case{"locus_of_beams",
                           {"locus", beams, "--from", "30mm", "--to", "98mm", "--points", "40"}},
                      Case{"locus_of_deformed_beams",
                           {"locus", beams, "--from", "60mm", "--to", "64mm", "--points", "5",
                            "--about", "deformed"}},
                      Case{"map_of_beams",
                           {"map", beams, "--x", "contact.start", "40mm", "60mm", "5", "--y",
                            "contact.friction.coefficient", "0.1", "0.5", "4"}},
                      Case{"map_of_deformed_beams",
                           {"map", beams, "--x", "contact.start", "60mm", "98mm", "8", "--y",
                            "contact.friction.coefficient", "0.1", "0.5", "5", "--about",
                            "deformed"}},
                      Case{"locus_of_the_disc",
                           {"locus", disc, "--parameter", "parameters.mu", "--from",
                            "0.1", "--to", "0.5", "--points", "5"}},
                      Case{"map_of_the_disc",
                           {"map", disc, "--x", "parameters.mu", "0.1", "0.5", "4",
                            "--y", "substructures.disc.spin", "1", "20", "3"}}),
    [](const auto& test) { return test.param.name; });

TEST(Threads, AreStoppedByASignal) {
  const std::vector<std::vector<std::string>> verbs{
      coarse_beams("", {"map", "--x", "contact.start", "30mm", "98mm", "1000", "--y",
                        "contact.friction.coefficient", "0", "1", "1000"})
          .arguments,
      coarse_beams("", {"sweep", "--parameter", "drive.load", "--from", "-0.3", "--to", "-0.1",
                        "--points", "24", "--set", "time.end=1000"})
          .arguments,
      {"map", sphere, "--x", "parameters.v", "1e-5", "1", "3000", "--y", "parameters.tau0", "1e-4",
       "0.1", "3000", "--scale", "log"},
      {"sweep", sphere, "--parameter", "parameters.tau0", "--from", "5e-3", "--to", "2e-2",
       "--points", "1000", "--set", "cycle.settle=25"}};
  for (std::vector<std::string> arguments : verbs) {
    arguments.insert(arguments.end(), {"--threads", "3"});
    Program program(arguments);
    program.start();
    for (int i = 0; i < 60'000 && program.num_threads() < 3; ++i) usleep(1000);
    program.send(SIGINT);
    const ProgramResult result = program.wait();
    EXPECT_EQ(result.exit_code, 5) << arguments[0] << result.err;
    EXPECT_NE(result.err.find("nothing has been written"), std::string::npos) << result.err;
    EXPECT_TRUE(result.out.empty()) << result.out;
  }
}

}  // namespace
}  // namespace stridor
