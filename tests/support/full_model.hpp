// Dense calculations on full models, independent of the program's sparse and reduced ones.
#pragma once

#include <Eigen/Dense>
#include <limits>
#include <vector>

#include "substructures/matrices/body_matrices.hpp"
#include "tests/support/constants.hpp"

namespace stridor::test {

/// Displacement of the free DoFs when every node moves by `translation` and turns by `rotation`
/// (linearised) about `centre`. A DoF shared by several nodes takes that of the last one.
inline Eigen::VectorXd rigid_motion(const BodyMatrices& body, const Eigen::Vector2d& translation,
                                    double rotation = 0.0,
                                    const Eigen::Vector2d& centre = Eigen::Vector2d::Zero()) {
  Eigen::VectorXd motion = Eigen::VectorXd::Zero(body.num_dofs());
  for (std::size_t node = 0; node < body.node_dofs.size(); ++node) {
    const auto [x, y] = body.node_dofs[node];
    const Eigen::Vector2d arm =
        body.nodes.row(static_cast<Eigen::Index>(node)).head<2>().transpose() - centre;
    if (x != BodyMatrices::held) motion(x) = translation.x() - rotation * arm.y();
    if (y != BodyMatrices::held) motion(y) = translation.y() + rotation * arm.x();
  }
  return motion;
}

/// All ω² of K φ = ω² M φ, ascending.
inline Eigen::VectorXd dense_spectrum(const Eigen::MatrixXd& stiffness,
                                      const Eigen::MatrixXd& mass) {
  return Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd>(stiffness, mass,
                                                                   Eigen::EigenvaluesOnly)
      .eigenvalues();
}

/// Ratio of the largest to the smallest eigenvalue of a symmetric positive definite matrix.
inline double condition_number(const Eigen::MatrixXd& matrix) {
  const Eigen::VectorXd values =
      Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(matrix, Eigen::EigenvaluesOnly).eigenvalues();
  return values(values.size() - 1) / values(0);
}

/// The DoFs that are not in `interface`, ascending.
inline std::vector<int> interior_dofs(const BodyMatrices& body, const std::vector<int>& interface) {
  std::vector<bool> is_kept(static_cast<std::size_t>(body.num_dofs()), true);
  for (const int dof : interface) is_kept[static_cast<std::size_t>(dof)] = false;
  std::vector<int> interior;
  for (int dof = 0; dof < body.num_dofs(); ++dof)
    if (is_kept[static_cast<std::size_t>(dof)]) interior.push_back(dof);
  return interior;
}

/// Rows and columns `dofs` of a sparse matrix.
inline SparseMatrix submatrix(const SparseMatrix& matrix, const std::vector<int>& dofs) {
  std::vector<int> position(static_cast<std::size_t>(matrix.cols()), -1);
  for (std::size_t k = 0; k < dofs.size(); ++k)
    position[static_cast<std::size_t>(dofs[k])] = static_cast<int>(k);
  std::vector<Eigen::Triplet<double>> entries;
  for (const int column : dofs) {
    for (SparseMatrix::InnerIterator entry(matrix, column); entry; ++entry) {
      const int row = position[static_cast<std::size_t>(entry.row())];
      if (row >= 0)
        entries.emplace_back(row, position[static_cast<std::size_t>(column)], entry.value());
    }
  }
  const auto size = static_cast<Eigen::Index>(dofs.size());
  SparseMatrix result(size, size);
  result.setFromTriplets(entries.begin(), entries.end());
  return result;
}

}  // namespace stridor::test
