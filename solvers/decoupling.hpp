// Coordinates in which a linear system falls apart into small ones.
#pragma once

#include <vector>

#include "solvers/group_diagonal.hpp"
#include "substructures/linear_system.hpp"

namespace stridor {

/// q = T z, and M, P, Q of z with a block for every group of coordinates z.
struct DecoupledSystem {
  LinearSystem system;                  ///< of z, with forces Tᵀ f, without constraints
  Eigen::MatrixXd motion;               ///< T, n x n
  Eigen::MatrixXd inverse;              ///< T⁻¹
  std::vector<CoordinateGroup> groups;  ///< one after another
};

/// Finds the coordinates that nothing couples with others: parts between which M, P and Q hold exact
/// zeros, and the modes of a part with M symmetric and positive definite, Q symmetric and P
/// proportional to them (proportional_damping()). The cosine and the sine of a spinning plate stay
/// a pair; where nothing comes apart T is a permutation.
DecoupledSystem decouple(const LinearSystem& system);

}  // namespace stridor
