#include "substructures/matrices/body_matrices.hpp"

#include <string_view>

namespace stridor {

DofSum BodyMatrices::displacement(int node, std::size_t direction) const {
  const auto found = dependent.find(node);
  if (found != dependent.end()) return found->second[direction];
  const auto n = static_cast<std::size_t>(node);
  constexpr std::size_t z = 2;
  const int dof = direction == z ? (across.empty() ? held : across[n]) : node_dofs[n][direction];
  return dof == held ? DofSum{} : DofSum{{dof, 1.0}};
}

std::optional<DofSum> BodyMatrices::load(const std::string& name) const {
  const auto found = loads.find(name);
  if (found != loads.end()) return found->second;
  const std::size_t dot = name.rfind('.');
  if (dot == std::string::npos || dot + 2 != name.size()) return std::nullopt;
  const auto point = points.find(name.substr(0, dot));
  const std::size_t direction = std::string_view("xyz").find(name.back());
  if (point == points.end() || direction == std::string_view::npos) return std::nullopt;
  return displacement(point->second, direction);
}

}  // namespace stridor
