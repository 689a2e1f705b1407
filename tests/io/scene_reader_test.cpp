#include "io/scene/scene_reader.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "io/scene/assignment.hpp"
#include "tests/io/example_scene.hpp"

namespace stridor {
namespace {

using test::Example;
using test::kExampleText;
using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

std::vector<Problem> problems_of(const SceneNode& root) {
  try {
    read_as<Example>(root);
  } catch (const ConfigError& error) {
    return error.problems();
  }
  return {};
}

std::vector<Problem> problems_in(const std::string& text) {
  return problems_of(read_scene_text(text, "s.yaml"));
}

/// The example with the first occurrence of `from` replaced.
std::string with(const std::string& from, const std::string& to) {
  std::string text = kExampleText;
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

/// Line of the first occurrence of `what` in the example.
int line_of(const std::string& what) {
  const std::size_t at = kExampleText.find(what);
  EXPECT_NE(at, std::string::npos) << what;
  return 1 +
         static_cast<int>(std::count(kExampleText.begin(),
                                     kExampleText.begin() + static_cast<std::ptrdiff_t>(at), '\n'));
}

void expect_problem(const Problem& problem, int line, int column, const std::string& key,
                    const std::string& message) {
  EXPECT_EQ(problem.source, "s.yaml");
  EXPECT_EQ(problem.line, line) << problem.text();
  EXPECT_EQ(problem.column, column) << problem.text();
  EXPECT_EQ(problem.key, key) << problem.text();
  EXPECT_THAT(problem.message, HasSubstr(message));
}

/// `from` replaced by `to` gives exactly one problem, in the line of `from`.
void expect_only(const std::string& from, const std::string& to, int column, const std::string& key,
                 const std::string& message) {
  const auto problems = problems_in(with(from, to));
  ASSERT_THAT(problems, SizeIs(1)) << to;
  expect_problem(problems[0], line_of(from), column, key, message);
}

// --- accepted input
// -----------------------------------------------------------------------------------

TEST(SceneReader, EveryKindOfKeyIsRead) {
  const auto scene = read_as<Example>(read_scene_text(kExampleText, "s.yaml"));
  EXPECT_EQ(scene.format, 2);
  EXPECT_EQ(scene.title, "squeal");
  EXPECT_EQ(scene.scheme, test::Scheme::exact);
  EXPECT_THAT(scene.band, testing::ElementsAre(2500.0, 15000.0));
  EXPECT_TRUE(scene.velocity.is_constant());
  EXPECT_EQ(scene.velocity.value(0.0), 0.03);
  ASSERT_TRUE(scene.load);
  EXPECT_EQ(scene.load->table(), (TimeTable{{0.0, 0.1}, {0.0, -0.2}}));
  const auto& beam = std::get<test::Beam>(scene.bodies.at("oblique"));
  EXPECT_EQ(beam.length, 0.075);
  EXPECT_DOUBLE_EQ(beam.angle, 0.52359877559829887);
  EXPECT_EQ(beam.elements, 37);
  EXPECT_EQ(beam.modes, 20);
  EXPECT_EQ(beam.material.youngs_modulus, 71e9);
  EXPECT_EQ(std::get<test::Lumped>(scene.bodies.at("tip")).mass, 0.002);
  EXPECT_EQ(scene.materials.at("steel").poissons_ratio, 0.3);
  ASSERT_TRUE(scene.friction);
  EXPECT_EQ(scene.friction->decay_velocity, 0.01);
  ASSERT_THAT(scene.expect, SizeIs(2));
  EXPECT_EQ(scene.expect[1].result, "force.max");
  EXPECT_FALSE(scene.recording.energy);
  EXPECT_THAT(scene.recording.channels, testing::ElementsAre("force", "tip.y"));
}

TEST(SceneReader, AbsentOptionalsKeepTheirDefaults) {
  const auto scene =
      read_as<Example>(read_scene_text("format: 2\nvelocity: 1\nbodies: {}\n", "s.yaml"));
  EXPECT_EQ(scene.scheme, test::Scheme::central);
  EXPECT_FALSE(scene.load);
  EXPECT_FALSE(scene.friction);
  EXPECT_TRUE(scene.recording.energy);
  EXPECT_THAT(scene.recording.channels, testing::ElementsAre("force"));
}

TEST(SceneReader, QuotesMakeNoDifference) {
  const auto scene = read_as<Example>(read_scene_text(
      "\"format\": '1'\nvelocity: \"30 mm/s\"\nscheme: 'exact'\nenergy: \"false\"\nbodies: {}\n",
      "s.yaml"));
  EXPECT_EQ(scene.format, 1);
  EXPECT_EQ(scene.velocity.value(0.0), 0.03);
  EXPECT_EQ(scene.scheme, test::Scheme::exact);
  EXPECT_FALSE(scene.recording.energy);
}

TEST(SceneReader, LeadingZeroIsNotOctal) {
  EXPECT_EQ(read_as<Example>(read_scene_text(with("format: 2", "format: 010"), "s.yaml")).format,
            10);
  EXPECT_EQ(std::get<test::Lumped>(
                read_as<Example>(read_scene_text(with("mass: 2 g", "mass: 010"), "s.yaml"))
                    .bodies.at("tip"))
                .mass,
            10.0);
}

TEST(SceneReader, SingleTextIsAListOfOne) {
  const auto scene = read_as<Example>(
      read_scene_text(with("channels: [force, tip.y]", "channels: all"), "s.yaml"));
  EXPECT_THAT(scene.recording.channels, testing::ElementsAre("all"));
}

TEST(SceneReader, AliasFillsASection) {
  const auto scene = read_as<Example>(
      read_scene_text("format: 2\nvelocity: 1\nmaterials:\n  a: &m {youngs_modulus: 1, "
                      "poissons_ratio: 0}\n  b: *m\nbodies: {}\n",
                      "s.yaml"));
  EXPECT_EQ(scene.materials.at("a"), scene.materials.at("b"));
}

TEST(SceneReader, TableWithOneEntryIsAConstant) {
  const auto scene = read_as<Example>(
      read_scene_text(with("velocity: 30 mm/s", "velocity: {times: [3], values: [2]}"), "s.yaml"));
  EXPECT_EQ(scene.velocity.table(), (TimeTable{{0.0}, {2.0}}));
}

TEST(SceneReader, SectionIsReadWithThePathGiven) {
  const SceneNode root = read_scene_text("m: {youngs_modulus: -1, poissons_ratio: 0}\n", "s.yaml");
  test::Material material;
  std::vector<Problem> problems;
  read_section(*find(root, "m"), test::Material::schema(), &material, "m", problems);
  ASSERT_THAT(problems, SizeIs(1));
  expect_problem(problems[0], 1, 21, "m.youngs_modulus", "must be > 0");
}

// --- keys
// -------------------------------------------------------------------------------------------

TEST(SceneReader, UnknownKeyNamesPlaceAndSuggestion) {
  const auto problems = problems_in(with("length: 75", "lenght: 75"));
  ASSERT_THAT(problems, SizeIs(2));
  expect_problem(problems[0], line_of("  oblique:"), 3, "bodies.oblique.length",
                 "required key 'length' is missing, expected a number in m: Length of the axis.");
  expect_problem(problems[1], line_of("length:"), 5, "bodies.oblique.lenght",
                 "unknown key 'lenght', did you mean 'length'?");
}

TEST(SceneReader, UnknownKeyFarFromAllListsTheKnownOnes) {
  expect_only("coefficient: 0.3", "viscosity: 3\n  coefficient: 0.3", 3, "friction.viscosity",
              "unknown key 'viscosity'; known here: coefficient, decay_velocity");
}

TEST(SceneReader, DiscriminatorIsAmongTheKnownKeys) {
  const auto problems = problems_in(with("mass: 2 g", "mass: 2 g\n    typ: 3"));
  ASSERT_THAT(problems, SizeIs(1));
  expect_problem(problems[0], line_of("mass:") + 1, 5, "bodies.tip.typ", "did you mean 'type'?");
}

TEST(SceneReader, MissingSpaceAfterTheColonIsNamed) {
  const auto problems = problems_in(
      "format: 2\nvelocity: 1\nbodies: {}\nmaterials: {a:1}\nfriction: {coefficient: 1, zz:2}\n");
  ASSERT_THAT(problems, SizeIs(2));
  expect_problem(problems[0], 4, 13, "materials.a:1", "'a:1' cannot be a name");
  expect_problem(problems[1], 5, 28, "friction.zz:2",
                 "unknown key 'zz:2'; write a space after the colon");
}

TEST(SceneReader, DuplicateKeyIsReportedWithTheRest) {
  const auto problems =
      problems_in(with("    mass: 2 g", "    mass: 2 g\n    mass: 3 g\n    colour: red"));
  ASSERT_THAT(problems, SizeIs(2));
  expect_problem(problems[0], line_of("mass:") + 1, 5, "bodies.tip.mass",
                 fmt::format("is given twice, first in line {}", line_of("mass:")));
  expect_problem(problems[1], line_of("mass:") + 2, 5, "bodies.tip.colour", "unknown key 'colour'");
}

TEST(SceneReader, DuplicateBelowAnUnknownKeyIsReportedToo) {
  const auto problems = problems_in(kExampleText + "nonsense: {a: 1, a: 2}\n");
  ASSERT_THAT(problems, SizeIs(2));
  EXPECT_EQ(problems[1].key, "nonsense.a");
}

TEST(SceneReader, MissingRootKeysAreReportedAtTheTop) {
  const auto problems = problems_in("title: x\n");
  ASSERT_THAT(problems, SizeIs(3));
  expect_problem(problems[0], 1, 1, "format",
                 "required key 'format' is missing, expected a whole number");
  expect_problem(problems[1], 1, 1, "velocity",
                 "expected a number in m/s or {times: [...], values: [...]}: Velocity.");
  expect_problem(problems[2], 1, 1, "bodies", "expected a map of named maps: Bodies.");
}

TEST(SceneReader, KeyWithoutValueIsReported) {
  expect_only("title: squeal", "title:", 1, "title", "has no value, expected a text");
  expect_only("title: squeal", "title: null", 1, "title", "has no value, expected a text");
  expect_only("channels: [force, tip.y]", "channels: [force, null]", 19, "channels.1",
              "has no value, expected a text");
  expect_only("band: [2.5 kHz, 15 kHz]", "band: [~]", 8, "band.0",
              "has no value, expected a number in Hz");
}

// --- scalars
// ----------------------------------------------------------------------------------------

TEST(SceneReader, WrongTypeIsNamed) {
  expect_only("length: 75 mm", "length: {a: 1}", 13, "bodies.oblique.length",
              "expected a number in m, got a map");
  expect_only("length: 75 mm", "length: [1]", 13, "bodies.oblique.length",
              "expected a number in m, got a list");
  expect_only("length: 75 mm", "length: long", 13, "bodies.oblique.length",
              "'long' is not a number, expected a length in m");
  expect_only("title: squeal", "title: [a]", 8, "title", "expected a text, got a list");
  expect_only("band: [2.5 kHz, 15 kHz]", "band: 3", 7, "band",
              "expected a list of numbers in Hz, got '3'");
  expect_only("channels: [force, tip.y]", "channels: {a: b}", 11, "channels",
              "expected a text or a list of texts, got a map");
  expect_only("velocity: 30 mm/s", "velocity: [1]", 11, "velocity",
              "expected a number in m/s or {times: [...], values: [...]}, got a list");
}

TEST(SceneReader, RangeIsNamedWithValueAndUnit) {
  expect_only("length: 75 mm", "length: -0.075", 13, "bodies.oblique.length",
              "must be > 0, got -0.075 m");
  expect_only("length: 75 mm", "length: -75 mm", 13, "bodies.oblique.length",
              "must be > 0, got -0.075 m (written '-75 mm')");
  expect_only("length: 75 mm", "length: 0", 13, "bodies.oblique.length", "must be > 0, got 0 m");
  expect_only("angle: 30 deg", "angle: 4", 12, "bodies.oblique.angle",
              "must be in [-3.2, 3.2] rad, got 4 rad");
  expect_only("ratio: 0.33", "ratio: 0.5", 23, "bodies.oblique.material.poissons_ratio",
              "must be in (-1, 0.5), got 0.5");
}

TEST(SceneReader, ValueJustOutsideTheRangeIsShownInFull) {
  expect_only("angle: 30 deg", "angle: 3.2000000000000006", 12, "bodies.oblique.angle",
              "got 3.2000000000000006 rad");
}

TEST(SceneReader, NotFiniteIsRefused) {
  for (const std::string text : {".nan", ".inf", "-.inf", "nan", "inf"}) {
    expect_only("length: 75 mm", "length: " + text, 13, "bodies.oblique.length",
                "must be finite, got '" + text + "'");
  }
}

TEST(SceneReader, WrongUnitIsNamed) {
  expect_only("length: 75 mm", "length: 75 kg", 13, "bodies.oblique.length",
              "'75 kg' has unit kg, expected a length in m");
  expect_only("coefficient: 0.3", "coefficient: 0.3 m", 16, "friction.coefficient",
              "expected a number without unit");
}

TEST(SceneReader, IntegersAreStrict) {
  for (const std::string text :
       {"1.5", "1.0", "1e3", "37 m", "0x10", "ten", "", "+", "--1", "+-1", "1 "}) {
    expect_only("elements: 37", "elements: '" + text + "'", 15, "bodies.oblique.elements",
                "expected a whole number without unit, got '" + text + "'");
  }
  expect_only("elements: 37", "elements: [1]", 15, "bodies.oblique.elements",
              "expected a whole number, got a list");
}

TEST(SceneReader, IntegerRangeIsNamed) {
  expect_only("elements: 37", "elements: 0", 15, "bodies.oblique.elements", "must be > 0, got 0");
  expect_only("modes: 20", "modes: -1", 12, "bodies.oblique.modes", "must be >= 0, got -1");
}

TEST(SceneReader, IntegerThatItsMemberCannotHoldIsRefused) {
  expect_only("format: 2", "format: 256", 9, "format", "is too far from 0 to be stored, got '256'");
  expect_only("elements: 37", "elements: 2147483648", 15, "bodies.oblique.elements",
              "is too far from 0");
  expect_only("modes: 20", "modes: 9223372036854775808", 12, "bodies.oblique.modes",
              "is too far from 0");
}

TEST(SceneReader, FlagIsTrueOrFalse) {
  for (const std::string text : {"yes", "no", "on", "True", "FALSE", "1", "0"}) {
    expect_only("energy: false", "energy: " + text, 9, "energy",
                "expected true or false, got '" + text + "'");
  }
}

TEST(SceneReader, ChoiceListsTheAllowedAndSuggests) {
  expect_only("scheme: exact", "scheme: exakt", 9, "scheme",
              "expected one of central, exact, got 'exakt', did you mean 'exact'?");
  expect_only("scheme: exact", "scheme: [exact]", 9, "scheme",
              "expected one of central, exact, got a list");
}

TEST(SceneReader, EntriesOfListsAreReportedOneByOne) {
  const auto problems = problems_in(with("[2.5 kHz, 15 kHz]", "[2.5 s, 15 kHz, -1, [2]]"));
  ASSERT_THAT(problems, SizeIs(3));
  expect_problem(problems[0], 4, 8, "band.0", "'2.5 s' has unit s, expected a frequency in Hz");
  expect_problem(problems[1], 4, 23, "band.2", "must be >= 0, got -1 Hz");
  expect_problem(problems[2], 4, 27, "band.3", "expected a number in Hz, got a list");
}

TEST(SceneReader, LongAndBrokenTextsAreShortenedToOneLine) {
  const auto problems =
      problems_in(with("length: 75 mm", "length: \"75\\nmm " + std::string(90, 'x') + "\""));
  ASSERT_THAT(problems, SizeIs(1));
  EXPECT_EQ(problems[0].message,
            "expected a number in m, got '75 mm " + std::string(54, 'x') + "...'");
}

TEST(SceneReader, TagOfAValueIsReported) {
  expect_only("length: 75 mm", "length: !!float 75", 13, "bodies.oblique.length",
              "has no meaning in a scene");
}

// --- curves
// -----------------------------------------------------------------------------------------

TEST(SceneReader, CurveIsCheckedAtItsPlaces) {
  const std::string from = "velocity: 30 mm/s";
  expect_only(from, "velocity: {times: [0, 2, 1], values: [1, 2, 3]}", 26, "velocity.times.2",
              "times must increase strictly, got 1 s after 2 s");
  expect_only(from, "velocity: {times: [0, 0], values: [1, 2]}", 23, "velocity.times.1",
              "times must increase strictly");
  expect_only(from, "velocity: {times: [0, 1], values: [1, 2, 3]}", 35, "velocity.values",
              "has 3 entries but times has 2; give one value for each time");
  expect_only(from, "velocity: {times: [], values: []}", 19, "velocity.times",
              "needs at least one time");
  expect_only(from, "velocity: {times: [0, 1 m], values: [1, 2]}", 23, "velocity.times.1",
              "expected a time in s");
  expect_only(from, "velocity: {times: [0, .inf], values: [1, 2]}", 23, "velocity.times.1",
              "must be finite");
  expect_only(from, "velocity: {times: [0, 1], values: [1, 20]}", 39, "velocity.values.1",
              "must be in [-10, 10] m/s, got 20 m/s");
  expect_only(from, "velocity: {times: [0, 1]}", 11, "velocity.values",
              "required key 'values' is missing, expected a list of numbers in m/s");
  expect_only(from, "velocity: {times: , values: [1]}", 12, "velocity.times", "has no value");
  expect_only(from, "velocity: {times: 3, values: [1]}", 19, "velocity.times",
              "expected a list of numbers in s, got '3'");
  expect_only(from, "velocity: {times: [0], values: [1], valves: 3}", 37, "velocity.valves",
              "unknown key 'valves', did you mean 'values'?");
  expect_only(from, "velocity: {times: [0], values: [1], times: [1]}", 37, "velocity.times",
              "is given twice");
}

TEST(SceneReader, MisspeltDiscriminatorIsFound) {
  const auto problems = problems_in(with("type: lumped", "tpye: lumped"));
  ASSERT_THAT(problems, SizeIs(2));
  expect_problem(problems[0], line_of("  tip:"), 3, "bodies.tip.type",
                 "required key 'type' is missing, expected one of beam, lumped");
  expect_problem(problems[1], line_of("type: lumped"), 5, "bodies.tip.tpye",
                 "unknown key 'tpye', did you mean 'type'?");
}

TEST(SceneReader, KeyThatNoAlternativeKnowsIsReportedThoughTheDiscriminatorIsWrong) {
  const auto problems =
      problems_in(with("type: lumped\n    mass: 2 g", "type: x\n    mass: 2 g\n    colour: red"));
  ASSERT_THAT(problems, SizeIs(2));
  EXPECT_EQ(problems[0].key, "bodies.tip.type");
  expect_problem(problems[1], line_of("mass:") + 1, 5, "bodies.tip.colour",
                 "unknown key 'colour'; known here: type, length, angle, elements, modes, "
                 "material, mass");
}

// --- sections
// ---------------------------------------------------------------------------------------

TEST(SceneReader, SectionMustBeAMap) {
  expect_only("friction:\n  coefficient: 0.3\n  decay_velocity: 10 mm/s", "friction: 0.3", 11,
              "friction", "expected a map, got '0.3'");
  expect_only("friction:\n  coefficient: 0.3\n  decay_velocity: 10 mm/s", "friction:", 1,
              "friction", "has no value, expected a map");
  const auto problems =
      problems_in("format: 2\nvelocity: 1\nbodies: {}\nexpect: {result: a, value: 1}\n");
  ASSERT_THAT(problems, SizeIs(1));
  expect_problem(problems[0], 4, 9, "expect", "expected a list of maps, got a map");
}

TEST(SceneReader, EntryOfASectionListMustBeAMap) {
  const auto problems =
      problems_in("format: 2\nvelocity: 1\nbodies: {}\nexpect: [3, {result: a, value: b}]\n");
  ASSERT_THAT(problems, SizeIs(2));
  expect_problem(problems[0], 4, 10, "expect.0", "expected a map, got '3'");
  expect_problem(problems[1], 4, 32, "expect.1.value", "'b' is not a number");
}

TEST(SceneReader, DiscriminatorIsRequiredAndKnown) {
  auto problems = problems_in(with("    type: lumped\n", ""));
  expect_problem(problems.at(0), line_of("  tip:"), 3, "bodies.tip.type",
                 "required key 'type' is missing, expected one of beam, lumped");
  expect_only("type: lumped", "type: lumpd", 11, "bodies.tip.type",
              "expected one of beam, lumped, got 'lumpd', did you mean 'lumped'?");
  expect_only("type: lumped", "type:", 5, "bodies.tip.type",
              "has no value, expected one of beam, lumped");
  expect_only("type: lumped", "type: [beam]", 11, "bodies.tip.type",
              "expected one of beam, lumped, got a list");
}

TEST(SceneReader, NameOfASectionFitsIntoChannels) {
  for (const std::string name : {"a.b", "1st", "-x", "a b", "\"\"", "é"}) {
    const auto problems = problems_in(with("  tip:", "  " + name + ":"));
    ASSERT_THAT(problems, SizeIs(1)) << name;
    EXPECT_EQ(problems[0].line, line_of("  tip:"));
    EXPECT_EQ(problems[0].column, 3);
    EXPECT_THAT(problems[0].message,
                HasSubstr("cannot be a name; use letters, digits, '_' and '-'"));
  }
  EXPECT_THAT(problems_in(with("  tip:", "  _Tip-2:")), IsEmpty());
}

TEST(SceneReader, NamedSectionMustBeAMap) {
  expect_only("  tip:\n    type: lumped\n    mass: 2 g", "  tip: 3", 8, "bodies.tip",
              "expected a map, got '3'");
  expect_only("  tip:\n    type: lumped\n    mass: 2 g", "  tip:", 3, "bodies.tip",
              "has no value, expected a map");
  expect_only("materials:\n  steel:\n    youngs_modulus: 210 GPa\n    poissons_ratio: 0.3\n",
              "materials: [1]\n", 12, "materials", "expected a map of named maps, got a list");
}

// --- checks between keys
// ----------------------------------------------------------------------------

TEST(SceneReader, CheckIsPlacedAtItsKey) {
  expect_only("modes: 20", "modes: 38", 12, "bodies.oblique.modes", "must not exceed elements");
  expect_only("band: [2.5 kHz, 15 kHz]", "band: [3, 2]", 7, "band", "must begin below its end");
}

TEST(SceneReader, CheckWaitsUntilTheSectionIsRight) {
  // The band is wrong in itself; that it also begins above its end is not known.
  const auto problems = problems_in(with("band: [2.5 kHz, 15 kHz]", "band: [3, 2]\ncolour: red"));
  ASSERT_THAT(problems, SizeIs(1));
  EXPECT_EQ(problems[0].key, "colour");
}

TEST(SceneReader, CheckOfOneSectionRunsThoughAnotherIsWrong) {
  const auto problems = problems_in(with("modes: 20", "modes: 38") + "colour: red\n");
  ASSERT_THAT(problems, SizeIs(2));
  EXPECT_EQ(problems[0].key, "bodies.oblique.modes");
}

// --- --set
// ------------------------------------------------------------------------------------------

TEST(SceneReader, ProblemFromSetNamesItAndComesLast) {
  SceneNode root = read_scene_text(with("energy: false", "energy: 2"), "s.yaml");
  set_value(root, "bodies.oblique.length=-3");
  set_value(root, "contcat.start=1");
  const auto problems = problems_of(root);
  ASSERT_THAT(problems, SizeIs(3));
  EXPECT_EQ(problems[0].key, "energy");
  EXPECT_EQ(problems[1].text(),
            "--set bodies.oblique.length=-3: bodies.oblique.length: must be > 0, got -3 m");
  EXPECT_THAT(problems[2].text(),
              HasSubstr("--set contcat.start=1: contcat: unknown key 'contcat'"));
}

TEST(SceneReader, ProblemShowsItsLineWithACaret) {
  EXPECT_EQ(problems_in(with("scheme: exact", "scheme:  exakt  # µ")).at(0).excerpt,
            "    3 | scheme:  exakt  # µ\n"
            "      |          ^");
  EXPECT_EQ(problems_in("title: x\nvelocity: 1\nbodies: {}\n").at(0).excerpt,
            "    1 | title: x\n"
            "      | ^");
}

TEST(SceneReader, ProblemFromSetShowsTheAssignmentWithACaret) {
  SceneNode root = read_scene_text(kExampleText, "s.yaml");
  set_value(root, "bodies.oblique.length=-3");
  set_value(root, "bodies.tip.mas=1");
  set_value(root, "velocity={times: [0, 1], values: [0, 2 kg]}");
  std::vector<std::string> excerpts;
  for (const Problem& problem : problems_of(root)) {
    EXPECT_EQ(problem.line, 0);
    EXPECT_EQ(problem.column, 0);
    excerpts.push_back(problem.excerpt);
  }
  EXPECT_THAT(excerpts, testing::UnorderedElementsAre(
                            "      | --set bodies.oblique.length=-3\n"
                            "      |                             ^",
                            "      | --set bodies.tip.mas=1\n"
                            "      |                  ^",
                            "      | --set velocity={times: [0, 1], values: [0, 2 kg]}\n"
                            "      |                                            ^"));
}

TEST(SceneReader, ValuesFromSetAreTyped) {
  SceneNode root = read_scene_text(kExampleText, "s.yaml");
  set_value(root, "velocity={times: [0, 1], values: [0, 40 mm/s]}");
  set_value(root, "expect.1.value=3");
  set_value(root, "energy=true");
  const auto scene = read_as<Example>(root);
  EXPECT_EQ(scene.velocity.value(2.0), 0.04);
  EXPECT_EQ(scene.expect[1].value, 3.0);
  EXPECT_TRUE(scene.recording.energy);
}

// --- all together
// -----------------------------------------------------------------------------------

TEST(SceneReader, AllProblemsComeAtOnceInTheOrderOfTheFile) {
  std::string text = kExampleText;
  for (const auto& [from, to] :
       std::vector<std::pair<std::string, std::string>>{{"format: 2", "format: one"},
                                                        {"exact", "exakt"},
                                                        {"75 mm", "75 kg"},
                                                        {"mass", "maas"},
                                                        {"false", "off"}}) {
    text.replace(text.find(from), from.size(), to);
  }
  const auto problems = problems_in(text);
  ASSERT_THAT(problems, SizeIs(6));
  for (std::size_t i = 1; i < problems.size(); ++i)
    EXPECT_LE(problems[i - 1].line, problems[i].line);
}

}  // namespace
}  // namespace stridor
