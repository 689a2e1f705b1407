#include "io/scene/assignment.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "io/scene/scene_problems.hpp"
#include "io/scene/yaml_text.hpp"

namespace stridor {
namespace {

const std::string set_option = "--set ";

/// Whether a text is a number as programs write it, "-1.5e-7": YAML has it as it is, and verbs that
/// vary a key set thousands of them.
bool is_plain_number(const std::string& text) {
  std::size_t i = text.starts_with('-') ? 1 : 0;
  const auto skip_digits = [&] {
    const std::size_t first = i;
    while (i < text.size() && text[i] >= '0' && text[i] <= '9') ++i;
    return i > first;
  };
  if (!skip_digits()) return false;
  if (i < text.size() && text[i] == '.' && (++i, !skip_digits())) return false;
  if (i < text.size() && (text[i] == 'e' || text[i] == 'E')) {
    ++i;
    if (i < text.size() && (text[i] == '+' || text[i] == '-')) ++i;
    if (!skip_digits()) return false;
  }
  return i == text.size();
}

SceneNode scalar_of(const std::string& text, const Place& place) {
  SceneNode node;
  node.kind = SceneNode::Kind::scalar;
  node.text = text;
  node.place = place;
  return node;
}

/// Of a byte of an assignment behind "--set ".
int column_of(std::size_t i) {
  return static_cast<int>(set_option.size() + i) + 1;
}

/// An assignment taken apart.
struct Assignment {
  std::string text;
  std::string path;
  std::vector<std::string> names;  ///< of the path
  std::string value;               ///< as written

  /// The place of a byte of the text.
  Place at(std::size_t i) const { return {set_option + text, 0, column_of(i)}; }
  /// The place of the value.
  Place value_place() const { return at(path.size() + 1); }
};

/// Refuses what is no line of text.
void check_line(const std::string& assignment) {
  if (assignment.size() > SceneLimits::assignment) {
    fail_at(Refusal::wrong_value, {set_option + printable(assignment.substr(0, 40)) + "...", 0, 0},
            "",
            fmt::format("is longer than {} KiB; write it into the scene",
                        SceneLimits::assignment / 1024));
  }
  check_characters(assignment, {set_option + printable(assignment), 0, column_of(0)});
  const std::size_t line_break = assignment.find_first_of("\r\n");
  if (line_break != std::string::npos) {
    fail_at(Refusal::wrong_value, {set_option + printable(assignment), 0, column_of(line_break)},
            "", "has a line break; write --set key.path=value in one line");
  }
}

/// @param line of check_line()
Assignment take_apart(const std::string& line) {
  Assignment assignment;
  assignment.text = line;
  const std::size_t equals = line.find('=');
  if (equals == std::string::npos) {
    fail_at(Refusal::wrong_value, assignment.at(line.size()), "",
            "has no '='; write --set key.path=value");
  }
  assignment.path = line.substr(0, equals);
  assignment.names = path_names(assignment.path);
  if (std::any_of(assignment.names.begin(), assignment.names.end(), [](const std::string& name) {
        return name.empty() || name.find_first_of(" \t") != std::string::npos;
      })) {
    fail_at(Refusal::wrong_value, assignment.at(0), "",
            fmt::format("'{}' is not a key path; write --set key.path=value", assignment.path));
  }
  assignment.value = line.substr(equals + 1);
  if (assignment.value.find_first_not_of(" \t") == std::string::npos) {
    fail_at(Refusal::missing, assignment.at(line.size()), assignment.path,
            "has no value; write --set key.path=value");
  }
  return assignment;
}

SceneNode value_of(const Assignment& assignment) {
  SceneNode value = is_plain_number(assignment.value)
                        ? scalar_of(assignment.value, assignment.value_place())
                        : parse_yaml(assignment.value, assignment.value_place());
  if (assignment.names.size() + num_levels(value) > SceneLimits::levels) {
    fail_at(Refusal::wrong_value, assignment.at(0), assignment.path,
            fmt::format("maps and lists are nested deeper than {} levels", SceneLimits::levels));
  }
  return value;
}

/// The entry of a list that a name of the path counts.
SceneNode& item_of(SceneNode& list, const std::string& name, const std::string& walked,
                   const Place& place, const std::string& path) {
  const auto index = list_index(name, list.items.size());
  if (!index) {
    fail_at(Refusal::wrong_value, place, path,
            list.items.empty()
                ? fmt::format("'{}' is an empty list and has no entry '{}'", walked, name)
                : fmt::format("'{}' is a list; expected an index from 0 to {}, got '{}'", walked,
                              list.items.size() - 1, name));
  }
  return list.items[*index];
}

/// The value of a key of a map, or of what holds nothing and so becomes one; made where missing.
/// @param is_last whether it is the value that is set
SceneNode& value_in(SceneNode& map, const std::string& name, const Place& place, bool is_last) {
  if (map.kind == SceneNode::Kind::null) {
    map.kind = SceneNode::Kind::map;
    map.place = place;
  }
  auto entry = std::find_if(map.entries.begin(), map.entries.end(),
                            [&](const SceneEntry& one) { return one.key == name; });
  if (entry == map.entries.end()) {
    entry = map.entries.insert(entry, SceneEntry{name, place, {}});
    entry->value.place = place;
    if (!is_last) entry->value.kind = SceneNode::Kind::map;
  } else if (is_last) {
    entry->place = place;
  }
  return entry->value;
}

/// The value at the path, made where it is missing.
///
/// Nothing can go wrong any more once the path has left what exists, so a throw leaves no trace.
SceneNode& opened(SceneNode& root, const Assignment& assignment) {
  SceneNode* node = &root;
  std::string walked;
  std::size_t begin = 0;  // of the name in the assignment
  for (const std::string& name : assignment.names) {
    const Place place = assignment.at(begin);
    if (node->kind == SceneNode::Kind::scalar) {
      fail_at(Refusal::unknown_key, place, assignment.path,
              fmt::format("'{}' is a single value and holds no key '{}'", walked, name));
    }
    node = node->kind == SceneNode::Kind::list
               ? &item_of(*node, name, walked, place, assignment.path)
               : &value_in(*node, name, place, &name == &assignment.names.back());
    walked = join_path(walked, name);
    begin += name.size() + 1;
  }
  return *node;
}

}  // namespace

void set_value(SceneNode& root, const std::string& assignment) {
  check_line(assignment);
  const Assignment taken = take_apart(assignment);
  SceneNode value = value_of(taken);
  opened(root, taken) = std::move(value);
}

}  // namespace stridor
