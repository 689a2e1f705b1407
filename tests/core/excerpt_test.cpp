#include "core/excerpt.hpp"

#include <gtest/gtest.h>

#include <string>

namespace stridor {
namespace {

TEST(Excerpt, ShowsTheLineWithItsNumberAndACaret) {
  EXPECT_EQ(excerpt_of("    thicknes: 1.5 mm", 12, 5),
            "   12 |     thicknes: 1.5 mm\n"
            "      |     ^");
  EXPECT_EQ(excerpt_of("a", 1234567, 1),
            "1234567 | a\n"
            "        | ^");
}

TEST(Excerpt, WithoutNumberOrColumnLeavesThemOut) {
  EXPECT_EQ(excerpt_of("--set a=1", 0, 9),
            "      | --set a=1\n"
            "      |         ^");
  EXPECT_EQ(excerpt_of("a: 1", 3, 0), "    3 | a: 1");
}

TEST(Excerpt, CaretBehindTheEndStandsJustBehindIt) {
  EXPECT_EQ(excerpt_of("ab", 1, 3), excerpt_of("ab", 1, 300));
  EXPECT_EQ(excerpt_of("ab", 1, 3), "    1 | ab\n      |   ^");
  EXPECT_EQ(excerpt_of("", 1, 1), "    1 | \n      | ^");
}

TEST(Excerpt, CaretCountsCharactersNotBytes) {
  // µ and é have two bytes and one column, 日 has three and two, a combining accent two and none.
  EXPECT_EQ(excerpt_of("µé: x", 1, 7), "    1 | µé: x\n      |     ^");
  EXPECT_EQ(excerpt_of("日: x", 1, 6), "    1 | 日: x\n      |     ^");
  EXPECT_EQ(excerpt_of("e\xCC\x81: x", 1, 6), "    1 | e\xCC\x81: x\n      |    ^");
  // A column in the middle of a character means that character.
  EXPECT_EQ(excerpt_of("a日b", 1, 3), excerpt_of("a日b", 1, 2));
}

TEST(Excerpt, TabsBecomeSpaces) {
  EXPECT_EQ(excerpt_of("\ta:\tx", 1, 5), "    1 |     a:    x\n      |           ^");
}

TEST(Excerpt, NothingSteersTheTerminal) {
  // Escape, an invalid byte, C1 control U+009B, right-to-left override U+202E.
  EXPECT_EQ(excerpt_of("\x1B[1m\xFF\xC2\x9B\xE2\x80\xAEx\r", 1, 11),
            "    1 | ?[1m???x?\n      |        ^");
}

/// Where the caret points, in the line above it.
char marked(const std::string& excerpt) {
  const std::size_t line_break = excerpt.find('\n');
  return excerpt.at(excerpt.find('^') - line_break - 1);
}

TEST(Excerpt, LongLineIsCutAroundTheCaret) {
  std::string line;
  while (line.size() < 300) line += "abcdefghij";
  for (int column = 1; column <= 300; ++column) {
    const std::string excerpt = excerpt_of(line, 1, column);
    EXPECT_EQ(marked(excerpt), line[static_cast<std::size_t>(column) - 1]) << excerpt;
    EXPECT_LE(excerpt.find('\n'), 80u) << excerpt;
    EXPECT_EQ(excerpt.find("..."), column <= 45 ? 77u : 8u) << excerpt;
  }
  EXPECT_EQ(excerpt_of(line, 1, 300),
            "    1 | ...bcdefghijabcdefghijabcdefghijabcdefghijabcdefghijabcdefghijabcdefghij\n"
            "      |                                                                        ^");
}

TEST(Excerpt, LineThatFitsIsNotCut) {
  const std::string line(72, 'x');
  EXPECT_EQ(excerpt_of(line, 1, 72).find("..."), std::string::npos);
  EXPECT_NE(excerpt_of(line + "x", 1, 72).find("..."), std::string::npos);
}

TEST(Excerpt, CutsBetweenCharacters) {
  std::string line;
  for (int i = 0; i < 2000; ++i) line += "日";
  const std::string excerpt = excerpt_of(line, 1, 3 * 1000 + 1);
  EXPECT_EQ(excerpt.find('?'), std::string::npos);
  EXPECT_LE(excerpt.find('\n'), 8u + 72u / 2u * 3u);
}

TEST(Excerpt, OfAHugeLineIsQuick) {
  std::string line(4'000'000, 'x');
  line[2'000'000] = 'Y';
  for (int i = 0; i < 1000; ++i) ASSERT_EQ(marked(excerpt_of(line, 1, 2'000'001)), 'Y');
}

}  // namespace
}  // namespace stridor
