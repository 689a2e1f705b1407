#include "io/linear_scene.hpp"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <stdexcept>

#include "core/activity.hpp"
#include "core/errors.hpp"
#include "core/memory.hpp"
#include "io/disc_recorder.hpp"
#include "io/matrix_reader.hpp"
#include "io/resolved_scene.hpp"
#include "io/scene_files.hpp"
#include "io/scene_reader.hpp"
#include "models/set_up_estimate.hpp"
#include "substructures/matrix_body.hpp"

namespace stridor {
namespace {

PlainKey format_key() {
  return {.doc = "Version of the scene language: 1.", .range = Range::between(1, 1)};
}

void check_recording(const DiscScene& scene, std::vector<Problem>& problems) {
  if (!scene.record) return;
  const std::size_t per_pad = num_contact_points(scene.model);
  if (!scene.record->channels.empty() && per_pad <= most_contact_points) {
    const std::vector<Problem> channels = channel_problems(scene.record->channels, per_pad);
    problems.insert(problems.end(), channels.begin(), channels.end());
  }
  if (!scene.time) return;
  const double ratio = scene.record->interval / scene.time->step;
  if (ratio < 1.0 - 1e-9 || std::abs(ratio - std::round(ratio)) > 1e-6 || std::round(ratio) > 1e5) {
    problems.push_back(
        {"record.interval",
         fmt::format("must be a whole multiple of time.step = {:g} s, up to 100000 of "
                     "them; got {:g} s",
                     scene.time->step, scene.record->interval),
         {},
         0,
         0});
  }
}

LinearSystem dense_system(const SparseSystem& sparse) {
  LinearSystem dense;
  dense.mass = sparse.mass;
  dense.velocity = sparse.velocity;
  dense.position = sparse.position;
  dense.gaps = dense.forces = Eigen::MatrixXd(0, sparse.size());
  return dense;
}

LinearModel model_of(const DiscScene& scene, const LoadedLinearScene& loaded) {
  require_memory(estimate_set_up(scene.model), memory_limit());
  const Activity assembling("disc and pads and their steady sliding");
  LinearModel model;
  if (!loaded.bodies) loaded.bodies = std::make_shared<DiscBodyCache>();
  model.disc = make_disc_model(scene.model, *loaded.bodies);
  model.dense = model.disc->system;
  model.highest_frequency = model.disc->highest_frequency;
  return model;
}

/// @throws ConfigError with the key path
LinearModel model_of(const MatrixScene& scene, const LoadedLinearScene& loaded) {
  const auto& [name, variant] = *scene.substructures.begin();
  const auto& body = std::get<MatrixBodyParameters>(variant);
  if (!loaded.matrices || !have_same_matrices(loaded.matrices_of, body)) {
    loaded.matrices = std::make_shared<const NamedMatrices>(
        read_matrices("substructures." + name, loaded.tree, body));
    loaded.matrices_of = body;
  }
  SparseSystem sparse = sum(*loaded.matrices, body);
  LinearModel model;
  model.highest_frequency = std::numeric_limits<double>::infinity();
  if (sparse.size() > largest_dense_size) {
    model.sparse = std::move(sparse);
  } else {
    model.dense = dense_system(sparse);
  }
  return model;
}

}  // namespace

const Schema& DiscScene::schema() {
  static const Schema keys =
      SchemaOf<DiscScene>("disc_and_pads")
          .integer("format", &DiscScene::format, format_key())
          .parameters("parameters", &DiscScene::parameters, parameters_key())
          .include(&DiscScene::model)
          .section("time", &DiscScene::time, {.doc = "Steps of `run`.", .optional = true})
          .section("initial", &DiscScene::initial,
                   {.doc = "Where `run` starts, about steady sliding.", .optional = true})
          .section("record", &DiscScene::record, {.doc = "What `run` writes.", .optional = true})
          .section("checkpoint", &DiscScene::checkpoint,
                   {.doc = "When the state of a run is stored.", .optional = true})
          .section_list("expect", &DiscScene::expect,
                        {.doc = "Results that `run --verify` checks.", .optional = true})
          .check(check_recording);
  return keys;
}

const Schema& DiscTimeParameters::schema() {
  static const Schema keys =
      SchemaOf<DiscTimeParameters>("disc_time")
          .real("step", &DiscTimeParameters::step,
                {.doc = "Time step. What is linear is exact at any step; a contact that opens or "
                        "sticks is of second order in it.",
                 .unit = "s",
                 .range = Range::positive()})
          .real("end", &DiscTimeParameters::end,
                {.doc = "End of the run.", .unit = "s", .range = Range::positive()});
  return keys;
}

const Schema& DiscInitialParameters::schema() {
  static const Schema keys =
      SchemaOf<DiscInitialParameters>("disc_initial")
          .section(
              "perturbation", &DiscInitialParameters::perturbation,
              {.doc = "An eigenvector of the motion about steady sliding; its amplitude is the "
                      "largest displacement of a pad."});
  return keys;
}

const Schema& DiscRecordParameters::schema() {
  static const Schema keys =
      SchemaOf<DiscRecordParameters>("disc_record")
          .real("interval", &DiscRecordParameters::interval,
                {.doc = "Time between samples, a multiple of time.step; motions are low-passed "
                        "before they are thinned to it; contact forces and states are not.",
                 .unit = "s",
                 .range = Range::positive()})
          .text_list("channels", &DiscRecordParameters::channels,
                     {.doc = "What is recorded: pad.<contact>.<r|phi|z>.<displacement|velocity|"
                             "acceleration>, disc.<contact>.z.<...>, <contact>.<force|"
                             "friction_force|gap|slip_velocity|state>, with the contacts upper and "
                             "lower, or upper_0, upper_1, ... where a pad has several points. "
                             "Default: all.",
                      .optional = true});
  return keys;
}

const Schema& MatrixScene::schema() {
  static const Schema keys =
      SchemaOf<MatrixScene>("matrix_scene")
          .integer("format", &MatrixScene::format, format_key())
          .parameters("parameters", &MatrixScene::parameters, parameters_key())
          .named_variants("substructures", &MatrixScene::substructures, "type", {"matrices"},
                          {.doc = "One body, given by its matrices."})
          .check([](const MatrixScene& scene, std::vector<Problem>& problems) {
            if (scene.substructures.size() != 1) {
              problems.push_back({"substructures",
                                  "a body given by matrices stands alone; put several into the "
                                  "blocks of one",
                                  {},
                                  0,
                                  0});
            }
          });
  return keys;
}

bool is_disc_scene(const SceneNode& tree) {
  return tree.entry("disc") != nullptr && tree.entry("substructures") == nullptr;
}

bool is_matrix_scene(const SceneNode& tree) {
  const SceneEntry* bodies = tree.entry("substructures");
  if (bodies == nullptr) return false;
  // What these say makes them bodies that touch others.
  for (const char* key : {"contact", "contacts", "drive", "time"})
    if (tree.entry(key) != nullptr) return false;
  for (const SceneEntry& body : bodies->value.entries) {
    const SceneEntry* type = body.value.entry("type");
    if (type != nullptr && type->value.text == "matrices") return true;
  }
  return false;
}

bool is_linear_scene(const SceneNode& tree) {
  return is_disc_scene(tree) || is_matrix_scene(tree);
}

LinearScene read_linear_scene(const SceneNode& tree) {
  if (is_disc_scene(tree)) return read_as<DiscScene>(tree);
  return read_as<MatrixScene>(tree);
}

const Schema& schema_of(const LinearScene& scene) {
  return std::visit(
      [](const auto& one) -> const Schema& { return std::decay_t<decltype(one)>::schema(); },
      scene);
}

const void* object_of(const LinearScene& scene) {
  return std::visit([](const auto& one) -> const void* { return &one; }, scene);
}

std::string LoadedLinearScene::resolved() const {
  return resolved_yaml(schema_of(scene), object_of(scene));
}

std::string LoadedLinearScene::hash() const {
  return scene_hash(resolved(), scene_files(*this));
}

LinearModel LoadedLinearScene::model() const {
  try {
    return std::visit([&](const auto& one) { return model_of(one, *this); }, scene);
  } catch (const ConfigError& error) {
    std::vector<Problem> problems = error.problems();
    locate(problems, tree);
    throw ConfigError(std::move(problems));
  }
}

LinearModel LoadedLinearScene::model(const std::vector<NumericKey>& keys,
                                     std::span<const double> values) const {
  LoadedLinearScene changed = *this;
  for (std::size_t i = 0; i < keys.size(); ++i)
    set_value(changed.tree, fmt::format("{}={}", keys[i].path, values[i]));
  changed.scene = read_linear_scene(changed.tree);
  LinearModel made = changed.model();
  matrices = changed.matrices;
  bodies = changed.bodies;
  matrices_of = changed.matrices_of;
  return made;
}

bool is_linear_scene_file(const std::string& path) {
  return is_linear_scene(read_scene_file(path));
}

LoadedLinearScene load_resolved_linear_scene(const std::string& text, const std::string& source) {
  LoadedLinearScene loaded;
  loaded.path = source;
  loaded.tree = read_scene_text(text, source);
  loaded.scene = read_linear_scene(loaded.tree);
  return loaded;
}

LoadedLinearScene load_linear_scene(const std::string& path, const std::vector<std::string>& sets) {
  LoadedLinearScene loaded;
  loaded.path = path;
  loaded.tree = read_scene_file(path);
  for (const std::string& assignment : sets) set_value(loaded.tree, assignment);
  loaded.scene = read_linear_scene(loaded.tree);
  return loaded;
}

}  // namespace stridor
