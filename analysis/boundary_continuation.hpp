// The boundary of stability over two parameters, followed by continuation.
#pragma once

#include <array>
#include <functional>
#include <vector>

#include "analysis/stability_map.hpp"

namespace stridor {

/// Spacing of the values of an axis of a map; its boundary is followed in the same measure.
enum class GridSpacing { linear, logarithmic };

struct MapGrid {
  std::vector<double> x;  ///< strictly ascending, at least two
  std::vector<double> y;  ///< likewise
  std::array<GridSpacing, 2> spacing{GridSpacing::linear, GridSpacing::linear};
};

/// Follows the lines margin(x, y) = 0 through the rectangle of a grid.
///
/// Pseudo-arclength continuation: from a point on the line the next one is sought on a circle about
/// it, where the margin changes its sign next to the direction of the last step, by regula falsi
/// with bisection to rounding. The line so may turn back in either parameter and have corners,
/// where another eigenvalue takes over. The radius, at most a cell, is halved where the line turns
/// by more than 15°, down to a 1000th of a cell. Lines keep the unstable side on their left; they
/// end at the edge of the rectangle, or where the margin is NaN, or close.
///
/// @param margin positive where unstable
/// @param seeds  lines near which the boundary is known to run: those of boundary_lines(); lines
///               without a seed are not found. Their points become points of the lines, unchanged
/// @return longest first; closed ones repeat their first point
/// @throws std::invalid_argument if the grid is inconsistent
std::vector<BoundaryLine> trace_boundary(const std::function<double(double, double)>& margin,
                                         const MapGrid& grid,
                                         const std::vector<BoundaryLine>& seeds);

}  // namespace stridor
