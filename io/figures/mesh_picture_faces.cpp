// Faces of elements as they are drawn.
#include <algorithm>
#include <array>
#include <map>

#include "io/figures/mesh_picture.hpp"

namespace stridor {
namespace {

/// Corners and middles of edges of a side in the order in which they follow each other.
template <class NodeOf>
std::vector<int> loop_of(const SideNodes& side, const NodeOf& node) {
  std::vector<int> loop;
  for (int edge = 0; edge < side.num_corners; ++edge) {
    loop.push_back(node(side.nodes[static_cast<std::size_t>(edge)]));
    if (side.count > side.num_corners)
      loop.push_back(node(side.nodes[static_cast<std::size_t>(side.num_corners + edge)]));
  }
  return loop;
}

/// A planar element all around.
std::vector<int> loop_around(const DrawnElement& element, const ShapeFacts& facts) {
  std::vector<int> loop;
  for (int corner = 0; corner < facts.num_corners; ++corner) {
    loop.push_back(element.nodes[static_cast<std::size_t>(corner)]);
    if (facts.num_nodes > facts.num_corners)
      loop.push_back(element.nodes[static_cast<std::size_t>(facts.num_corners + corner)]);
  }
  return loop;
}

}  // namespace

std::vector<std::vector<int>> face_loops(std::span<const DrawnElement> elements) {
  std::vector<std::vector<int>> loops;
  // A side between two volumes has the same corners in both.
  std::map<std::array<int, 4>, std::pair<int, std::vector<int>>> sides;
  for (const DrawnElement& element : elements) {
    const ShapeFacts& facts = facts_of(element.shape);
    if (facts.dimension == 2) {
      loops.push_back(loop_around(element, facts));
      continue;
    }
    const auto node = [&](int of_element) {
      return element.nodes[static_cast<std::size_t>(of_element)];
    };
    for (const SideNodes& side : facts.sides) {
      std::array<int, 4> corners{-1, -1, -1, -1};
      for (int k = 0; k < side.num_corners; ++k)
        corners[static_cast<std::size_t>(k)] = node(side.nodes[static_cast<std::size_t>(k)]);
      std::sort(corners.begin(), corners.end());
      auto& [count, loop] = sides[corners];
      if (++count == 1) loop = loop_of(side, node);
    }
  }
  for (auto& [corners, side] : sides)
    if (side.first == 1) loops.push_back(std::move(side.second));
  return loops;
}

std::vector<std::vector<int>> face_loops(const Mesh& mesh, std::span<const ElementSide> sides) {
  std::vector<std::vector<int>> loops;
  loops.reserve(sides.size());
  for (const ElementSide& one : sides) {
    const auto e = static_cast<std::size_t>(one.element);
    const std::span<const int> nodes = mesh.nodes_of(e);
    loops.push_back(loop_of(facts_of(mesh.shapes[e]).sides[static_cast<std::size_t>(one.side)],
                            [&](int of_element) {
                              return nodes[static_cast<std::size_t>(of_element)];
                            }));
  }
  return loops;
}

}  // namespace stridor
