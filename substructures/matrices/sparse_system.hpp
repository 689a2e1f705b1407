// Equations of motion with sparse matrices.
#pragma once

#include "substructures/matrices/body_matrices.hpp"

namespace stridor {

/// M q̈ + P q̇ + Q q = 0 with sparse matrices, all n x n.
struct SparseSystem {
  SparseMatrix mass, velocity, position;
  /// Structural damping: the imaginary part of the complex Q, n x n; or empty. Of bodies on their way to a
  /// reduction.
  SparseMatrix loss{};
  Eigen::Index size() const { return mass.rows(); }
};

}  // namespace stridor
