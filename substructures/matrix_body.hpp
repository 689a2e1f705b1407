// A body given by its matrices.
#pragma once

#include <Eigen/SparseCore>
#include <string>
#include <vector>

#include "core/schema.hpp"
#include "substructures/body_matrices.hpp"

namespace stridor {

/// What a scene says of one matrix: the name of a Matrix Market file, or its rows as texts of
/// numbers ("1 0 -2.5"). Nothing where it is zero.
using MatrixText = std::vector<std::string>;

/// Numbers by which matrices are multiplied, to be varied.
struct MatrixFactors {
  double damping = 1.0;
  double gyroscopic = 1.0;
  double stiffness = 1.0;
  double circulatory = 1.0;
  static const Schema& schema();
};

/// M q̈ + (d D + g G) q̇ + (k K + n N) q + p (D₁ q̇ + K₁ q) = 0   (HS (28); docs/theory.md, 10.3)
struct MatrixBodyParameters {
  MatrixText mass;            ///< M, symmetric positive definite
  MatrixText damping;         ///< D
  MatrixText gyroscopic;      ///< G, skew-symmetric
  MatrixText stiffness;       ///< K
  MatrixText circulatory;     ///< N, skew-symmetric
  MatrixFactors factors;      ///< d, g, k, n
  double load = 0.0;          ///< p
  MatrixText load_damping;    ///< D₁
  MatrixText load_stiffness;  ///< K₁
  static const Schema& schema();
};

/// M q̈ + P q̇ + Q q = 0 with sparse matrices, all n x n.
struct SparseSystem {
  SparseMatrix mass, velocity, position;
  Eigen::Index size() const { return mass.rows(); }
};

}  // namespace stridor
