// Sides of elements by their corner nodes.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "substructures/elements/mesh.hpp"

namespace stridor {

/// An edge or a face that is asked for: its corners, then the middles of its edges, rows of nodes.
struct WantedSide {
  int num_corners = 0;  ///< 2 to 4
  int count = 0;        ///< of all nodes
  std::array<int, 8> nodes{};
};

/// Elements of which a wanted side is one.
struct FoundSide {
  int num_elements = 0;
  ElementSide first, second;  ///< of the first two elements
  bool is_complete = true;    ///< the nodes of these sides are the wanted ones, middle nodes too
  /// The one whose outward normal is that of the wanted side, whose corners are counter-clockwise
  /// seen from the tip of its normal; for edges, that which runs in the same direction. -1: none,
  /// 0: the first, 1: the second.
  int agreeing = -1;
};

/// Cost: once through the sides of all elements, whatever the number of wanted ones.
std::vector<FoundSide> find_sides(const Mesh& mesh, std::span<const WantedSide> wanted);

}  // namespace stridor
