// A text in YAML as a tree of maps, lists and scalars.
//
// Read with yaml-cpp. Errors that the library lets pass are caught here: bytes that are no text,
// duplicate keys, merge keys, tags, several documents, alias bombs; what it says of the others is
// put in words that tell what to do.
#pragma once

#include <string>
#include <string_view>

#include "io/scene/scene_tree.hpp"

namespace stridor {

inline constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";

/// Refuses what is not text: yaml-cpp ends silently at a byte 4, and a message with broken UTF-8 in
/// it could not be written as JSON.
/// @param place of the first character
/// @throws ConfigError at the first byte that is not
void check_characters(const std::string& text, Place place);

/// Without the bytes that a message in one line of UTF-8 cannot hold; yaml-cpp quotes single bytes.
std::string printable(std::string text);

/// The value that a text holds. Faults that leave the rest readable are kept in
/// SceneNode::problems.
/// @param start place of the first character; without a line for a text of one line
/// @throws ConfigError with source, line and column where the text is not YAML in UTF-8, holds
///         several documents or passes SceneLimits
SceneNode parse_yaml(const std::string& text, const Place& start);

}  // namespace stridor
