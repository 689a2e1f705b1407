// `parameters` and the expressions that depend on them, through the reader.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <span>
#include <string>
#include <vector>

#include "io/scene/assignment.hpp"
#include "io/scene/resolved_scene.hpp"
#include "io/scene/scene.hpp"
#include "io/scene/scene_family.hpp"
#include "io/scene/scene_reader.hpp"
#include "io/scene/scene_tree.hpp"
#include "tests/io/example_scene.hpp"
#include "tests/support/message_of.hpp"

namespace stridor {
namespace {

using test::Example;
using test::kExampleText;
using test::message_of;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::SizeIs;

/// The example with parameters, and with `from` replaced.
std::string text_with(const std::string& parameters, const std::string& from = "",
                      const std::string& to = "") {
  std::string text = kExampleText;
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  text.replace(at, from.size(), to);
  return text + "parameters: " + parameters + "\n";
}

Example example_with(const std::string& parameters, const std::string& from = "",
                     const std::string& to = "", const std::vector<std::string>& sets = {}) {
  SceneNode root = read_scene_text(text_with(parameters, from, to), "s.yaml");
  for (const std::string& assignment : sets) set_value(root, assignment);
  return read_as<Example>(root);
}

std::vector<Problem> problems_with(const std::string& parameters, const std::string& from = "",
                                   const std::string& to = "",
                                   const std::vector<std::string>& sets = {}) {
  try {
    (void)example_with(parameters, from, to, sets);
  } catch (const ConfigError& error) {
    return error.problems();
  }
  return {};
}

/// What is said of the only problem.
std::string refusal(const std::string& parameters, const std::string& from = "",
                    const std::string& to = "", const std::vector<std::string>& sets = {}) {
  const auto problems = problems_with(parameters, from, to, sets);
  EXPECT_THAT(problems, SizeIs(1));
  return problems.empty() ? "" : problems.front().text();
}

const test::Beam& oblique(const Example& example) {
  return std::get<test::Beam>(example.bodies.at("oblique"));
}

TEST(SceneParameters, AnyNumberMayDependOnThem) {
  const std::string parameters =
      "{mu: 30 %, length: 75 mm, fast: =2*length, n: 37, k: 8, m: 2, omega: =sqrt(k/m)}";
  EXPECT_EQ(example_with(parameters, "coefficient: 0.3", "coefficient: =mu/2").friction->coefficient,
            0.15);
  EXPECT_EQ(oblique(example_with(parameters, "75 mm", "=length")).length, 0.075);
  EXPECT_EQ(oblique(example_with(parameters, "elements: 37", "elements: =n+3")).elements, 40);
  EXPECT_EQ(example_with(parameters, "format: 2", "format: =omega/2").format, 1);
  EXPECT_THAT(example_with(parameters, "[2.5 kHz, 15 kHz]", "[=k, '=max(k, 100)']").band,
              ElementsAre(8.0, 100.0));
  EXPECT_EQ(example_with(parameters, "velocity: 30 mm/s", "velocity: =fast").velocity.value(0.0),
            0.15);
  EXPECT_EQ(example_with(parameters, "values: [0, -0.2]", "values: [0, =-mu]").load->table(),
            (TimeTable{{0.0, 0.1}, {0.0, -0.3}}));
  EXPECT_EQ(example_with(parameters, "value: 0.19751", "value: =omega").expect[0].value, 2.0);
}

TEST(SceneParameters, SettingAParameterMovesEveryKeyThatDependsOnIt) {
  const std::string parameters = "{mu: 0.3, double: =2*mu}";
  const auto set = [&](const std::vector<std::string>& sets) {
    return example_with(parameters, "coefficient: 0.3", "coefficient: =double", sets);
  };
  EXPECT_EQ(set({}).friction->coefficient, 0.6);
  EXPECT_EQ(set({"parameters.mu=0.4"}).friction->coefficient, 0.8);
  EXPECT_EQ(set({"parameters.double=0.4"}).friction->coefficient, 0.4);
  EXPECT_EQ(set({"friction.coefficient==3*double"}).friction->coefficient, 3 * 0.6);
  EXPECT_EQ(set({"parameters.half==mu/2", "friction.coefficient==half"}).friction->coefficient,
            0.15);
}

TEST(SceneParameters, HoldTheirUnitsInSi) {
  const Example example = example_with(
      "{length: 75 mm, speed: 30 mm/s, modulus: 2 GPa, spin: 60 rpm, f: 1 kHz, share: 5 %, n: 2, "
      "twice: =2*length}");
  const auto quantity = [&](std::size_t i) {
    return fmt::format("{:.12g} {}", example.parameters[i].value, example.parameters[i].unit);
  };
  EXPECT_EQ(quantity(0), "0.075 m");
  EXPECT_EQ(quantity(1), "0.03 m s-1");
  EXPECT_EQ(quantity(2), "2000000000 kg m-1 s-2");
  EXPECT_EQ(quantity(3), "6.28318530718 rad s-1");
  EXPECT_EQ(quantity(4), "1000 s-1");
  EXPECT_EQ(quantity(5), "0.05 ");
  EXPECT_EQ(quantity(6), "2 ");
  EXPECT_EQ(quantity(7), "0.15 ");
}

TEST(SceneParameters, OfWhichUseIsMadeAreKnown) {
  const Example example = example_with("{a: 1, b: =a, c: =b, d: =a, e: 2}", "coefficient: 0.3",
                                       "coefficient: =c");
  std::string used;
  for (const NamedNumber& number : example.parameters)
    if (number.is_used) used += number.name;
  EXPECT_EQ(used, "abc");
}

TEST(SceneParameters, ResolvedSceneHoldsValuesAndReadsBack) {
  const Example example =
      example_with("{length: 75 mm, mu: 0.1, mu3: =3*mu}", "coefficient: 0.3", "coefficient: =mu3");
  const std::string resolved = resolved_yaml(example);
  EXPECT_THAT(resolved, HasSubstr("\nparameters: {length: \"0.075 m\", mu: 0.1, mu3: "
                                  "0.30000000000000004}\n"));
  EXPECT_THAT(resolved, HasSubstr("\n  coefficient: 0.30000000000000004\n"));
  EXPECT_EQ(resolved_yaml(read_as<Example>(read_scene_text(resolved, "r.yaml"))), resolved);
  // Nothing is added to a scene without parameters.
  EXPECT_EQ(resolved_yaml(example_with("{}")).find("parameters"), std::string::npos);
}

TEST(SceneParameters, CycleIsRefusedWithItsChain) {
  EXPECT_EQ(refusal("{a: =b, b: =2*c, c: =a+1}"),
            "s.yaml:38:17: parameters.a: depends on itself: a -> b -> c -> a; give one of them a "
            "number");
  EXPECT_EQ(refusal("{mu: =mu}"),
            "s.yaml:38:18: parameters.mu: depends on itself: mu -> mu; give one of them a number");
  // What depends on a cycle without being in it is not blamed.
  EXPECT_THAT(refusal("{z: =a, a: =b, b: =a}", "coefficient: 0.3", "coefficient: =z"),
              HasSubstr("parameters.a: depends on itself: a -> b -> a"));
}

TEST(SceneParameters, ChainsMayBeLong) {
  std::string chain = "{p0: 1";
  for (int i = 1; i <= 5000; ++i) chain += fmt::format(", p{}: =p{}", i, i - 1);
  const Example example =
      example_with(chain + "}", "coefficient: 0.3", "coefficient: =p5000");
  EXPECT_EQ(example.friction->coefficient, 1.0);
}

TEST(SceneParameters, WrongOnesAreRefusedAtTheirPlaceAndOnce) {
  EXPECT_EQ(refusal("{mu: 0.3, mo: =mu+nu}"),
            "s.yaml:38:27: parameters.mo: '=mu+nu', column 4: there is no parameter 'nu', did you "
            "mean 'mu'?");
  EXPECT_THAT(refusal("{mu: fast}", "coefficient: 0.3", "coefficient: =mu"),
              HasSubstr("38:18: parameters.mu: 'fast' is not a number, expected a number, with a "
                        "unit or without"));
  EXPECT_THAT(refusal("{mu: 3 xyzzy}"), HasSubstr("has the unknown unit 'xyzzy'"));
  EXPECT_THAT(refusal("{mu: 20 degC}"), HasSubstr("no multiple of an SI unit"));
  EXPECT_THAT(refusal("{mu: [1, 2]}"), HasSubstr("expected a number or an expression, got a map"));
  EXPECT_THAT(refusal("{mu: }"), HasSubstr("parameters.mu: has no value"));
  EXPECT_THAT(refusal("{a-b: 1}"), HasSubstr("cannot be the name of a parameter"));
  EXPECT_THAT(refusal("{pi: 3}"), HasSubstr("'pi' already means something in expressions"));
  EXPECT_THAT(refusal("{mu: " + std::string(100, '1') + "}"), HasSubstr("got a long text"));
  EXPECT_THAT(refusal("3"), HasSubstr("expected a map of names to numbers, got '3'"));
}

TEST(SceneParameters, KeysAreCheckedAsIfTheyHeldTheNumber) {
  const std::string parameters = "{mu: 0.3, n: 2.5}";
  EXPECT_EQ(refusal(parameters, "coefficient: 0.3", "coefficient: =-mu"),
            "s.yaml:27:16: friction.coefficient: must be >= 0, got -0.3 (written '=-mu')");
  EXPECT_EQ(refusal(parameters, "elements: 37", "elements: =n"),
            "s.yaml:14:15: bodies.oblique.elements: must be a whole number, got 2.5 (written "
            "'=n'); round() rounds");
  EXPECT_EQ(refusal(parameters, "elements: 37", "elements: =2-4*mu/mu"),
            "s.yaml:14:15: bodies.oblique.elements: must be > 0, got -2 (written '=2-4*mu/mu')");
  EXPECT_THAT(refusal(parameters, "elements: 37", "elements: =10^12"),
              HasSubstr("is too far from 0 to be stored"));
  EXPECT_THAT(refusal(parameters, "75 mm", "=mu*10^40"),
              HasSubstr("is beyond what can be computed with"));
  EXPECT_EQ(refusal(parameters, "coefficient: 0.3", "coefficient: =2*mo"),
            "s.yaml:27:16: friction.coefficient: '=2*mo', column 3: there is no parameter 'mo', "
            "did you mean 'mu'?");
  // A text remains a text.
  EXPECT_EQ(example_with(parameters, "title: squeal", "title: =mu").title, "=mu");
  EXPECT_THAT(refusal(parameters, "energy: false", "energy: =mu"),
              HasSubstr("expected true or false, got '=mu'"));
}

TEST(SceneParameters, SettingOneThatIsNotUsedIsRefused) {
  EXPECT_THAT(problems_with("{mu: 0.3}"), SizeIs(0));  // a warning of `check`
  EXPECT_EQ(refusal("{mu: 0.3}", "", "", {"parameters.mo=0.4"}),
            "--set parameters.mo=0.4: parameters.mo: no expression of the scene uses this "
            "parameter, so setting it changes nothing");
}

/// Two masses between springs, of which the rows of K depend on parameters.
LoadedScene two_masses() {
  return load_resolved_scene(
      "format: 2\n"
      "parameters: {k: 8, n: =k/4}\n"
      "substructures:\n"
      "  pair:\n"
      "    type: matrices\n"
      "    mass: [[=n/2, 0], [0, '=max(1, n/2)']]\n"
      "    terms: [{role: stiffness, matrix: [[=2*k, =-k], [=-k, =2*k]], factor: =n}]\n",
      "m.yaml");
}

TEST(SceneParameters, RowsOfMatricesTakeExpressions) {
  const Model model = build_model(two_masses());
  const ReducedBody& body = model.system.bodies.at(0).reduced;
  EXPECT_EQ(body.mass, Eigen::MatrixXd::Identity(2, 2));
  EXPECT_EQ(body.stiffness, (Eigen::MatrixXd(2, 2) << 32.0, -16.0, -16.0, 32.0).finished());
}

TEST(SceneParameters, VaryingOneReadsTheRowsOfMatricesAnew) {
  const LoadedScene loaded = two_masses();
  const NumericKey key = find_numeric_key(loaded.scene, "parameters.k", "--x");
  SceneFamily family(loaded, {key});
  for (const double k : {8.0, 4.0, 16.0}) {  // what has been read must not be taken for new rows
    const Model& model = *family.at(std::span(&k, 1)).model;
    const ReducedBody& body = model.system.bodies.at(0).reduced;
    const double n = k / 4.0;
    EXPECT_EQ(body.stiffness,
              (Eigen::MatrixXd(2, 2) << 2 * k, -k, -k, 2 * k).finished() * n);
    EXPECT_EQ(body.mass(1, 1), std::max(1.0, n / 2));
  }
}

TEST(SceneParameters, WrongExpressionInARowSaysHowRowsAreWritten) {
  SceneNode tree = two_masses().tree;
  set_value(tree, "substructures.pair.mass=['=n 0', '0 1']");
  try {
    read_as<Scene>(tree);
    FAIL();
  } catch (const ConfigError& error) {
    EXPECT_THAT(error.what(), HasSubstr("column 3: an operator is missing before '0'; a row of "
                                        "several is a list: [=a, =b]"));
  }
}

TEST(SceneParameters, AreVariedByTheirPathAndUnit) {
  const Example example = example_with("{length: 75 mm, idle: 1}", "75 mm", "=length");
  const auto find = [&](const std::string& path) {
    return find_numeric_key(Example::schema(), &example, path, "--parameter");
  };
  const NumericKey key = find("parameters.length");
  EXPECT_EQ(key.unit, "m");
  EXPECT_TRUE(is_parameter(key));
  EXPECT_EQ(parse_value(key, "80 mm", "--from"), 0.08);
  const auto refusal_of = [&](const std::string& path) {
    return message_of<ConfigError>([&] { (void)find(path); });
  };
  EXPECT_EQ(refusal_of("parameters.lenght"),
            "--parameter: 'parameters.lenght': there is no key 'lenght' in 'parameters', did you "
            "mean 'length'?");
  EXPECT_EQ(refusal_of("parameters.idle"),
            "--parameter: no expression of the scene uses 'parameters.idle', so varying it changes "
            "nothing");
  EXPECT_EQ(refusal_of("length"),
            "--parameter: 'length' is a parameter of the scene; write 'parameters.length'");
}

}  // namespace
}  // namespace stridor
