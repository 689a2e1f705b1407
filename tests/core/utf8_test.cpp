#include "core/utf8.hpp"

#include <gtest/gtest.h>

#include <string>

namespace stridor {
namespace {

TEST(Utf8, CharactersOfAllLengthsAreRead) {
  const struct {
    std::string text;
    std::uint32_t code;
  } cases[] = {{"a", 0x61},
               {"\x7F", 0x7F},
               {"\xC2\x80", 0x80},
               {"µ", 0xB5},
               {"\xDF\xBF", 0x7FF},
               {"\xE0\xA0\x80", 0x800},
               {"日", 0x65E5},
               {"\xED\x9F\xBF", 0xD7FF},
               {"\xEE\x80\x80", 0xE000},
               {"\xEF\xBF\xBF", 0xFFFF},
               {"\xF0\x90\x80\x80", 0x10000},
               {"\xF4\x8F\xBF\xBF", 0x10FFFF}};
  for (const auto& one : cases) {
    const Utf8Character character = utf8_at("x" + one.text + "y", 1);
    EXPECT_EQ(character.code, one.code) << one.text;
    EXPECT_EQ(character.length, one.text.size()) << one.text;
  }
}

TEST(Utf8, WhatIsNoCharacterHasNoLength) {
  for (const std::string text : {"\x80",              // in the middle of one
                                 "\xC3",              // cut short
                                 "\xC3(",             // broken off
                                 "\xE6\x97",          //
                                 "\xC0\xAF",          // overlong
                                 "\xE0\x9F\xBF",      //
                                 "\xF0\x8F\xBF\xBF",  //
                                 "\xED\xA0\x80",      // surrogate
                                 "\xF4\x90\x80\x80",  // beyond U+10FFFF
                                 "\xFF"}) {
    EXPECT_EQ(utf8_at(text, 0).length, 0u) << text;
  }
}

TEST(TerminalWidth, IsOneTwoOrNone) {
  for (const std::uint32_t code : {0x61u, 0xB5u, 0xB0u, 0x3BBu, 0x2026u}) {  // a µ ° λ …
    EXPECT_EQ(terminal_width(code), 1) << code;
  }
  for (const std::uint32_t code : {0x65E5u, 0xD55Cu, 0x3042u, 0xFF21u, 0x1F600u, 0x20000u}) {
    EXPECT_EQ(terminal_width(code), 2) << code;
  }
  for (const std::uint32_t code : {0x301u, 0x200Du, 0xFE0Fu}) {
    EXPECT_EQ(terminal_width(code), 0) << code;
  }
}

}  // namespace
}  // namespace stridor
