// Valid scenes that together hold every declared key, found from the declarations alone.
//
// The values are first guesses by kind, unit and range. Conditions between keys are known to the
// checks only, so guesses are changed until none objects. If no valid scene is found for a key, the
// test that asked fails with the scene that came nearest and its remaining errors.
#pragma once

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "core/schema.hpp"
#include "io/scene/scene_reader.hpp"
#include "io/scene/scene_tree.hpp"
#include "tests/support/scene_draft.hpp"

namespace stridor::test {

/// The problems in lines, or "nothing".
inline std::string joined(const std::vector<Problem>& problems) {
  return problems.empty() ? "nothing" : ConfigError(problems).what();
}

/// The same keys without the checks between them.
inline const Schema& without_checks(const Schema& schema) {
  static std::map<const Schema*, std::unique_ptr<Schema>> known;
  std::unique_ptr<Schema>& copy = known[&schema];
  if (copy) return *copy;
  copy = std::make_unique<Schema>(schema);
  copy->checks.clear();
  for (Key& key : copy->keys) {
    for (Alternative& alternative : key.alternatives) {
      alternative.schema = [inner = alternative.schema]() -> const Schema& {
        return without_checks(inner());
      };
    }
  }
  return *copy;
}

/// The tree that reading the text of a draft would give, without places; much quicker. Values that
/// are written in flow style in `Draft::text` stay texts.
inline SceneNode node_of(const Draft& draft) {
  SceneNode node;
  switch (draft.form) {
    case Draft::Form::text:
      node.kind = SceneNode::Kind::scalar;
      node.text = draft.text;
      break;
    case Draft::Form::map:
      node.kind = SceneNode::Kind::map;
      for (const Draft& child : draft.children) {
        node.entries.push_back({child.name, {}, node_of(child)});
      }
      break;
    case Draft::Form::list:
      node.kind = SceneNode::Kind::list;
      for (const Draft& child : draft.children) node.items.push_back(node_of(child));
  }
  return node;
}

/// Changes a complete draft until no check between keys objects any more: gives keys another value,
/// leaves optional ones out, or takes them in again.
///
/// A check names a key. Changes are tried on that key, then on those beside it, then on those
/// beside the maps around it; the first that leaves fewer problems is kept. Where none does, the
/// first after which that key is no longer named, though others may be. No draft is visited twice.
class Repair {
 public:
  using Problems = std::function<std::vector<Problem>(const Draft&)>;

  /// @param problems_of errors of the checks, none hiding another
  /// @param wanted      pattern of a key that must stay
  /// @param fixed       path of a value that must stay as it is; "": none
  Repair(Problems problems_of, std::string wanted, std::string fixed = "")
      : problems_of_(std::move(problems_of)),
        wanted_(std::move(wanted)),
        fixed_(std::move(fixed)) {}

  /// @return the remaining errors where nothing helped; empty where the draft is right
  std::vector<Problem> operator()(Draft& root) {
    std::vector<Problem> problems = problems_of_(root);
    for (int i = 0; i < 500 && !problems.empty(); ++i) {
      if (!improve(root, problems)) break;
      problems = problems_of_(root);
    }
    return problems;
  }

 private:
  using IsBetter = std::function<bool(const std::vector<Problem>&)>;

  template <class Range, class Predicate>
  static bool any_of(const Range& range, Predicate predicate) {
    return std::any_of(range.begin(), range.end(), predicate);
  }

  /// True where the draft is to be kept.
  ///
  /// @param attempt name of the change that made it
  bool accepts(const Draft& root, const IsBetter& is_better, const std::string& attempt) {
    const auto [found, is_new] = problems_after_.try_emplace(attempt);
    if (is_new) found->second = problems_of_(root);
    return is_better(found->second) &&
           visited_.insert(WrittenScene(root, YamlStyle::block).text()).second;
  }

  bool improve(Draft& root, const std::vector<Problem>& problems) {
    problems_after_.clear();
    for (const bool must_be_fewer : {true, false}) {
      bool is_at_top = false;
      for (int distance = 0; !is_at_top; ++distance) {
        is_at_top = true;
        for (const Problem& problem : problems) {
          const auto path = ancestor(problem.key, distance);
          if (!path) continue;
          is_at_top = false;
          named_ = problem.key;
          const IsBetter is_better = [&](const std::vector<Problem>& left) {
            if (must_be_fewer) return left.size() < problems.size();
            return !any_of(left, [&](const Problem& one) { return one.key == problem.key; });
          };
          if (improve_below(root, *path, is_better)) return true;
        }
      }
    }
    return false;
  }

  /// The path itself for 0, the map that holds it for 1, ...; nothing beyond the top.
  static std::optional<std::string> ancestor(std::string path, int distance) {
    for (int i = 0; i < distance; ++i) {
      if (path.empty()) return std::nullopt;
      path = parent_path(path);
    }
    return path;
  }

  bool improve_below(Draft& root, const std::string& path, const IsBetter& is_better) {
    if (take_in(root, path, is_better)) return true;
    const Draft* draft = find_draft(root, path);
    if (draft == nullptr) return false;
    std::vector<std::string> below;
    visit(*draft, path, [&](const Draft&, const std::string& one) { below.push_back(one); });
    std::vector<std::string> absent;
    for (const std::string& name : draft->allowed) absent.push_back(join_path(path, name));
    const auto try_all = [&](const std::vector<std::string>& paths, auto attempt) {
      return any_of(paths,
                    [&](const std::string& one) { return (this->*attempt)(root, one, is_better); });
    };
    return try_all(below, &Repair::change) || try_all(absent, &Repair::take_in) ||
           try_all(below, &Repair::leave_out);
  }

  /// Takes in again a key that was left out.
  bool take_in(Draft& root, const std::string& path, const IsBetter& is_better) {
    Draft* map = find_draft(root, parent_path(path));
    if (map == nullptr) return take_in_with_map(root, path, is_better);
    if (map->schema == nullptr || map->child(last_name(path)) != nullptr) return false;
    const Key* key = map->schema->find(last_name(path));
    if (key == nullptr) return false;
    map->children.push_back(complete_draft(*key, map->pattern));
    if (accepts(root, is_better, "in " + path) || change(root, path, is_better)) return true;
    map->children.pop_back();
    return false;
  }

  /// Takes in a key together with the section around it that was left out, of which nothing else.
  bool take_in_with_map(Draft& root, const std::string& path, const IsBetter& is_better) {
    const std::string section = parent_path(path);
    Draft* map = section.empty() ? nullptr : find_draft(root, parent_path(section));
    if (map == nullptr || map->schema == nullptr) return false;
    const Key* key = map->schema->find(last_name(section));
    if (key == nullptr || key->kind != KeyKind::section) return false;
    Draft taken = complete_draft(*key, map->pattern);
    std::erase_if(taken.children, [&](const Draft& child) {
      return child.name != last_name(path) && child.key != nullptr && child.key->is_optional;
    });
    map->children.push_back(std::move(taken));
    if (accepts(root, is_better, "in " + path) || change(root, path, is_better)) return true;
    map->children.pop_back();
    return false;
  }

  /// Whether the value that must stay is at `path` or below.
  bool holds_fixed(const std::string& path) const {
    return !fixed_.empty() && (fixed_ + ".").starts_with(path + ".");
  }

  /// Another value for the key at `path`.
  bool change(Draft& root, const std::string& path, const IsBetter& is_better) {
    if (holds_fixed(path)) return false;
    Draft* draft = find_draft(root, path);
    if (draft == nullptr || draft->key == nullptr) return false;
    const Draft before = *draft;
    const bool is_named = (named_ + ".").starts_with(path + ".");
    const WordPairs pairs = is_named ? WordPairs::tried : WordPairs::left_out;
    int index = 0;
    for (const Draft& candidate : candidates(*before.key, pairs)) {
      draft->form = candidate.form;
      draft->text = candidate.text;
      draft->children = candidate.children;
      if (accepts(root, is_better, fmt::format("{} {}", path, index++))) return true;
    }
    *draft = before;
    return false;
  }

  bool leave_out(Draft& root, const std::string& path, const IsBetter& is_better) {
    if (holds_fixed(path)) return false;
    const Draft* draft = find_draft(root, path);
    if (draft == nullptr || draft->key == nullptr || !draft->key->is_optional ||
        (wanted_ + ".").starts_with(draft->pattern + ".")) {
      return false;
    }
    Draft* map = find_draft(root, parent_path(path));
    const std::vector<Draft> before = map->children;
    std::erase_if(map->children, [&](const Draft& child) { return child.name == last_name(path); });
    if (accepts(root, is_better, "out " + path)) return true;
    map->children = before;
    return false;
  }

  Problems problems_of_;
  std::string wanted_;
  std::string fixed_;
  std::set<std::string> visited_;
  std::string named_;  ///< path that a check names, for which the changes are tried
  /// Of the changes tried in one improvement, most of which are tried again from further away.
  std::map<std::string, std::vector<Problem>> problems_after_;
};

/// Errors of the checks between keys of a struct and of those below it. The reader runs them from
/// the inside out and stops at the first that objects; here none hides another.
inline void run_checks(const Schema& schema, const void* object, const std::string& path,
                       std::vector<Problem>& problems) {
  std::vector<Problem> found;
  for (const auto& check : schema.checks) check(object, found);
  for (Problem& problem : found) {
    problem.key = join_path(path, problem.key);
    problems.push_back(std::move(problem));
  }
  for (const Key& key : schema.keys) {
    if (!key.visit) continue;
    const std::string key_path = join_path(path, key.name);
    int index = 0;
    key.visit(object, [&](const std::string& name, std::size_t alternative, const void* nested) {
      const std::string nested_path = key.kind == KeyKind::section_list
                                          ? join_path(key_path, std::to_string(index++))
                                          : join_path(key_path, name);
      run_checks(key.alternatives[alternative].schema(), nested, nested_path, problems);
    });
  }
}

template <class T>
std::vector<Problem> objections_of_checks(const Draft& draft) {
  T object{};
  std::vector<Problem> problems;
  read_section(node_of(draft), without_checks(T::schema()), &object, "", problems);
  if (problems.empty()) run_checks(T::schema(), &object, "", problems);
  return problems;
}

/// A valid scene and the keys, as key paths, that it is the first to hold.
struct CompleteScene {
  Draft draft;
  std::set<std::string> new_paths;
};

/// Copies the value at `path`, or the map around it that is missing, from one draft to another.
inline void take_over(Draft& from, Draft& to, const std::string& path) {
  std::string missing;
  for (std::string above = path; find_draft(to, above) == nullptr; above = parent_path(above)) {
    missing = above;
  }
  if (missing.empty()) return;
  find_draft(to, parent_path(missing))->children.push_back(*find_draft(from, missing));
}

/// Takes every optional key out that does not hold the wanted one or lie within it.
inline void strip_to(Draft& draft, const std::string& wanted) {
  std::erase_if(draft.children, [&](const Draft& child) {
    return child.key != nullptr && child.key->is_optional &&
           !(wanted + ".").starts_with(child.pattern + ".") &&
           !(child.pattern + ".").starts_with(wanted + ".");
  });
  for (Draft& child : draft.children) strip_to(child, wanted);
}

/// Valid scenes that together hold every key of T: several, because there are keys that exclude
/// each other.
template <class T>
std::vector<CompleteScene> make_complete_scenes() {
  Draft all = complete_draft(T::schema(), "");
  std::map<std::string, std::string> missing;  // pattern -> path; of several entries, the last
  visit(all, "", [&](const Draft& draft, const std::string& path) {
    if (!draft.pattern.empty()) missing[draft.pattern] = path;
  });
  std::vector<CompleteScene> scenes;
  while (!missing.empty()) {
    const auto [wanted, wanted_path] = *missing.begin();
    // Where few keys stand, few stand in the way; but there may be no way that changes one key after
    // the other, and one from another scene.
    std::vector<Draft> starts;
    if (!scenes.empty()) starts.push_back(all);
    for (Draft& bare : starts) strip_to(bare, wanted);
    for (auto scene = scenes.rbegin(); scene != scenes.rend(); ++scene)
      starts.push_back(scene->draft);
    starts.push_back(all);
    CompleteScene scene;
    std::vector<Problem> problems;
    for (Draft& start : starts) {
      scene.draft = std::move(start);
      take_over(all, scene.draft, wanted_path);
      problems = Repair(objections_of_checks<T>, wanted)(scene.draft);
      if (problems.empty()) break;
    }
    visit(scene.draft, "", [&](const Draft& draft, const std::string& path) {
      if (!missing.contains(draft.pattern) || missing[draft.pattern] != path) return;
      missing.erase(draft.pattern);
      scene.new_paths.insert(path);
    });
    if (!problems.empty() || missing.contains(wanted)) {
      ADD_FAILURE() << "no valid scene with " << wanted << " was found; got to\n"
                    << WrittenScene(scene.draft, YamlStyle::block).text() << joined(problems);
      return scenes;
    }
    scenes.push_back(std::move(scene));
  }
  return scenes;
}

template <class T>
const std::vector<CompleteScene>& complete_scenes() {
  static const std::vector<CompleteScene> scenes = make_complete_scenes<T>();
  return scenes;
}

}  // namespace stridor::test
