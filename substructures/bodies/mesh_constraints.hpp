// How the displacements of a mesh follow from the DoFs of its body.
#pragma once

#include <Eigen/Core>
#include <array>
#include <map>
#include <string>
#include <vector>

#include "substructures/bodies/named_mesh.hpp"
#include "substructures/matrices/body_matrices.hpp"

namespace stridor {

/// The motion of nodes that move as one rigid body: u = u_0 + θ x (x − x_0).
struct RigidRegion {
  Eigen::Vector3d at = Eigen::Vector3d::Zero();  ///< x_0, m
  std::array<DofSum, 3> displacement;            ///< u_0
  std::array<DofSum, 3> rotation;                ///< θ, rad; in a plane about z alone
};

/// u = A q (docs/theory.md, 1.7).
struct MeshConstraints {
  std::vector<DofSum> rows;  ///< of A: `dimension` x node + direction; empty where held
  /// Of matrices from elsewhere: DoF of every row that is no displacement of a node, `held` where the
  /// row is one of these or is held.
  std::vector<int> others;
  int num_dofs = 0;
  int load_dof = BodyMatrices::held;  ///< shared by guided nodes, or `held`
  std::map<std::string, RigidRegion> regions;
  /// DoFs without which nothing is left of the rigid motions that supports leave free: a reduction
  /// keeps them, so that what it solves for inside is held. Empty where the body is held.
  std::vector<int> determinate;

  /// A, with a column for each DoF.
  SparseMatrix matrix() const;
  /// The same with the rows of matrices from elsewhere.
  SparseMatrix matrix(const NodalMatrices& given) const;
};

/// Applies supports, guide, rigid regions and ties. Nodes that are tied are moved onto the faces of
/// their masters.
/// @throws ConfigError with key paths below the body
MeshConstraints make_constraints(const MeshBodyParameters& parameters, NamedMesh& mesh);

}  // namespace stridor
