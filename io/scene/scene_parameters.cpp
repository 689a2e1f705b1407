#include "io/scene/scene_parameters.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "core/units.hpp"
#include "io/scene/expression.hpp"
#include "io/scene/scene_problems.hpp"

namespace stridor {
namespace {

/// Names as expressions hold them; '-' would be a minus.
bool is_parameter_name(const std::string& name) {
  constexpr std::size_t longest = 60;
  const auto is_letter = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_';
  };
  return !name.empty() && name.size() <= longest && is_letter(name.front()) &&
         std::all_of(name.begin(), name.end(),
                     [&](char c) { return is_letter(c) || (c >= '0' && c <= '9'); });
}

/// False for what is no number and would break a message.
bool is_short_line(const std::string& text) {
  constexpr std::size_t longest = 60;
  return text.size() <= longest && std::none_of(text.begin(), text.end(), [](char c) {
           return static_cast<unsigned char>(c) < 0x20 || c == 0x7F;
         });
}

}  // namespace

void SceneParameters::read(const SceneNode& node, const std::string& path,
                           std::vector<Problem>& problems) {
  parameters_.reserve(node.entries.size());
  for (const SceneEntry& entry : node.entries) add(entry, join_path(path, entry.key), problems);
  for (std::size_t i = 0; i < parameters_.size(); ++i) resolve(i, problems);
}

void SceneParameters::add(const SceneEntry& entry, const std::string& path,
                          std::vector<Problem>& problems) {
  const SceneNode& node = entry.value;
  collect_text_problems(node, path, problems);
  if (is_reserved_name(entry.key)) {
    problems.push_back(
        problem_at(Refusal::expression, entry.place, path,
                   fmt::format("'{}' already means something in expressions; choose another name",
                               entry.key)));
    return;
  }
  if (!is_parameter_name(entry.key)) {
    problems.push_back(problem_at(Refusal::expression, entry.place, path,
                                  "cannot be the name of a parameter; use at most 60 letters, "
                                  "digits and '_', no digit first"));
    return;
  }
  index_[entry.key] = parameters_.size();
  Parameter& parameter = parameters_.emplace_back();
  parameter.node = &node;
  parameter.path = path;
  parameter.number.name = entry.key;
  const auto refuse = [&](const Place& place, std::string message) {
    problems.push_back(problem_at(Refusal::expression, place, path, std::move(message)));
    parameter.state = State::wrong;
  };
  if (node.kind == SceneNode::Kind::null) {
    refuse(entry.place, "has no value, expected a number or an expression");
  } else if (node.kind != SceneNode::Kind::scalar) {
    refuse(node.place, "expected a number or an expression, got a map or a list");
  } else if (!node.problems.empty()) {
    parameter.state = State::wrong;
  } else if (!is_expression(node.text) && !is_short_line(node.text)) {
    refuse(node.place, "expected a number or an expression, got a long text");
  } else {
    try {
      if (is_expression(node.text)) parameter.needs = names_in(node.text);
    } catch (const std::invalid_argument& error) {
      refuse(node.place, error.what());
    }
  }
}

/// Evaluates a parameter after those that it needs. Not by calling itself, since a scene may have
/// longer chains than the stack is deep.
void SceneParameters::resolve(std::size_t first, std::vector<Problem>& problems) {
  struct Step {
    Parameter* parameter;
    std::size_t next = 0;  ///< of its needs
  };
  if (parameters_[first].state != State::unread) return;
  std::vector<Step> chain{{&parameters_[first]}};
  parameters_[first].state = State::pending;
  while (!chain.empty()) {
    Parameter& parameter = *chain.back().parameter;
    if (chain.back().next == parameter.needs.size()) {
      if (parameter.state == State::pending) evaluate_parameter(parameter, problems);
      chain.pop_back();
      continue;
    }
    Parameter* needed = find(parameter.needs[chain.back().next++]);
    if (needed == nullptr) continue;  // evaluate() says that it is not there
    if (needed->state == State::unread) {
      needed->state = State::pending;
      chain.push_back({needed});
    } else if (needed->state == State::pending) {  // so it is in the chain
      constexpr std::ptrdiff_t most_shown = 8;
      std::string names;
      const auto begin = std::find_if(chain.begin(), chain.end(),
                                      [&](const Step& step) { return step.parameter == needed; });
      for (auto step = begin; step != chain.end(); ++step) {
        if (step - begin < most_shown) names += step->parameter->number.name + " -> ";
        if (step - begin == most_shown) names += "... -> ";
        step->parameter->state = State::wrong;
      }
      problems.push_back(
          problem_at(Refusal::expression, needed->node->place, needed->path,
                     fmt::format("depends on itself: {}{}; give one of them a number", names,
                                 needed->number.name)));
    }
  }
}

void SceneParameters::evaluate_parameter(Parameter& parameter, std::vector<Problem>& problems) {
  parameter.state = State::wrong;
  for (const std::string& name : parameter.needs) {
    const Parameter* needed = find(name);
    if (needed != nullptr && needed->state == State::wrong) return;  // which has been said
  }
  const std::string& text = parameter.node->text;
  try {
    if (is_expression(text)) {
      parameter.number.value = evaluate(text, values_);
    } else {
      const Quantity quantity = parse_any_quantity(text);
      parameter.number.value = quantity.value;
      parameter.number.unit = quantity.unit;
    }
  } catch (const QuantityError& error) {
    problems.push_back(
        problem_at(error.refusal(), parameter.node->place, parameter.path, error.what()));
    return;
  } catch (const std::invalid_argument& error) {
    problems.push_back(
        problem_at(Refusal::expression, parameter.node->place, parameter.path, error.what()));
    return;
  }
  parameter.state = State::known;
  values_[parameter.number.name] = parameter.number.value;
}

std::optional<double> SceneParameters::value_of(const SceneNode& node, const std::string& path,
                                                std::vector<Problem>& problems) {
  try {
    const std::vector<std::string> names = names_in(node.text);
    mark_used(names);
    for (const std::string& name : names) {
      const Parameter* needed = find(name);
      if (needed != nullptr && needed->state == State::wrong) return std::nullopt;
    }
    return evaluate(node.text, values_);
  } catch (const std::invalid_argument& error) {
    problems.push_back(problem_at(Refusal::expression, node.place, path, error.what()));
    return std::nullopt;
  }
}

void SceneParameters::mark_used(const std::vector<std::string>& names) {
  std::vector<std::string> open = names;
  while (!open.empty()) {
    Parameter* parameter = find(open.back());
    open.pop_back();
    if (parameter == nullptr || parameter->number.is_used) continue;
    parameter->number.is_used = true;
    open.insert(open.end(), parameter->needs.begin(), parameter->needs.end());
  }
}

SceneParameters::Parameter* SceneParameters::find(const std::string& name) {
  const auto found = index_.find(name);
  return found == index_.end() ? nullptr : &parameters_[found->second];
}

NamedNumbers SceneParameters::numbers() const {
  NamedNumbers numbers;
  numbers.reserve(parameters_.size());
  for (const Parameter& parameter : parameters_) numbers.push_back(parameter.number);
  return numbers;
}

void SceneParameters::refuse_idle_settings(std::vector<Problem>& problems) const {
  for (const Parameter& parameter : parameters_) {
    const bool is_set = parameter.node->place.source.starts_with("--set ");
    if (parameter.number.is_used || !is_set) continue;
    problems.push_back(problem_at(
        Refusal::expression, parameter.node->place, parameter.path,
        "no expression of the scene uses this parameter, so setting it changes nothing"));
  }
}

}  // namespace stridor
