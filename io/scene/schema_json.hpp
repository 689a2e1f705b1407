// The JSON Schema of scenes, made from the declared keys (core/schema.hpp).
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "core/schema.hpp"

namespace stridor {

/// JSON Schema (draft 2020-12) of the scenes that a Schema describes.
///
/// Every map becomes an object with `required` and without additional properties; maps below the
/// top are in `$defs`, once each. A real is a number within its range, or a string that holds a
/// number and perhaps a unit; a curve is a real or {times, values}; entries of named sections are
/// told apart by their discriminator. `description` holds doc, unit and range.
///
/// A scene that the reader accepts (io/scene/scene_reader.hpp) is valid, unless it puts quotes around a
/// whole number or a truth value, or leaves them out around a text that looks like one of these or
/// like a number. The converse does not hold: dimensions of units, ranges of strings, equal lengths
/// and increasing times of tables, and `Schema::checks` are left to the reader.
nlohmann::ordered_json json_schema(const Schema& schema);

/// The same as text.
std::string json_schema_text(const Schema& schema);

}  // namespace stridor
