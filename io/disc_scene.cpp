#include "io/disc_scene.hpp"

#include <fmt/format.h>

#include <cmath>

#include "core/activity.hpp"
#include "core/errors.hpp"
#include "core/memory.hpp"
#include "io/disc_recorder.hpp"
#include "io/resolved_scene.hpp"
#include "io/scene_files.hpp"
#include "io/scene_reader.hpp"
#include "models/set_up_estimate.hpp"

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

bool is_disc_scene(const SceneNode& tree) {
  return tree.entry("disc") != nullptr && tree.entry("substructures") == nullptr;
}

std::string LoadedDiscScene::resolved() const {
  return resolved_yaml(scene);
}

std::string LoadedDiscScene::hash() const {
  return scene_hash(resolved());
}

DiscModel LoadedDiscScene::model() const {
  try {
    require_memory(estimate_set_up(scene.model), memory_limit());
    const Activity assembling("disc and pads and their steady sliding");
    if (!bodies) bodies = std::make_shared<DiscBodyCache>();
    return make_disc_model(scene.model, *bodies);
  } catch (const ConfigError& error) {
    std::vector<Problem> problems = error.problems();
    locate(problems, tree);
    throw ConfigError(std::move(problems));
  }
}

DiscModel LoadedDiscScene::model(const std::vector<NumericKey>& keys,
                                 std::span<const double> values) const {
  LoadedDiscScene changed = *this;
  for (std::size_t i = 0; i < keys.size(); ++i)
    set_value(changed.tree, fmt::format("{}={}", keys[i].path, values[i]));
  changed.scene = read_as<DiscScene>(changed.tree);
  DiscModel made = changed.model();
  bodies = changed.bodies;
  return made;
}

bool is_disc_scene_file(const std::string& path) {
  return is_disc_scene(read_scene_file(path));
}

LoadedDiscScene load_resolved_disc_scene(const std::string& text, const std::string& source) {
  LoadedDiscScene loaded;
  loaded.path = source;
  loaded.tree = read_scene_text(text, source);
  loaded.scene = read_as<DiscScene>(loaded.tree);
  return loaded;
}

LoadedDiscScene load_disc_scene(const std::string& path, const std::vector<std::string>& sets) {
  LoadedDiscScene loaded;
  loaded.path = path;
  loaded.tree = read_scene_file(path);
  for (const std::string& assignment : sets) set_value(loaded.tree, assignment);
  loaded.scene = read_as<DiscScene>(loaded.tree);
  return loaded;
}

}  // namespace stridor
