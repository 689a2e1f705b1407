#include "io/contact_scene.hpp"

#include <nlohmann/json.hpp>

#include "io/disc_scene.hpp"
#include "io/resolved_scene.hpp"
#include "io/scene_reader.hpp"
#include "io/scene_reference.hpp"
#include "io/schema_json.hpp"
#include "models/set_up_estimate.hpp"

namespace stridor {

const Schema& SlidingPoints::schema() {
  static const Schema keys =
      SchemaOf<SlidingPoints>("sliding")
          .real_list("speeds", &SlidingPoints::speeds,
                     {.doc = "Sliding speeds v τ_1/R, with τ_1 the first creep time and R "
                             "profile.radius; negative towards −x.",
                      .optional = true})
          .real_list("indentations", &SlidingPoints::indentations,
                     {.doc = "Indentations y/R.", .range = Range::positive(), .optional = true})
          .real_list("loads", &SlidingPoints::loads,
                     {.doc = "Normal forces F/(E_0* R²), E_0* = E_0/(1 − ν²), instead of "
                             "indentations.",
                      .range = Range::positive(),
                      .optional = true})
          .check([](const SlidingPoints& points, std::vector<Problem>& problems) {
            if (!points.loads.empty() && !points.indentations.empty())
              problems.push_back({"loads", "cannot stand beside `indentations`", {}, 0, 0});
          });
  return keys;
}

const Schema& ContactScene::schema() {
  static const Schema keys =
      SchemaOf<ContactScene>("viscoelastic_contact")
          .integer("format", &ContactScene::format,
                   {.doc = "Version of the scene language: 1.", .range = Range::between(1, 1)})
          .parameters("parameters", &ContactScene::parameters, parameters_key())
          .section("material", &ContactScene::material,
                   {.doc = "The half-space that is slid over: linear viscoelastic, isotropic."})
          .section("profile", &ContactScene::profile, {.doc = "The rigid axisymmetric indenter."})
          .section("contact_solver", &ContactScene::contact_solver,
                   {.doc = "Numerical settings of the boundary elements.", .optional = true})
          .section("sliding", &ContactScene::sliding,
                   {.doc = "Where contacts are computed; options of the verb `contact` win over "
                           "it.",
                    .optional = true})
          .section_list("expect", &ContactScene::expect,
                        {.doc = "Results that `contact --verify` checks, e.g. rows.0.force.",
                         .optional = true});
  return keys;
}

bool is_contact_scene(const SceneNode& tree) {
  return tree.entry("substructures") == nullptr &&
         (tree.entry("profile") != nullptr || tree.entry("contact_solver") != nullptr);
}

std::string all_scenes_json_schema() {
  return json_schema(Scene::schema(), {{&ContactScene::schema(), {"profile", "contact_solver"}},
                                       {&DiscScene::schema(), {"disc"}}})
             .dump(2) +
         "\n";
}

std::string all_scenes_reference() {
  return scene_reference(
      {&Scene::schema(), &ContactScene::schema(), &DiscScene::schema()});
}

std::string LoadedContactScene::resolved() const {
  return resolved_yaml(scene);
}

std::string LoadedContactScene::hash() const {
  return scene_hash(resolved());
}

ConfigError LoadedContactScene::problem(const std::string& key, const std::string& message) const {
  std::vector<Problem> problems{{key, message, {}, 0, 0}};
  locate(problems, tree);
  return ConfigError(std::move(problems));
}

LoadedContactScene load_contact_scene(const std::string& path,
                                      const std::vector<std::string>& sets) {
  LoadedContactScene loaded;
  loaded.path = path;
  loaded.tree = read_scene_file(path);
  for (const std::string& assignment : sets) set_value(loaded.tree, assignment);
  if (loaded.tree.entry("substructures") != nullptr) {
    throw loaded.problem("substructures",
                         "belongs to a scene of bodies; a sliding contact has `material` and "
                         "`profile`");
  }
  loaded.scene = read_as<ContactScene>(loaded.tree);
  try {
    require_memory(estimate_set_up(loaded.scene.contact_solver), memory_limit());
  } catch (const ConfigError& error) {
    std::vector<Problem> problems = error.problems();
    locate(problems, loaded.tree);
    throw ConfigError(std::move(problems));
  }
  return loaded;
}

CreepLengths creep_lengths(const ContactScene& scene, double speed) {
  const ViscoelasticMaterial& material = scene.material;
  CreepLengths lengths;
  for (std::size_t k = 0; k < material.creep_times.size(); ++k) {
    const double ratio = material.creep_times[k] / material.creep_times.front();
    lengths.push_back({material.creep_weight(k), speed * scene.profile.radius * ratio});
  }
  return lengths;
}

}  // namespace stridor
