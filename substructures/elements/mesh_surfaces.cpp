#include "substructures/elements/mesh_surfaces.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <stdexcept>
#include <string>
#include <unordered_map>

namespace stridor {
namespace {

const SideNodes& side_of(const Mesh& mesh, const ElementSide& side) {
  const auto element = static_cast<std::size_t>(side.element);
  return facts_of(mesh.shapes[element]).sides[static_cast<std::size_t>(side.side)];
}

/// Corners of a side in ascending order; −1 behind the last of a triangle or an edge.
using SideKey = std::array<int, 4>;

struct SideKeyHash {
  std::size_t operator()(const SideKey& key) const {
    std::size_t hash = 0;
    for (const int node : key) hash = hash * 1000003U + static_cast<std::size_t>(node + 1);
    return hash;
  }
};

SideKey key_of_side(const Mesh& mesh, const ElementSide& side) {
  const SideNodes& local = side_of(mesh, side);
  const std::span<const int> nodes = mesh.nodes_of(static_cast<std::size_t>(side.element));
  SideKey key{-1, -1, -1, -1};
  for (int i = 0; i < local.num_corners; ++i) {
    const auto at = static_cast<std::size_t>(i);
    key[at] = nodes[static_cast<std::size_t>(local.nodes[at])];
  }
  std::sort(key.begin(), key.begin() + local.num_corners);
  return key;
}

std::string place_text(const Mesh& mesh, int node) {
  return fmt::format("({:.6g}, {:.6g}) m", mesh.nodes(node, 0), mesh.nodes(node, 1));
}

}  // namespace

std::vector<ElementSide> outer_sides(const Mesh& mesh) {
  std::unordered_map<SideKey, ElementSide, SideKeyHash> alone;
  for (std::size_t e = 0; e < mesh.num_elements(); ++e) {
    const std::size_t num_sides = facts_of(mesh.shapes[e]).sides.size();
    for (std::size_t s = 0; s < num_sides; ++s) {
      const ElementSide side{static_cast<int>(e), static_cast<int>(s)};
      const auto [found, is_new] = alone.emplace(key_of_side(mesh, side), side);
      if (!is_new) alone.erase(found);
    }
  }
  std::vector<ElementSide> outer;
  outer.reserve(alone.size());
  for (const auto& entry : alone) outer.push_back(entry.second);
  std::sort(outer.begin(), outer.end());
  return outer;
}

std::vector<int> nodes_of(const Mesh& mesh, const ElementSide& side) {
  const SideNodes& local = side_of(mesh, side);
  const std::span<const int> of_element = mesh.nodes_of(static_cast<std::size_t>(side.element));
  std::vector<int> nodes;
  for (int i = 0; i < local.count; ++i)
    nodes.push_back(of_element[static_cast<std::size_t>(local.nodes[static_cast<std::size_t>(i)])]);
  return nodes;
}

std::vector<int> nodes_of(const Mesh& mesh, const std::vector<ElementSide>& sides) {
  std::vector<int> all;
  for (const ElementSide& side : sides) {
    const std::vector<int> nodes = nodes_of(mesh, side);
    all.insert(all.end(), nodes.begin(), nodes.end());
  }
  std::sort(all.begin(), all.end());
  all.erase(std::unique(all.begin(), all.end()), all.end());
  return all;
}

bool MeshRegion::contains(const Eigen::Vector3d& point, double tolerance) const {
  if (plane) {
    const double distance = plane->normal.normalized().dot(point) - plane->offset;
    if (!(std::abs(distance) <= tolerance)) return false;
  }
  if (cylinder) {
    const Eigen::Vector3d from_axis = point - cylinder->point;
    const Eigen::Vector3d axis = cylinder->axis.normalized();
    const double radius = (from_axis - axis.dot(from_axis) * axis).norm();
    if (!(std::abs(radius - cylinder->radius) <= tolerance)) return false;
  }
  if (box) {
    if (((box->lowest - point).array() > tolerance).any()) return false;
    if (((point - box->highest).array() > tolerance).any()) return false;
  }
  return true;
}

std::vector<ElementSide> sides_within(const Mesh& mesh, const std::vector<ElementSide>& sides,
                                      const MeshRegion& region, double tolerance) {
  std::vector<ElementSide> found;
  for (const ElementSide& side : sides) {
    const std::vector<int> nodes = nodes_of(mesh, side);
    if (std::all_of(nodes.begin(), nodes.end(), [&](int node) {
          return region.contains(mesh.nodes.row(node).transpose(), tolerance);
        }))
      found.push_back(side);
  }
  return found;
}

std::vector<int> outline_of(const Mesh& mesh, const std::vector<ElementSide>& sides) {
  if (sides.empty()) throw std::invalid_argument("it has no edges");
  // An element lies on the left of its edges, so each is passed from its second corner to its
  // first.
  std::map<int, std::vector<int>> edge_from;
  std::map<int, int> edges_to;
  for (const ElementSide& side : sides) {
    std::vector<int> nodes = nodes_of(mesh, side);
    std::swap(nodes[0], nodes[1]);
    if (edge_from.contains(nodes[0]) || edges_to.contains(nodes[1])) {
      throw std::invalid_argument(
          fmt::format("it branches at {}",
                      place_text(mesh, edge_from.contains(nodes[0]) ? nodes[0] : nodes[1])));
    }
    edges_to[nodes[1]] = nodes[0];
    edge_from[nodes[0]] = std::move(nodes);
  }
  int first = edge_from.begin()->first;
  for (const auto& entry : edge_from) {
    if (!edges_to.contains(entry.first)) first = entry.first;
  }
  std::vector<int> outline{first};
  std::size_t num_passed = 0;
  for (auto edge = edge_from.find(first); edge != edge_from.end() && num_passed < sides.size();
       edge = edge_from.find(outline.back())) {
    const std::vector<int>& nodes = edge->second;
    if (nodes.size() == 3) outline.push_back(nodes[2]);
    outline.push_back(nodes[1]);
    ++num_passed;
  }
  if (num_passed < sides.size()) {
    throw std::invalid_argument(fmt::format(
        "it is not in one piece: {} of its {} edges follow each "
        "other from {} to {}",
        num_passed, sides.size(), place_text(mesh, first), place_text(mesh, outline.back())));
  }
  return outline;
}

std::vector<Facet> facets_of(const Mesh& mesh, const std::vector<ElementSide>& sides) {
  std::vector<Facet> facets;
  for (const ElementSide& side : sides) {
    const std::vector<int> n = nodes_of(mesh, side);
    switch (n.size()) {
      case 3:
        facets.push_back({3, {n[0], n[1], n[2], 0}});
        break;
      case 4:
        facets.push_back({4, {n[0], n[1], n[2], n[3]}});
        break;
      case 6:
        for (const auto& corner : {std::array{0, 3, 5}, {3, 1, 4}, {5, 4, 2}, {3, 4, 5}}) {
          const auto node = [&](std::size_t k) { return n[static_cast<std::size_t>(corner[k])]; };
          facets.push_back({3, {node(0), node(1), node(2), 0}});
        }
        break;
      case 8:
        facets.push_back({4, {n[4], n[5], n[6], n[7]}});
        for (std::size_t k = 0; k < 4; ++k)
          facets.push_back({3, {n[k], n[4 + k], n[4 + (k + 3) % 4], 0}});
        break;
      default:
        throw std::invalid_argument("facets_of: a side of a planar element");
    }
  }
  return facets;
}

double extent_of(const Mesh& mesh) {
  if (mesh.num_nodes() == 0) return 0.0;
  return (mesh.nodes.colwise().maxCoeff() - mesh.nodes.colwise().minCoeff()).norm();
}

}  // namespace stridor
