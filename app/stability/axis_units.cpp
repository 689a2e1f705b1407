#include "app/stability/axis_units.hpp"

#include <stdexcept>

#include "app/stability/key_range.hpp"
#include "core/units.hpp"

namespace stridor {
namespace {

/// Unit after the number in "30 mm"; empty for a bare number or a text without a number.
std::string unit_in(const std::string& text) {
  std::size_t end = 0;
  try {
    std::stod(text, &end);
  } catch (const std::exception&) {
    return "";
  }
  const std::size_t first = text.find_first_not_of(' ', end);
  return first == std::string::npos ? "" : text.substr(first);
}

/// The scalar at a path of maps; empty where there is none.
std::string text_at(const SceneNode& scene, const std::string& path) {
  const SceneNode* node = &scene;
  for (std::size_t begin = 0; begin <= path.size();) {
    const std::size_t end = std::min(path.find('.', begin), path.size());
    const SceneEntry* entry = node->entry(path.substr(begin, end - begin));
    if (entry == nullptr) return "";
    node = &entry->value;
    begin = end + 1;
  }
  return node->kind == SceneNode::Kind::scalar ? node->text : "";
}

}  // namespace

AxisUnit axis_unit(const NumericKey& key, std::initializer_list<std::string> written,
                   const SceneNode* scene) {
  std::vector<std::string> texts(written);
  if (scene != nullptr) texts.push_back(text_at(*scene, key.path));
  for (const std::string& text : texts) {
    const std::string unit = unit_in(text);
    if (unit.empty()) continue;
    try {
      // A unit with an offset is no mere factor.
      const double in_si = parse_quantity("1 " + unit, key.unit);
      if (parse_quantity("2 " + unit, key.unit) == 2.0 * in_si) return {unit, in_si};
    } catch (const std::invalid_argument&) {  // of another key of this name
    }
  }
  return {printed_units(key), 1.0};
}

}  // namespace stridor
