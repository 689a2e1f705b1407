#include "app/terminal/completion.hpp"

#include <algorithm>
#include <exception>
#include <filesystem>
#include <optional>

#include "app/terminal/manual.hpp"
#include "io/figures/run_panels.hpp"
#include "io/run_file/run_file.hpp"
#include "io/scene/numeric_key.hpp"
#include "io/scene/scene.hpp"
#include "models/model_body.hpp"

namespace stridor {
namespace {

using Candidates = std::vector<Candidate>;

/// Options behind which a key stands that is varied.
bool takes_key(const std::string& option) {
  return option == "--parameter" || option == "--x" || option == "--y";
}

const CLI::App* verb_named(const CLI::App& program, const std::string& name) {
  for (const CLI::App* verb : verbs_of(program))
    if (verb->get_name() == name) return verb;
  return nullptr;
}

const CLI::Option* option_named(const CLI::App& verb, const std::string& written) {
  for (const CLI::Option* option : verb.get_options()) {
    for (const std::string& name : option->get_lnames())
      if ("--" + name == written) return option;
    for (const std::string& name : option->get_snames())
      if ("-" + name == written) return option;
  }
  return nullptr;
}

/// The file with one of these endings among the words.
std::optional<std::string> file_among(const std::vector<std::string>& words,
                                      const std::vector<std::string>& endings) {
  for (const std::string& word : words) {
    for (const std::string& ending : endings) {
      std::error_code unreadable;
      if (word.ends_with(ending) && std::filesystem::is_regular_file(word, unreadable)) return word;
    }
  }
  return std::nullopt;
}

void collect_keys(const SceneNode& node, const std::string& path, std::vector<std::string>& keys) {
  if (node.kind == SceneNode::Kind::map) {
    if (!path.empty()) keys.push_back(path);  // a number may stand in its place
    for (const SceneEntry& entry : node.entries)
      collect_keys(entry.value, join_path(path, entry.key), keys);
  } else if (!path.empty()) {
    keys.push_back(path);
  }
}

bool is_section(const SceneNode& scene, const std::string& path) {
  const SceneNode* node = find(scene, path);
  return node != nullptr && node->kind == SceneNode::Kind::map;
}

/// The words that a key may be set to; none where it takes others.
std::vector<std::string> choices_at(const Schema& schema, const std::string& path) {
  const std::size_t dot = path.find('.');
  const Key* key = schema.find(path.substr(0, dot));
  if (key == nullptr) return {};
  if (dot == std::string::npos) {
    if (key->kind == KeyKind::flag) return {"true", "false"};
    return key->choices;
  }
  std::string rest = path.substr(dot + 1);
  if (key->kind == KeyKind::named_sections) {
    const std::size_t name_end = rest.find('.');
    if (name_end == std::string::npos) return {};
    rest.erase(0, name_end + 1);
  }
  for (const Alternative& alternative : key->alternatives)
    if (auto found = choices_at(alternative.schema(), rest); !found.empty()) return found;
  return {};
}

/// "key=choice" for the key that is written in front of the sign; where there are no choices, its
/// present value in the scene, SI.
Candidates settings_of(const std::string& key, const std::optional<std::string>& file) {
  Candidates found;
  for (const std::string& choice : choices_at(Scene::schema(), key))
    found.push_back({key + "=" + choice, ""});
  if (!found.empty() || !file) return found;
  const LoadedScene loaded = load_scene(*file, {});
  const SceneNode scene = read_scene_text(loaded.resolved(), *file);
  const SceneNode* node = find(scene, key);
  // Of several words each shell would make something else.
  if (node != nullptr && node->kind == SceneNode::Kind::scalar &&
      node->text.find_first_of(" \t") == std::string::npos)
    found.push_back({key + "=" + node->text, "present value"});
  return found;
}

/// Every key that the scene has or has a default for.
/// @param varied numbers alone
Candidates keys_of(const std::string& file, bool varied) {
  const LoadedScene loaded = load_scene(file, {});
  std::vector<std::string> keys;
  const SceneNode scene = read_scene_text(loaded.resolved(), file);
  collect_keys(scene, "", keys);
  Candidates found;
  for (const std::string& key : keys) {
    std::string meaning;
    bool is_number = true;
    try {
      meaning = find_numeric_key(loaded.scene, key, "").unit;
    } catch (const std::exception&) {
      is_number = false;
    }
    if (is_number || !(varied || is_section(scene, key)))
      found.push_back({varied ? key : key + "=", meaning});
  }
  return found;
}

/// Directions in which points of the bodies of a scene move, "<body>.<point>.<x|y|z>".
std::vector<std::string> motions_of(const std::string& file) {
  const LoadedScene loaded = load_scene(file, {});
  BodyCache cache;
  const ModelParameters parameters = parameters_with_files(loaded, cache);
  const std::vector<ModelBody> bodies = make_bodies(parameters.substructures, cache);
  std::vector<std::string> found;
  const auto add = [&](const std::string& point, auto&& moves) {
    for (const std::size_t direction : {0U, 1U, 2U})
      if (moves(direction)) found.push_back(point + "." + "xyz"[direction]);
  };
  for (const ModelBody& body : bodies) {
    const BodyMatrices& matrices = body.matrices;
    for (const auto& [point, node] : matrices.points)
      add(body.name + "." + point,
          [&, at = node](std::size_t direction) { return matrices.moves(at, direction); });
    for (const auto& [point, place] : parameters.points)
      if (place.of == body.name)
        add(body.name + "." + point,
            [&](std::size_t direction) { return direction < 2 || !matrices.across.empty(); });
  }
  return found;
}

/// Where a force may act.
Candidates inputs_of(const std::string& file) {
  Candidates found;
  for (const std::string& motion : motions_of(file)) found.push_back({motion, "N"});
  return found;
}

/// Channels of all motions.
Candidates outputs_of(const std::string& file) {
  Candidates found;
  for (const std::string& motion : motions_of(file)) {
    found.push_back({motion + ".displacement", "m"});
    found.push_back({motion + ".velocity", "m/s"});
    found.push_back({motion + ".acceleration", "m/s^2"});
  }
  return found;
}

Candidates channels_of(const std::string& file) {
  const RunFileReader run(file);
  Candidates found;
  for (const std::string& series : run.series_names())
    found.push_back({channel_name(series), run.units(series)});
  return found;
}

/// The words of a list "{a,b,c}" in the type of an option.
Candidates values_of_type(const CLI::Option& option) {
  const std::string type = option.get_type_name();
  const std::size_t begin = type.find('{');
  const std::size_t end = type.rfind('}');
  Candidates found;
  if (begin == std::string::npos || end == std::string::npos || end < begin) return found;
  for (std::size_t at = begin + 1; at < end;) {
    const std::size_t comma = std::min(type.find(',', at), end);
    found.push_back({type.substr(at, comma - at), ""});
    at = comma + 1;
  }
  return found;
}

Candidates options_of(const CLI::App& verb) {
  Candidates found;
  for (const CLI::Option* option : verb.get_options())
    for (const std::string& name : option->get_lnames())
      found.push_back({"--" + name, option->get_description()});
  return found;
}

/// @param behind words of the line behind the one that is being typed
Candidates all_candidates(const CLI::App& program, const std::vector<std::string>& words,
                          const std::vector<std::string>& behind) {
  if (words.size() <= 1) {
    Candidates found;
    for (const CLI::App* verb : verbs_of(program))
      found.push_back({verb->get_name(), verb->get_description()});
    return found;
  }
  const CLI::App* verb = verb_named(program, words.front());
  if (verb == nullptr) return {};
  const std::string& before = words[words.size() - 2];
  std::vector<std::string> line = words;
  line.insert(line.end(), behind.begin(), behind.end());
  if (const CLI::Option* option = option_named(*verb, before)) {
    if (before == "--set" || takes_key(before)) {
      const std::size_t sign = words.back().find('=');
      const auto scene = file_among(line, {".yaml", ".yml"});
      if (before == "--set" && sign != std::string::npos)
        return settings_of(words.back().substr(0, sign), scene);
      return scene ? keys_of(*scene, before != "--set") : Candidates{};
    }
    // Elsewhere --output is a file.
    if (words.front() == "frf" && (before == "--input" || before == "--output")) {
      const auto scene = file_among(line, {".yaml", ".yml"});
      if (!scene) return {};
      return before == "--input" ? inputs_of(*scene) : outputs_of(*scene);
    }
    if (before == "--channel") {
      const auto run = file_among(line, {".h5", ".hdf5"});
      return run ? channels_of(*run) : Candidates{};
    }
    if (option->get_items_expected_max() > 0) return values_of_type(*option);
  }
  return words.back().starts_with("-") ? options_of(*verb) : Candidates{};
}

}  // namespace

std::vector<Candidate> candidates(const CLI::App& program, std::vector<std::string> words,
                                  const std::vector<std::string>& behind) {
  // "--option=value" is two words written as one.
  std::string prefix;
  if (!words.empty() && words.back().starts_with("--")) {
    if (const std::size_t sign = words.back().find('='); sign != std::string::npos) {
      prefix = words.back().substr(0, sign + 1);
      const std::string value = words.back().substr(sign + 1);
      words.back() = prefix.substr(0, sign);
      words.push_back(value);
    }
  }
  Candidates found = all_candidates(program, words, behind);
  const std::string begun = words.empty() ? "" : words.back();
  std::erase_if(found, [&](const Candidate& one) { return !one.word.starts_with(begun); });
  for (Candidate& one : found) {
    one.word.insert(0, prefix);
    std::replace_if(
        one.meaning.begin(), one.meaning.end(), [](char c) { return c == '\t' || c == '\n'; }, ' ');
  }
  return found;
}

}  // namespace stridor
