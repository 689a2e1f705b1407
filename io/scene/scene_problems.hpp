// Problems of a scene and their places: where the text is wrong, the line there as an excerpt, and
// the order in which problems are reported.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/errors.hpp"
#include "io/scene/scene_tree.hpp"

namespace stridor {

/// A problem at a place. One of `--set` has its excerpt, the assignment, from the beginning; one of
/// a file gets it from `add_excerpts`, since the place does not hold the line.
/// @param refusal its kind
/// @param key     path of the key that is meant
Problem problem_at(Refusal refusal, const Place& place, std::string key, std::string message);

/// Ends the reading.
/// @throws ConfigError with the one problem_at() a place
[[noreturn]] void fail_at(Refusal refusal, const Place& place, std::string key,
                          std::string message);

/// Gives the problems that lie in a source the line of its text there as their excerpt.
void add_excerpts(std::vector<Problem>& problems, const std::string& source, std::string_view text);
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

}  // namespace stridor
