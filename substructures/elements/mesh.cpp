#include "substructures/elements/mesh.hpp"

#include <stdexcept>

namespace stridor {
namespace {

// Long because it is a table: one entry for each shape.
std::vector<ShapeFacts> make_facts() {
  return {
      {"tri3", 2, 3, 3, {{2, 2, {0, 1}}, {2, 2, {1, 2}}, {2, 2, {2, 0}}}},
      {"tri6", 2, 6, 3, {{2, 3, {0, 1, 3}}, {2, 3, {1, 2, 4}}, {2, 3, {2, 0, 5}}}},
      {"quad4", 2, 4, 4, {{2, 2, {0, 1}}, {2, 2, {1, 2}}, {2, 2, {2, 3}}, {2, 2, {3, 0}}}},
      {"quad8",
       2,
       8,
       4,
       {{2, 3, {0, 1, 4}}, {2, 3, {1, 2, 5}}, {2, 3, {2, 3, 6}}, {2, 3, {3, 0, 7}}}},
      {"tet4",
       3,
       4,
       4,
       {{3, 3, {0, 2, 1}}, {3, 3, {0, 1, 3}}, {3, 3, {1, 2, 3}}, {3, 3, {2, 0, 3}}}},
      {"tet10",
       3,
       10,
       4,
       {{3, 6, {0, 2, 1, 6, 5, 4}},
        {3, 6, {0, 1, 3, 4, 8, 7}},
        {3, 6, {1, 2, 3, 5, 9, 8}},
        {3, 6, {2, 0, 3, 6, 7, 9}}}},
      {"hex8",
       3,
       8,
       8,
       {{4, 4, {0, 3, 2, 1}},
        {4, 4, {4, 5, 6, 7}},
        {4, 4, {0, 1, 5, 4}},
        {4, 4, {1, 2, 6, 5}},
        {4, 4, {2, 3, 7, 6}},
        {4, 4, {3, 0, 4, 7}}}},
      {"hex20",
       3,
       20,
       8,
       {{4, 8, {0, 3, 2, 1, 11, 10, 9, 8}},
        {4, 8, {4, 5, 6, 7, 12, 13, 14, 15}},
        {4, 8, {0, 1, 5, 4, 8, 17, 12, 16}},
        {4, 8, {1, 2, 6, 5, 9, 18, 13, 17}},
        {4, 8, {2, 3, 7, 6, 10, 19, 14, 18}},
        {4, 8, {3, 0, 4, 7, 11, 16, 15, 19}}}},
      {"wedge6",
       3,
       6,
       6,
       {{3, 3, {0, 2, 1}},
        {3, 3, {3, 4, 5}},
        {4, 4, {0, 1, 4, 3}},
        {4, 4, {1, 2, 5, 4}},
        {4, 4, {2, 0, 3, 5}}}},
      {"wedge15",
       3,
       15,
       6,
       {{3, 6, {0, 2, 1, 8, 7, 6}},
        {3, 6, {3, 4, 5, 9, 10, 11}},
        {4, 8, {0, 1, 4, 3, 6, 13, 9, 12}},
        {4, 8, {1, 2, 5, 4, 7, 14, 10, 13}},
        {4, 8, {2, 0, 3, 5, 8, 12, 11, 14}}}},
  };
}

}  // namespace

const ShapeFacts& facts_of(ElementShape shape) {
  static const std::vector<ShapeFacts> facts = make_facts();
  return facts[static_cast<std::size_t>(shape)];
}

int vtk_cell_type(ElementShape shape) {
  // Of vtkCellType.h, in the order of ElementShape.
  constexpr std::array types{5, 22, 9, 23, 10, 24, 12, 25, 13, 26};
  return types.at(static_cast<std::size_t>(shape));
}

void Mesh::add_element(ElementShape shape, std::span<const int> nodes_of_element,
                       std::int64_t label) {
  if (nodes_of_element.size() != static_cast<std::size_t>(facts_of(shape).num_nodes))
    throw std::invalid_argument("Mesh::add_element: wrong number of nodes");
  shapes.push_back(shape);
  connectivity.insert(connectivity.end(), nodes_of_element.begin(), nodes_of_element.end());
  first_node.push_back(connectivity.size());
  element_labels.push_back(label);
}

int Mesh::dimension() const {
  if (shapes.empty()) throw std::invalid_argument("Mesh::dimension: no elements");
  const int first = facts_of(shapes.front()).dimension;
  for (const ElementShape shape : shapes) {
    if (facts_of(shape).dimension != first)
      throw std::invalid_argument("Mesh::dimension: planar elements beside volumes");
  }
  return first;
}

}  // namespace stridor
