// The edge of a contact area between the cells of a grid.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

namespace stridor {

/// The edge of the contact in the half y ≥ 0, found to a fraction of a cell.
struct ContactEdge {
  /// (x, y) in sides of a cell from the centre of the window, by angle from +x to −x about
  /// (centre, 0); empty where the edge was not resolved.
  std::vector<std::array<double, 2>> points;
  double centre = 0.0;  ///< x of the middle of the contact
  double area = 0.0;    ///< of both halves, in cells
  bool is_resolved = false;
};

/// Finds the edge from pressures and gaps.
///
/// Towards the edge the pressure falls as the square root of the distance and beyond it the gap
/// opens as its power 3/2, so that p² and gap^⅔ run straight into the edge. Which of them does so
/// over several cells depends on the side: ahead of the indenter the pressure has a layer of the
/// length v τ, behind it the gap has a wake. Along x and along y, wherever the edge is not nearly
/// parallel, a parabola is laid through three values of each and followed to its zero; the two are
/// weighted by how little their zero moves when the next three values are taken. The cells next to
/// the edge are left out, since the steps of the contact area disturb them. A = ½ ∮ r² dθ over the
/// points.
///
/// If the contact is not one piece without holes, or only a few cells wide, the contact cells
/// are counted instead and `is_resolved` is false.
///
/// @param pressure  N/2 × N, rows along x from the axis outwards; > 0 in contact
/// @param gap       likewise, any positive unit, may be infinite; used out of contact
/// @param num_cells N
/// @throws std::invalid_argument if a size is not N²/2
ContactEdge find_contact_edge(std::span<const double> pressure, std::span<const double> gap,
                              std::size_t num_cells);

}  // namespace stridor
