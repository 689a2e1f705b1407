// Values that are set in a scene, and the places of its problems.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "io/scene/assignment.hpp"
#include "io/scene/scene_problems.hpp"
#include "io/scene/scene_tree.hpp"

namespace stridor {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::SizeIs;
using Kind = SceneNode::Kind;

Problem set_failure(SceneNode& root, const std::string& assignment) {
  try {
    set_value(root, assignment);
  } catch (const ConfigError& error) {
    EXPECT_EQ(error.problems().size(), 1u);
    return error.problems().at(0);
  }
  return {};
}

TEST(PathOfFile, IsFromTheSceneOrOfAnAssignmentFromTheWorkingDirectory) {
  SceneNode root = read_scene_text("a: {b: x.h5}\nc: /y.h5\nd: [m.mtx]\n", "folder/s.yaml");
  EXPECT_EQ(path_of_file(root, "a.b", "x.h5"), "folder/x.h5");
  EXPECT_EQ(path_of_file(root, "a.b", "../x.h5"), "folder/../x.h5");
  EXPECT_EQ(path_of_file(root, "c", "/y.h5"), "/y.h5");
  EXPECT_EQ(path_of_file(root, "d", "m.mtx"), "folder/m.mtx");
  set_value(root, "a.b=z.h5");
  EXPECT_EQ(path_of_file(root, "a.b", "z.h5"), "z.h5");
  EXPECT_EQ(path_of_file(read_scene_text("c: y.h5\n", "s.yaml"), "c", "y.h5"), "y.h5");
}

// --- set_value
// --------------------------------------------------------------------------------------

TEST(SetValue, ReplacesWhatWasThere) {
  SceneNode root = read_scene_text("a:\n  b: 1\n  c: 2\n", "s.yaml");
  set_value(root, "a.b=75 mm");
  const SceneNode* b = find(root, "a.b");
  EXPECT_EQ(b->text, "75 mm");
  EXPECT_EQ(b->place, (Place{"--set a.b=75 mm", 0, 11}));
  EXPECT_EQ(find(root, "a")->entry("b")->place, (Place{"--set a.b=75 mm", 0, 9}));
  EXPECT_EQ(find(root, "a.c")->text, "2");
  EXPECT_EQ(find(root, "a")->entries.size(), 2u);
  EXPECT_EQ(find(root, "a")->entry("c")->place.line, 3);
}

TEST(SetValue, TakesNumbersAsYamlDoes) {
  // Numbers as programs write them are taken without a look at YAML; with a space before them they
  // are not.
  for (const char* number : {"0", "-3", "1.25", "1e-07", "-2.5E+30", "007", "1e5"}) {
    SceneNode plain = read_scene_text("a: 1\n", "x.yaml");
    SceneNode parsed = plain;
    set_value(plain, std::string("a=") + number);
    set_value(parsed, std::string("a= ") + number);
    const SceneNode& one = plain.entry("a")->value;
    const SceneNode& other = parsed.entry("a")->value;
    EXPECT_EQ(one.kind, other.kind) << number;
    EXPECT_EQ(one.text, other.text);
    EXPECT_EQ(one.is_quoted, other.is_quoted);
    EXPECT_EQ(one.place.column + 1, other.place.column);
  }
  for (const char* text : {"-", "1.", ".5", "1e", "1 2", "--3", "0x10", "1_000"}) {
    SceneNode tree = read_scene_text("a: 1\n", "x.yaml");
    set_value(tree, std::string("a=") + text + " ");
    SceneNode same = read_scene_text("a: 1\n", "x.yaml");
    set_value(same, std::string("a=") + text);
    EXPECT_EQ(same.entry("a")->value.kind, tree.entry("a")->value.kind) << text;
    EXPECT_EQ(same.entry("a")->value.text, tree.entry("a")->value.text) << text;
  }
}

TEST(SetValue, MakesMissingMaps) {
  SceneNode root = read_scene_text("a: 1\nempty:\n", "s.yaml");
  set_value(root, "x.y.z=true");
  EXPECT_EQ(find(root, "x.y.z")->text, "true");
  EXPECT_EQ(find(root, "x.y")->kind, Kind::map);
  EXPECT_EQ(find(root, "x")->place, (Place{"--set x.y.z=true", 0, 7}));
  set_value(root, "empty.key=1");
  EXPECT_EQ(find(root, "empty.key")->text, "1");
}

TEST(SetValue, ReadsListsMapsAndQuotedTexts) {
  SceneNode root = read_scene_text("a: 1\n", "s.yaml");
  set_value(root, "a=[1, 2 kHz]");
  EXPECT_EQ(find(root, "a.1")->text, "2 kHz");
  set_value(root, "a={times: [0, 1], values: [0, 2]}");
  EXPECT_EQ(find(root, "a.values.1")->text, "2");
  set_value(root, "a='x = y'");
  EXPECT_EQ(find(root, "a")->text, "x = y");
  EXPECT_TRUE(find(root, "a")->is_quoted);
  set_value(root, "a=-0.2");
  EXPECT_EQ(find(root, "a")->text, "-0.2");
}

TEST(SetValue, NumberIndexesAList) {
  SceneNode root = read_scene_text("a: [{b: 1}, {b: 2}]\n", "s.yaml");
  set_value(root, "a.1.b=3");
  EXPECT_EQ(find(root, "a.0.b")->text, "1");
  EXPECT_EQ(find(root, "a.1.b")->text, "3");
}

TEST(SetValue, MalformedAssignmentIsRefused) {
  SceneNode root = read_scene_text("a: 1\nl: [1, 2]\ne: []\n", "s.yaml");
  const struct {
    std::string assignment, key, message;
    std::size_t caret;  // in the assignment
  } cases[] = {
      {"a", "", "has no '='", 1},
      {"=1", "", "'' is not a key path", 0},
      {"a..b=1", "", "'a..b' is not a key path", 0},
      {".a=1", "", "is not a key path", 0},
      {"a b=1", "", "'a b' is not a key path", 0},
      {"a=", "a", "has no value", 2},
      {"a=  ", "a", "has no value", 4},
      {"a=[1", "", "the list that begins here is never closed by ']'", 2},
      {"a={b: 1 c: 2}", "", "a ',' or '}' is missing before this in the map", 9},
      {"a=\"x", "", "a quote opened after here is never closed", 2},
      {"a.b=1", "a.b", "'a' is a single value and holds no key 'b'", 2},
      {"l.2=1", "l.2", "'l' is a list; expected an index from 0 to 1, got '2'", 2},
      {"l.x=1", "l.x", "expected an index from 0 to 1, got 'x'", 2},
      {"l.-1=1", "l.-1", "expected an index from 0 to 1, got '-1'", 2},
      {"e.0=1", "e.0", "'e' is an empty list", 2},
  };
  for (const auto& one : cases) {
    const Problem problem = set_failure(root, one.assignment);
    EXPECT_EQ(problem.source, "--set " + one.assignment);
    EXPECT_EQ(problem.line, 0);
    EXPECT_EQ(problem.column, 0);
    EXPECT_EQ(problem.key, one.key) << one.assignment;
    EXPECT_THAT(problem.message, HasSubstr(one.message)) << one.assignment;
    EXPECT_EQ(problem.excerpt, "      | --set " + one.assignment + "\n      |       " +
                                   std::string(one.caret, ' ') + "^");
  }
  EXPECT_EQ(find(root, "a")->text, "1");
  EXPECT_THAT(root.entries, SizeIs(3));
}

TEST(SetValue, WhatIsNoLineOfTextIsRefused) {
  SceneNode root = read_scene_text("a: 1\n", "s.yaml");
  const Problem control = set_failure(root, "a=\x01");
  EXPECT_EQ(control.text(), "--set a=?: control character 0x01; a scene is plain text in UTF-8");
  EXPECT_EQ(control.excerpt, "      | --set a=?\n      |         ^");
  EXPECT_EQ(set_failure(root, "a\xFF=1").text(),
            "--set a?=1: byte 0xFF is not UTF-8; save the text as UTF-8");
  EXPECT_THAT(set_failure(root, "a=1\nb: 2").text(), HasSubstr("--set a=1?b: 2: has a line break"));
}

TEST(SetValue, LongAssignmentIsRefused) {
  SceneNode root = read_scene_text("a: 1\n", "s.yaml");
  const std::string longest = "a=" + std::string(SceneLimits::assignment - 2, 'x');
  EXPECT_EQ(set_failure(root, longest).message, "");
  EXPECT_THAT(set_failure(root, longest + "x").text(),
              AllOf(HasSubstr("--set a=xxx"), HasSubstr("...: is longer than 16 KiB")));
}

TEST(SetValue, DeepPathIsRefused) {
  SceneNode root = read_scene_text("a: 1\n", "s.yaml");
  std::string path = "b";
  for (std::size_t i = 0; i < SceneLimits::levels; ++i) path += ".b";
  EXPECT_THAT(set_failure(root, path + "=1").message, HasSubstr("nested deeper than 32 levels"));
  EXPECT_EQ(find(root, "b"), nullptr);
}

TEST(SetValue, DuplicateInTheValueIsKeptAsAProblem) {
  SceneNode root = read_scene_text("a: 1\n", "s.yaml");
  set_value(root, "a={b: 1, b: 2}");
  std::vector<Problem> problems;
  collect_text_problems(root, "", problems);
  ASSERT_THAT(problems, SizeIs(1));
  EXPECT_EQ(problems[0].text(), "--set a={b: 1, b: 2}: a.b: is given twice; remove one of them");
}

// --- places
// -----------------------------------------------------------------------------------------

TEST(Locate, GivesTheKeyOrItsNearestAncestor) {
  SceneNode root = read_scene_text("a: 1\nb:\n  c: [5, 6]\n", "s.yaml");
  set_value(root, "d=3");
  const auto problem = [](const char* key) { return Problem{Refusal::wrong_value, key, "m"}; };
  std::vector<Problem> problems{problem("b.c.1"),
                                problem("b.c.7"),
                                problem("b.missing.x"),
                                problem("nowhere"),
                                problem(""),
                                problem("d"),
                                {Refusal::wrong_value, "a", "m", "other", 7, 8}};
  locate(problems, root);
  const Place expected[] = {{"s.yaml", 3, 10}, {"s.yaml", 3, 6}, {"s.yaml", 2, 1},
                            {"s.yaml", 1, 1},  {"s.yaml", 0, 0}, {"--set d=3", 0, 0},
                            {"other", 7, 8}};
  for (std::size_t i = 0; i < problems.size(); ++i) {
    EXPECT_EQ((Place{problems[i].source, problems[i].line, problems[i].column}), expected[i]) << i;
  }
  EXPECT_EQ(problems[0].excerpt, "    3 |   c: [5, 6]\n      |          ^");
  EXPECT_EQ(problems[4].excerpt, "");
  EXPECT_EQ(problems[5].excerpt, "      | --set d=3\n      |         ^");
  EXPECT_EQ(problems[6].excerpt, "");
}

TEST(SortByPlace, FileComesFirstAndEqualPlacesKeepTheirOrder) {
  std::vector<Problem> problems{{Refusal::wrong_value, "set", "", "--set", 0, 0},
                                {Refusal::wrong_value, "b", "", "f", 2, 5},
                                {Refusal::wrong_value, "c", "", "f", 2, 1},
                                {Refusal::wrong_value, "first", "", "f", 1, 9},
                                {Refusal::wrong_value, "second", "", "f", 1, 9}};
  sort_by_place(problems);
  std::vector<std::string> keys;
  for (const Problem& problem : problems) keys.push_back(problem.key);
  EXPECT_THAT(keys, testing::ElementsAre("first", "second", "c", "b", "set"));
}

}  // namespace
}  // namespace stridor
