// Element types of Gmsh.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>

#include "substructures/elements/mesh.hpp"

namespace stridor {

/// A type of elements that is read: volumes, surfaces, lines or points.
struct GmshType {
  int number;  ///< in the file
  int dimension;
  int num_corners;
  int num_nodes;
  std::optional<ElementShape> shape;  ///< none for lines and points
  /// Node k of the shape is node order[k] of Gmsh. Gmsh numbers the middles of edges of volumes by
  /// the edges from the first corner, then those from the second, and so on ("Node ordering" in its
  /// manual).
  std::array<std::uint8_t, 20> order;
};

/// @return nullptr if elements of this number are not read
const GmshType* gmsh_type(std::int64_t number);

/// Why a type is not read and what to do: "elements of 27 nodes (type 12); ...".
std::string refused_gmsh_type(std::int64_t number);

}  // namespace stridor
