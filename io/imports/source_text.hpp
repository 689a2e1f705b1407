// Files in memory, and messages that say where in them something is wrong.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace stridor {

/// How a place in a file is named: "line:column" in a text, "byte 1234" (from 0) in a binary file.
enum class PlaceForm { line, byte };

/// Contents of a file, and its name in messages.
struct SourceText {
  std::string name;
  std::string text;
  PlaceForm places = PlaceForm::line;
};

/// A byte of a file. Lines are counted only for a message.
struct TextPlace {
  const SourceText* source = nullptr;
  std::size_t offset = 0;
};

/// @throws ConfigError "name:line:column: message" or "name: byte 1234: message"
[[noreturn]] void refuse_at(const TextPlace& place, const std::string& message);

/// The whole of a file.
/// @param expected what it should hold, for the message: "a Gmsh mesh (.msh)"
/// @throws FileError if it is not there, no regular file, unreadable or empty
SourceText read_source_text(const std::string& path, const std::string& expected);

/// What a file is, going by its first bytes, if it is of a known format that holds no mesh in a
/// form that is read here: "a gzip archive; unpack it first"; "" if none is recognised.
std::string foreign_format(std::string_view text);

/// The whole word as a number, a leading '+' allowed.
std::optional<std::int64_t> integer_in(std::string_view word);
/// The same for a finite number; exponents with D too, as Fortran writes them. What is too small
/// for a double is 0.
std::optional<double> real_in(std::string_view word);

/// Letters A to Z become small, others stay.
std::string lower_case_of(std::string_view text);
/// Without blanks at both ends.
std::string_view trimmed(std::string_view text);
/// Text for a message: at most 40 letters, unprintable ones as '?'.
std::string shown(std::string_view text);

}  // namespace stridor
