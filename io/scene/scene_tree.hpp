// The text of a scene as a tree of maps, lists and scalars that know where they were written.
//
// The text is YAML (io/scene/yaml_text.hpp), of which `--set` may change values
// (io/scene/assignment.hpp). Numbers stay text; what a scalar means is decided by the key that it
// fills (io/scene/scene_reader.hpp).
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "core/errors.hpp"

namespace stridor {

/// Place of a text in its source.
struct Place {
  std::string source;  ///< file, or "--set key.path=value"
  int line = 0;        ///< 1-based; 0 where the source has no lines (--set)
  int column = 0;      ///< 1-based, in bytes; without lines in `source` itself; 0: unknown
  bool operator==(const Place&) const = default;
};

struct SceneEntry;

/// One value of a scene: a scalar, a map, a list, or nothing ("key:").
///
/// The place of a value is where it begins; that of an indented map or list below its key is the
/// place of the key, which is the line that the user looks for.
struct SceneNode {
  enum class Kind { null, scalar, map, list };

  Kind kind = Kind::null;
  std::string text;                 ///< of a scalar, without quotes
  bool is_quoted = false;           ///< the scalar stood in quotes or was a block scalar
  std::vector<SceneEntry> entries;  ///< of a map, in the order of the file; no name occurs twice
  std::vector<SceneNode> items;     ///< of a list
  Place place;
  /// Faults of the text itself here (a duplicate key, a merge key, a tag, ...), with keys relative
  /// to this node. Kept so that they are reported along with everything else.
  std::vector<Problem> problems;
  std::string document;  ///< of the map at the top: the text read, for the excerpts of messages

  /// The entry of a map with this name, or nullptr.
  const SceneEntry* entry(const std::string& key) const;
};

/// One key of a map with its value.
struct SceneEntry {
  std::string key;
  Place place;  ///< of the key
  SceneNode value;
};

/// Levels of maps and lists: 0 for a scalar.
std::size_t num_levels(const SceneNode& node);

/// Limits of a scene text; a scene beyond them is refused, because it is a mistake or an attack.
struct SceneLimits {
  static constexpr std::size_t bytes = 4 * 1024 * 1024;  ///< of a file
  static constexpr std::size_t nodes = 100000;           ///< with every alias expanded
  static constexpr std::size_t levels = 32;              ///< of maps and lists inside one another
  static constexpr std::size_t assignment = 16 * 1024;   ///< bytes of a `--set`
};

/// Reads a scene from YAML text.
///
/// @param text        the scene, UTF-8
/// @param source_name name in messages, as a rule the path of the file
/// @return the map at the top
/// @throws ConfigError with source, line and column where the text is not YAML in UTF-8, is empty,
/// is
///         not a map, holds several documents or passes SceneLimits. Faults that leave the rest
///         readable are kept in SceneNode::problems instead.
SceneNode read_scene_text(const std::string& text, const std::string& source_name);

/// Reads a scene from a file.
/// @throws FileError if the file does not exist, is a directory, cannot be read or passes
///         SceneLimits::bytes; ConfigError as read_scene_text
SceneNode read_scene_file(const std::string& path);

/// The value at a dotted path ("substructures.oblique.length", "expect.0.value"), or nullptr.
/// The empty path is the root.
const SceneNode* find(const SceneNode& root, const std::string& path);

/// The place of the value at a dotted path, or of its nearest ancestor that was written.
Place place_of(const SceneNode& root, const std::string& path);

/// The path of a file that a scene names: from the folder of the scene where the name was written
/// in it, from the working directory where it comes from `--set`.
/// @param key  path of the key that holds the name
/// @param name as written
std::string path_of_file(const SceneNode& root, const std::string& key, const std::string& name);

/// "a.b" from "a" and "b"; either may be empty.
std::string join_path(const std::string& path, const std::string& key);

/// "a" and "b" from "a.b".
std::vector<std::string> path_names(const std::string& path);

/// The index that a path element names, if it is one of a list of this size.
std::optional<std::size_t> list_index(const std::string& name, std::size_t size);

}  // namespace stridor
