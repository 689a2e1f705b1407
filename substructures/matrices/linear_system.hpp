// Small motion of a linear system, as matrices: the common form of gyroscopic and circulatory
// systems.
#pragma once

#include <Eigen/Core>

namespace stridor {

/// M q̈ + P q̇ + Q q = Fᵀ Λ,   N q = 0   (docs/theory.md, 10.3; HS (16), (21), (24))
///
/// P = D + G and Q = K + N hold symmetric and skew parts together; split() takes them apart. The k
/// constraints have rows N for the gaps and F for the forces, which differ under friction; there
/// may be none.
struct LinearSystem {
  Eigen::MatrixXd mass;      ///< M, n x n, symmetric positive definite
  Eigen::MatrixXd velocity;  ///< P, n x n
  Eigen::MatrixXd position;  ///< Q, n x n
  Eigen::MatrixXd gaps;      ///< N, k x n: gap of every constraint
  Eigen::MatrixXd forces;    ///< F, k x n: generalised force per contact force

  Eigen::Index size() const { return mass.rows(); }
};

/// A matrix as the sum of its symmetric and its skew part.
struct MatrixParts {
  Eigen::MatrixXd symmetric;
  Eigen::MatrixXd skew;
};

inline MatrixParts split(const Eigen::MatrixXd& matrix) {
  return {0.5 * (matrix + matrix.transpose()), 0.5 * (matrix - matrix.transpose())};
}

}  // namespace stridor
