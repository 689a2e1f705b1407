// Scenes made from the declared keys alone and then spoilt, key by key and in every way that the
// kind of key allows. What is declared tomorrow is tested without a line added here.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <optional>
#include <set>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "core/excerpt.hpp"
#include "io/scene/scene.hpp"
#include "io/scene/scene_reader.hpp"
#include "tests/io/example_scene.hpp"
#include "tests/support/complete_scenes.hpp"
#include "tests/support/program.hpp"
#include "tests/support/scene_draft.hpp"
#include "tests/support/scene_mutants.hpp"

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
