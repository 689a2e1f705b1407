#include "io/scene/scene.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <memory>

#include "core/memory.hpp"
#include "core/suggestion.hpp"
#include "io/imports/law_table_file.hpp"
#include "io/scene/assignment.hpp"
#include "io/scene/channels.hpp"
#include "io/scene/former_keys.hpp"
#include "io/scene/body_reader.hpp"
#include "io/scene/resolved_scene.hpp"
#include "io/scene/scene_files.hpp"
#include "io/scene/scene_problems.hpp"
#include "io/scene/scene_reader.hpp"
#include "models/set_up_estimate.hpp"

namespace stridor {
namespace {

/// Checks the section `spectrogram` against what the scene records.
void check_spectrogram(const Scene& scene, std::vector<Problem>& problems) {
  if (!scene.spectrogram) return;
  const SpectrogramSection& section = *scene.spectrogram;
  const auto report = [&](const char* key, std::string message) {
    problems.push_back({std::string("spectrogram.") + key, std::move(message), {}, 0, 0});
  };
  const std::vector<std::string> channels =
      scene.record ? scene.record->channels : std::vector<std::string>{};
  if (section.channel) {
    // A pair with several slave points records "pair[0].force" for the channel "pair.force".
    std::string channel = *section.channel;
    const std::size_t open = channel.find('[');
    const std::size_t close = channel.find(']', open);
    if (close != std::string::npos) channel.erase(open, close + 1 - open);
    if (std::find(channels.begin(), channels.end(), channel) == channels.end()) {
      report("channel", fmt::format("'{}' is not among record.channels{}", *section.channel,
                                    did_you_mean(*section.channel, channels)));
    }
  }
  if (!scene.record) return;
  const double interval = scene.record->interval;
  if (section.length && scene.time &&
      (*section.length < 2.0 * interval || *section.length > scene.time->end)) {
    report("length", fmt::format("{:g} s must be at least two times record.interval = {:g} s and "
                                 "at most time.end = {:g} s",
                                 *section.length, interval, scene.time->end));
  }
  if (section.max_frequency && *section.max_frequency > 0.5 / interval) {
    report("max_frequency",
           fmt::format("{:g} Hz is above {:g} Hz, the highest frequency that record.interval "
                       "resolves",
                       *section.max_frequency, 0.5 / interval));
  }
}

const std::vector<std::string> term_names{"gyroscopic", "friction", "friction_damping", "geometric",
                                          "structural_damping"};

bool keeps_term(const Scene& scene, const std::string& name) {
  return !scene.terms ||
         std::find(scene.terms->begin(), scene.terms->end(), name) != scene.terms->end();
}

void check_terms(const Scene& scene, std::vector<Problem>& problems) {
  if (!scene.terms) return;
  for (std::size_t i = 0; i < scene.terms->size(); ++i) {
    const std::string& name = (*scene.terms)[i];
    if (std::find(term_names.begin(), term_names.end(), name) != term_names.end()) continue;
    problems.push_back({fmt::format("terms.{}", i),
                        fmt::format("there is no term '{}'{} (there are: {})", name,
                                    did_you_mean(name, term_names), fmt::join(term_names, ", ")),
                        {},
                        0,
                        0});
  }
}

/// Checks the rates of recording and of the band against each other.
void check_rates(const Scene& scene, std::vector<Problem>& problems) {
  if (!scene.record) return;
  const double interval = scene.record->interval;
  const auto report = [&](const char* key, std::string message) {
    problems.push_back({key, std::move(message), {}, 0, 0});
  };
  const double step = scene.time ? scene.time->step : interval;
  const double ratio = interval / step;
  const bool is_multiple = ratio >= 1.0 - 1e-9 && std::abs(ratio - std::round(ratio)) <= 1e-6 &&
                           std::round(ratio) <= 1e5;
  const bool is_event_driven = scene.time && scene.time->is_event_driven();
  if (!is_event_driven && !is_multiple) {
    report("record.interval",
           fmt::format("{:g} s must be a whole multiple (1 to 100000) of "
                       "time.step = {:g} s, is {:g} of it; the "
                       "nearest is {:g} s",
                       interval, step, ratio, std::clamp(std::round(ratio), 1.0, 1e5) * step));
  }
  if (is_event_driven && scene.record->energy)
    report("record.energy", "the energy ledger does not know what a half_space stores");
  const double nyquist = 0.5 / interval;
  if (!scene.measure.band.empty() && scene.measure.band.back() >= nyquist) {
    report("measure.band",
           fmt::format("reaches {:g} Hz, but record.interval resolves only frequencies below {:g} "
                       "Hz",
                       scene.measure.band.back(), nyquist));
  }
}

}  // namespace

PlainKey parameters_key() {
  return {.doc =
              "Numbers with names, with or without a unit, or expressions of each other "
              "(`=sqrt(k/m)`), for the expressions of all other keys (`=2*mu`).",
          .optional = true};
}

const Schema& Scene::schema() {
  static const Schema keys =
      SchemaOf<Scene>("scene")
          .integer("format", &Scene::format,
                   {.doc = "Version of the scene language: 2.", .range = Range::between(2, 2)})
          .parameters("parameters", &Scene::parameters, parameters_key())
          .include(&Scene::model)
          .section("time", &Scene::time,
                   {.doc = "How the system is marched in time: for run, sweep, compare and "
                           "precision.",
                    .optional = true})
          .text_list("terms", &Scene::terms,
                     {.doc = "Terms of the linearised equations, of gyroscopic, friction, "
                             "friction_damping (all damping that contacts bring), geometric and "
                             "structural_damping (all that bodies bring). The two dampings may be "
                             "left out; where all contacts are on faces of plates, friction and "
                             "geometric too; with a plate, gyroscopic. Default: all.",
                      .optional = true})
          .section("cycle", &Scene::cycle,
                   {.doc = "How `cycle` and sweeps of cycles seek the periodic motion of one mass "
                           "that moves in x and y on a half_space.",
                    .optional = true})
          .section(
              "sliding", &Scene::sliding,
              {.doc = "Where `contact` evaluates the viscoelastic normal laws; its options win "
                      "over it.",
               .optional = true})
          .section("record", &Scene::record,
                   {.doc = "What is written to the run file.", .optional = true})
          .section("measure", &Scene::measure,
                   {.doc = "Window and band of the statistics.", .optional = true})
          .section("spectrogram", &Scene::spectrogram,
                   {.doc = "How the spectrogram of the run is made; options of the verb "
                           "`spectrogram` win over it.",
                    .optional = true})
          .section("checkpoint", &Scene::checkpoint,
                   {.doc = "When the state of a run is stored.", .optional = true})
          .section_list(
              "expect", &Scene::expect,
              {.doc = "Results that `run --verify` checks, or `contact --verify` where the scene "
                      "has a section `sliding`.",
               .optional = true})
          .check(check_spectrogram)
          .check(check_terms)
          .check(check_rates);
  return keys;
}

LinearisationTerms contact_terms(const KeptTerms& kept) {
  LinearisationTerms terms;
  terms.friction = kept.friction;
  terms.friction_damping = kept.friction_damping;
  terms.geometric = kept.geometric;
  return terms;
}

KeptTerms kept_terms(const Scene& scene) {
  return {keeps_term(scene, "gyroscopic"), keeps_term(scene, "friction"),
          keeps_term(scene, "friction_damping"), keeps_term(scene, "geometric"),
          keeps_term(scene, "structural_damping")};
}

Accounts accounts_of(const Scene& scene) {
  return scene.record && scene.record->energy ? Accounts::energy : Accounts::none;
}

std::string LoadedScene::resolved() const {
  return resolved_yaml(scene);
}

std::string scene_hash(const std::string& resolved) {
  return scene_hash(resolved, std::vector<SceneFile>());
}

std::string LoadedScene::hash() const {
  return scene_hash(resolved(), scene_files(*this));
}

namespace {

/// Calls with every contact pair and its key path.
template <class Visit>
void for_each_pair(ModelParameters& model, const Visit& visit) {
  if (model.contact) visit("contact", *model.contact);
  for (auto& [name, pair] : model.contacts) visit("contacts." + name, pair);
}

}  // namespace

bool is_face(const ModelParameters& model, const std::string& master) {
  const std::size_t dot = master.find('.');
  if (dot == std::string::npos) return false;
  const auto body = model.substructures.find(master.substr(0, dot));
  return body != model.substructures.end() && body->second->has_face(master.substr(dot + 1));
}

bool has_two_tangents(const ModelParameters& model, const ContactParameters& pair) {
  const auto is_spatial = [&](const std::string& name) {
    const auto body = model.substructures.find(name.substr(0, name.find('.')));
    return body != model.substructures.end() && body->second->is_spatial();
  };
  if (pair.plane || is_face(model, pair.master) || is_spatial(pair.master)) return true;
  return pair.master == rigid_master && !pair.slave.empty() && is_spatial(pair.slave.front());
}

bool has_face_contacts(const ModelParameters& model) {
  const auto pairs = model.pairs();
  return std::any_of(pairs.begin(), pairs.end(),
                     [&](const auto& pair) { return has_two_tangents(model, pair.second); });
}

namespace {

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
        "terms", fmt::format("`{}` is missing: only friction_damping and structural_damping can be "
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
    throw ConfigError(channel.key, fmt::format("channel '{}': '{}' does not move along z",
                                               channel.name, channel.point->body));
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
    throw ConfigError("substructures",
                      "is missing: without bodies there are only normal laws, which the verb "
                      "`contact` evaluates");
  }
  const auto pairs = model.pairs();
  for (const auto& [name, pair] : pairs) {
    const std::string key = model.contact ? name : "contacts." + name;
    if (pair.slave.empty()) {
      throw ConfigError(key + ".slave",
                        "is missing: a contact without it is only one for the verb `contact`");
    }
    if (!pair.normal.is_solved()) continue;
    throw ConfigError(
        key + ".normal.form",
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
  throw located(ConfigError(
      section, fmt::format("missing: `{}` needs this section, which the scene has not", verb)));
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
      throw ConfigError("terms",
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
