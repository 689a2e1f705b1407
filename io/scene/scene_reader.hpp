// Fills parameter structs from a scene, by the keys that they declare (core/schema.hpp).
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "core/errors.hpp"
#include "core/schema.hpp"
#include "io/scene/scene_problems.hpp"
#include "io/scene/scene_tree.hpp"

namespace stridor {

/// Fills a struct from a map and reports everything that is wrong with the map.
///
/// Strict: an unknown, doubled, missing or empty key, a wrong type, unit or range is a problem;
/// nothing is converted silently. Bare numbers are SI, "75 mm" is converted, quotes make no
/// difference. A number may also be an expression of the scene's `parameters` (io/scene/expression.hpp),
/// which gives it in the SI unit of its key. Names of named sections are letters, digits, '_' and '-', because dots separate the
/// parts of a channel. A table {times, values} with a single entry is read as the constant that it
/// describes. Problems carry the place of the key where the key itself is wrong, else of the value;
/// a missing key that of the map. `Schema::checks` of a map run only if no problem was found in it
/// or below it, since they may rely on every value; the places of what they report are looked up
/// here.
///
/// @param node     the map; anything else is reported as a problem
/// @param schema   declared keys
/// @param object   the struct that `schema` describes; half filled where problems were added
/// @param path     key path of the map, "" for the top
/// @param problems receives what was found, in no particular order (sort_by_place)
void read_section(const SceneNode& node, const Schema& schema, void* object,
                  const std::string& path, std::vector<Problem>& problems);

/// Reads a whole scene, or one map of it, into a struct with a static `schema()`.
/// @throws ConfigError with all problems in the order of the file, those of `--set` last
template <class T>
T read_as(const SceneNode& node) {
  T object{};
  std::vector<Problem> problems;
  read_section(node, T::schema(), &object, "", problems);
  if (!problems.empty()) {
    sort_by_place(problems);
    add_excerpts(problems, node);
    throw ConfigError(std::move(problems));
  }
  return object;
}

}  // namespace stridor
