// The text of a scene as a tree of maps, lists and scalars that know where they were written.
//
// YAML is read with yaml-cpp. Errors that the library lets pass are caught here: duplicate keys,
// merge keys, tags, several documents, alias bombs. Numbers stay text; what a scalar means is
// decided by the key that it fills (io/scene/scene_reader.hpp).
#pragma once

#include <cstddef>
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

/// Applies one `--set key.path=value` to the tree.
///
/// The value is read as YAML (a scalar, or a list or map in one line) and replaces the old one;
/// maps missing on the way are made. A number in the path counts the entries of a list from 0.
///
/// @param root       map at the top; unchanged where this throws
/// @param assignment "key.path=value"
/// @throws ConfigError, with the source "--set key.path=value", if there is no '=', no key or no
/// value,
///         if it passes SceneLimits, if the value is not YAML, or if the path leads through a
///         single value, through a name in a list or past the end of a list
void set_value(SceneNode& root, const std::string& assignment);

/// The value at a dotted path ("substructures.oblique.length", "expect.0.value"), or nullptr.
/// The empty path is the root.
const SceneNode* find(const SceneNode& root, const std::string& path);

/// The place of the value at a dotted path, or of its nearest ancestor that was written.
Place place_of(const SceneNode& root, const std::string& path);

/// A problem at a place. One of `--set` has its excerpt, the assignment, from the beginning; one of
/// a file gets it from `add_excerpts`, since the place does not hold the line.
/// @param key path of the key that is meant
Problem problem_at(const Place& place, std::string key, std::string message);

/// The path of a file that a scene names: from the folder of the scene where the name was written
/// in it, from the working directory where it comes from `--set`.
/// @param key  path of the key that holds the name
/// @param name as written
std::string path_of_file(const SceneNode& root, const std::string& key, const std::string& name);

/// Gives the problems that lie in the file of this scene the line there as their excerpt.
/// @param root map at the top
void add_excerpts(std::vector<Problem>& problems, const SceneNode& root);

/// Gives every problem without a source the place of its key, or of the nearest ancestor that was
/// written, and its excerpt. A problem without key, which means the whole scene, gets the source
/// alone.
void locate(std::vector<Problem>& problems, const SceneNode& root);

/// Sorts by place, those of the file before those of `--set`; equal places keep their order.
void sort_by_place(std::vector<Problem>& problems);

/// Adds the faults of the text itself at this node and below it (SceneNode::problems).
/// @param path key path of `node`, which goes before the keys
void collect_text_problems(const SceneNode& node, const std::string& path,
                           std::vector<Problem>& problems);

/// "a.b" from "a" and "b"; either may be empty.
std::string join_path(const std::string& path, const std::string& key);

}  // namespace stridor
