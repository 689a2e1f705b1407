// stridor draw: a picture of what a scene describes.
#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <optional>

#include "app/terminal/command.hpp"
#include "core/activity.hpp"
#include "core/errors.hpp"
#include "io/figures/scene_picture.hpp"
#include "io/scene/channels.hpp"
#include "io/scene/scene.hpp"
#include "models/body_cache.hpp"

namespace stridor {
namespace {

struct DrawOptions {
  CommonOptions common;
  std::string scene;
  std::string output;
};

std::vector<std::string> recorded_points(const Scene& scene) {
  std::vector<std::string> names;
  if (!scene.record) return names;
  for (const Channel& channel : parse_channels(*scene.record, scene.model))
    if (channel.point) names.push_back(channel.point->body + "." + channel.point->point);
  return names;
}

MeshPicture picture_of(const LoadedScene& loaded, BodyCache& cache) {
  if (loaded.scene.model.substructures.empty())
    throw ConfigError(Refusal::missing, "substructures",
                      "is missing: without bodies there is nothing to draw");
  try {
    const ModelParameters parameters = parameters_with_files(loaded, cache);
    const PlacedModel model = place_model(parameters, cache);
    return make_scene_picture(
        model, recorded_points(loaded.scene), length_unit_of(loaded.tree),
        fmt::format("{}, scene {}: at rest, where the scene puts the bodies.",
                    std::filesystem::path(loaded.path).filename().string(), loaded.hash()));
  } catch (const ConfigError& error) {
    throw loaded.located(error);
  }
}

ExitCode draw(const DrawOptions& options) {
  check_figure(options.output, options.common);
  const LoadedScene loaded = load_scene(options.scene, options.common.sets);
  BodyCache cache;
  const MeshPicture picture = picture_of(loaded, cache);
  const Activity drawing("drawing");
  draw_mesh_picture(picture, options.output);
  if (!options.common.json) {
    fmt::print("{}\n", options.output);
    return ExitCode::done;
  }
  Json object = {{"file", options.output},
                 {"unit", picture.unit},
                 {"view", picture.view.is_planar ? "plane" : "isometric"},
                 {"names", Json::array()}};
  for (const PictureLabel& label : picture.labels) {
    object["names"].push_back(
        {{"name", label.of.empty() ? label.text : label.of + "." + label.text}, {"at", {label.at.x(), label.at.y(), label.at.z()}}});
  }
  print_json(std::move(object));
  return ExitCode::done;
}

}  // namespace

void add_draw_command(CLI::App& program, Action& action) {
  auto options = std::make_shared<DrawOptions>();
  CLI::App* verb = program.add_subcommand(
      "draw", "Picture of a scene before anything is run: bodies, supports, contacts, drives, points");
  verb->add_option("scene", options->scene, "Scene file (YAML)")->required();
  verb->add_option("-o,--output", options->output, "Picture: .png, .svg or .pdf")->required();
  add_scene_options(*verb, options->common);
  add_json_option(*verb, options->common);
  add_force_option(*verb, options->common);
  verb->callback([options, &action] { action = [options] { return draw(*options); }; });
}

}  // namespace stridor
