#include "io/sphere_scene.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "io/law_table_file.hpp"
#include "io/resolved_scene.hpp"
#include "io/scene_files.hpp"
#include "io/scene_reader.hpp"

namespace stridor {
namespace {

/// Sets a number within nested sections.
void set_number(const Schema& schema, void* object, const std::string& path, double value) {
  const std::size_t dot = path.find('.');
  const Key* key = schema.find(path.substr(0, dot));
  if (key->kind != KeyKind::section) {
    if (key->kind == KeyKind::integer) {
      key->assign(object, static_cast<std::int64_t>(value));
    } else {
      key->assign(object, value);
    }
    return;
  }
  set_number(key->alternatives[0].schema(), key->open(object, "", 0), path.substr(dot + 1), value);
}

/// The scene with some of its numbers set before its expressions are evaluated.
SphereScene read_again(const LoadedSphereScene& loaded, const std::vector<NumericKey>& keys,
                       std::span<const double> values) {
  SceneNode tree = loaded.tree;
  for (std::size_t i = 0; i < keys.size(); ++i)
    set_value(tree, fmt::format("{}={}", keys[i].path, values[i]));
  SphereScene changed = read_as<SphereScene>(tree);
  changed.model.contact_law = loaded.scene.model.contact_law;
  changed.model.table = loaded.scene.model.table;
  return changed;
}

/// Reads the table of the contact law where the scene names one. The resolved scene names it from
/// the root, as it may be read again from anywhere.
void read_table(LoadedSphereScene& loaded) {
  SphereModelParameters& model = loaded.scene.model;
  if (!model.has_table()) return;
  model.contact_law =
      std::filesystem::absolute(path_of_file(loaded.tree, "contact_law", model.contact_law))
          .lexically_normal();
  model.table = std::make_shared<TabulatedLaw>(read_law_table(model.contact_law));
}

}  // namespace

const Schema& SphereTimeParameters::schema() {
  static const Schema keys =
      SchemaOf<SphereTimeParameters>("sphere_time")
          .choice(
              "integrator", &SphereTimeParameters::integrator,
              {{"event_driven", SphereIntegrator::event_driven},
               {"central_difference", SphereIntegrator::central_difference},
               {"exact", SphereIntegrator::exact}},
              {.doc = "Of `run`: adaptive steps that end at every change between stick, slip and "
                      "flight, or the fixed steps of the bodies.",
               .optional = true})
          .real("step", &SphereTimeParameters::step,
                {.doc = "Of the fixed-step integrators, in multiples of 1/ω_nx.",
                 .range = Range::positive(),
                 .optional = true})
          .real("end", &SphereTimeParameters::end,
                {.doc = "End of a transient, in multiples of 1/ω_nx.", .range = Range::positive()})
          .real("record_interval", &SphereTimeParameters::record_interval,
                {.doc = "Time between the samples of a run, in multiples of 1/ω_nx.",
                 .range = Range::positive(),
                 .optional = true})
          .real("settle", &SphereTimeParameters::settle,
                {.doc = "Time that passes before a limit cycle is sought, in multiples of 1/ω_nx.",
                 .range = Range::non_negative(),
                 .optional = true})
          .real("tolerance", &SphereTimeParameters::tolerance,
                {.doc = "Relative error of a step of the event-driven integrator.",
                 .range = Range::between(1e-14, 1e-2),
                 .optional = true})
          .real("initial_indentation", &SphereTimeParameters::initial_indentation,
                {.doc = "Indentation at the start over that in equilibrium; the rest is as in "
                        "equilibrium.",
                 .range = Range::any(),
                 .optional = true})
          .check([](const SphereTimeParameters& time, std::vector<Problem>& problems) {
            const bool is_fixed = time.integrator != SphereIntegrator::event_driven;
            if (is_fixed && !time.step)
              problems.push_back({"", "`step` is missing, which this integrator needs", {}, 0, 0});
            if (time.step && time.end / *time.step > 1e10)
              problems.push_back({"step", "takes more than 1e10 steps to `end`", {}, 0, 0});
          });
  return keys;
}

const Schema& SphereScene::schema() {
  static const Schema keys =
      SchemaOf<SphereScene>("viscoelastic_sphere")
          .integer("format", &SphereScene::format,
                   {.doc = "Version of the scene language: 1.", .range = Range::between(1, 1)})
          .parameters("parameters", &SphereScene::parameters, parameters_key())
          .include(&SphereScene::model)
          .section("time", &SphereScene::time, {.doc = "How motions in time are computed."})
          .section("checkpoint", &SphereScene::checkpoint,
                   {.doc = "When the state of a run is stored.", .optional = true})
          .section_list(
              "expect", &SphereScene::expect,
              {.doc = "Results that `cycle --verify` checks, e.g. period.", .optional = true});
  return keys;
}

bool is_sphere_scene(const SceneNode& tree) {
  return tree.entry("substructures") == nullptr && tree.entry("sphere") != nullptr;
}

bool is_sphere_scene_file(const std::string& path) {
  return is_sphere_scene(read_scene_file(path));
}

std::string LoadedSphereScene::resolved() const {
  return resolved_yaml(scene);
}

std::string LoadedSphereScene::hash() const {
  return scene_hash(resolved(), scene_files(*this));
}

LoadedSphereScene load_sphere_scene(const std::string& path, const std::vector<std::string>& sets) {
  LoadedSphereScene loaded;
  loaded.path = path;
  loaded.tree = read_scene_file(path);
  for (const std::string& assignment : sets) set_value(loaded.tree, assignment);
  if (!is_sphere_scene(loaded.tree)) {
    throw ConfigError("sphere", fmt::format("is missing: {} is no scene of an oscillator on a "
                                            "viscoelastic substrate",
                                            path));
  }
  loaded.scene = read_as<SphereScene>(loaded.tree);
  read_table(loaded);
  return loaded;
}

LoadedSphereScene load_resolved_sphere_scene(const std::string& text, const std::string& source) {
  LoadedSphereScene loaded;
  loaded.path = source;
  loaded.tree = read_scene_text(text, source);
  loaded.scene = read_as<SphereScene>(loaded.tree);
  read_table(loaded);
  return loaded;
}

SphereScene with_values(const LoadedSphereScene& loaded, const std::vector<NumericKey>& keys,
                        std::span<const double> values) {
  if (std::any_of(keys.begin(), keys.end(), is_parameter)) return read_again(loaded, keys, values);
  SphereScene changed = loaded.scene;
  for (std::size_t i = 0; i < keys.size(); ++i)
    set_number(SphereScene::schema(), &changed, keys[i].path, values[i]);
  std::vector<Problem> problems;
  for (const auto& check : SphereParameters::schema().checks)
    check(&changed.model.sphere, problems);
  for (Problem& problem : problems) problem.key = join_path("sphere", problem.key);
  if (!problems.empty()) throw ConfigError(std::move(problems));
  return changed;
}

}  // namespace stridor
