// Meshes of boxes of every shape of element.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <functional>
#include <map>
#include <random>
#include <span>
#include <utility>
#include <vector>

#include "substructures/elements/mesh.hpp"
#include "substructures/elements/shape_functions.hpp"

namespace stridor::test {

inline constexpr std::array<ElementShape, 10> element_shapes{
    ElementShape::tri3,   ElementShape::tri6,   ElementShape::quad4, ElementShape::quad8,
    ElementShape::tet4,   ElementShape::tet10,  ElementShape::hex8,  ElementShape::hex20,
    ElementShape::wedge6, ElementShape::wedge15};

inline bool is_quadratic(ElementShape shape) {
  return facts_of(shape).num_nodes > facts_of(shape).num_corners;
}

/// The shape with the same corners and no other nodes.
inline ElementShape linear_shape(ElementShape shape) {
  return is_quadratic(shape) ? static_cast<ElementShape>(static_cast<int>(shape) - 1) : shape;
}

/// The same elements with nodes in the middles of their edges.
inline Mesh with_middles(const Mesh& linear) {
  Mesh mesh;
  std::vector<Eigen::RowVector3d> nodes(linear.num_nodes());
  for (std::size_t k = 0; k < nodes.size(); ++k)
    nodes[k] = linear.nodes.row(static_cast<Eigen::Index>(k));
  std::map<std::pair<int, int>, int> middles;
  for (std::size_t e = 0; e < linear.num_elements(); ++e) {
    const ElementShape from = linear.shapes[e];
    const auto shape = static_cast<ElementShape>(static_cast<int>(from) + 1);
    std::vector<int> of_element(linear.nodes_of(e).begin(), linear.nodes_of(e).end());
    const auto places = natural_nodes(shape);
    const Eigen::Index num_corners = facts_of(shape).num_corners;
    for (Eigen::Index k = num_corners; k < places.rows(); ++k) {
      // Halfway between two corners their linear functions are 1/2.
      const auto values = shape_functions(from, places.row(k).transpose()).values;
      std::vector<int> ends;
      for (Eigen::Index c = 0; c < num_corners; ++c)
        if (values(c) > 0.25) ends.push_back(of_element[static_cast<std::size_t>(c)]);
      const std::pair<int, int> edge = std::minmax(ends.at(0), ends.at(1));
      const auto [found, is_new] = middles.try_emplace(edge, static_cast<int>(nodes.size()));
      if (is_new) {
        nodes.push_back(0.5 * (nodes[static_cast<std::size_t>(edge.first)] +
                               nodes[static_cast<std::size_t>(edge.second)]));
      }
      of_element.push_back(found->second);
    }
    mesh.add_element(shape, of_element, linear.element_labels[e]);
  }
  mesh.nodes.resize(static_cast<Eigen::Index>(nodes.size()), 3);
  for (std::size_t k = 0; k < nodes.size(); ++k)
    mesh.nodes.row(static_cast<Eigen::Index>(k)) = nodes[k];
  return mesh;
}

/// Sides of which no other element has the same corners.
inline std::vector<ElementSide> outer_sides(const Mesh& mesh) {
  std::map<std::vector<int>, std::vector<ElementSide>> by_corners;
  for (std::size_t e = 0; e < mesh.num_elements(); ++e) {
    const auto& sides = facts_of(mesh.shapes[e]).sides;
    for (std::size_t s = 0; s < sides.size(); ++s) {
      std::vector<int> corners;
      for (int k = 0; k < sides[s].num_corners; ++k)
        corners.push_back(mesh.nodes_of(
            e)[static_cast<std::size_t>(sides[s].nodes[static_cast<std::size_t>(k)])]);
      std::sort(corners.begin(), corners.end());
      by_corners[corners].push_back({static_cast<int>(e), static_cast<int>(s)});
    }
  }
  std::vector<ElementSide> outer;
  for (const auto& [corners, sides] : by_corners)
    if (sides.size() == 1) outer.push_back(sides.front());
  std::sort(outer.begin(), outer.end());
  return outer;
}

/// Moves the nodes of a mesh without middles that are not on its boundary.
inline void distort_inside(Mesh& mesh, double most) {
  std::vector<bool> is_outer(mesh.num_nodes(), false);
  for (const ElementSide& side : test::outer_sides(mesh)) {
    const auto element = static_cast<std::size_t>(side.element);
    const SideNodes& nodes =
        facts_of(mesh.shapes[element]).sides[static_cast<std::size_t>(side.side)];
    for (int k = 0; k < nodes.count; ++k) {
      const int within = nodes.nodes[static_cast<std::size_t>(k)];
      is_outer[static_cast<std::size_t>(mesh.nodes_of(element)[static_cast<std::size_t>(within)])] =
          true;
    }
  }
  std::mt19937 random(11);
  std::uniform_real_distribution<double> uniform(-most, most);
  const int dimension = mesh.dimension();
  for (std::size_t node = 0; node < mesh.num_nodes(); ++node) {
    if (is_outer[node]) continue;
    for (int i = 0; i < dimension; ++i)
      mesh.nodes(static_cast<Eigen::Index>(node), i) += uniform(random);
  }
}

/// What the cell in a column, row and layer is made of: elements of a linear shape.
using CellShape = std::function<ElementShape(int, int, int)>;
using HasCell = std::function<bool(int, int, int)>;

/// A grid of cells, each one quad4 or hex8, or cut into 2 tri3, 2 wedge6 or 6 tet4.
inline Mesh linear_grid(const std::array<int, 3>& cells, const Eigen::Vector3d& size,
                        bool is_planar, const CellShape& shape_of_cell, const HasCell& has_cell) {
  const int layers = is_planar ? 0 : cells[2];
  const auto node = [&](int i, int j, int k) {
    return (k * (cells[1] + 1) + j) * (cells[0] + 1) + i;
  };
  Mesh::Nodes places((cells[0] + 1) * (cells[1] + 1) * (layers + 1), 3);
  for (int k = 0; k <= layers; ++k)
    for (int j = 0; j <= cells[1]; ++j)
      for (int i = 0; i <= cells[0]; ++i)
        places.row(node(i, j, k)) << size.x() * i / cells[0], size.y() * j / cells[1],
            is_planar ? 0.0 : size.z() * k / cells[2];
  Mesh mesh;
  const auto add = [&](ElementShape shape, const std::vector<int>& corners,
                       const std::vector<int>& of_cell) {
    std::vector<int> nodes;
    for (const int corner : corners) nodes.push_back(of_cell[static_cast<std::size_t>(corner)]);
    mesh.add_element(shape, nodes, static_cast<std::int64_t>(mesh.num_elements()) + 1);
  };
  for (int k = 0; k < std::max(layers, 1); ++k) {
    for (int j = 0; j < cells[1]; ++j) {
      for (int i = 0; i < cells[0]; ++i) {
        if (!has_cell(i, j, k)) continue;
        std::vector<int> c{node(i, j, k), node(i + 1, j, k), node(i + 1, j + 1, k),
                           node(i, j + 1, k)};
        if (!is_planar)
          for (int corner = 0; corner < 4; ++corner)
            c.push_back(c[static_cast<std::size_t>(corner)] + node(0, 0, 1));
        const ElementShape shape = shape_of_cell(i, j, k);
        switch (shape) {
          case ElementShape::tri3:
            add(shape, {0, 1, 2}, c);
            add(shape, {0, 2, 3}, c);
            break;
          case ElementShape::wedge6:
            add(shape, {0, 1, 2, 4, 5, 6}, c);
            add(shape, {0, 2, 3, 4, 6, 7}, c);
            break;
          case ElementShape::tet4:
            // Around the diagonal 0-6, one for every order of the axes.
            add(shape, {0, 1, 2, 6}, c);
            add(shape, {0, 2, 3, 6}, c);
            add(shape, {0, 3, 7, 6}, c);
            add(shape, {0, 7, 4, 6}, c);
            add(shape, {0, 4, 5, 6}, c);
            add(shape, {0, 5, 1, 6}, c);
            break;
          case ElementShape::quad4:
            add(shape, {0, 1, 2, 3}, c);
            break;
          default:
            add(shape, {0, 1, 2, 3, 4, 5, 6, 7}, c);
            break;
        }
      }
    }
  }
  // Nodes of cells that are there.
  std::vector<int> renumbered(static_cast<std::size_t>(places.rows()), -1);
  int count = 0;
  for (const int used : mesh.connectivity) renumbered[static_cast<std::size_t>(used)] = 0;
  for (int& number : renumbered)
    if (number == 0) number = count++;
  mesh.nodes.resize(count, 3);
  for (std::size_t k = 0; k < renumbered.size(); ++k)
    if (renumbered[k] >= 0)
      mesh.nodes.row(renumbered[k]) = places.row(static_cast<Eigen::Index>(k));
  for (int& used : mesh.connectivity) used = renumbered[static_cast<std::size_t>(used)];
  return mesh;
}

/// A box, or a rectangle, of elements of one shape whose corners inside are moved by `most` at most
/// in every direction.
inline Mesh box_mesh(ElementShape shape, const std::array<int, 3>& cells,
                     const Eigen::Vector3d& size, double most = 0.0) {
  const bool is_planar = facts_of(shape).dimension == 2;
  Mesh mesh = linear_grid(
      cells, size, is_planar, [&](int, int, int) { return linear_shape(shape); },
      [](int, int, int) { return true; });
  if (most > 0.0) distort_inside(mesh, most);
  return is_quadratic(shape) ? with_middles(mesh) : mesh;
}

}  // namespace stridor::test
