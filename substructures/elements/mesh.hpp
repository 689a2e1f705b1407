// Finite element meshes: nodes, elements of several shapes, sets and surfaces.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

namespace stridor {

/// Shapes of elements. Nodes come in the order of Abaqus and CalculiX: corners first (base, then
/// top), then the middles of the edges of the base, of the top, and of those between. Planar shapes
/// are counter-clockwise seen against +z; the base of a volume is counter-clockwise seen from
/// inside.
enum class ElementShape : std::uint8_t {
  tri3,
  tri6,
  quad4,
  quad8,
  tet4,
  tet10,
  hex8,
  hex20,
  wedge6,
  wedge15,
};

/// A side of an element: its corners in order, then the middles of their edges, so that the normal
/// points out of a volume. Sides of planar elements are edges of two corners.
struct SideNodes {
  int num_corners = 0;
  int count = 0;               ///< of all nodes
  std::array<int, 8> nodes{};  ///< numbers within the element
};

/// Facts of a shape that do not depend on where its nodes are.
struct ShapeFacts {
  const char* name;  ///< "tet10"
  int dimension;     ///< 2 or 3
  int num_nodes;
  int num_corners;
  std::vector<SideNodes> sides;  ///< S1, S2, ... of Abaqus
};
const ShapeFacts& facts_of(ElementShape shape);

/// One side of one element.
struct ElementSide {
  int element = 0;
  int side = 0;  ///< from 0
  auto operator<=>(const ElementSide&) const = default;
};

/// Elements in the order in which they were read. Lengths are those of the file until scaled.
struct Mesh {
  using Nodes = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>;

  Nodes nodes;                            ///< a row each; z = 0 in a planar mesh
  std::vector<std::int64_t> node_labels;  ///< in the file
  std::vector<ElementShape> shapes;       ///< of the elements
  std::vector<std::size_t> first_node{
      0};                         ///< of element e in `connectivity`; one more than elements
  std::vector<int> connectivity;  ///< rows of `nodes`
  std::vector<std::int64_t> element_labels;  ///< in the file
  /// By name, ascending, each once.
  std::map<std::string, std::vector<int>> node_sets;
  std::map<std::string, std::vector<int>> element_sets;
  /// By name; sides of elements, ascending, each once.
  std::map<std::string, std::vector<ElementSide>> surfaces;

  std::size_t num_elements() const { return shapes.size(); }
  std::size_t num_nodes() const { return static_cast<std::size_t>(nodes.rows()); }
  std::span<const int> nodes_of(std::size_t element) const {
    return {connectivity.data() + first_node[element],
            first_node[element + 1] - first_node[element]};
  }
  /// @param nodes_of_element rows of `nodes` in the order of the shape
  void add_element(ElementShape shape, std::span<const int> nodes_of_element, std::int64_t label);
  /// 2 or 3: of all its elements.
  /// @throws std::invalid_argument if it has none, or planar ones beside volumes
  int dimension() const;
};

}  // namespace stridor
