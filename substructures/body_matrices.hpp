// Matrices and interface of every kind of body before its reduction.
#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <array>
#include <map>
#include <string>
#include <vector>

#include "substructures/damping.hpp"

namespace stridor {

using SparseMatrix = Eigen::SparseMatrix<double>;

/// Full model of one component: M ü + C u̇ + K u = f over its free DoFs.
///
/// Displacements are measured from the undeformed place, which follows the drive where the body has
/// a guided support. Nodes carry an x and a y displacement; each is a DoF or is held (`held`).
struct BodyMatrices {
  static constexpr int held = -1;

  SparseMatrix mass;       ///< M, N x N, symmetric positive definite, kg
  SparseMatrix stiffness;  ///< K, N x N, symmetric positive semi-definite, N/m
  RayleighDamping damping;
  /// Terms beside these (CoupledTerms), N x N; both empty where there are none.
  SparseMatrix velocity, circulatory;

  Eigen::Matrix<double, Eigen::Dynamic, 2> nodes;  ///< undeformed positions in the body's frame, m
  std::vector<std::array<int, 2>> node_dofs;       ///< (x, y) DoF of every node, or `held`
  std::map<std::string, int> points;               ///< named nodes
  /// Named outlines: nodes in the order in which the body lies on their right-hand side, so that
  /// the direction turned by +90° points out of the body.
  std::map<std::string, std::vector<int>> surfaces;

  /// DoF that carries the drive's load, or `held` where no support is guided.
  int load_dof = held;
  /// M r over the free DoFs with r the unit translation in x of all nodes, held ones included; kg.
  /// Empty where no support is guided.
  Eigen::VectorXd base_inertia;

  Eigen::Index num_dofs() const { return mass.rows(); }
  bool follows_drive() const { return load_dof != held; }
};

}  // namespace stridor
