// Equal masses between equal springs, both ends to ground: everything in closed form.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "substructures/matrices/body_matrices.hpp"

namespace stridor::test {

/// K of n unit springs and masses: 2 on the diagonal, −1 beside it.
inline SparseMatrix chain_stiffness(int n) {
  std::vector<Eigen::Triplet<double>> entries;
  for (int i = 0; i < n; ++i) {
    entries.emplace_back(i, i, 2.0);
    if (i > 0) entries.emplace_back(i, i - 1, -1.0);
    if (i + 1 < n) entries.emplace_back(i, i + 1, -1.0);
  }
  SparseMatrix matrix(n, n);
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

/// M of n unit masses.
inline SparseMatrix chain_mass(int n) {
  SparseMatrix matrix(n, n);
  matrix.setIdentity();
  return matrix;
}

/// ω² of mode j = 1 .. n: 4 sin²(jπ / (2 (n + 1))).
inline double chain_omega_squared(int n, int j) {
  const double sine = std::sin(j * std::numbers::pi / (2.0 * (n + 1)));
  return 4.0 * sine * sine;
}

/// Entry i = 0 .. n−1 of the displacement under a unit force on mass k:
/// min(i+1, k+1) (n − max(i, k)) / (n + 1).
inline double chain_compliance(int n, int i, int k) {
  return static_cast<double>(std::min(i, k) + 1) * (n - std::max(i, k)) / (n + 1);
}

/// The chain moving along x, one node per mass.
inline BodyMatrices chain_body(int n) {
  BodyMatrices body;
  body.mass = chain_mass(n);
  body.stiffness = chain_stiffness(n);
  body.nodes.resize(n, 3);
  for (int i = 0; i < n; ++i) {
    body.nodes.row(i) << i + 1.0, 0.0, 0.0;
    body.node_dofs.push_back({i, BodyMatrices::held});
  }
  return body;
}

}  // namespace stridor::test
