#include "app/results/universal_file.hpp"

#include <algorithm>
#include <filesystem>

#include "core/version.hpp"
#include "io/hdf5/output_options.hpp"
#include "io/scene/channels.hpp"
#include "models/body_cache.hpp"
#include "models/placed_model.hpp"

namespace stridor {

UffNumbers UniversalOptions::numbers() const {
  return {is_binary ? UffForm::binary : UffForm::text,
          is_single ? UffPrecision::single_precision : UffPrecision::double_precision};
}

void add_universal_options(CLI::App& verb, UniversalOptions& options) {
  verb.add_flag("--binary", options.is_binary,
                "Universal files with their numbers in binary (58b), at any frequencies or times "
                "to the last digit");
  verb.add_flag(
      "--single", options.is_single,
      "Universal files with numbers of single precision: six digits in text, four bytes in binary");
}

bool is_universal(const std::string& file) {
  const std::filesystem::path ending = std::filesystem::path(file).extension();
  return ending == ".uff" || ending == ".unv";
}

UffContents headed_contents(const std::string& title) {
  UffContents contents;
  contents.title = title;
  contents.program = std::string("stridor ") + std::string(version);
  contents.stamp(utc_now());
  return contents;
}

UffQuantity quantity_in(const std::string& units) {
  if (units == "m") return UffQuantity::displacement;
  if (units == "m/s") return UffQuantity::velocity;
  if (units == "m/s^2") return UffQuantity::acceleration;
  if (units == "N") return UffQuantity::reaction_force;
  return UffQuantity::general;
}

UffDof PointNodes::dof(const std::string& point, int direction) {
  const auto number = static_cast<std::int64_t>(numbers_.size() + 1);
  return {numbers_.emplace(point, number).first->second, direction + 1};
}

std::vector<UffNode> PointNodes::placed(const LoadedScene& loaded) const {
  std::vector<UffNode> nodes;
  if (numbers_.empty()) return nodes;
  BodyCache cache;
  const ModelParameters parameters = parameters_with_files(loaded, cache);
  const PlacedModel model = place_model(parameters, cache);
  for (const auto& [name, number] : numbers_) {
    const PointName point =
        *parse_channel(name + ".x.displacement", name, loaded.scene.model).point;
    const auto body = std::find_if(model.bodies.begin(), model.bodies.end(),
                                   [&](const ModelBody& one) { return one.name == point.body; });
    nodes.push_back({number, name, body->place_of(node_at(*body, point.point, name))});
  }
  std::ranges::sort(nodes, {}, &UffNode::number);
  return nodes;
}

}  // namespace stridor
