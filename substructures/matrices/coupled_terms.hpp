// Forces of a body on itself that its modes do not keep apart.
#pragma once

#include <Eigen/Core>

namespace stridor {

/// Gyroscopic, circulatory and non-proportional damping terms of a body (docs/theory.md, 1.5):
///
///   M q̈ + (α M + β K + V) q̇ + (K + N) q = f
///
/// Both matrices are n x n in the coordinates of the body, or both are empty.
struct CoupledTerms {
  Eigen::MatrixXd velocity;  ///< V = D + G: damping of any kind and gyroscopic terms, N s/m
  Eigen::MatrixXd position;  ///< N: circulatory terms, skew-symmetric, N/m

  bool is_empty() const { return velocity.size() == 0; }
  /// The same of coordinates z with q = T z: Tᵀ V T, Tᵀ N T.
  CoupledTerms in(const Eigen::MatrixXd& T) const;
};

}  // namespace stridor
