// The boundary of stability over two parameters.
#pragma once

#include <array>
#include <vector>

namespace stridor {

/// Changes of stability along the lines of a grid.
struct GridCrossings {
  std::vector<double> x;                     ///< of the grid, strictly ascending, at least two
  std::vector<double> y;                     ///< likewise
  std::vector<std::vector<double>> along_x;  ///< for every y: values of x, ascending
  std::vector<std::vector<double>> along_y;  ///< for every x: values of y, ascending
};

/// A line of points (x, y).
using BoundaryLine = std::vector<std::array<double, 2>>;

/// Connects the crossings of a grid to lines.
///
/// Around a cell of the grid, stable and unstable parts alternate from crossing to crossing. Every
/// crossing is connected with a neighbour on the way around, such that lines do not cross; of the
/// two ways to do so, that with fewer lines from a side to itself is taken, or the shorter one in
/// units of the cell. Lines end at the edge of the grid,
/// and in cells with an odd number of crossings, where something was missed.
///
/// @return longest lines first; closed ones repeat their first point
/// @throws std::invalid_argument if the lists do not fit the grid or do not ascend
std::vector<BoundaryLine> boundary_lines(const GridCrossings& crossings);

}  // namespace stridor
