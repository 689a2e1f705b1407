// The program from outside: verbs, exit codes, messages, and what is left on disk.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <thread>

#include "io/run_file/run_file.hpp"
#include "tests/support/program.hpp"

namespace stridor {
namespace {

using namespace test;
using ::testing::AllOf;
using ::testing::ContainsRegex;
using ::testing::HasSubstr;
using ::testing::Not;
using Json = nlohmann::json;

const std::string main_scene = scene_path("beam_on_beam.yaml");

/// Arguments of a run of 1 ms.
std::vector<std::string> short_run(const std::filesystem::path& output,
                                   std::vector<std::string> more = {}) {
  std::vector<std::string> arguments{"run",   main_scene,      "-o",    output.string(),
                                     "--set", "time.end=1e-3", "--set", "measure.from=5e-4"};
  arguments.insert(arguments.end(), more.begin(), more.end());
  return arguments;
}

TEST(Program, RunPrintsOneJsonObjectWithThePromisedKeys) {
  const TemporaryFolder folder;
  const ProgramResult result = Program(short_run(folder / "a.h5", {"--json"})).run();
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const Json object = Json::parse(result.out);
  for (const char* key :
       {"steps", "step", "step_limit", "wall_s", "setup_s", "output_s", "step_ns", "contact_force",
        "free_end_acceleration", "violations", "bursts", "energy_error", "status"}) {
    EXPECT_TRUE(object.contains(key)) << key;
  }
  EXPECT_EQ(object["status"], "done");
  EXPECT_EQ(object["step"], 2e-7);
  EXPECT_NEAR(object["step_limit"].get<double>(), 2.916e-7, 5e-11);
  EXPECT_GE(object["steps"].get<int>(), 5000);
  EXPECT_TRUE(object["contact_force"]["min"].is_number());
  EXPECT_TRUE(object["free_end_acceleration"]["peak"].is_number());
}

TEST(Program, StatisticsAreNullWhereTheWindowIsEmpty) {
  const TemporaryFolder folder;
  const ProgramResult result =
      Program(short_run(folder / "a.h5", {"--json", "--set", "measure.from=1"})).run();
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const Json object = Json::parse(result.out);
  EXPECT_TRUE(object["contact_force"]["min"].is_null());
  EXPECT_TRUE(object["free_end_acceleration"].is_null());
}

TEST(Program, BurstsAboveWhatTheBodiesResolveAreCalledDoubtful) {
  const TemporaryFolder folder;
  const auto run = [&](const char* modes) {
    return Program({"run", scene_path("beam_on_beam.yaml"), "-o", (folder / "a.h5").string(), "--force", "--set",
                    "time.integrator=exact", "--set", "time.step=5e-6", "--set",
                    std::string("substructures.oblique.reduction.fixed_interface_modes=") + modes})
        .run();
  };
  // Half of the highest mode kept of the three of the oblique beam is 3286 Hz, of ten far more; bursts are at 3.5 kHz.
  EXPECT_THAT(run("3").out,
              ContainsRegex("\ndoubtful +3 bursts above 3286.12 Hz, more than the bodies resolve"));
  EXPECT_THAT(run("10").out, AllOf(ContainsRegex("\nburst +"), Not(HasSubstr("doubtful"))));
}

TEST(Program, SummaryNamesTheChannelAndTheBandOfTheAcceleration) {
  const TemporaryFolder folder;
  const ProgramResult banded =
      Program(short_run(folder / "a.h5", {"--set", "measure.from=0"})).run();
  EXPECT_THAT(banded.out, ContainsRegex("acceleration +peak [^ ]+ m/s\\^2, r.m.s. in band [^ ]+ "
                                        "m/s\\^2, of cantilever.free_end.y.acceleration\n"));
  EXPECT_THAT(banded.out, ContainsRegex("\nbursts +none\n"));
  const ProgramResult plain =
      Program(short_run(folder / "b.h5", {"--set", "measure={from: 0}"})).run();
  EXPECT_THAT(plain.out, ContainsRegex("acceleration +peak [^ ]+ m/s\\^2, r.m.s. [0-9.e-]+ m/s"));
  EXPECT_THAT(plain.out, Not(HasSubstr("burst")));
}

TEST(Program, RunFileHoldsTheChannelsAskedForUpToTheEnd) {
  const TemporaryFolder folder;
  ASSERT_EQ(Program(short_run(folder / "a.h5")).run().exit_code, 0);
  const RunFileReader file((folder / "a.h5").string());
  EXPECT_EQ(file.series_names(),
            (std::vector<std::string>{"/channels/cantilever.free_end.y.acceleration",
                                      "/contact/contact/force", "/contact/contact/force_low_passed",
                                      "/contact/contact/force_max", "/contact/contact/force_min",
                                      "/contact/contact/slip_velocity"}));
  ASSERT_EQ(file.times().size(), 101u);
  EXPECT_EQ(file.times().front(), 0.0);
  EXPECT_NEAR(file.times().back(), 1e-3, 1e-15);
  EXPECT_EQ(file.units("/contact/contact/force"), "N");
  EXPECT_EQ(file.static_array("/modal/cantilever/frequency").size(), 220u);
  EXPECT_THAT(file.header().scene_resolved, HasSubstr("end: 0.001"));
  EXPECT_THAT(file.header().scene_text, HasSubstr("end: 2.25"));
  EXPECT_THAT(file.header().command, HasSubstr("--set time.end=1e-3"));
  EXPECT_EQ(std::get<std::string>(file.results().at("status")), "done");
}

TEST(Program, RunsTwiceToBitwiseTheSameData) {
  const TemporaryFolder folder;
  ASSERT_EQ(Program(short_run(folder / "a.h5")).run().exit_code, 0);
  ASSERT_EQ(Program(short_run(folder / "b.h5")).run().exit_code, 0);
  const RunFileReader a((folder / "a.h5").string());
  const RunFileReader b((folder / "b.h5").string());
  for (const std::string& name : a.series_names())
    EXPECT_EQ(a.series(name), b.series(name)) << name;
}

TEST(Program, FinishedFileIsKeptWithoutForceAndReplacedWithIt) {
  const TemporaryFolder folder;
  ASSERT_EQ(Program(short_run(folder / "a.h5")).run().exit_code, 0);
  const std::string before = contents_of(folder / "a.h5");
  const ProgramResult refused =
      Program(short_run(folder / "a.h5", {"--set", "time.end=2e-3"})).run();
  EXPECT_EQ(refused.exit_code, 4);
  EXPECT_THAT(refused.err, HasSubstr("a.h5: exists; use --force to overwrite it"));
  EXPECT_EQ(contents_of(folder / "a.h5"), before);
  const ProgramResult forced =
      Program(short_run(folder / "a.h5", {"--set", "time.end=2e-3", "--force"})).run();
  EXPECT_EQ(forced.exit_code, 0) << forced.err;
  EXPECT_EQ(RunFileReader((folder / "a.h5").string()).times().size(), 201u);
}

TEST(Program, RunTellsWhatItLeavesOut) {
  const TemporaryFolder folder;
  const ProgramResult result =
      Program(
          short_run(folder / "a.h5", {"--json", "--set", "time.integrator=exact", "--set",
                                      "time.step=5e-6", "--set", "time.retain.frequency=30kHz"}))
          .run();
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const nlohmann::json left_out = nlohmann::json::parse(result.out)["left_out"];
  EXPECT_EQ(left_out["modes"]["of"], 243);
  EXPECT_EQ(left_out["modes"]["left_out"], 243 - 29);
  // x and y of the slave; of the 101 nodes of the master two are followed.
  EXPECT_EQ(left_out["contact_rows"]["of"], 2 + 202);
  EXPECT_EQ(left_out["contact_rows"]["left_out"], 202 - 4);
  EXPECT_EQ(left_out["multiplications"]["done"], 9 * (4 + 4) + 20 * (4 + 8));
  EXPECT_EQ(left_out["multiplications"]["of"], 23 * (4 + 4) + 220 * (4 + 404));
  EXPECT_THAT(left_out["rest"].dump(), HasSubstr("stick, slip and lift-off"));
}

TEST(Program, WrongSceneLeavesTheOldFileAlone) {
  const TemporaryFolder folder;
  ASSERT_EQ(Program(short_run(folder / "a.h5")).run().exit_code, 0);
  const std::string before = contents_of(folder / "a.h5");
  EXPECT_EQ(
      Program(short_run(folder / "a.h5", {"--force", "--set", "time.step=1"})).run().exit_code, 2);
  EXPECT_EQ(
      Program(short_run(folder / "a.h5", {"--force", "--set", "contact.start=1"})).run().exit_code,
      2);
  EXPECT_EQ(contents_of(folder / "a.h5"), before);
}

struct BadInput {
  std::vector<std::string> sets;
  std::string message;
};

void PrintTo(const BadInput& input, std::ostream* stream) {
  *stream << input.sets.back();
}

class BadInputTest : public ::testing::TestWithParam<BadInput> {};

TEST_P(BadInputTest, IsRefusedWithPlaceAndRemedyAndLeavesNoFile) {
  const TemporaryFolder folder;
  std::vector<std::string> arguments = short_run(folder / "a.h5");
  for (const std::string& set : GetParam().sets) {
    arguments.push_back("--set");
    arguments.push_back(set);
  }
  const ProgramResult result = Program(arguments).run();
  EXPECT_EQ(result.exit_code, 2) << result.err;
  EXPECT_THAT(result.err, HasSubstr(GetParam().message));
  EXPECT_TRUE(result.out.empty()) << result.out;
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

INSTANTIATE_TEST_SUITE_P(
    Values, BadInputTest,
    ::testing::Values(
        BadInput{{"contact.frction.coefficient=0.3"},
                 "contact.frction: unknown key 'frction', did you mean 'friction'?"},
        BadInput{{"substructures.oblique.length=-75 mm"}, "substructures.oblique.length"},
        BadInput{{"substructures.oblique.length=75 kg"}, "substructures.oblique.length"},
        BadInput{{"substructures.oblique.length=long"}, "substructures.oblique.length"},
        BadInput{{"substructures.oblique.material.density=.nan"},
                 "substructures.oblique.material.density"},
        BadInput{{"substructures.cantilever.material.poissons_ratio=0.5"}, "in (-1, 0.5)"},
        BadInput{{"substructures.cantilever.mesh.along=1.5"},
                 "substructures.cantilever.mesh.along"},
        BadInput{{"substructures.oblique.type=beem"}, "did you mean 'beam'?"},
        BadInput{{"contact.friction.coefficient=-0.1"}, "contact.friction.coefficient"},
        BadInput{{"contact.assumption=subs_d"}, "contact.assumption"},
        BadInput{{"contact.start=101 mm"},
                 "is off the master 'cantilever.top', which is 0.1 m long; allowed: 0 to 0.1 m"},
        BadInput{{"contact.master=cantilever.roof"}, "has no surface 'roof'"},
        BadInput{{"time.step=3e-7", "record.interval=3e-5"},
                 "3e-07 s is above the largest stable step 2.9162e-07 s"},
        BadInput{{"time.step=0"}, "time.step"},
        BadInput{{"time.end=1e-8"}, "time.end: is shorter than one step"},
        BadInput{{"record.interval=3e-7"}, "record.interval: 3e-07 s must be a whole multiple"},
        BadInput{{"record.channels=[cantilever.free_end.y.accelaration]"},
                 "did you mean 'acceleration'?"},
        BadInput{{"record.channels=[cantilever.freeend.y.velocity]"}, "did you mean 'free_end'?"},
        BadInput{{"record.channels=[contact.forse]"}, "did you mean 'force'?"},
        BadInput{{"record.channels=[contact.force, contact.force]"}, "is listed twice"},
        BadInput{{"measure.band=[15 kHz, 2 kHz]"}, "measure.band"},
        BadInput{{"measure.band=[1 kHz, 60 kHz]"}, "resolves only frequencies below 50000 Hz"},
        BadInput{{"drive.velocity={times: [0, 1, 1], values: [0, 1, 2]}"}, "drive.velocity"},
        BadInput{{"format=3"}, "format"}, BadInput{{"time.step"}, "time.step"}));

TEST(Program, EveryErrorOfAFileIsReportedAtOnceWithItsPlace) {
  const TemporaryFolder folder;
  std::string scene = contents_of(main_scene);
  const auto replace = [&](const std::string& from, const std::string& to) {
    scene.replace(scene.find(from), from.size(), to);
  };
  replace("thickness: 1.5 mm", "thicknes: 1.5 mm");
  replace("density: 1200", "density: -1200");
  replace("friction: {coefficient: 0.30}", "friction: {coefficient: 0.30, coefficient: 0.4}");
  write_file(folder / "bad.yaml", scene);
  const ProgramResult text = Program({"check", (folder / "bad.yaml").string()}).run();
  EXPECT_EQ(text.exit_code, 2);
  EXPECT_THAT(text.err, HasSubstr("bad.yaml:12:5: substructures.oblique.thicknes: unknown key "
                                  "'thicknes', did you mean 'thickness'?"));
  const ProgramResult json = Program({"check", (folder / "bad.yaml").string(), "--json"}).run();
  EXPECT_EQ(json.exit_code, 2);
  const Json errors = Json::parse(json.out)["errors"];
  ASSERT_EQ(errors.size(), 4u) << json.out;
  std::vector<int> lines;
  for (const Json& error : errors) lines.push_back(error["line"].get<int>());
  EXPECT_TRUE(std::is_sorted(lines.begin(), lines.end()));
  EXPECT_EQ(errors[3]["key"], "contact.friction.coefficient");
}

TEST(Program, CheckOfTheShippedScenesFindsNothing) {
  for (const char* name : {"beam_on_beam.yaml", "beam_on_beam_leading.yaml"}) {
    const ProgramResult result = Program({"check", scene_path(name), "--json"}).run();
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_EQ(Json::parse(result.out), Json({{"errors", Json::array()}, {"warnings", Json::array()}}));
  }
}

TEST(Program, ContactThatLeavesTheMasterStopsTheRunAndKeepsTheFile) {
  const TemporaryFolder folder;
  const ProgramResult result =
      Program(
          short_run(folder / "a.h5", {"--json", "--set", "time.end=0.02", "--set",
                                      "contact.start=98 mm", "--set", "drive.velocity=1 m/s",
                                      "--set", "drive.ramp=1e-3", "--set", "contact.armed_from=1"}))
          .run();
  EXPECT_EQ(result.exit_code, 3) << result.err;
  EXPECT_THAT(result.err, HasSubstr("has left the end of the surface cantilever.top"));
  EXPECT_THAT(result.err,
              ContainsRegex("mind the [0-9]+ steps without persistent sliding that were "
                            "let pass before contact.armed_from: arm earlier"));
  EXPECT_THAT(result.err, HasSubstr("holds everything up to then"));
  EXPECT_EQ(Json::parse(result.out)["status"], "failed");
  const RunFileReader file((folder / "a.h5").string());
  EXPECT_GT(file.times().back(), 1e-3);
  EXPECT_LT(file.times().back(), 1e-2);
}

TEST(Program, LossOfPersistentSlidingStopsAnArmedRun) {
  const TemporaryFolder folder;
  const ProgramResult result =
      Program(short_run(folder / "a.h5", {"--set", "drive.load=+0.2", "--set", "drive.ramp=1e-4",
                                          "--set", "contact.armed_from=2e-4"}))
          .run();
  EXPECT_EQ(result.exit_code, 3);
  EXPECT_THAT(result.err, HasSubstr("a bilateral contact pulls where real bodies would part"));
  EXPECT_THAT(result.err, HasSubstr("Remedy"));
}

TEST(Program, InterruptClosesTheFileAndExits5) {
  for (const int signal : {SIGINT, SIGTERM}) {
    const TemporaryFolder folder;
    Program program({"run", main_scene, "-o", (folder / "a.h5").string(), "--set", "time.end=1000",
                     "--set", "contact.sliding=frozen"});
    program.start();
    // The file takes its name once set-up is done; then let it compute for a while.
    for (int i = 0; i < 3000 && !std::filesystem::exists(folder / "a.h5"); ++i) {
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(300));
    program.send(signal);
    const ProgramResult result = program.wait();
    EXPECT_EQ(result.exit_code, 5) << result.err;
    EXPECT_THAT(result.err, HasSubstr("stopped on request"));
    EXPECT_THAT(result.err, HasSubstr("It can be resumed:\nstridor run --resume"));
    const RunFileReader file((folder / "a.h5").string());
    EXPECT_GT(file.times().size(), 1u);
    EXPECT_EQ(std::get<std::string>(file.results().at("status")), "stopped");
  }
}

TEST(Program, FullDiskIsReportedAndTheFileStaysReadable) {
  const TemporaryFolder folder;
  const ProgramResult result = Program(short_run(folder / "a.h5", {"--set", "time.end=0.2", "--set",
                                                                   "record.interval=2e-7"}))
                                   .with_file_limit(2'000'000)
                                   .run();
  EXPECT_EQ(result.exit_code, 4) << result.err;
  EXPECT_THAT(result.err, HasSubstr("a.h5"));
  const RunFileReader file((folder / "a.h5").string());
  for (const std::string& name : file.series_names())
    EXPECT_EQ(file.series(name).size(), file.times().size());
}

TEST(Program, UnwritableOutputIsFileTrouble) {
  const TemporaryFolder folder;
  const ProgramResult missing = Program(short_run(folder / "no such folder" / "a.h5")).run();
  EXPECT_EQ(missing.exit_code, 4);
  EXPECT_THAT(missing.err, HasSubstr("no such folder"));
  const ProgramResult is_folder = Program(short_run(folder.path(), {"--force"})).run();
  EXPECT_EQ(is_folder.exit_code, 4);
}

TEST(Program, MissingSceneIsFileTrouble) {
  const TemporaryFolder folder;
  const ProgramResult result =
      Program({"run", (folder / "none.yaml").string(), "-o", (folder / "a.h5").string()}).run();
  EXPECT_EQ(result.exit_code, 4);
  EXPECT_THAT(result.err, HasSubstr("none.yaml"));
}

TEST(Program, WrongUsageExits2) {
  EXPECT_EQ(Program({}).run().exit_code, 2);
  EXPECT_EQ(Program({"rum"}).run().exit_code, 2);
  EXPECT_THAT(Program({"rum"}).run().err, HasSubstr("there is no verb 'rum', did you mean 'run'?"));
  EXPECT_EQ(Program({"run", main_scene}).run().exit_code, 2);  // no -o
  EXPECT_EQ(Program({"run", main_scene, "-o", "x.h5", "--nonsense"}).run().exit_code, 2);
  EXPECT_EQ(Program({"--help"}).run().exit_code, 0);
  EXPECT_EQ(Program({"--version"}).run().exit_code, 0);
}

/// Code of the one error that a command line which makes no command gets.
std::string code_of_command(std::vector<std::string> words) {
  words.emplace_back("--json");
  const ProgramResult result = Program(std::move(words)).run();
  EXPECT_EQ(result.exit_code, 2) << result.err;
  const auto errors = nlohmann::json::parse(result.out)["errors"];
  EXPECT_THAT(result.err, HasSubstr("[" + errors[0]["code"].get<std::string>() + "]"));
  return errors.size() == 1 ? errors[0]["code"] : "";
}

TEST(Program, WrongUsageHasTheCodeOfItsKind) {
  EXPECT_EQ(code_of_command({}), "unknown-option");  // --json comes first
  EXPECT_EQ(code_of_command({"rum"}), "unknown-option");
  EXPECT_EQ(code_of_command({"eig", main_scene, "--nonsense"}), "unknown-option");
  EXPECT_EQ(code_of_command({"eig", main_scene, "more"}), "unknown-option");
  EXPECT_EQ(code_of_command({"eig"}), "missing");
  EXPECT_EQ(code_of_command({"report", "-o", "a.html"}), "missing");
  EXPECT_EQ(code_of_command({"plot", "a.h5", "-o", "a.png"}), "missing");
  EXPECT_EQ(code_of_command({"plot", "a.h5", "-o", "a.png", "--kind", "foo"}), "wrong-value");
  EXPECT_EQ(code_of_command({"eig", main_scene, "--count", "many"}), "wrong-value");
  EXPECT_EQ(code_of_command({"map", main_scene, "--x", "time.step", "1", "2"}), "wrong-size");
  EXPECT_THAT(Program({}).run().err, HasSubstr("a verb is required: run, check,"));
  EXPECT_THAT(Program({"eig", main_scene, "--count"}).run().err, HasSubstr("[missing]"));
}

TEST(Program, VerifyComparesWithTheExpectBlock) {
  const TemporaryFolder folder;
  const std::string met = "expect=[{result: steps, value: 5650, tolerance: 1000}]";
  const std::string unmet =
      "expect=[{result: step_limit, value: 1e-6, tolerance: 1e-9}, {result: no.such, value: 0, "
      "tolerance: 1}]";
  const ProgramResult good = Program(short_run(folder / "a.h5", {"--verify", "--set", met})).run();
  EXPECT_EQ(good.exit_code, 0) << good.err;
  const ProgramResult bad = Program(short_run(folder / "b.h5", {"--verify", "--set", unmet})).run();
  EXPECT_EQ(bad.exit_code, 3);
  EXPECT_THAT(bad.err, HasSubstr("step_limit: expected 1e-06 within 1e-09, got 2.916"));
  EXPECT_THAT(bad.err, HasSubstr("no.such: expected 0, but the run has no such number"));
}

TEST(Program, SchemaPrintsTheJsonSchemaAndTheReferenceOfScenes) {
  const ProgramResult result = Program({"schema"}).run();
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_TRUE(Json::parse(result.out)["properties"].contains("substructures"));
  EXPECT_THAT(Program({"schema", "--reference"}).run().out, HasSubstr("# Scene reference"));
}

TEST(Program, InfoAndPlotReadARunFile) {
  const TemporaryFolder folder;
  ASSERT_EQ(Program(short_run(folder / "a.h5")).run().exit_code, 0);
  const ProgramResult info = Program({"info", (folder / "a.h5").string(), "--json"}).run();
  ASSERT_EQ(info.exit_code, 0) << info.err;
  EXPECT_EQ(Json::parse(info.out)["samples"], 101);
  const std::string figure = (folder / "a.png").string();
  EXPECT_EQ(Program({"plot", (folder / "a.h5").string(), "--kind", "history", "-o", figure})
                .run()
                .exit_code,
            0);
  EXPECT_GT(std::filesystem::file_size(figure), 1000u);
  const ProgramResult again =
      Program({"plot", (folder / "a.h5").string(), "--kind", "history", "-o", figure}).run();
  EXPECT_EQ(again.exit_code, 4);
  EXPECT_THAT(again.err, HasSubstr("use --force"));
  const ProgramResult channel = Program({"plot", (folder / "a.h5").string(), "--kind", "history",
                                         "-o", figure, "--force", "--channel", "contact.forc"})
                                    .run();
  EXPECT_EQ(channel.exit_code, 2);
  EXPECT_THAT(channel.err, HasSubstr("did you mean 'contact.force'?"));
  const ProgramResult ending = Program({"plot", (folder / "a.h5").string(), "--kind", "history",
                                        "-o", (folder / "a.bmp").string()})
                                   .run();
  EXPECT_EQ(ending.exit_code, 2);
}

TEST(Program, ForeignAndDamagedFilesAreFileTrouble) {
  const TemporaryFolder folder;
  write_file(folder / "text.h5", "not HDF5 at all");
  ASSERT_EQ(Program(short_run(folder / "a.h5")).run().exit_code, 0);
  const std::string whole = contents_of(folder / "a.h5");
  write_file(folder / "cut.h5", whole.substr(0, whole.size() / 2));
  for (const char* name : {"text.h5", "cut.h5", "missing.h5"}) {
    for (const std::vector<std::string>& arguments :
         {std::vector<std::string>{"info", (folder / name).string()},
          std::vector<std::string>{"plot", (folder / name).string(), "--kind", "history", "-o",
                                   (folder / "f.png").string()}}) {
      const ProgramResult result = Program(arguments).run();
      EXPECT_EQ(result.exit_code, 4) << name << result.err;
      EXPECT_THAT(result.err, HasSubstr(name));
    }
  }
  EXPECT_FALSE(std::filesystem::exists(folder / "f.png"));
}

TEST(Program, PathsWithSpacesAndUnicodeWork) {
  const TemporaryFolder folder;
  const auto output = folder / "Läufe und Brüche.h5";
  ASSERT_EQ(Program(short_run(output)).run().exit_code, 0);
  EXPECT_EQ(RunFileReader(output.string()).times().size(), 101u);
}

TEST(Program, SeveralPairsAreReportedByName) {
  const TemporaryFolder folder;
  std::string scene = contents_of(main_scene);
  const std::size_t contact = scene.find("contact:\n");
  const std::size_t drive = scene.find("drive:");
  const std::size_t cantilever = scene.find("  cantilever:");
  const std::string oblique =
      scene.substr(scene.find("  oblique:"), cantilever - scene.find("  oblique:"));
  std::string second = oblique;
  second.replace(second.find("oblique"), 7, "second");
  const auto pair = [](const std::string& name, const std::string& slave,
                       const std::string& start) {
    return "  " + name + ": {slave: " + slave +
           ".tip, master: cantilever.top, assumption: subs_b, start: " + start +
           ", friction: {coefficient: 0.3}}\n";
  };
  scene.replace(
      contact, drive - contact,
      "contacts:\n" + pair("first", "oblique", "30 mm") + pair("other", "second", "50 mm"));
  scene.insert(cantilever, second);
  scene.replace(scene.find("contact.force, contact.slip_velocity"), 36,
                "first.force, other.force, other.position");
  scene.erase(scene.find("expect:"));
  write_file(folder / "two.yaml", scene);
  const ProgramResult result =
      Program({"run", (folder / "two.yaml").string(), "-o", (folder / "a.h5").string(), "--json",
               "--set", "time.end=2e-3", "--set", "measure.from=0"})
          .run();
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const Json object = Json::parse(result.out);
  EXPECT_TRUE(object["contacts"]["first"]["contact_force"]["max"].is_number());
  EXPECT_TRUE(object["contacts"]["other"]["contact_force"]["max"].is_number());
  const RunFileReader file((folder / "a.h5").string());
  EXPECT_NEAR(file.series("/contact/other/position").front(), 0.050, 1e-9);
}

}  // namespace
}  // namespace stridor
