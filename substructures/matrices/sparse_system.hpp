// Equations of motion with sparse matrices.
#pragma once

#include "substructures/matrices/body_matrices.hpp"

namespace stridor {

/// M q̈ + P q̇ + Q q = 0 with sparse matrices, all n x n.
struct SparseSystem {
  SparseMatrix mass, velocity, position;
  Eigen::Index size() const { return mass.rows(); }
};

}  // namespace stridor
