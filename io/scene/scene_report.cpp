#include "io/scene/scene_report.hpp"

#include <fmt/format.h>

#include <utility>

#include "io/scene/scene_problems.hpp"
#include "io/scene/scene_words.hpp"

namespace stridor {

void SceneReport::add(Refusal refusal, const Place& place, const std::string& path,
                      std::string message) {
  problems_.push_back(problem_at(refusal, place, path, std::move(message)));
}

void SceneReport::add_text_problems(const SceneNode& node, const std::string& path) {
  for (Problem problem : node.problems) {
    problem.key = join_path(path, problem.key);
    problems_.push_back(std::move(problem));
  }
}

bool SceneReport::is_kind(const SceneNode& node, SceneNode::Kind kind, const std::string& expected,
                          const std::string& path) {
  if (node.kind == kind) return true;
  const bool is_missing = node.kind == SceneNode::Kind::null;
  add(is_missing ? Refusal::missing : Refusal::wrong_value, node.place, path,
      is_missing ? fmt::format("has no value, expected {}", expected)
                 : fmt::format("expected {}, got {}", expected, found_in(node)));
  collect_text_problems(node, path, problems_);
  return false;
}

bool SceneReport::is_scalar(const SceneNode& node, const std::string& expected,
                            const std::string& path) {
  if (!is_kind(node, SceneNode::Kind::scalar, expected, path)) return false;
  add_text_problems(node, path);
  return true;
}

}  // namespace stridor
