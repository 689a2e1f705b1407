// The section `parameters` of a scene, and the expressions that depend on it.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/errors.hpp"
#include "core/schema.hpp"
#include "io/scene/scene_tree.hpp"

namespace stridor {

/// Evaluates the expressions of one scene.
class SceneParameters {
 public:
  /// Reads `parameters`: a map of names to numbers, with or without units, or to expressions of
  /// other parameters, in any order.
  ///
  /// @param node     the map
  /// @param path     its key path
  /// @param problems receives what is wrong: values that are none, names that expressions cannot
  ///                 hold, expressions that depend on themselves, with the chain of names
  void read(const SceneNode& node, const std::string& path, std::vector<Problem>& problems);

  /// The value of an expression, in SI units.
  /// @param node     a scalar with is_expression(text)
  /// @param path     key path of it
  /// @param problems receives why there is none, unless that lies in a parameter, of which it is
  ///                 known already
  std::optional<double> value_of(const SceneNode& node, const std::string& path,
                                 std::vector<Problem>& problems);

  /// The parameters in the order of the scene; used are those of which value_of() has made use.
  NamedNumbers numbers() const;

  /// Adds a problem for each parameter that was given by `--set` and of which no use was made: it
  /// would change nothing.
  void refuse_idle_settings(std::vector<Problem>& problems) const;

 private:
  enum class State { unread, pending, known, wrong };
  struct Parameter {
    const SceneNode* node = nullptr;
    std::string path;
    std::vector<std::string> needs;  ///< names in its expression
    NamedNumber number;
    State state = State::unread;
  };

  void add(const SceneEntry& entry, const std::string& path, std::vector<Problem>& problems);
  void resolve(std::size_t first, std::vector<Problem>& problems);
  void evaluate_parameter(Parameter& parameter, std::vector<Problem>& problems);
  void mark_used(const std::vector<std::string>& names);
  Parameter* find(const std::string& name);

  std::vector<Parameter> parameters_;
  std::map<std::string, std::size_t> index_;
  std::map<std::string, double> values_;  ///< of those that are known
};

}  // namespace stridor
