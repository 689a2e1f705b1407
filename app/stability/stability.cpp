#include "app/stability/stability.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "app/stability/growth_of_mass.hpp"
#include "core/errors.hpp"

namespace stridor {
namespace {

/// ": 'parameters.mu', 'parameters.lean', ..." of the parameters of a scene, where it has any.
std::string examples_of_keys(const Scene& scene) {
  std::vector<std::string> names;
  for (const NamedNumber& number : scene.parameters)
    names.push_back(fmt::format("'parameters.{}'", number.name));
  if (names.empty()) return ", as 'contact.friction.coefficient' or another number of the scene";
  return fmt::format(": {}, or another number of the scene", fmt::join(names, ", "));
}

}  // namespace

ContactGeometry StabilityOptions::geometry() const {
  return about == "deformed" ? ContactGeometry::deformed : ContactGeometry::undeformed;
}

EigenvalueMethod StabilityOptions::eigenvalue_method() const {
  return method == "dense" ? EigenvalueMethod::dense : EigenvalueMethod::secular;
}

std::string StabilityOptions::window_words() const {
  const SpectrumWindow wanted = window();
  std::string words = !wanted.count       ? "eigenvalues"
                      : *wanted.count > 1 ? fmt::format("{} lowest eigenvalues", *wanted.count)
                                          : "lowest eigenvalue";
  if (std::isfinite(wanted.frequency)) words += fmt::format(" below {:g} Hz", wanted.frequency);
  return words;
}

LocusOptions StabilityOptions::locus_options() const {
  LocusOptions options;
  options.method = method == "dense" ? LocusMethod::dense : LocusMethod::secular;
  options.window = window();
  return options;
}

SpectrumWindow StabilityOptions::window() const {
  constexpr int default_count = 20;
  if (!below) return SpectrumWindow::lowest(count.value_or(default_count));
  const NumericKey frequency{"--below", "Hz", Range::positive()};
  SpectrumWindow window = SpectrumWindow::below(parse_value(frequency, *below, "--below"));
  window.count = count;
  return window;
}

void add_stability_options(CLI::App& verb, StabilityOptions& options) {
  verb.add_option("scene", options.scene, "Scene file (YAML)")->required();
  verb.add_option("--about", options.about,
                  "Geometry about which the system is linearised: undeformed, or that of the "
                  "deformed sliding equilibrium; default: undeformed, with contacts on the faces of "
                  "plates deformed")
      ->check(CLI::IsMember({"undeformed", "deformed"}));
  verb.add_option("--method", options.method,
                  "secular (default): zeros of the secular function; dense: all eigenvalues of the "
                  "assembled matrices, as a check")
      ->check(CLI::IsMember({"secular", "dense"}));
  verb.add_option("--count", options.count,
                  "How many eigenvalues with positive frequency, lowest first (default: 20, with "
                  "--below all)")
      ->check(CLI::Range(1, 100000));
  verb.add_option(
      "--below", options.below,
      "Only those up to this frequency, Hz or with a unit: all of them where no --count is "
      "given");
  add_scene_options(verb, options.common);
  add_json_option(verb, options.common);
}

NumericKey find_stability_key(const Scene& scene, const std::string& path,
                              const std::string& option) {
  if (path == drive_displacement_name) {
    if (scene.model.pairs().empty())
      throw ConfigError(Refusal::wrong_value, option,
                        "'drive.displacement' moves contacts, and the scene has none");
    return {path, "m", Range::any(), false};
  }
  NumericKey key = find_numeric_key(scene, path, option);
  const std::string section = path.substr(0, path.find('.'));
  const bool is_mechanical =
      is_parameter(key) ||
      (section != "initial" && ModelParameters::schema().find(section) != nullptr);
  if (!is_mechanical)
    throw ConfigError(Refusal::wrong_value, option,
                      fmt::format("'{}' has no influence on the eigenvalues", path));
  return key;
}

KeyRange make_range(const StabilityScene& scene, const RangeOptions& options) {
  std::string path = options.parameter;
  if (path.empty()) {
    const auto key = scene.default_key();
    if (!key)
      throw ConfigError(Refusal::missing, "--parameter",
                        "no place along a path can be varied in this scene; name a key" +
                            examples_of_keys(scene.loaded().scene));
    path = *key;
  }
  KeyRange range{scene.find_key(path, "--parameter"), {}};
  range.values = range_values(range.key, options, Spacing::linear);
  return range;
}

std::optional<std::string> StabilityScene::default_key() const {
  const ModelParameters& model = loaded_.scene.model;
  const auto pairs = model.pairs();
  const bool moves = std::any_of(pairs.begin(), pairs.end(), [&](const auto& pair) {
    return !is_face(model, pair.second.master);
  });
  if (!moves) return std::nullopt;
  if (has_face_contacts(model)) return drive_displacement_name;
  return start_key(model).value_or(drive_displacement_name);
}

std::unique_ptr<GrowthField> StabilityScene::growth_field(
    const std::vector<NumericKey>& keys) const {
  return make_growth_field(loaded_, keys);
}

std::string StabilityScene::about_text(const StabilityOptions& options) const {
  if (loaded_.scene.model.pairs().empty()) return "";
  return fmt::format(" about the {} geometry", options.about);
}

void make_choices(StabilityOptions& options, const Scene& scene) {
  if (options.method.empty()) options.method = "secular";
  if (options.about.empty())
    options.about = has_face_contacts(scene.model) ? "deformed" : "undeformed";
}

StabilityScene load_stability_scene(StabilityOptions& options) {
  StabilityScene scene(load_scene(options.scene, options.common.sets));
  make_choices(options, scene.loaded().scene);
  return scene;
}

}  // namespace stridor
