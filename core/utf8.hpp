// Characters of a text in UTF-8.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

namespace stridor {

/// One character of a text.
struct Utf8Character {
  std::uint32_t code = 0;  ///< Unicode code point
  std::size_t length = 0;  ///< in bytes; 0 where the bytes are not UTF-8
};

/// The character that begins at `text[i]`, `i` less than the size of the text.
///
/// Strict: overlong forms, surrogates and codes beyond U+10FFFF are not UTF-8.
Utf8Character utf8_at(std::string_view text, std::size_t i);

/// Columns that a terminal gives to a printable character: 0 for marks put on the character before
/// them, 2 for those of Chinese, Japanese and Korean and for pictures, else 1.
int terminal_width(std::uint32_t code);

}  // namespace stridor
