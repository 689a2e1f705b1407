// Scenes from files and texts to models.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <memory>

#include "core/suggestion.hpp"
#include "io/imports/law_table_file.hpp"
#include "io/scene/assignment.hpp"
#include "io/scene/body_reader.hpp"
#include "io/scene/channels.hpp"
#include "io/scene/former_keys.hpp"
#include "io/scene/scene.hpp"
#include "io/scene/scene_files.hpp"
#include "io/scene/scene_problems.hpp"
#include "io/scene/scene_reader.hpp"

namespace stridor {
namespace {

/// Calls with every contact pair and its key path.
template <class Visit>
void for_each_pair(ModelParameters& model, const Visit& visit) {
  if (model.contact) visit("contact", *model.contact);
  for (auto& [name, pair] : model.contacts) visit("contacts." + name, pair);
}

/// Terms that only contacts on faces, and bodies that spin, can do without.
std::vector<std::string> indispensable_terms(const ModelParameters& model) {
  const auto pairs = model.pairs();
  const bool spins = std::any_of(
      model.substructures.begin(), model.substructures.end(), [](const auto& body) {
        return body.second->has_face("top") || body.second->has_face("bottom");
      });
  const bool is_on_faces =
      !pairs.empty() && std::all_of(pairs.begin(), pairs.end(), [&](const auto& pair) {
        return has_two_tangents(model, pair.second);
      });
  std::vector<std::string> names;
  if (!spins) names.push_back("gyroscopic");
  if (!is_on_faces) names.insert(names.end(), {"friction", "geometric"});
  return names;
}

/// @throws ConfigError if a term is left out that bodies and contacts cannot do without
void require_terms(const LoadedScene& loaded) {
  for (const std::string& name : indispensable_terms(loaded.scene.model)) {
    if (keeps_term(loaded.scene, name)) continue;
    throw loaded.located(ConfigError(
        Refusal::contradiction, "terms",
        fmt::format("`{}` is missing: only friction_damping and structural_damping can be "
                    "left out, of contacts on the faces of plates friction and geometric, "
                    "of plates gyroscopic as well",
                    name)));
  }
}

/// @throws ConfigError for the motion of a point along z, along which it does not move
void require_rows(const Model& model, const std::vector<Channel>& channels) {
  for (const Channel& channel : channels) {
    if (!channel.point || !model.points.contains(*channel.point)) continue;
    if (model.points.at(*channel.point).rows.row(channel.direction) >= 0) continue;
    throw ConfigError(
        Refusal::motion_is_held, channel.key,
        fmt::format("channel '{}': '{}' does not move along z", channel.name, channel.point->body));
  }
}

/// Takes up what the files of bodies in contact hold, which tells whether contacts have one tangent
/// or two. build_model() says what is wrong with files that cannot be read.
void take_up_contents(LoadedScene& loaded) {
  if (loaded.scene.model.pairs().empty()) return;
  BodyCache cache;
  for (auto& [name, substructure] : loaded.scene.model.substructures) {
    try {
      read_files("substructures." + name, loaded.tree, *substructure, cache);
    } catch (const ConfigError&) {
    } catch (const FileError&) {
    }
  }
}

/// Names files from the root, as the resolved scene may be read again from anywhere, and reads the
/// tables of contact laws.
void read_named_files(LoadedScene& loaded) {
  ModelParameters& model = loaded.scene.model;
  for (auto& [name, substructure] : model.substructures)
    make_files_absolute("substructures." + name, loaded.tree, *substructure);
  for_each_pair(model, [&](const std::string& key, ContactParameters& pair) {
    if (!pair.normal.has_table()) return;
    pair.normal.form =
        std::filesystem::absolute(path_of_file(loaded.tree, key + ".normal.form", pair.normal.form))
            .lexically_normal();
    pair.normal.table = std::make_shared<TabulatedLaw>(read_law_table(pair.normal.form));
  });
}

}  // namespace

void require_bodies(const LoadedScene& loaded) {
  const ModelParameters& model = loaded.scene.model;
  if (model.substructures.empty()) {
    throw ConfigError(Refusal::missing, "substructures",
                      "is missing: without bodies there are only normal laws, which the verb "
                      "`contact` evaluates");
  }
  const auto pairs = model.pairs();
  for (const auto& [name, pair] : pairs) {
    const std::string key = model.contact ? name : "contacts." + name;
    if (pair.slave.empty()) {
      throw ConfigError(Refusal::missing, key + ".slave",
                        "is missing: a contact without it is only one for the verb `contact`");
    }
    if (!pair.normal.is_solved()) continue;
    throw ConfigError(
        Refusal::missing, key + ".normal.form",
        fmt::format("solve computes every contact by boundary elements, of which bodies in motion "
                    "need a table: `stridor contact {} {}--table law.h5`, and then `form: law.h5`",
                    loaded.path, pairs.size() > 1 ? fmt::format("--contact {} ", name) : ""));
  }
}

ConfigError LoadedScene::located(const ConfigError& error) const {
  std::vector<Problem> problems = error.problems();
  locate(problems, tree);
  sort_by_place(problems);
  return ConfigError(std::move(problems));
}

void LoadedScene::require_section(const std::string& section, const std::string& verb) const {
  const bool is_there = section == "time"     ? scene.time.has_value()
                        : section == "record" ? scene.record.has_value()
                                              : !scene.model.pairs().empty();
  if (is_there) return;
  throw located(
      ConfigError(Refusal::missing, section,
                  fmt::format("missing: `{}` needs this section, which the scene has not", verb)));
}

LoadedScene load_scene(const std::string& path, const std::vector<std::string>& sets) {
  LoadedScene loaded;
  loaded.path = path;
  loaded.sets = sets;
  loaded.tree = read_scene_file(path);
  loaded.text = loaded.tree.document;
  for (const std::string& assignment : sets) set_value(loaded.tree, assignment);
  refuse_former_keys(loaded.tree);
  loaded.scene = read_as<Scene>(loaded.tree);
  require_terms(loaded);
  read_named_files(loaded);
  take_up_contents(loaded);
  return loaded;
}

LoadedScene load_resolved_scene(const std::string& text, const std::string& source) {
  LoadedScene loaded;
  loaded.path = source;
  loaded.text = text;
  loaded.tree = read_scene_text(text, source);
  loaded.scene = read_as<Scene>(loaded.tree);
  read_named_files(loaded);
  take_up_contents(loaded);
  return loaded;
}

Model build_model(const LoadedScene& loaded) {
  BodyCache cache;
  return build_runnable_model(loaded, cache);
}

Model build_runnable_model(const LoadedScene& loaded, BodyCache& cache) {
  Model model = build_model(loaded, cache);
  try {
    require_modes(model);
    if (!kept_terms(loaded.scene).has_all_but_damping()) {
      throw ConfigError(Refusal::contradiction, "terms",
                        "must not leave out gyroscopic, friction or geometric in a run, whose "
                        "motion has all terms; eig, locus and the like can do without some");
    }
  } catch (const ConfigError& error) {
    throw loaded.located(error);
  }
  return model;
}

ModelParameters parameters_with_files(const LoadedScene& loaded, BodyCache& cache) {
  ModelParameters parameters = loaded.scene.model;
  const KeptTerms kept = kept_terms(loaded.scene);
  for (auto& [name, substructure] : parameters.substructures) {
    read_files("substructures." + name, loaded.tree, *substructure, cache);
    substructure->keep_terms({kept.gyroscopic, kept.structural_damping});
  }
  return parameters;
}

Model build_model(const LoadedScene& loaded, BodyCache& cache) {
  try {
    const Scene& scene = loaded.scene;
    require_bodies(loaded);
    std::vector<std::pair<PointName, std::string>> observed = loaded.observed;
    std::vector<Channel> channels;
    if (scene.record) channels = parse_channels(*scene.record, scene.model);
    for (const Channel& channel : channels) {
      if (channel.point) observed.emplace_back(*channel.point, channel.key);
    }
    const ModelParameters parameters = parameters_with_files(loaded, cache);
    Model model = make_model(parameters, observed, cache);
    require_rows(model, channels);
    return model;
  } catch (const ConfigError& error) {
    throw loaded.located(error);
  }
}

}  // namespace stridor
