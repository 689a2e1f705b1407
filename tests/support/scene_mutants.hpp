// Scenes spoilt, key by key and in every way that the kind of key allows, and what must be said of
// them.
#pragma once

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "core/schema.hpp"
#include "core/suggestion.hpp"
#include "core/units.hpp"
#include "io/scene/scene_words.hpp"
#include "tests/support/number_cases.hpp"
#include "tests/support/scene_draft.hpp"

namespace stridor::test {

/// The message that a spoilt scene must bring, and its place: the name of a key or a value.
struct Answer {
  enum class At { key, value };

  std::string key;
  At at = At::value;
  std::string path;  ///< where it stands, in the spoilt scene
  std::string message;
};

/// A spoilt scene; without answers, one with another allowed value.
struct Mutant {
  std::string what;
  Draft scene;
  std::vector<Answer> answers;
  std::string path = "";  ///< of that value, where there must be others that go with it
};

/// A text that differs from `name` by one slip and from which the program finds back to it.
inline std::string misspelt(const std::string& name, const std::vector<std::string>& allowed) {
  std::vector<std::string> slips;
  for (std::size_t i = 0; i < name.size(); ++i) {
    slips.push_back(name.substr(0, i + 1) + name.substr(i));
    slips.push_back(name.substr(0, i) + name.substr(i + 1));
    if (i == 0) continue;
    slips.push_back(name);
    std::swap(slips.back()[i - 1], slips.back()[i]);
  }
  for (const std::string& slip : slips) {
    const bool is_allowed = std::find(allowed.begin(), allowed.end(), slip) != allowed.end();
    if (!slip.empty() && !is_allowed && nearest(slip, allowed) == name) return slip;
  }
  ADD_FAILURE() << "no slip leads back to " << name;
  return name + "x";
}

/// Spoils a scene.
class MutantMaker {
 public:
  explicit MutantMaker(const Draft& scene) : scene_(scene) {}

  /// Every way to spoil what stands at a key path.
  std::vector<Mutant> mutants_at(const std::string& path) {
    mutants_.clear();
    const Draft& draft = *find_draft(scene_, path);
    const Draft& parent = *find_draft(scene_, parent_path(path));
    if (parent.key != nullptr && parent.key->kind == KeyKind::parameters) {
      spoil_parameter(path);
    } else if (parent.form == Draft::Form::list) {
      spoil_item(path);
    } else if (!parent.allowed.empty()) {
      spoil_name(path, draft, parent);
    } else {
      spoil_section_name(path);
    }
    if (draft.key != nullptr) spoil_value(path, draft, *draft.key);
    return std::move(mutants_);
  }

 private:
  using At = Answer::At;

  void add(std::string what, Draft scene, std::vector<Answer> answers) {
    mutants_.push_back({std::move(what), std::move(scene), std::move(answers)});
  }

  /// The value at a path replaced by a text; `message` is said of it.
  void put(const std::string& path, const std::string& text, const std::string& message) {
    put(path, text_draft(text), path, message);
  }
  void put(const std::string& path, const Draft& value, const std::string& key,
           const std::string& message) {
    Draft scene = scene_;
    Draft& draft = *find_draft(scene, path);
    draft.form = value.form;
    draft.text = value.text;
    draft.children = value.children;
    draft.allowed = value.allowed;
    if (message.empty()) {
      mutants_.push_back({"set to " + value.text, std::move(scene), {}, path});
    } else {
      add("set to " + value.text, std::move(scene), {{key, At::value, key, message}});
    }
  }

  void put_null(const std::string& path, At at, const std::string& expected) {
    for (const std::string text : {"", "null", "~"}) {
      if (text.empty() && at == At::value) continue;  // an item of a list cannot be nothing at all
      Draft scene = scene_;
      Draft& draft = *find_draft(scene, path);
      draft.form = Draft::Form::text;
      draft.text = text;
      add(fmt::format("emptied by '{}'", text), std::move(scene),
          {{path, at, path, "has no value, expected " + expected}});
    }
  }

  void put_double(const std::string& path) {
    Draft scene = scene_;
    Draft& map = *find_draft(scene, parent_path(path));
    map.children.push_back(*map.child(last_name(path)));
    add("doubled", std::move(scene), {{path, At::key, path, "is given twice, first in line"}});
  }

  /// A key of a map: left out, doubled, emptied, misspelt.
  void spoil_name(const std::string& path, const Draft& draft, const Draft& map) {
    const std::string map_path = parent_path(path);
    std::vector<Answer> missing;
    const bool is_optional = draft.key != nullptr && draft.key->is_optional;
    if (!is_optional) {
      missing.push_back({path, At::value, map_path,
                         fmt::format("required key '{}' is missing, expected {}", draft.name,
                                     expected_at(draft, map))});
      Draft scene = scene_;
      std::erase_if(find_draft(scene, map_path)->children,
                    [&](const Draft& child) { return child.name == draft.name; });
      add("left out", std::move(scene), missing);
    }
    put_double(path);
    put_null(path, At::key, expected_at(draft, map));

    const std::string wrong = misspelt(draft.name, map.allowed);
    const std::string wrong_path = join_path(map_path, wrong);
    Draft scene = scene_;
    find_draft(scene, path)->name = wrong;
    missing.push_back({wrong_path, At::key, wrong_path,
                       fmt::format("unknown key '{}', did you mean '{}'?", wrong, draft.name)});
    add("misspelt", std::move(scene), missing);
    if (draft.key == nullptr && map.schema != nullptr) spoil_discriminator(path, draft);
  }

  static std::string expected_at(const Draft& draft, const Draft& map) {
    if (draft.key != nullptr) return expected_of(*draft.key);
    return map.schema != nullptr ? "one of " : "a list of numbers";
  }

  void spoil_discriminator(const std::string& path, const Draft& draft) {
    put(path, misspelt(draft.text, {draft.text}), fmt::format("did you mean '{}'?", draft.text));
    put(path, "{zz: 1}", "expected one of ");
    put(path, "[1]", "expected one of ");
  }

  /// An entry of a map of named sections.
  void spoil_section_name(const std::string& path) {
    put_double(path);
    put_null(path, At::key, "a map");
    put(path, "1", "expected a map, got '1'");
    put(path, "[1]", "expected a map, got a list");
    for (const std::string wrong : {"1st", "a b", "-x"}) {
      Draft scene = scene_;
      find_draft(scene, path)->name = wrong;
      const std::string wrong_path = join_path(parent_path(path), wrong);
      add("named " + wrong, std::move(scene),
          {{wrong_path, At::key, wrong_path, fmt::format("'{}' cannot be a name", wrong)}});
    }
  }

  /// A number with a name.
  void spoil_parameter(const std::string& path) {
    put_double(path);
    put_null(path, At::key, "a number or an expression");
    put(path, "[1]", "expected a number or an expression, got a map or a list");
    put(path, "fast", "'fast' is not a number");
    put(path, "=1/0", "1 is divided by 0");
    put(path, "=nobody", "column 1: there is no parameter 'nobody'");
    put(path, fmt::format("={}", last_name(path)), "depends on itself: " + last_name(path));
    for (const std::string wrong : {"a-b", "1st", "sqrt", "pi"}) {
      Draft scene = scene_;
      Draft& map = *find_draft(scene, parent_path(path));
      map.children.push_back(text_draft("1"));
      map.children.back().name = wrong;
      const std::string wrong_path = join_path(parent_path(path), wrong);
      add("named " + wrong, std::move(scene), {{wrong_path, At::key, wrong_path, ""}});
    }
  }

  /// An entry of a list of sections.
  void spoil_item(const std::string& path) {
    put_null(path, At::value, "a map");
    put(path, "1", "expected a map, got '1'");
    put(path, "[1]", "expected a map, got a list");
  }

  /// A single number, which is right before.
  void spoil_number(const std::string& path, const NumberRules& rules) {
    const double allowed = parse_quantity(find_draft(scene_, path)->text, rules.unit);
    for (const NumberCase& one : number_cases(rules, allowed)) {
      put(path, one.text, one.message);
      if (!one.is_bound) mutants_.back().path.clear();
    }
  }

  /// The last of a list of numbers.
  void spoil_numbers(const std::string& path, const NumberRules& rules) {
    const std::string expected =
        "expected a number" + (rules.unit.empty() ? "" : " in " + rules.unit) + ", got a ";
    const std::size_t last = find_draft(scene_, path)->children.size() - 1;
    const std::string item = join_path(path, std::to_string(last));
    spoil_number(item, rules);
    put(item, "[1]", expected + "list");
    put(item, "{zz: 1}", expected + "map");
    put_null(item, At::value, "a number");
  }

  void spoil_value(const std::string& path, const Draft& draft, const Key& key) {
    const NumberRules rules{key.unit, key.range, key.kind == KeyKind::integer, key.storable};
    const std::string expected = "expected " + expected_of(key) + ", got ";
    const auto refuse = [&](const std::string& text, const std::string& found) {
      put(path, text, expected + found);
    };
    switch (key.kind) {
      case KeyKind::flag:
        for (const std::string text : {"yes", "True", "1", "''"}) put(path, text, expected + "'");
        break;
      case KeyKind::integer:
      case KeyKind::real:
        spoil_number(path, rules);
        break;
      case KeyKind::text:
        break;
      case KeyKind::choice:
        for (const std::string& choice : key.choices) {
          const std::string slip = misspelt(choice, key.choices);
          put(path, slip, fmt::format("{}'{}', did you mean '{}'?", expected, slip, choice));
          put(path, choice, "");
        }
        refuse("zzzzzzzzzzzz", "'zzzzzzzzzzzz'");
        break;
      case KeyKind::real_list:
        spoil_numbers(path, rules);
        refuse("1", "'1'");
        break;
      case KeyKind::text_list:
        if (draft.form == Draft::Form::list) {
          const std::string item = join_path(path, std::to_string(draft.children.size() - 1));
          const std::string entry = key.has_rows ? "a row of numbers" : "a text";
          put(item, "{zz: 1}", fmt::format("expected {}, got a map", entry));
          put(item, "[1]", key.has_rows ? "" : "expected a text, got a list");
          put_null(item, At::value, entry);
        }
        // The meaning of texts is known to the checks and to the model alone.
        for (const std::string text : {"a", "[a, b]"}) {
          put(path, text, "");
          mutants_.back().path.clear();
        }
        break;
      case KeyKind::curve:
        spoil_curve(path, key, rules);
        break;
      case KeyKind::section:
      case KeyKind::named_sections:
      case KeyKind::section_list:
      case KeyKind::parameters:
        if (number_in_place_of(key) != nullptr) {
          put(path, "zz", "'zz' is not a number, expected");
        } else {
          refuse("1", "'1'");
        }
        break;
    }
    const bool takes_list = key.kind == KeyKind::real_list || key.kind == KeyKind::text_list ||
                            key.kind == KeyKind::section_list || !key.list_key.empty();
    const bool takes_map = key.kind == KeyKind::curve || key.kind == KeyKind::section ||
                           key.kind == KeyKind::named_sections || key.kind == KeyKind::parameters;
    if (!takes_list) refuse("[1]", "a list");
    if (!takes_map) refuse("{zz: 1}", "a map");
  }

  /// A curve in both of its forms.
  void spoil_curve(const std::string& path, const Key& key, const NumberRules& rules) {
    const Draft original = scene_;
    const std::string value = number_text(allowed_numbers(key).at(0));
    put(path, value, "");
    find_draft(scene_, path)->form = Draft::Form::text;
    find_draft(scene_, path)->text = value;
    spoil_number(path, rules);

    const Draft table = table_draft({"0", "1 s", "2"}, {value, value, value});
    put(path, table, path, "");
    Draft& curve = *find_draft(scene_, path);
    curve.form = table.form;
    curve.children = table.children;
    curve.allowed = table.allowed;
    const std::string times = path + ".times";
    const std::string values = path + ".values";
    for (const std::string& column : {times, values}) {
      spoil_name(column, *find_draft(scene_, column), *find_draft(scene_, path));
      put(column, "1", "expected a list of numbers");
      put(column, "{zz: 1}", "expected a list of numbers");
    }
    spoil_numbers(times, {"s", Range::any()});
    spoil_numbers(values, rules);
    put(times, list_draft({"0", "1", "1"}), times + ".2", "times must increase strictly");
    put(times, list_draft({"0", "2", "1"}), times + ".2", "times must increase strictly");
    put(times, list_draft({}), times, "needs at least one time");
    put(values, list_draft({value, value}), values, "has 2 entries but times has 3");
    scene_ = original;
  }

  Draft scene_;
  std::vector<Mutant> mutants_;
};

}  // namespace stridor::test
