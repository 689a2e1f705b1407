#include "io/scene/scene_tree.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <memory>
#include <utility>

#include "io/hdf5/regular_file.hpp"
#include "io/scene/scene_problems.hpp"
#include "io/scene/yaml_text.hpp"

namespace stridor {
namespace {

SceneNode parse_scene(const std::string& text, const std::string& source) {
  SceneNode root = parse_yaml(text, {source, 1, 1});
  if (root.kind == SceneNode::Kind::null) {
    fail_at(Refusal::not_yaml, {source, 1, 1}, "", "the scene is empty; expected a map of keys");
  }
  if (root.kind != SceneNode::Kind::map) {
    fail_at(
        Refusal::not_yaml, root.place, "",
        fmt::format("expected a map of keys ('key: value', with a space after the colon), got {}",
                    root.kind == SceneNode::Kind::list ? "a list" : "a single value"));
  }
  return root;
}

struct Found {
  const SceneNode* node;
  bool is_exact;
};

Found find_nearest(const SceneNode& root, const std::string& path) {
  const SceneNode* node = &root;
  if (path.empty()) return {node, true};
  for (const std::string& name : path_names(path)) {
    if (const SceneEntry* entry = node->entry(name)) {
      node = &entry->value;
    } else if (const auto index = list_index(name, node->items.size())) {
      node = &node->items[*index];
    } else {
      return {node, false};
    }
  }
  return {node, true};
}

}  // namespace

const SceneEntry* SceneNode::entry(const std::string& key) const {
  const auto found = std::find_if(entries.begin(), entries.end(),
                                  [&](const SceneEntry& one) { return one.key == key; });
  return found == entries.end() ? nullptr : &*found;
}

std::size_t num_levels(const SceneNode& node) {
  if (node.kind != SceneNode::Kind::map && node.kind != SceneNode::Kind::list) return 0;
  std::size_t tallest = 0;
  for (const SceneEntry& entry : node.entries) tallest = std::max(tallest, num_levels(entry.value));
  for (const SceneNode& item : node.items) tallest = std::max(tallest, num_levels(item));
  return tallest + 1;
}

std::string join_path(const std::string& path, const std::string& key) {
  if (path.empty()) return key;
  return key.empty() ? path : path + "." + key;
}

std::vector<std::string> path_names(const std::string& path) {
  std::vector<std::string> names;
  std::size_t begin = 0;
  while (true) {
    const std::size_t dot = path.find('.', begin);
    names.push_back(path.substr(begin, dot - begin));
    if (dot == std::string::npos) return names;
    begin = dot + 1;
  }
}

std::optional<std::size_t> list_index(const std::string& name, std::size_t size) {
  std::size_t index = 0;
  const char* end = name.data() + name.size();
  const auto [stop, status] = std::from_chars(name.data(), end, index);
  if (status != std::errc() || stop != end || index >= size) return std::nullopt;
  return index;
}

SceneNode read_scene_text(const std::string& text, const std::string& source_name) {
  try {
    SceneNode root = parse_scene(text, source_name);
    root.document = text;
    return root;
  } catch (const ConfigError& error) {
    std::vector<Problem> problems = error.problems();
    add_excerpts(problems, source_name, text);
    throw ConfigError(std::move(problems));
  }
}

SceneNode read_scene_file(const std::string& path) {
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(path, error);
  if (status.type() == std::filesystem::file_type::not_found) {
    throw FileError(Refusal::cannot_read, path, "",
                    "does not exist; give the path of a scene file");
  }
  if (status.type() == std::filesystem::file_type::directory) {
    throw FileError(Refusal::cannot_read, path, "",
                    "is a directory; give the path of a scene file");
  }
  const std::string irregular = irregular_kind(path);
  if (!irregular.empty())
    throw FileError(Refusal::cannot_read, path, "",
                    "is " + irregular + "; give the path of a scene file");
  const OpenFile file(std::fopen(path.c_str(), "rb"));
  if (!file)
    throw FileError(Refusal::cannot_read, path, "",
                    fmt::format("cannot be opened: {}", std::strerror(errno)));

  // Read up to the limit rather than trust the size: files of /proc tell none.
  std::string text;
  std::vector<char> part(64 * 1024);
  std::size_t size = 1;
  while (size > 0 && text.size() <= SceneLimits::bytes) {
    size = std::fread(part.data(), 1, part.size(), file.get());
    text.append(part.data(), size);
  }
  if (std::ferror(file.get()) != 0) {
    throw FileError(Refusal::cannot_read, path, "",
                    fmt::format("cannot be read: {}", std::strerror(errno)));
  }
  if (text.starts_with("\x89HDF\r\n\x1a\n")) {
    fail_at(
        Refusal::not_yaml, {path, 0, 0}, "",
        "is an HDF5 file, not a scene (YAML); `stridor info` says what a run file holds, and its "
        "scene is the text in /scene/text");
  }
  if (text.size() > SceneLimits::bytes) {
    throw FileError(
        Refusal::cannot_read, path, "",
        fmt::format("is larger than {} MiB, which no scene is; put large tables into files "
                    "of their own",
                    SceneLimits::bytes / (1024 * 1024)));
  }
  return read_scene_text(text, path);
}

const SceneNode* find(const SceneNode& root, const std::string& path) {
  const Found found = find_nearest(root, path);
  return found.is_exact ? found.node : nullptr;
}

Place place_of(const SceneNode& root, const std::string& path) {
  return find_nearest(root, path).node->place;
}

std::string path_of_file(const SceneNode& root, const std::string& key, const std::string& name) {
  const Place place = place_of(root, key);
  if (place.line == 0) return name;
  return (std::filesystem::path(place.source).parent_path() / name).string();
}

}  // namespace stridor
