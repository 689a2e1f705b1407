// Matrices of other programs, whose rows are displacements of nodes by their numbers there.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "substructures/elements/mesh.hpp"
#include "substructures/matrices/body_matrices.hpp"

namespace stridor {

/// What a row of a matrix is: a displacement or rotation of a node.
struct NodeUnknown {
  std::int64_t node = 0;  ///< number of the node in its program; <= 0: of none that a mesh has
  int direction = 0;      ///< 1 to 3: along x, y, z; 4 to 6: about them; 0: anything else
  auto operator<=>(const NodeUnknown&) const = default;
  bool is_displacement() const { return direction >= 1 && direction <= 3; }
};

/// Places of nodes, in lengths of the file.
struct NodeTable {
  std::vector<std::int64_t> labels;
  Mesh::Nodes positions = Mesh::Nodes(0, 3);
};

/// What a table of unknowns says: a row of the matrices each.
struct UnknownTable {
  std::vector<NodeUnknown> unknowns;
  NodeTable nodes;  ///< where the table has places too
};

/// Which entries of a symmetric matrix a file holds; `half`: one of each pair, in no common order.
enum class StoredPart { full, upper, lower, half, diagonal };

/// A square matrix as a file holds it, both triangles filled in.
struct LabelledMatrix {
  SparseMatrix matrix;
  std::vector<NodeUnknown> unknowns;  ///< of its rows, ascending; empty where it numbers rows alone
  NodeTable nodes;                    ///< where the file has places of nodes too
  std::string format = "Matrix Market";
  StoredPart stored = StoredPart::full;
  bool is_open = false;  ///< rows without entries may follow: the file does not say how many it has
  /// ‖A − Aᵀ‖/‖A‖ of the file; up to `largest_rounding` it is taken out of matrices of programs.
  double symmetry_error = 0.0;
  static constexpr double largest_rounding = 1e-9;
};

/// What a file of a matrix turned out to hold.
struct MatrixFileFacts {
  std::string key;     ///< that names it, below that of the body
  std::string format;
  StoredPart stored = StoredPart::full;
  double symmetry_error = 0.0;  ///< as LabelledMatrix has it
};

/// Which of several matrices in one file is meant.
enum class MatrixPurpose { any, mass, damping, stiffness };

}  // namespace stridor
