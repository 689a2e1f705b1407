// Matrices over the displacements of the nodes of a mesh that do not come from its elements.
#pragma once

#include <vector>

#include "substructures/matrices/body_matrices.hpp"

namespace stridor {

/// Matrices of a body whose rows are known to be displacements and rotations of nodes.
struct NodalMatrices {
  int dimension = 3;  ///< of the displacements of a node
  SparseMatrix mass, stiffness;
  RayleighDamping damping;
  SparseMatrix velocity, circulatory;  ///< as BodyMatrices has them
  /// Row of displacement `dimension` x node + direction; `BodyMatrices::held` where they have none.
  std::vector<int> rows;
  /// Row of rotation 3 x node + axis likewise; empty where no node turns.
  std::vector<int> rotations;
  SparseMatrix loss_stiffness{};  ///< as BodyMatrices has it
};

}  // namespace stridor
