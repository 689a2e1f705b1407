// Scenes made from the declared keys alone and then spoilt, key by key and in every way that the
// kind of key allows. What is declared tomorrow is tested without a line added here.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <set>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "core/excerpt.hpp"
#include "core/suggestion.hpp"
#include "core/units.hpp"
#include "io/scene/scene.hpp"
#include "io/scene/scene_reader.hpp"
#include "io/scene/scene_words.hpp"
#include "tests/io/example_scene.hpp"
#include "tests/support/complete_scenes.hpp"
#include "tests/support/program.hpp"
#include "tests/support/scene_draft.hpp"

namespace stridor {
namespace {

using namespace test;

enum class Checks { all, none };

template <class T>
std::vector<Problem> problems_with(const std::string& text, Checks checks = Checks::all) {
  const SceneNode root = read_scene_text(text, "s.yaml");
  std::vector<Problem> problems;
  if (checks == Checks::none) {
    T object{};
    read_section(root, without_checks(T::schema()), &object, "", problems);
    return problems;
  }
  try {
    read_as<T>(root);
  } catch (const ConfigError& error) {
    problems = error.problems();
  }
  return problems;
}

/// What must be said of a spoilt scene, and where: at the name of a key or at a value.
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
std::string misspelt(const std::string& name, const std::vector<std::string>& allowed) {
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

/// What is allowed of a number.
struct NumberRules {
  std::string unit;
  Range range;
  bool is_integer = false;
  Range storable{};
};

/// A number and what must be said of it; nothing where it is right.
struct NumberCase {
  std::string text;
  std::string message;
  bool is_bound = false;  ///< an end of the range that belongs to it
};

constexpr const char* beyond_computation = "is beyond what can be computed with";

/// Whether products of a few such numbers neither overflow nor vanish.
bool is_computable(const NumberRules& rules, double value) {
  if (rules.is_integer) return true;
  const double size = std::abs(value);
  if (rules.unit.empty()) return size <= 1e100;
  return size == 0.0 || (size >= 1e-30 && size <= 1e30);
}

/// Numbers at, just below and just above the bounds of the range, and further away.
void add_range_cases(const NumberRules& rules, std::vector<NumberCase>& cases) {
  const Range& range = rules.range;
  const std::string refusal = "must be " + range.text();
  const auto next = [&](double value, double towards) {
    return rules.is_integer ? value + std::copysign(1.0, towards) : std::nextafter(value, towards);
  };
  for (const double bound : {range.low, range.high}) {
    if (!std::isfinite(bound)) continue;
    for (const double value :
         {next(bound, -HUGE_VAL), bound, next(bound, HUGE_VAL), bound - 10.0, bound + 10.0}) {
      const bool is_allowed = range.contains(value) && is_computable(rules, value);
      const std::string message = range.contains(value) ? beyond_computation : refusal;
      cases.push_back(
          {number_text(value), is_allowed ? "" : message, is_allowed && value == bound});
    }
    if (rules.is_integer || rules.unit.empty()) continue;
    const double outside = bound == range.low ? bound - 1.0 : bound + 1.0;
    const std::string text = number_text(outside) + " " + rules.unit;
    cases.push_back({text, refusal});
    cases.push_back({text, fmt::format("(written '{}')", text)});
  }
  if (rules.is_integer && rules.storable.high < range.high) {
    cases.push_back({fmt::format("{:.0f}", rules.storable.high + 1.0), "is too far from 0"});
  }
}

/// @param allowed a number that the rules allow
std::vector<NumberCase> number_cases(const NumberRules& rules, double allowed) {
  std::vector<NumberCase> cases;
  if (rules.is_integer) {
    for (const std::string text :
         {"1.5", "1e3", "1.0", "1 m", "1 apples", "1 2", "one", "true", "0x10", ".nan"}) {
      cases.push_back({text, fmt::format("expected a whole number without unit, got '{}'", text)});
    }
    cases.push_back({"''", "expected a whole number without unit, got ''"});
    cases.push_back({"=0.5", "must be a whole number, got 0.5 (written '=0.5')"});
  } else {
    for (const std::string text : {"long", "true", "1 2", "1.2.3", "1 2 m"}) {
      cases.push_back({text, fmt::format("'{}' is not a number, expected", text)});
    }
    cases.push_back({"'1,5'", "'1,5' is not a number, expected"});
    cases.push_back({"0x10", "is not a decimal number (hexadecimal is not read)"});
    cases.push_back({"''", "is empty, expected"});
    for (const std::string text : {".nan", "-.inf", "inf"}) {
      cases.push_back({text, fmt::format("must be finite, got '{}'", text)});
    }
    cases.push_back({"1e999", "must be finite"});
    const std::string other = rules.unit == "kg" ? "m" : "kg";
    cases.push_back({"1 " + other, fmt::format("'1 {0}' has unit {0}, expected", other)});
    cases.push_back({"1 xyzzy", "'1 xyzzy' has the unknown unit 'xyzzy', expected"});
    cases.push_back({"1 m or so", "has the unknown unit 'm or so', expected"});
    cases.push_back({rules.unit.empty() ? number_text(100.0 * allowed) + " %"
                                        : number_text(allowed) + " " + rules.unit,
                     ""});
  }
  cases.push_back({"=" + number_text(allowed), ""});
  cases.push_back({"=1/0", "'=1/0': 1 is divided by 0"});
  cases.push_back({"=nobody", "'=nobody', column 1: there is no parameter 'nobody'"});
  cases.push_back({"=2 +", "'=2 +', column 4: a number or a name is missing after '+'"});
  add_range_cases(rules, cases);
  return cases;
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
        // What texts mean is known to the checks and to the model.
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

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

/// Empty where exactly the expected answers are given, else what is wrong with them.
template <class T>
std::string objection(const Mutant& mutant, YamlStyle style) {
  const WrittenScene written(mutant.scene, style);
  const std::vector<std::string> lines = lines_of(written.text());
  const std::vector<Problem> problems =
      problems_with<T>(written.text(), mutant.answers.empty() ? Checks::none : Checks::all);
  std::string said;
  for (const Answer& answer : mutant.answers) {
    const WrittenScene::Spot& spot = written.spot(answer.path);
    const Place& place = answer.at == Answer::At::key ? spot.key : spot.value;
    const bool is_given =
        std::any_of(problems.begin(), problems.end(), [&](const Problem& problem) {
          return problem.key == answer.key && problem.source == place.source &&
                 problem.line == place.line && problem.column == place.column &&
                 problem.message.find(answer.message) != std::string::npos &&
                 problem.excerpt == excerpt_of(lines.at(static_cast<std::size_t>(place.line) - 1),
                                               place.line, place.column);
        });
    if (!is_given) {
      said += fmt::format("expected at {}:{}: {}: {}\n", place.line, place.column, answer.key,
                          answer.message);
    }
  }
  if (problems.size() != mutant.answers.size()) {
    said += fmt::format("expected {} problems\n", mutant.answers.size());
  }
  return said.empty() ? said : said + "got " + joined(problems) + "\nin\n" + written.text();
}

/// Empty where other values can be found to go with the allowed one of a mutant, so that no check
/// between keys objects; else what remains.
///
/// @param valid the scene that the mutant was made from
template <class T>
std::string loneliness(const Mutant& mutant, const Draft& valid) {
  Draft scene = mutant.scene;
  std::string path = mutant.path;
  const std::string value = find_draft(scene, path)->text;
  const bool is_item = find_draft(scene, path)->pattern.empty();
  const std::string wanted = find_draft(scene, is_item ? parent_path(path) : path)->pattern;
  std::vector<Problem> problems = Repair(objections_of_checks<T>, wanted, path)(scene);
  if (!problems.empty() && is_item) {
    // The last of a list, which a check may want ascending: as the first it may do.
    path = join_path(parent_path(path), "0");
    scene = valid;
    find_draft(scene, path)->text = value;
    problems = Repair(objections_of_checks<T>, wanted, path)(scene);
  }
  const std::string text = WrittenScene(scene, YamlStyle::block).text();
  if (problems.empty()) problems = problems_with<T>(text);
  return problems.empty() ? "" : "no valid scene has it; nearest\n" + text + joined(problems);
}

/// Values that take more other keys than are found by trial: shapes of a profile, which take a
/// viscoelastic law of the form `solve` with its material and solver. Empty where a scene with the
/// value is read, else what is wrong with it; nothing for other mutants.
std::optional<std::string> without_trial(const Mutant& mutant) {
  constexpr std::string_view shape = "normal.profile.shape";
  if (!mutant.path.ends_with(shape)) return std::nullopt;
  Draft scene = mutant.scene;
  const std::string value = find_draft(scene, mutant.path)->text;
  const std::string table = value == "table" ? ", radii: [0, 1, 2], heights: [0, 1, 4]" : "";
  try {
    (void)load_scene(
        scene_path("viscoelastic_contact.yaml"),
        {"contacts.tip.normal.profile={shape: " + value + ", radius: 0.5" + table + "}"});
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "";
}

template <class T>
class SceneMutation : public ::testing::Test {};

/// The example holds every kind of key, which the scenes of the program need not do.
using Roots = ::testing::Types<Example, Scene>;
TYPED_TEST_SUITE(SceneMutation, Roots);

using CompleteScenes = std::vector<CompleteScene>;

template <class T>
void expect_read(const CompleteScenes& scenes) {
  for (const CompleteScene& scene : scenes) {
    for (const YamlStyle style : {YamlStyle::block, YamlStyle::flow}) {
      const std::string text = WrittenScene(scene.draft, style).text();
      EXPECT_EQ(joined(problems_with<T>(text)), "nothing") << text;
    }
  }
}

template <class T>
void expect_every_spoilt_key_answered(const CompleteScenes& scenes) {
  int num_keys = 0;
  int num_mutants = 0;
  for (const CompleteScene& scene : scenes) {
    MutantMaker maker(scene.draft);
    for (const std::string& path : scene.new_paths) {
      ++num_keys;
      for (const Mutant& mutant : maker.mutants_at(path)) {
        // Now the one and now the other, to keep the test short.
        const YamlStyle style = ++num_mutants % 2 == 0 ? YamlStyle::block : YamlStyle::flow;
        std::string said = objection<T>(mutant, style);
        if (!mutant.path.empty()) {
          const std::optional<std::string> known = without_trial(mutant);
          said += known ? *known : loneliness<T>(mutant, scene.draft);
        }
        EXPECT_TRUE(said.empty()) << path << " " << mutant.what << ": " << said;
      }
    }
  }
  // Each is at least misspelt, doubled, emptied in three ways and of a wrong kind.
  EXPECT_GE(num_mutants, 6 * num_keys);
  std::set<std::string> declared;
  visit(complete_draft(T::schema(), ""), "",
        [&](const Draft& draft, const std::string&) { declared.insert(draft.pattern); });
  EXPECT_GE(num_keys, static_cast<int>(declared.size()) - 1);  // without that of the whole
  EXPECT_GE(num_keys, 10);
}

template <class T>
void expect_all_spoilt_values_answered_once(const CompleteScenes& scenes) {
  for (const CompleteScene& scene : scenes) {
    Draft spoilt = scene.draft;
    std::set<std::string> values;
    visit(scene.draft, "", [&](const Draft& draft, const std::string& path) {
      if (draft.key == nullptr || !draft.key->assign) return;
      values.insert(path);
      Draft& value = *find_draft(spoilt, path);
      value.form = Draft::Form::text;
      value.text = "[[[1]]]";
    });
    std::set<std::string> answered;
    for (Problem& problem : problems_with<T>(WrittenScene(spoilt, YamlStyle::block).text())) {
      // A list in a list is wrong by its entry where the key takes a list, or a list of rows.
      while (!problem.key.empty() && !values.contains(problem.key))
        problem.key = parent_path(problem.key);
      EXPECT_TRUE(answered.insert(problem.key).second) << problem.text();
    }
    EXPECT_EQ(answered, values);
  }
}

// One test, because it takes a while to find scenes that hold every key.
TYPED_TEST(SceneMutation, CompleteScenesAreReadAndSpoiltKeysAnsweredAtTheirPlaces) {
  const CompleteScenes scenes = complete_scenes<TypeParam>();
  expect_read<TypeParam>(scenes);
  expect_every_spoilt_key_answered<TypeParam>(scenes);
  expect_all_spoilt_values_answered_once<TypeParam>(scenes);
}

TEST(SceneMutationOfExample, HoldsEveryKindOfKey) {
  std::set<KeyKind> kinds;
  visit(complete_draft(Example::schema(), ""), "", [&](const Draft& draft, const std::string&) {
    if (draft.key != nullptr) kinds.insert(draft.key->kind);
  });
  EXPECT_EQ(kinds.size(), 12u);
}

}  // namespace
}  // namespace stridor
