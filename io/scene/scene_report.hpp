// What is found wrong with a scene while it is read, value by value.
#pragma once

#include <string>
#include <vector>

#include "core/errors.hpp"
#include "io/scene/scene_tree.hpp"

namespace stridor {

/// Collects the problems of the values of one scene.
class SceneReport {
 public:
  /// @param problems receives what is found; must live longer
  explicit SceneReport(std::vector<Problem>& problems) : problems_(problems) {}

  void add(Refusal refusal, const Place& place, const std::string& path, std::string message);

  /// Adds the faults of the text of this node alone; the nodes below it add their own when they are
  /// read.
  void add_text_problems(const SceneNode& node, const std::string& path);

  /// True where the node is what was expected; else says so.
  bool is_kind(const SceneNode& node, SceneNode::Kind kind, const std::string& expected,
               const std::string& path);

  /// A scalar, with the faults of its text reported.
  bool is_scalar(const SceneNode& node, const std::string& expected, const std::string& path);

  std::vector<Problem>& problems() const { return problems_; }

 private:
  std::vector<Problem>& problems_;
};

}  // namespace stridor
