#include "io/scene/scene_problems.hpp"

#include <algorithm>
#include <string_view>
#include <utility>

#include "core/excerpt.hpp"
#include "io/scene/yaml_text.hpp"

namespace stridor {
namespace {

std::vector<std::string_view> lines_of(std::string_view text) {
  if (text.starts_with(byte_order_mark)) text.remove_prefix(byte_order_mark.size());
  std::vector<std::string_view> lines;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    std::string_view line = text.substr(0, end);
    if (line.ends_with('\r')) line.remove_suffix(1);
    lines.push_back(line);
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return lines;
}

}  // namespace

Problem problem_at(Refusal refusal, const Place& place, std::string key, std::string message) {
  if (place.line > 0) {
    return {refusal, std::move(key), std::move(message), place.source, place.line, place.column};
  }
  return {refusal,
          std::move(key),
          std::move(message),
          place.source,
          0,
          0,
          place.column > 0 ? excerpt_of(place.source, 0, place.column) : ""};
}

void fail_at(Refusal refusal, const Place& place, std::string key, std::string message) {
  throw ConfigError(
      std::vector<Problem>{problem_at(refusal, place, std::move(key), std::move(message))});
}

void add_excerpts(std::vector<Problem>& problems, const std::string& source,
                  std::string_view text) {
  const std::vector<std::string_view> lines = lines_of(text);
  for (Problem& problem : problems) {
    if (problem.source != source || problem.line < 1 || !problem.excerpt.empty()) continue;
    const auto index = static_cast<std::size_t>(problem.line) - 1;
    if (index >= lines.size() || lines[index].empty()) continue;
    problem.excerpt = excerpt_of(lines[index], problem.line, problem.column);
  }
}

void add_excerpts(std::vector<Problem>& problems, const SceneNode& root) {
  add_excerpts(problems, root.place.source, root.document);
}

void locate(std::vector<Problem>& problems, const SceneNode& root) {
  for (Problem& problem : problems) {
    if (!problem.source.empty()) continue;
    const Place place = place_of(root, problem.key);
    if (problem.key.empty()) {
      problem.source = place.source;
    } else {
      problem =
          problem_at(problem.refusal, place, std::move(problem.key), std::move(problem.message));
    }
  }
  add_excerpts(problems, root);
}

void sort_by_place(std::vector<Problem>& problems) {
  // A file always has a line where it has a place; what has none goes after it.
  const auto rank = [](const Problem& problem) {
    return std::make_pair(problem.line == 0 ? 1 : 0, std::make_pair(problem.line, problem.column));
  };
  std::stable_sort(problems.begin(), problems.end(),
                   [&](const Problem& a, const Problem& b) { return rank(a) < rank(b); });
}

void collect_text_problems(const SceneNode& node, const std::string& path,
                           std::vector<Problem>& problems) {
  for (Problem problem : node.problems) {
    problem.key = join_path(path, problem.key);
    problems.push_back(std::move(problem));
  }
  for (const SceneEntry& entry : node.entries) {
    collect_text_problems(entry.value, join_path(path, entry.key), problems);
  }
  for (std::size_t i = 0; i < node.items.size(); ++i) {
    collect_text_problems(node.items[i], join_path(path, std::to_string(i)), problems);
  }
}

}  // namespace stridor
