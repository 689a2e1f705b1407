// Set-up: what does not fit into memory is refused before it begins, and a signal ends the rest.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>
#include <vector>

#include "tests/support/program.hpp"

namespace stridor::test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using Strings = std::vector<std::string>;

constexpr rlim_t gigabyte = 1'000'000'000;

/// A mesh that fits into memory and whose set-up takes a minute or more.
Strings with_long_set_up(Strings command) {
  command.insert(command.end(), {"--set", "substructures.cantilever.mesh.along=4000", "--set",
                                 "substructures.cantilever.mesh.through=8", "--set",
                                 "substructures.cantilever.reduction.fixed_interface_modes=200"});
  return command;
}

TEST(SetUpProgram, WhatDoesNotFitIntoMemoryIsRefusedBeforeItBegins) {
  const std::string scene = scene_path("beam_on_beam.yaml");
  for (const Strings& verb : {Strings{"check", scene}, {"eig", scene}, {"run", scene, "-o", "x"}}) {
    Strings command = verb;
    command.insert(command.end(), {"--set", "substructures.cantilever.mesh.along=900000"});
    const auto start = std::chrono::steady_clock::now();
    const ProgramResult result = Program(command).with_memory_limit(20 * gigabyte).run();
    EXPECT_EQ(result.exit_code, 2) << verb[0];
    EXPECT_THAT(result.err,
                AllOf(HasSubstr("substructures.cantilever.mesh.along"),
                      HasSubstr("the limit of its address space (ulimit -v) is 20 GB"),
                      HasSubstr("of 9e+06 unknowns"), HasSubstr("take fewer elements")));
    EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(10));
  }
}

TEST(SetUpProgram, ResultsThatDoNotFitIntoMemoryAreRefusedBeforeTheFirst) {
  const auto refusal = [](Strings command) {
    command.insert(command.begin() + 1, scene_path("examples/flutter.yaml"));
    for (const char* set : {"parameters.damping=0",
                            "substructures.oscillator.damping=[[=damping, 0], [0, =damping]]"})
      command.insert(command.end(), {"--set", set});
    const ProgramResult result =
        Program(std::move(command)).with_memory_limit(gigabyte * 9 / 10).run();
    EXPECT_EQ(result.exit_code, 2) << result.err;
    return result.err;
  };
  const std::string load = "parameters.load";
  const std::string damping = "parameters.damping";
  for (const char* verb : {"locus", "threshold"}) {
    EXPECT_THAT(
        refusal({verb, "--parameter", load, "--from", "0", "--to", "0.3", "--points", "1000000"}),
        AllOf(HasSubstr("--points: 2 eigenvalues at 1000000 values would take about 1 GB"),
              HasSubstr("ask for fewer")));
  }
  EXPECT_THAT(refusal({"map", "--x", load, "0", "0.3", "30000", "--y", damping, "0", "1", "30000"}),
              HasSubstr("--x: a map of 30000 times 30000 points would take about"));
}

TEST(SetUpProgram, DiscsAndContactsAreRefusedLikewise) {
  const auto refusal = [](Strings command) {
    const ProgramResult result = Program(std::move(command)).with_memory_limit(3 * gigabyte).run();
    EXPECT_EQ(result.exit_code, 2) << result.err;
    return result.err;
  };
  EXPECT_THAT(refusal({"eig", scene_path("disc_and_pads.yaml"), "--set",
                       "substructures.disc.nodal_diameters=200", "--set",
                       "substructures.disc.radial_modes=40", "--set",
                       "substructures.disc.radial_terms=40"}),
              HasSubstr("substructures.disc.nodal_diameters"));
  EXPECT_THAT(refusal({"check", scene_path("examples/elastic_pads.yaml"), "--set",
                       "substructures.upper.mesh.along=900000"}),
              HasSubstr("substructures.upper.mesh"));
  EXPECT_THAT(refusal({"contact", scene_path("viscoelastic_contact.yaml"), "--set",
                       "contacts.tip.normal.solver.grid=4096"}),
              HasSubstr("contacts.tip.normal.solver.grid"));
}

TEST(SetUpProgram, ARecordOfAnyLengthIsAllowed) {
  // 50,000 million samples: they are summed up in blocks.
  const ProgramResult result = Program({"check", scene_path("beam_on_beam.yaml"), "--set",
                                        "time.end=10000", "--set", "record.interval=2e-7"})
                                   .with_memory_limit(3 * gigabyte)
                                   .run();
  EXPECT_EQ(result.exit_code, 0) << result.err;
}

TEST(SetUpProgram, HearsASignalWhateverItIsAt) {
  const TemporaryFolder folder;
  const std::string scene = scene_path("beam_on_beam.yaml");
  const std::string file = (folder / "run.h5").string();
  // At several moments: while matrices are assembled, factorised, reduced.
  int delay_ms = 50;
  for (const Strings& verb : {Strings{"check", scene},
                              {"run", scene, "-o", file},
                              {"eig", scene},
                              {"threshold", scene, "--from", "30mm", "--to", "31mm"},
                              {"compare", scene}}) {
    Program program(with_long_set_up(verb));
    program.start();
    std::this_thread::sleep_for(std::chrono::milliseconds(delay_ms));
    delay_ms += 400;
    const auto asked = std::chrono::steady_clock::now();
    program.send(SIGTERM);
    const ProgramResult result = program.wait();
    EXPECT_EQ(result.exit_code, 5) << verb[0] << result.err;
    EXPECT_THAT(result.err, HasSubstr("stopped on request")) << verb[0];
    // At once or nearly so, but a busy machine takes its time.
    EXPECT_LT(std::chrono::steady_clock::now() - asked, std::chrono::seconds(20)) << verb[0];
    EXPECT_TRUE(folder.files().empty()) << verb[0];
  }
}

TEST(SetUpProgram, ASignalIsToldAsJsonWhereThatIsAskedFor) {
  Program program(with_long_set_up({"eig", scene_path("beam_on_beam.yaml"), "--json"}));
  program.start();
  std::this_thread::sleep_for(std::chrono::milliseconds(100));
  program.send(SIGINT);
  const ProgramResult result = program.wait();
  EXPECT_EQ(result.exit_code, 5) << result.err;
  EXPECT_THAT(nlohmann::json::parse(result.out)["errors"][0]["message"].get<std::string>(),
              HasSubstr("stopped on request"));
}

}  // namespace
}  // namespace stridor::test
