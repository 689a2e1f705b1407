// The verb precision from outside.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <csignal>
#include <nlohmann/json.hpp>
#include <set>
#include <thread>

#include "io/results/result_file.hpp"
#include "tests/support/program.hpp"

namespace stridor {
namespace {

using namespace test;
using ::testing::HasSubstr;
using Json = nlohmann::json;

const std::string scene = scene_path("beam_on_beam_leading.yaml");

/// The main scene over its first 8 ms, most of it still in the ramp.
std::vector<std::string> short_study(std::vector<std::string> more) {
  std::vector<std::string> arguments{"precision",     scene,
                                     "--until",       "8 ms",
                                     "--set",         "measure.from=4 ms",
                                     "--set",         "record.interval=1e-5",
                                     "--points",      "3",
                                     "--retain",      "50 kHz",
                                     "--assumptions", "subs_a"};
  arguments.insert(arguments.end(), more.begin(), more.end());
  return arguments;
}

/// The HDF5 file of a study holds the rows of its JSON object.
void expect_same_rows(const ResultFile& file, const Json& object) {
  EXPECT_EQ(file.kind(), "study of precision");
  const std::vector<std::string> methods = file.texts("/settings/method");
  ASSERT_EQ(methods.size(), object["rows"].size());
  const std::pair<const char*, const char*> columns[] = {{"step", "/step"},
                                                         {"modes", "/modes"},
                                                         {"run_time", "/least_wall_s"},
                                                         {"error", "/error"},
                                                         {"error_of_force", "/errors/force"}};
  for (const auto& [name, pointer] : columns) {
    const std::vector<double> values = file.read(std::string("/settings/") + name);
    for (std::size_t i = 0; i < methods.size(); ++i) {
      const Json& row = object["rows"][i];
      EXPECT_EQ(methods[i], row["method"]);
      const Json::json_pointer at(pointer);
      if (!row.contains(at) || row[at].is_null())
        EXPECT_TRUE(std::isnan(values[i])) << name;
      else
        EXPECT_EQ(values[i], row[at].get<double>()) << name;
    }
  }
  EXPECT_EQ(file.read("/reduction/error").size(), 10u);
  EXPECT_THAT(file.text("tuned"), HasSubstr("step"));
}

TEST(PrecisionProgram, MeasuresEveryMethodAndNamesTheCheapest) {
  const TemporaryFolder folder;
  const ProgramResult result =
      Program(short_study({"--json", "--tune", "5e-3", "--norm", "acceleration", "-o",
                           (folder / "study").string(), "--published-window", "2e-4"}))
          .run();
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const Json object = Json::parse(result.out);
  EXPECT_EQ(object["reference"]["modes"], 243);
  EXPECT_GT(object["reference"]["error"].get<double>(), 0.0);
  std::set<std::string> methods;
  int unstable = 0;
  for (const Json& row : object["rows"]) {
    methods.insert(row["method"].get<std::string>());
    for (const char* key : {"integrator", "modes", "step", "wall_s", "error", "stable"})
      EXPECT_TRUE(row.contains(key)) << key;
    if (!row["stable"].get<bool>()) {
      ++unstable;
      EXPECT_TRUE(row["error"].is_null());
      EXPECT_THAT(row["status"].get<std::string>(), HasSubstr("above the largest stable step"));
    } else {
      EXPECT_GT(row["least_wall_s"].get<double>(), 0.0);
    }
  }
  EXPECT_EQ(methods, (std::set<std::string>{"central difference, all modes", "exact, all modes",
                                            "exact, to 50 kHz", "central difference, to 50 kHz",
                                            "exact, to 50 kHz, subs_a", "published form",
                                            "published form, fused"}));
  EXPECT_EQ(unstable, 1);

  // The tuned setting is a row of its own, within what was asked even with the reference's error.
  const Json& tune = object["tune"];
  EXPECT_LE(tune["error"].get<double>() + object["reference"]["error"].get<double>(), 5e-3);
  bool is_row = false;
  for (const Json& row : object["rows"]) {
    is_row = is_row || (row["method"] == tune["method"] && row["step"] == tune["step"] &&
                        row["error"] == tune["error"]);
    if (row["stable"].get<bool>() && row["assumption"] == "subs_b" &&
        row["coordinates"] == "modal" &&
        row["error"].get<double>() + object["reference"]["error"].get<double>() <= 5e-3) {
      EXPECT_GE(row["least_wall_s"].get<double>(), tune["least_wall_s"].get<double>());
    }
  }
  EXPECT_TRUE(is_row);
  EXPECT_THAT(folder.files(), ::testing::ElementsAre("study"));
  EXPECT_GT(std::filesystem::file_size(folder / "study" / "precision.png"), 1000u);
  EXPECT_EQ(Json::parse(contents_of(folder / "study" / "precision.json")), object);
  expect_same_rows(ResultFile((folder / "study" / "precision.h5").string()), object);

  // The text offered for pasting can be pasted.
  std::string text = contents_of(scene);
  const std::size_t line = text.find("\ntime:");
  text.replace(line + 1, text.find('\n', line + 1) - line, tune["scene"].get<std::string>());
  write_file(folder / "tuned.yaml", text);
  const ProgramResult check = Program({"check", (folder / "tuned.yaml").string()}).run();
  EXPECT_EQ(check.exit_code, 0) << check.err << text;
  EXPECT_THAT(tune["scene"].get<std::string>(), HasSubstr("integrator: "));
}

TEST(PrecisionProgram, PrintsATable) {
  const ProgramResult result = Program(short_study({"--published-window", "0"})).run();
  ASSERT_EQ(result.exit_code, 0) << result.err;
  for (const char* text :
       {"reference: exact, all 243 modes", "not stable", "slope of", "exact, to 50 kHz"})
    EXPECT_THAT(result.out, HasSubstr(text));
}

TEST(PrecisionProgram, SaysThatNothingIsGoodEnough) {
  const ProgramResult result =
      Program(short_study({"--tune", "1e-12", "--published-window", "0"})).run();
  EXPECT_EQ(result.exit_code, 3);
  EXPECT_THAT(result.err, HasSubstr("no setting measured is within 1e-12"));
}

TEST(RunError, IsNearTheErrorAgainstAFineReference) {
  const TemporaryFolder folder;
  const ProgramResult study = Program(short_study({"--json", "--published-window", "0"})).run();
  ASSERT_EQ(study.exit_code, 0) << study.err;
  const Json precise = Json::parse(study.out);
  int num_compared = 0;
  for (const Json& row : precise["rows"]) {
    if (!row["stable"].get<bool>() || row["assumption"] != "subs_b") continue;
    std::vector<std::string> run{"run",
                                 scene,
                                 "-o",
                                 (folder / "run.h5").string(),
                                 "--force",
                                 "--error",
                                 "--json",
                                 "--set",
                                 "time.end=8 ms",
                                 "--set",
                                 "measure.from=4 ms",
                                 "--set",
                                 "record.interval=1e-5"};
    const auto set = [&](const std::string& assignment) {
      run.insert(run.end(), {"--set", assignment});
    };
    set("time.integrator=" + row["integrator"].get<std::string>());
    set("time.step=" + row["step"].dump());
    if (row["method"].get<std::string>().ends_with("to 50 kHz")) set("time.retain.frequency=50kHz");
    const ProgramResult result = Program(run).run();
    ASSERT_EQ(result.exit_code, 0) << result.err;
    const Json error = Json::parse(result.out)["error"];
    EXPECT_EQ(error["failure"], nullptr);
    EXPECT_GT(error["wall_s"].get<double>(), 0.0);
    for (const char* norm : {"force", "acceleration", "envelope"}) {
      // Of errors of order two in the step, 3/4; less could be the error of the reference.
      const double expected = row["errors"][norm];
      if (expected < 20.0 * precise["reference"]["errors"][norm].get<double>()) continue;
      ++num_compared;
      EXPECT_GT(error[norm].get<double>(), 0.45 * expected) << row << norm;
      EXPECT_LT(error[norm].get<double>(), 1.2 * expected) << row << norm;
    }
  }
  EXPECT_GE(num_compared, 12);
}

TEST(RunError, IsPrintedAndKeptInTheFile) {
  const TemporaryFolder folder;
  const std::string file = (folder / "run.h5").string();
  const ProgramResult run =
      Program({"run", scene, "-o", file, "--error", "--set", "time.end=8 ms", "--set",
               "measure.from=4 ms", "--set", "time.integrator=exact", "--set", "time.step=5e-6"})
          .run();
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("of the force: difference from exact propagation of all modes at "
                                 "2.5e-06 s"));
  const Json info = Json::parse(Program({"info", file, "--json"}).run().out);
  EXPECT_GT(info["results"]["error.envelope"].get<double>(), 0.0);
}

TEST(RunError, IsRefusedBeforeTheRunWhereItCannotBe) {
  const TemporaryFolder folder;
  const std::string file = (folder / "run.h5").string();
  const auto refusal = [&](const std::string& what, std::vector<std::string> more) {
    std::vector<std::string> arguments{"run", what, "-o", file, "--error"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const ProgramResult result = Program(arguments).run();
    EXPECT_EQ(result.exit_code, 2);
    EXPECT_FALSE(std::filesystem::exists(file));
    return result.err;
  };
  EXPECT_THAT(refusal(scene, {"--set", "record.channels=[contact.force]"}),
              HasSubstr("no motion of a point among the channels"));
  EXPECT_THAT(refusal(scene, {"--set", "time.end=0.2"}),
              HasSubstr("time.end: the run ends at 0.2 s, but errors are taken from 0.4 s on"));
  EXPECT_THAT(refusal(scene_path("viscoelastic_sphere.yaml"), {}),
              HasSubstr("--error: is for time.step"));
}

TEST(PrecisionProgram, RejectsBadInput) {
  const auto refusal = [](std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "precision");
    const ProgramResult result = Program(arguments).run();
    EXPECT_EQ(result.exit_code, 2);
    EXPECT_EQ(result.out, "");
    return result.err;
  };
  EXPECT_THAT(refusal({scene, "--tune", "2"}), HasSubstr("--tune: must be"));
  EXPECT_THAT(refusal({scene, "--tune", "close"}), HasSubstr("--tune"));
  EXPECT_THAT(refusal({scene, "--until", "0.2"}), HasSubstr("errors are taken from 0.4 s on"));
  EXPECT_THAT(refusal({scene, "--until", "9"}), HasSubstr("beyond the end of the scene, 2.25 s"));
  EXPECT_THAT(refusal({scene, "--retain", "50 kg"}), HasSubstr("--retain"));
  EXPECT_THAT(refusal({scene, "--norm", "phase"}), HasSubstr("--norm"));
  EXPECT_THAT(refusal({scene, "--assumptions", "subs_d"}), HasSubstr("--assumptions"));
  EXPECT_THAT(refusal({scene, "--points", "1"}), HasSubstr("--points"));
  EXPECT_THAT(refusal({scene, "--set", "record.channels=[contact.force]"}),
              HasSubstr("no motion of a point among the channels"));
}

TEST(PrecisionProgram, ComparesReducedBodiesWithFullOnesWithoutARun) {
  const TemporaryFolder folder;
  const std::string of_frozen = scene_path("examples/frozen_growth.yaml");
  const std::vector<std::string> asked{"precision", of_frozen,       "--reduction", "--frequencies",
                                       "3kHz,1kHz", "-o", folder.path().string()};
  const auto with = [&](std::vector<std::string> more) {
    more.insert(more.begin(), asked.begin(), asked.end());
    return Program(more).run();
  };
  const ProgramResult result = with({"--json"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const Json object = Json::parse(result.out);
  ASSERT_EQ(object["reduction"].size(), 2u);
  for (const Json& body : object["reduction"]) {
    EXPECT_EQ(body["frequencies"], Json::array({1000.0, 3000.0}));
    EXPECT_GT(body["unknowns"].get<int>(), body["interface"].get<int>() + body["modes"].get<int>());
    ASSERT_EQ(body["errors"].size(), 2u);
    EXPECT_GT(body["errors"][0].get<double>(), 0.0);
    EXPECT_LT(body["errors"][0].get<double>(), 1e-2);
  }
  EXPECT_EQ(Json::parse(contents_of(folder / "precision.json")), object);
  EXPECT_EQ(with({}).exit_code, 4);  // is there already
  const ProgramResult text = with({"--force"});
  EXPECT_THAT(text.out, HasSubstr("cantilever: "));
  EXPECT_THAT(text.out, HasSubstr("1000 Hz"));
  // One mode fewer of each body answers less well.
  const Json fewer = Json::parse(
      with({"--force", "--json", "--set", "substructures.cantilever.reduction.fixed_interface_modes=1"})
          .out);
  EXPECT_GT(fewer["reduction"][0]["errors"][1].get<double>(),
            object["reduction"][0]["errors"][1].get<double>());
  // So does an interface that moves in a few modes.
  const std::string few_modes = "substructures.cantilever.interface.modes=30";
  const Json coarse = Json::parse(with({"--force", "--json", "--set", few_modes}).out);
  EXPECT_EQ(coarse["reduction"][0]["interface_modes"], 30);
  EXPECT_EQ(coarse["reduction"][1]["interface_modes"], nullptr);
  EXPECT_GT(coarse["reduction"][0]["errors"][0].get<double>(),
            object["reduction"][0]["errors"][0].get<double>());
  EXPECT_LT(coarse["reduction"][0]["errors"][0].get<double>(), 0.2);
  const ProgramResult too_many = with({"--force", "--set", "substructures.cantilever.interface.modes=999"});
  EXPECT_EQ(too_many.exit_code, 2);
  EXPECT_THAT(too_many.err, HasSubstr("999 modes asked of the interface of 'cantilever'"));
  const ProgramResult whole =
      Program({"precision", scene_path("examples/mass_on_belt.yaml"), "--reduction"}).run();
  EXPECT_EQ(whole.exit_code, 0) << whole.err;
  EXPECT_THAT(whole.out, HasSubstr("no body is reduced"));
  EXPECT_EQ(Program({"precision", of_frozen, "--reduction", "--frequencies", "-1"}).run().exit_code, 2);
}

TEST(PrecisionProgram, DoesNotOverwriteUnasked) {
  const TemporaryFolder folder;
  write_file(folder / "precision.json", "mine");
  const ProgramResult result = Program(short_study({"-o", folder.path().string()})).run();
  EXPECT_EQ(result.exit_code, 4);
  EXPECT_THAT(result.err, HasSubstr("use --force"));
  EXPECT_EQ(contents_of(folder / "precision.json"), "mine");
}

TEST(PrecisionProgram, StopsOnRequest) {
  Program program({"precision", scene});
  program.start();
  std::this_thread::sleep_for(std::chrono::milliseconds(1500));
  program.send(SIGTERM);
  const ProgramResult result = program.wait();
  EXPECT_EQ(result.exit_code, 5);
  EXPECT_THAT(result.err, HasSubstr("stopped on request"));
}

}  // namespace
}  // namespace stridor
