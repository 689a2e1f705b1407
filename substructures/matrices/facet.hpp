// Facets of surfaces in space.
#pragma once

#include <array>

namespace stridor {

/// A triangle or quadrilateral between nodes, counter-clockwise seen from outside of its body.
struct Facet {
  int count = 3;               ///< of nodes, 3 or 4
  std::array<int, 4> nodes{};  ///< the first `count` of them
};

}  // namespace stridor
