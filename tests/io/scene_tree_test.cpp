#include "io/scene/scene_tree.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "io/scene/scene_problems.hpp"
#include "tests/support/temporary_folder.hpp"

namespace stridor {
namespace {

using test::TemporaryFolder;
using test::write_file;
using testing::AllOf;
using testing::HasSubstr;
using testing::SizeIs;
using Kind = SceneNode::Kind;

/// The one problem for which the text is refused as a whole; an empty message where it is not.
Problem fatal(const std::string& text) {
  try {
    read_scene_text(text, "s.yaml");
  } catch (const ConfigError& error) {
    EXPECT_EQ(error.problems().size(), 1u);
    return error.problems().at(0);
  }
  return {};
}

/// The problems that leave the rest readable.
std::vector<Problem> problems_of_text(const std::string& text) {
  std::vector<Problem> problems;
  collect_text_problems(read_scene_text(text, "s.yaml"), "", problems);
  return problems;
}

void expect_at(const Problem& problem, int line, int column, const std::string& key,
               const std::string& message) {
  EXPECT_EQ(problem.source, "s.yaml");
  EXPECT_EQ(problem.line, line) << problem.text();
  EXPECT_EQ(problem.column, column) << problem.text();
  EXPECT_EQ(problem.key, key) << problem.text();
  EXPECT_THAT(problem.message, HasSubstr(message));
}

const Place kNowhere{};

// --- accepted input
// -----------------------------------------------------------------------------------

TEST(SceneTree, MapsListsAndScalarsKeepTheirPlaces) {
  const SceneNode root = read_scene_text("a: 1\nb:\n  c: [x, 'y z']\n  d: {e: f}\n", "s.yaml");
  EXPECT_EQ(root.kind, Kind::map);
  EXPECT_EQ(root.place, (Place{"s.yaml", 1, 1}));
  const SceneEntry& b = root.entries.at(1);
  EXPECT_EQ(b.key, "b");
  EXPECT_EQ(b.place, (Place{"s.yaml", 2, 1}));
  const SceneNode* c = find(root, "b.c");
  ASSERT_NE(c, nullptr);
  EXPECT_EQ(c->kind, Kind::list);
  EXPECT_EQ(c->place, (Place{"s.yaml", 3, 6}));
  EXPECT_EQ(c->items.at(0).text, "x");
  EXPECT_FALSE(c->items.at(0).is_quoted);
  EXPECT_EQ(c->items.at(1).text, "y z");
  EXPECT_TRUE(c->items.at(1).is_quoted);
  EXPECT_EQ(c->items.at(1).place, (Place{"s.yaml", 3, 10}));
  EXPECT_EQ(find(root, "b.d.e")->text, "f");
  EXPECT_TRUE(problems_of_text("a: 1\n").empty());
}

TEST(SceneTree, IndentedMapHasThePlaceOfItsKey) {
  const SceneNode root = read_scene_text("a: 1\nbeam:\n\n  length: 2\nlist:\n  - 1\n", "s.yaml");
  EXPECT_EQ(find(root, "beam")->place, (Place{"s.yaml", 2, 1}));
  EXPECT_EQ(find(root, "list")->place, (Place{"s.yaml", 5, 1}));
  EXPECT_EQ(find(root, "list.0")->place, (Place{"s.yaml", 6, 5}));
}

TEST(SceneTree, NothingIsNullAndQuotedNothingIsText) {
  const SceneNode root =
      read_scene_text("a:\nb: ~\nc: null\nd: ''\ne: \"null\"\nf: {}\n", "s.yaml");
  for (const std::string key : {"a", "b", "c"}) EXPECT_EQ(find(root, key)->kind, Kind::null) << key;
  EXPECT_EQ(find(root, "d")->kind, Kind::scalar);
  EXPECT_EQ(find(root, "e")->text, "null");
  EXPECT_EQ(find(root, "f")->kind, Kind::map);
}

TEST(SceneTree, ScalarsStayText) {
  const SceneNode root = read_scene_text("a: 010\nb: yes\nc: 75 mm\nd: 1:30\ne: µm\n", "s.yaml");
  EXPECT_EQ(find(root, "a")->text, "010");
  EXPECT_EQ(find(root, "b")->text, "yes");
  EXPECT_EQ(find(root, "c")->text, "75 mm");
  EXPECT_EQ(find(root, "d")->text, "1:30");
  EXPECT_EQ(find(root, "e")->text, "µm");
}

TEST(SceneTree, AliasIsTheValueOfItsAnchor) {
  const SceneNode root = read_scene_text("a: &m {x: 1}\nb: *m\nc: [*m, *m]\n", "s.yaml");
  EXPECT_EQ(find(root, "b.x")->text, "1");
  EXPECT_EQ(find(root, "c.1.x")->text, "1");
  EXPECT_EQ(find(root, "b.x")->place.line, 1);  // where the text stands that would have to change
}

TEST(SceneTree, ByteOrderMarkAndCarriageReturnsAreRead) {
  const SceneNode root = read_scene_text(
      "\xEF\xBB\xBF"
      "a: 1\r\nb: 2\r\n",
      "s.yaml");
  EXPECT_EQ(find(root, "a")->text, "1");
  EXPECT_EQ(find(root, "b")->text, "2");
}

TEST(Find, IsExact) {
  const SceneNode root = read_scene_text("a: {b: 1}\n", "s.yaml");
  EXPECT_EQ(find(root, ""), &root);
  EXPECT_NE(find(root, "a.b"), nullptr);
  EXPECT_EQ(find(root, "a.b.c"), nullptr);
  EXPECT_EQ(find(root, "a."), nullptr);
  EXPECT_NE(place_of(root, "a.x"), kNowhere);
}

// --- errors that leave the rest readable
// ---------------------------------------------------------------------

TEST(SceneTree, DuplicateKeyNamesBothLines) {
  const auto problems = problems_of_text("a:\n  x: 1\n  y: 2\n  x: 3\n");
  ASSERT_THAT(problems, SizeIs(1));
  expect_at(problems[0], 4, 3, "a.x", "is given twice, first in line 2; remove one of them");
}

TEST(SceneTree, FirstOfDuplicateKeysIsKept) {
  const SceneNode root = read_scene_text("x: 1\nx: 2\n", "s.yaml");
  ASSERT_THAT(root.entries, SizeIs(1));
  EXPECT_EQ(root.entries[0].value.text, "1");
}

TEST(SceneTree, DuplicateKeyInFlowMapIsFoundThoughQuotedDifferently) {
  const auto problems = problems_of_text("a: {x: 1, \"x\": 2}\n");
  ASSERT_THAT(problems, SizeIs(1));
  expect_at(problems[0], 1, 11, "a.x", "is given twice");
}

TEST(SceneTree, MergeKeyIsRefused) {
  const auto problems = problems_of_text("a: &m {x: 1}\nb:\n  <<: *m\n  y: 2\n");
  ASSERT_THAT(problems, SizeIs(1));
  expect_at(problems[0], 3, 3, "b.<<", "merge keys are not read");
}

TEST(SceneTree, KeyThatIsNoNameIsRefused) {
  auto problems = problems_of_text("a:\n  ? [1, 2]\n  : 3\n");
  ASSERT_THAT(problems, SizeIs(1));
  expect_at(problems[0], 2, 5, "a", "a key must be a plain name");
  problems = problems_of_text("a:\n  {x: 1}: 3\n");
  ASSERT_THAT(problems, SizeIs(1));
  expect_at(problems[0], 2, 3, "a", "a key must be a plain name");
  problems = problems_of_text("null: 3\n");
  ASSERT_THAT(problems, SizeIs(1));
  expect_at(problems[0], 1, 1, "", "a key must be a plain name");
}

TEST(SceneTree, KeyWithALineBreakIsRefused) {
  const auto problems = problems_of_text("\"a\\nb\": 1\n");
  ASSERT_THAT(problems, SizeIs(1));
  expect_at(problems[0], 1, 1, "", "a key must be a plain name");
}

TEST(SceneTree, MessagesAreUtf8WhateverTheParserQuotes) {
  EXPECT_EQ(fatal("a: \"\\\xC3\xA9\"\n").message, "not YAML: unknown escape character: ?");
}

TEST(SceneTree, TagIsRefused) {
  const auto problems = problems_of_text("a:\n  b: !!float 3\nc: !mine {d: 1}\n");
  ASSERT_THAT(problems, SizeIs(2));
  expect_at(problems[0], 2, 6, "a.b", "the YAML tag 'tag:yaml.org,2002:float' has no meaning");
  expect_at(problems[1], 3, 4, "c", "the YAML tag '!mine' has no meaning");
}

TEST(SceneTree, AllProblemsAreCollected) {
  EXPECT_THAT(problems_of_text("a: 1\na: 2\nb:\n  - {c: 1, c: 2}\n  - {<<: 3}\nb: 4\n"), SizeIs(4));
}

// --- errors that refuse the text as a whole
// ------------------------------------------------------------------

TEST(SceneTree, EmptySceneIsRefused) {
  for (const std::string text : {"", "\n\n", "# only a comment\n", "---\n", "~\n"}) {
    expect_at(fatal(text), 1, 1, "", "the scene is empty");
  }
}

TEST(SceneTree, SceneThatIsNoMapIsRefused) {
  expect_at(fatal("\n- a\n"), 2, 1, "",
            "expected a map of keys ('key: value', with a space after the colon), got a list");
  expect_at(fatal("hello\n"), 1, 1, "", "got a single value");
}

TEST(SceneTree, SecondDocumentIsRefused) {
  expect_at(fatal("a: 1\n---\nb: 2\n"), 2, 1, "", "a second YAML document");
  expect_at(fatal("{a: 1}\nb: 2\n"), 2, 1, "", "a second YAML document, or text after the end");
}

TEST(SceneTree, TabInTheIndentationIsRefused) {
  const Problem problem = fatal("a:\n  b: 1\n\tc: 2\n");
  expect_at(problem, 3, 1, "", "tab");
  // Also where yaml-cpp stumbles over what the tab makes of the text.
  expect_at(fatal("a:\n\tm: {b: 1}\n"), 2, 1, "", "a tab in the indentation");
  expect_at(fatal("a:\n  m:\n  \tb: 1\n"), 3, 3, "", "a tab in the indentation");
}

TEST(SceneTree, SyntaxErrorsCarryTheirPlace) {
  expect_at(fatal("a: b: c\n"), 1, 5, "", "a ':' where no key can be");
  expect_at(fatal("a: 1\n  b: 2\n"), 2, 4, "", "':'");
  expect_at(fatal("a: *nowhere\n"), 1, 4, "", "anchor is not defined");
  expect_at(fatal("a: \"\\q\"\n"), 1, 7, "", "not YAML: unknown escape character: q");
  expect_at(fatal("a: @x\n"), 1, 4, "", "not YAML: unknown token");
}

TEST(SceneTree, OpenBracketIsReportedWhereItStandsOrWhereTheTextGoesWrong) {
  expect_at(fatal("a: 1\nb: [1, 2\n"), 2, 4, "",
            "the list that begins here is never closed by ']'");
  expect_at(fatal("a: {b: 1"), 1, 4, "", "the map that begins here is never closed by '}'");
  expect_at(fatal("a: 1\nb: [1, 2\nc: 3\n"), 3, 2, "",
            "a ',' or ']' is missing before this in the list of line 2");
  expect_at(fatal("a: {b: [1, 2}\n"), 1, 13, "", "a closing bracket without its opening one");
  expect_at(fatal("a: {b: 1\n  c: 2}\n"), 2, 4, "",
            "a ',' or '}' is missing before this in the map of line 1");
}

TEST(SceneTree, FaultAtTheEndLiesInTheLastLine) {
  expect_at(fatal("a: 1\nb: |x"), 2, 5, "", "not YAML");
  for (const std::string text : {"a: &", "a: *", "a: !<x", "? ", "a:\n  - b\n  c", "%YAML"}) {
    const Problem problem = fatal(text);
    if (problem.message.empty()) continue;  // some of them mean something
    const int num_lines = 1 + static_cast<int>(std::count(text.begin(), text.end(), '\n'));
    EXPECT_LE(problem.line, num_lines) << problem.text();
  }
}

TEST(SceneTree, ExcerptIsTheLineAsReadWithACaret) {
  EXPECT_EQ(fatal("# x\r\na: @é\r\n").excerpt,
            "    2 | a: @é\n"
            "      |    ^");
  // The byte order mark is no column of the first line.
  EXPECT_EQ(fatal("\xEF\xBB\xBF"
                  "é: @x\n")
                .excerpt,
            "    1 | é: @x\n"
            "      |    ^");
  EXPECT_EQ(fatal("\xEF\xBB\xBF"
                  "a: \xFF\n")
                .excerpt,
            "    1 | a: ?\n"
            "      |    ^");
  EXPECT_EQ(fatal("").excerpt, "");
}

TEST(SceneTree, OpenQuoteDoesNotSwallowTheRest) {
  expect_at(fatal("a: 1\nb: 'open\nc: 2\n"), 2, 1, "", "a quote opened after here is never closed");
  expect_at(fatal("a: 1\nb: \"open\nc: 2\n"), 2, 1, "",
            "a quote opened after here is never closed");
  expect_at(fatal("a: 1\nb: 'open"), 2, 1, "", "a quote opened after here is never closed");
  expect_at(fatal("a: [1, 'x\n"), 1, 5, "", "a quote opened after here is never closed");
  expect_at(fatal("'open\n"), 1, 1, "", "a quote opened after here is never closed");
}

TEST(SceneTree, BlockScalarsKeepTheirLines) {
  const SceneNode root = read_scene_text("a: |\n  x\n  y\nb: |-\n  z\nc: |+\n  w\n", "s.yaml");
  EXPECT_EQ(find(root, "a")->text, "x\ny\n");
  EXPECT_EQ(find(root, "b")->text, "z");
  EXPECT_EQ(find(root, "c")->text, "w\n");
}

TEST(SceneTree, EndOfDocumentMarkerIsAllowed) {
  EXPECT_EQ(find(read_scene_text("---\na: 1\n...\n", "s.yaml"), "a")->text, "1");
}

TEST(SceneTree, DeepNestingIsRefused) {
  const auto nested = [](std::size_t lists) {
    return "a: " + std::string(lists, '[') + std::string(lists, ']') + "\n";
  };
  EXPECT_EQ(fatal(nested(SceneLimits::levels - 1)).message, "");
  const Problem problem = fatal(nested(SceneLimits::levels));
  EXPECT_EQ(problem.line, 1);
  EXPECT_EQ(problem.column, 4 + static_cast<int>(SceneLimits::levels) - 1);
  EXPECT_THAT(problem.message, HasSubstr("nested deeper than 32 levels"));
  EXPECT_THAT(fatal(nested(1000000)).message, HasSubstr("nested deeper than 32 levels"));
}

TEST(SceneTree, DepthThroughAliasesIsRefused) {
  std::string text = "k0: &a0 [1]\n";
  for (int i = 1; i < 100; ++i) text += fmt::format("k{}: &a{} [*a{}]\n", i, i, i - 1);
  const Problem problem = fatal(text);
  EXPECT_EQ(problem.line, 32);
  EXPECT_THAT(problem.message, HasSubstr("nested deeper than 32 levels"));
}

TEST(SceneTree, AliasBombIsRefused) {
  std::string text = "k0: &a0 [1, 1, 1, 1, 1, 1, 1, 1, 1, 1]\n";
  for (int i = 1; i < 10; ++i) {
    text += fmt::format("k{0}: &a{0} [*a{1}, *a{1}, *a{1}, *a{1}, *a{1}, *a{1}, *a{1}, *a{1}]\n", i,
                        i - 1);
  }
  const Problem problem = fatal(text);
  EXPECT_GT(problem.line, 0);
  EXPECT_THAT(problem.message, HasSubstr("more than 100000 values"));
}

TEST(SceneTree, AnchorsInsideAnchorsCountTowardsTheLimit) {
  // Thirty anchors around the same 10000 values: their copies must not be free.
  std::string text = "a: ";
  for (int i = 0; i < 30; ++i) text += fmt::format("&n{} [", i);
  for (int i = 0; i < 10000; ++i) text += "1, ";
  text += std::string(30, ']') + "\n";
  EXPECT_THAT(fatal(text).message, HasSubstr("more than 100000 values"));
}

TEST(SceneTree, AliasInsideItsAnchorIsRefused) {
  expect_at(fatal("a: &x\n  b: [1, *x]\n"), 2, 10, "a.b.1",
            "an alias inside the value that it stands for");
}

TEST(SceneTree, ManyKeysAreReadInReasonableTime) {
  std::string text;
  for (int i = 0; i < 40000; ++i) text += fmt::format("key_{}: {}\n", i, i);
  EXPECT_THAT(read_scene_text(text, "s.yaml").entries, SizeIs(40000));
}

TEST(SceneTree, WhatIsNotUtf8TextIsRefused) {
  expect_at(fatal("a: 1\nb: \xFF\n"), 2, 4, "", "byte 0xFF is not UTF-8");
  expect_at(fatal("a: \xC3\n"), 1, 4, "", "is not UTF-8");              // cut short
  expect_at(fatal("a: \xE0\x80\x80\n"), 1, 4, "", "is not UTF-8");      // overlong
  expect_at(fatal("a: \xED\xA0\x80\n"), 1, 4, "", "is not UTF-8");      // surrogate
  expect_at(fatal("a: \xF4\x90\x80\x80\n"), 1, 4, "", "is not UTF-8");  // beyond U+10FFFF
  expect_at(fatal("a: 1\nb: x\x04y\n"), 2, 5, "",
            "control character 0x04");  // yaml-cpp stops there
  expect_at(fatal(std::string("a\0: 1\n", 6)), 1, 2, "", "control character 0x00");
}

// --- files
// ------------------------------------------------------------------------------------------

std::string file_failure(const std::string& path) {
  try {
    read_scene_file(path);
  } catch (const FileError& error) {
    return error.what();
  }
  return {};
}

TEST(SceneFile, IsReadWithItsPathAsSource) {
  const TemporaryFolder folder;
  const std::string path = folder / "s.yaml";
  write_file(path, "a: 1\n");
  const SceneNode root = read_scene_file(path);
  EXPECT_EQ(find(root, "a")->place, (Place{path, 1, 4}));
  EXPECT_EQ(root.document, "a: 1\n");
}

TEST(SceneFile, ThatDoesNotExistIsAFileError) {
  EXPECT_THAT(file_failure("/nowhere/scene.yaml"),
              AllOf(HasSubstr("/nowhere/scene.yaml"), HasSubstr("does not exist")));
}

TEST(SceneFile, ThatIsADirectoryIsAFileError) {
  EXPECT_THAT(file_failure(testing::TempDir()), HasSubstr("is a directory"));
}

TEST(SceneFile, ThatIsTooLargeIsAFileError) {
  const TemporaryFolder folder;
  const std::string path = folder / "s.yaml";
  write_file(path, "a: 1\n#" + std::string(SceneLimits::bytes - 6, 'x'));
  EXPECT_EQ(file_failure(path), "");
  write_file(path, "a: 1\n#" + std::string(SceneLimits::bytes - 5, 'x'));
  EXPECT_THAT(file_failure(path), HasSubstr("is larger than 4 MiB"));
  // A file without end is not even opened.
  EXPECT_THAT(file_failure("/dev/zero"), HasSubstr("is a device; give the path of a scene file"));
}

TEST(SceneFile, ThatCannotBeOpenedIsAFileError) {
  const TemporaryFolder folder;
  write_file(folder / "s.yaml", "a: 1\n");
  EXPECT_THAT(file_failure(folder / "s.yaml/below"), HasSubstr("does not exist"));
}

}  // namespace
}  // namespace stridor
