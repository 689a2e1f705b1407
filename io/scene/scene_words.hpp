// Words for messages about the values of a scene: what a key holds, what stands there instead, and
// why a number is none for it.
#pragma once

#include <string>
#include <vector>

#include "core/schema.hpp"
#include "io/scene/scene_tree.hpp"

namespace stridor {

/// What a key holds, in words: "a number in m", "one of free, clamped", "a map".
std::string expected_of(const Key& key);

/// "a number in m" from "a number" and "m", which may be empty.
std::string in_unit(const std::string& what, const std::string& unit);

/// "a, b, c".
std::string joined(const std::vector<std::string>& words);

/// A text in quotes for a message of one line: shortened, without line breaks.
std::string quoted(const std::string& text);

/// What stands there, in words: "a map", "a list", "'abc'".
std::string found_in(const SceneNode& node);

/// "must be > 0, got -0.075 m"; bounds other than 0 carry the unit.
std::string range_message(const Range& range, double value, const std::string& unit);

/// Why a number cannot be computed with, though its key allows it, or "". Products of a few numbers
/// of a scene must neither overflow nor vanish.
std::string magnitude_message(double value, const std::string& unit);

}  // namespace stridor
