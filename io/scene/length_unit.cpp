#include "io/scene/length_unit.hpp"

#include <cstdlib>
#include <map>
#include <stdexcept>

#include "core/units.hpp"

namespace stridor {
namespace {

/// Counts units of scalars that are a number with a unit of length.
void count_units(const SceneNode& node, std::map<std::string, int>& counts) {
  for (const SceneEntry& entry : node.entries) count_units(entry.value, counts);
  for (const SceneNode& item : node.items) count_units(item, counts);
  if (node.kind != SceneNode::Kind::scalar) return;
  char* end = nullptr;
  (void)std::strtod(node.text.c_str(), &end);
  std::string unit(end);
  if (unit.size() == node.text.size() || unit.empty()) return;
  unit.erase(0, unit.find_first_not_of(' '));
  if (unit.empty()) return;
  const auto known = counts.find(unit);
  if (known != counts.end()) {
    if (known->second >= 0) ++known->second;
    return;
  }
  int count = -1;  // not a length
  try {
    (void)parse_quantity("1 " + unit, "m");
    count = 1;
  } catch (const std::invalid_argument&) {
  }
  counts[unit] = count;
}

}  // namespace

LengthUnit length_unit_of(const SceneNode& scene) {
  std::map<std::string, int> counts;
  count_units(scene, counts);
  LengthUnit best;
  int most = 0;
  for (const auto& [unit, count] : counts) {
    if (count <= 0) continue;
    const double metres = parse_quantity("1 " + unit, "m");
    if (count < most || (count == most && metres < best.metres)) continue;
    most = count;
    best = {unit, metres};
  }
  return best;
}

}  // namespace stridor
