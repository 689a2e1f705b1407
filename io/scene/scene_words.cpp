#include "io/scene/scene_words.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/units.hpp"

namespace stridor {
namespace {

/// A number for a message: short, unless rounding would move it into the range that it violates.
std::string number_text(double value, const Range& range) {
  const std::string rounded = fmt::format("{:.12g}", value);
  return range.contains(parse_quantity(rounded, "")) ? fmt::format("{}", value) : rounded;
}

}  // namespace

std::string in_unit(const std::string& what, const std::string& unit) {
  return unit.empty() ? what : what + " in " + unit;
}

// Not fmt::join, over which g++ 12 warns at -O3 in fmt 9.
std::string joined(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : ", ") + word;
  return text;
}

std::string quoted(const std::string& text) {
  constexpr std::size_t longest = 60;
  std::size_t length = std::min(text.size(), longest);
  // Not in the middle of a UTF-8 character.
  while (length < text.size() && (static_cast<unsigned char>(text[length]) & 0xC0u) == 0x80u)
    --length;
  std::string shown = text.substr(0, length);
  for (char& c : shown) {
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7F) c = ' ';
  }
  return fmt::format("'{}{}'", shown, length < text.size() ? "..." : "");
}

std::string found_in(const SceneNode& node) {
  switch (node.kind) {
    case SceneNode::Kind::null:
      return "nothing";
    case SceneNode::Kind::scalar:
      return quoted(node.text);
    case SceneNode::Kind::map:
      return "a map";
    case SceneNode::Kind::list:
      return "a list";
  }
  return {};
}

std::string range_message(const Range& range, double value, const std::string& unit) {
  const bool has_bound = (std::isfinite(range.low) && range.low != 0.0) ||
                         (std::isfinite(range.high) && range.high != 0.0);
  const std::string suffix = unit.empty() ? "" : " " + unit;
  return fmt::format("must be {}{}, got {}{}", range.text(), has_bound ? suffix : "",
                     number_text(value, range), suffix);
}

std::string magnitude_message(double value, const std::string& unit) {
  constexpr double largest = 1e30;
  constexpr double largest_pure = 1e100;
  const double size = std::abs(value);
  if (unit.empty()) {
    return size <= largest_pure ? ""
                                : fmt::format(
                                      "is beyond what can be computed with, up to {:g} in "
                                      "magnitude; got {:g}",
                                      largest_pure, value);
  }
  if (size == 0.0 || (size <= largest && size >= 1.0 / largest)) return "";
  return fmt::format(
      "is beyond what can be computed with, 0 or {:g} to {:g} {} in magnitude; got "
      "{:g} {}",
      1.0 / largest, largest, unit, value, unit);
}

std::string expected_of(const Key& key) {
  switch (key.kind) {
    case KeyKind::flag:
      return "true or false";
    case KeyKind::integer:
      return "a whole number";
    case KeyKind::real:
      return in_unit("a number", key.unit);
    case KeyKind::text:
      return "a text";
    case KeyKind::choice:
      return fmt::format("one of {}", joined(key.choices));
    case KeyKind::real_list:
      return in_unit("a list of numbers", key.unit);
    case KeyKind::text_list:
      return key.has_rows ? "a text, or a list of rows of numbers" : "a text or a list of texts";
    case KeyKind::curve:
      return in_unit("a number", key.unit) + " or {times: [...], values: [...]}";
    case KeyKind::section: {
      std::string expected = key.absent_word.empty() ? "" : key.absent_word + " or ";
      if (const Key* number = number_in_place_of(key)) expected += expected_of(*number) + " or ";
      if (const Key* list = list_in_place_of(key)) expected += expected_of(*list) + " or ";
      return expected + "a map";
    }
    case KeyKind::named_sections:
      return "a map of named maps";
    case KeyKind::section_list:
      return "a list of maps";
    case KeyKind::parameters:
      return "a map of names to numbers";
  }
  return {};
}

}  // namespace stridor
