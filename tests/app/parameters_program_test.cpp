// `parameters` and expressions in every verb that reads or varies scenes, from outside.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <stdexcept>
#include <utility>

#include "tests/app/resume_fixture.hpp"
#include "tests/support/program.hpp"

namespace stridor {
namespace {

using namespace test;
using ::testing::HasSubstr;
using ::testing::Not;
using Json = nlohmann::json;

using Replacements = std::vector<std::pair<std::string, std::string>>;

/// A shipped scene with parameters, and with every occurrence of some texts replaced.
std::string scene_with(const TemporaryFolder& folder, const std::string& scene,
                       const std::string& parameters, const Replacements& replacements) {
  std::string text = contents_of(scene_path(scene));
  for (const auto& [from, to] : replacements) {
    std::size_t at = text.find(from);
    if (at == std::string::npos) throw std::logic_error(scene + " does not hold " + from);
    for (; at != std::string::npos; at = text.find(from, at + to.size()))
      text.replace(at, from.size(), to);
  }
  const std::string path = (folder / "scene.yaml").string();
  write_file(path, text + "parameters: " + parameters + "\n");
  return path;
}

Json json_of(std::vector<std::string> arguments) {
  arguments.push_back("--json");
  const ProgramResult result = Program(arguments).run();
  EXPECT_EQ(result.exit_code, 0) << result.err;
  return result.exit_code == 0 ? Json::parse(result.out) : Json();
}

/// Two beams on one cantilever, both contacts under the same friction, both arms equally thick.
std::string pairs_with_parameters(const TemporaryFolder& folder) {
  return scene_with(folder, "examples/two_pairs.yaml", "{mu: 0.3, h: 1.5 mm}",
                    {{"coefficient: 0.3", "coefficient: =mu"},
                     {"coefficient: 0.1", "coefficient: =mu"},
                     {"thickness: 1.5 mm", "thickness: =h"},
                     {"along: 20", "along: 6"},
                     {"along: 50", "along: 10"},
                     {"spacing: 2 mm", "spacing: 10 mm"}});
}

TEST(ParametersProgram, VaryingOneThatContactsAndBodiesShareEqualsVaryingAllTheirKeys) {
  const TemporaryFolder folder;
  const std::string scene = pairs_with_parameters(folder);
  const auto eigenvalues = [&](const std::vector<std::string>& sets) {
    std::vector<std::string> arguments{"eig", scene, "--count", "10"};
    for (const std::string& set : sets) arguments.insert(arguments.end(), {"--set", set});
    return json_of(arguments)["eigenvalues"];
  };
  const Json plain = eigenvalues({});
  const Json shared = eigenvalues({"parameters.mu=0.1", "parameters.h=2 mm"});
  EXPECT_EQ(shared, eigenvalues({"contacts.front.friction.coefficient=0.1",
                                 "contacts.rear.friction.coefficient=0.1",
                                 "substructures.front.thickness=2 mm",
                                 "substructures.rear.thickness=2 mm"}));
  EXPECT_NE(shared, plain);
  EXPECT_EQ(eigenvalues({"contacts.front.friction.coefficient==mu/3",
                         "contacts.rear.friction.coefficient==0.1", "parameters.h==0.004/2"}),
            shared);
}

TEST(ParametersProgram, LocusAlongOneIsMadeOfTheEigenvaluesOfItsValues) {
  const TemporaryFolder folder;
  const std::string scene = pairs_with_parameters(folder);
  const Json locus = json_of({"locus", scene, "--parameter", "parameters.h", "--from", "1.5 mm",
                              "--to", "2 mm", "--points", "2", "--count", "5"});
  EXPECT_EQ(locus["parameter"], "parameters.h");
  EXPECT_EQ(locus["values"], (Json{0.0015, 0.002}));
  for (const std::size_t i : {0u, 1u}) {
    const Json alone =
        json_of({"eig", scene, "--count", "5", "--set",
                 "parameters.h=" + std::to_string(locus["values"][i].get<double>())});
    for (std::size_t j = 0; j < 5; ++j) {
      EXPECT_NEAR(locus["eigenvalues"][i][j][1].get<double>(),
                  alone["eigenvalues"][j][1].get<double>(),
                  1e-8 * alone["eigenvalues"][j][1].get<double>());
    }
  }
}

TEST(ParametersProgram, WhatCannotBeVariedIsRefusedWithAdvice) {
  const TemporaryFolder folder;
  const std::string scene = pairs_with_parameters(folder);
  const auto refusal = [&](const std::string& parameter,
                           const std::vector<std::string>& more = {}) {
    std::vector<std::string> arguments{"locus",  scene, "--parameter", parameter,
                                       "--from", "0.1", "--to",        "0.2"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const ProgramResult result = Program(arguments).run();
    EXPECT_EQ(result.exit_code, 2);
    return result.err;
  };
  EXPECT_THAT(refusal("mu"), HasSubstr("'mu' is a parameter of the scene; write 'parameters.mu'"));
  EXPECT_THAT(refusal("parameters.nu"), HasSubstr("there is no key 'nu' in 'parameters', did you "
                                                  "mean 'mu'?"));
  EXPECT_THAT(refusal("parameters.mu", {"--set", "parameters.nu=1"}),
              HasSubstr("no expression of the scene uses this parameter"));
  EXPECT_THAT(refusal("parameters.mu", {"--set", "contacts.front.friction.coefficient=0.1", "--set",
                                        "contacts.rear.friction.coefficient=0.1"}),
              HasSubstr("no expression of the scene uses 'parameters.mu'"));
}

TEST(ParametersProgram, AWordIsAWrongValueAndAStrangeUnitAWrongUnit) {
  const auto code_of = [](const std::vector<std::string>& arguments) {
    const ProgramResult result = Program(arguments).run();
    EXPECT_EQ(result.exit_code, 2);
    return Json::parse(result.out)["errors"][0]["code"];
  };
  const std::string scene = scene_path("beam_on_beam.yaml");
  for (const char* key : {"parameters.mu=", "contact.start=", "time.step="}) {
    const auto checked = [&](const char* value) {
      return code_of({"check", scene, "--json", "--set", std::string(key) + value});
    };
    EXPECT_EQ(checked("abc"), "wrong-value") << key;
    EXPECT_EQ(checked("3 furble"), "wrong-unit") << key;
  }
  const auto located = [&](const char* from) {
    return code_of({"locus", scene, "--from", from, "--to", "0.09", "--points", "3", "--json"});
  };
  EXPECT_EQ(located("abc"), "wrong-value");
  EXPECT_EQ(located("30 kg"), "wrong-unit");
}

TEST(ParametersProgram, ThresholdOfTheSphereIsThatOfTheKey) {
  const std::string scene = scene_path("viscoelastic_sphere.yaml");
  const Json parameter = json_of(
      {"threshold", scene, "--parameter", "parameters.v", "--from", "1e-2", "--to", "0.1"});
  // v_d = v R/tau = v m/s.
  const Json key = json_of(
      {"threshold", scene, "--parameter", "drive.velocity", "--from", "1e-2", "--to", "0.1"});
  ASSERT_EQ(key["roots"].size(), 1u);
  ASSERT_EQ(parameter["roots"].size(), 1u);
  const double root = key["roots"][0]["value"];
  EXPECT_NEAR(root, 0.0208030197, 1e-9);
  EXPECT_NEAR(parameter["roots"][0]["value"].get<double>(), root, 1e-9 * root);

  const auto growth = [&](const std::vector<std::string>& axes) {
    std::vector<std::string> arguments{"map", scene, "--scale", "log"};
    arguments.insert(arguments.end(), axes.begin(), axes.end());
    return json_of(arguments)["growth"];
  };
  const std::string inclined = "substructures.sphere.springs.inclined.stiffness";
  // eta^2 k_x, at eta 0.5 and 1.
  const Json of_key = growth({"--x", "parameters.tau0", "1e-3", "1e-1", "3", "--y", inclined,
                              "12.5", "50", "2"});
  const Json of_parameter = growth({"--x", "parameters.tau0", "1e-3", "1e-1", "3", "--y",
                                    "parameters.eta", "0.5", "1", "2"});
  for (std::size_t j = 0; j < 2; ++j) {
    for (std::size_t i = 0; i < 3; ++i)
      EXPECT_NEAR(of_key[j][i].get<double>(), of_parameter[j][i].get<double>(), 1e-9);
  }
}

TEST(ParametersProgram, MapOfTheDiscIsThatOfTheKeys) {
  const TemporaryFolder folder;
  const std::string scene =
      scene_with(folder, "disc_and_pads.yaml", "{mu: 0.3, preload: 3000, speed: 10}",
                 {{"spin: 10 rad/s", "spin: =speed"}, {"parameters: {mu: 0.3, preload: 3000}", ""}});
  const auto growth = [&](const std::string& x, const std::string& y) {
    return json_of(
        {"map", scene, "--x", x, "0", "0.6", "3", "--y", y, "5", "20", "2"})["growth"];
  };
  EXPECT_EQ(growth("parameters.mu", "parameters.speed"),
            growth("parameters.mu", "substructures.disc.spin"));
}

std::vector<std::string> shortened(const std::string& scene, const std::string& output) {
  return {"run",   scene,
          "-o",    output,
          "--set", "time.end=0.02",
          "--set", "time.integrator=exact",
          "--set", "time.step=2e-6",
          "--set", "measure.from=0.01",
          "--set", "expect=[]"};
}

TEST(ParametersProgram, RunWithExpressionsIsTheRunOfTheirValues) {
  const TemporaryFolder folder;
  const std::string scene =
      scene_with(folder, "beam_on_beam.yaml", "{mu: 0.15, p: -0.1, n: 10}",
                 {{"coefficient: 0.30", "coefficient: =2*mu"},
                  {"load: -0.20", "load: =2*p"},
                  {"fixed_interface_modes: 20", "fixed_interface_modes: =2*n"}});
  const std::string with_values = (folder / "values.h5").string();
  const std::string with_expressions = (folder / "expressions.h5").string();
  EXPECT_EQ(Program(shortened(scene_path("beam_on_beam.yaml"), with_values)).run().exit_code, 0);
  const ProgramResult result = Program(shortened(scene, with_expressions)).run();
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(difference(with_values, with_expressions), "");

  const RunFileReader reader(with_expressions);
  const RunFileHeader& header = reader.header();
  EXPECT_THAT(header.scene_text, HasSubstr("load: =2*p"));
  EXPECT_THAT(header.scene_resolved, HasSubstr("\nparameters: {mu: 0.15, p: -0.1, \"n\": 10}\n"));
  EXPECT_THAT(header.scene_resolved, HasSubstr("\n  load: -0.2\n"));
  EXPECT_NE(header.scene_hash, RunFileReader(with_values).header().scene_hash);
}

TEST(ParametersProgram, InterruptedRunWithExpressionsGoesOnBitIdentically) {
  const TemporaryFolder folder;
  const std::string scene = scene_with(folder, "beam_on_beam.yaml", "{mu: 0.15, last: 20 ms}",
                                       {{"coefficient: 0.30", "coefficient: =2*mu"},
                                        {"end: 2.25", "end: =last"},
                                        {"value: 0.19751", "value: =mu"}});
  const auto run = [&](const std::string& output) {
    return std::vector<std::string>{"run",   scene,
                                    "-o",    output,
                                    "--set", "parameters.mu=0.1",
                                    "--set", "measure.from=0.01",
                                    "--set", "time.step=1e-8"};
  };
  const std::string whole = (folder / "whole.h5").string();
  const std::string stopped = (folder / "stopped.h5").string();
  EXPECT_EQ(Program(run(whole)).run().exit_code, 0);
  std::vector<std::string> briefly = run(stopped);
  briefly.insert(briefly.end(), {"--max-wall", "0.02"});
  EXPECT_EQ(Program(briefly).run().exit_code, 5);
  const ProgramResult result = Program({"run", "--resume", stopped}).run();
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.err, Not(HasSubstr("no expression")));
  EXPECT_EQ(difference(whole, stopped), "");
}

TEST(ParametersProgram, SweepAlongOneIsMadeOfTheRunsOfItsValues) {
  const TemporaryFolder folder;
  const std::string scene = scene_with(folder, "beam_on_beam.yaml", "{mu: 0.15}",
                                       {{"coefficient: 0.30", "coefficient: =2*mu"}});
  const auto rows = [&](const std::string& key, const std::string& from, const std::string& to) {
    std::vector<std::string> arguments = shortened(scene, "");
    arguments[0] = "sweep";
    arguments.erase(arguments.begin() + 2, arguments.begin() + 4);
    arguments.insert(arguments.end(),
                     {"--parameter", key, "--from", from, "--to", to, "--points", "2"});
    return json_of(arguments)["rows"];
  };
  const Json parameter = rows("parameters.mu", "0.05", "0.1");
  const Json key = rows("contact.friction.coefficient", "0.1", "0.2");
  ASSERT_EQ(parameter.size(), 2u);
  for (const std::size_t i : {0u, 1u})
    EXPECT_EQ(parameter[i]["contact_force"], key[i]["contact_force"]);
}

TEST(ParametersProgram, CheckWarnsOfTheUnusedAndPlacesErrors) {
  const TemporaryFolder folder;
  const std::string scene =
      scene_with(folder, "beam_on_beam.yaml", "{mu: 0.15, idle: 1, omega: =sqrt(mu)}",
                 {{"coefficient: 0.30", "coefficient: =2*mu"}});
  const Json checked = json_of({"check", scene});
  EXPECT_EQ(checked["errors"], Json::array());
  std::string keys;
  for (const Json& warning : checked["warnings"]) keys += warning["key"].get<std::string>() + " ";
  EXPECT_THAT(keys, HasSubstr("parameters.idle parameters.omega"));

  const ProgramResult wrong =
      Program({"check", scene, "--set", "contact.friction.coefficient==2*mo"}).run();
  EXPECT_EQ(wrong.exit_code, 2);
  EXPECT_THAT(wrong.err, HasSubstr("--set contact.friction.coefficient==2*mo: "
                                   "contact.friction.coefficient: '=2*mo', column 3: there is no "
                                   "parameter 'mo', did you mean 'mu'?"));
}

}  // namespace
}  // namespace stridor
