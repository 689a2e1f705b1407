// Matrices of a body that spins about an axis, seen from space.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "substructures/elements/assembly.hpp"
#include "substructures/elements/material_axes.hpp"

namespace stridor {

/// How displacements change along circles about an axis (docs/theory.md, 10.9).
///
/// A body of revolution stays where it is while it spins, so that its displacement u(x, t) is a
/// field over places in space. Its material passes there with Ω e x (x − p), hence a particle has
///
///   velocity  Ω e x (x − p) + ∂u/∂t + Ω ∂_φ u,  ∂_φ u = ((e x (x − p))·∇) u
///
/// for the components of u along axes at rest. Matrices between nodes, alike in every direction:
struct SpinMatrices {
  SparseMatrix gyroscopic;  ///< G = ∫ ρ N_a ∂_φ N_b dV, kg; its skew part, which is all of a body of
                            ///< revolution
  SparseMatrix convected;   ///< ∫ ρ ∂_φ N_a ∂_φ N_b dV, kg
};
/// @throws std::invalid_argument as assemble_mesh(); for planar meshes
SpinMatrices assemble_spin(const Mesh& mesh, const MeshSections& sections,
                           const AxisOfRevolution& axis);

/// ∂_φ u at the nodes from u at the nodes: the mean of the elements that share a node, weighted by
/// their volumes. Between nodes, alike in every direction.
SparseMatrix derivative_around(const Mesh& mesh, const AxisOfRevolution& axis);

/// ∫ ρ N_a r dV, with r the vector from the axis: forces on all DoFs for Ω = 1 rad/s, kg m.
Eigen::VectorXd centrifugal_load(const Mesh& mesh, const MeshSections& sections,
                                 const AxisOfRevolution& axis);

/// Σ ∫ ∇N_a·σ ∇N_b dV between nodes, alike in every direction, with the stress σ of displacements:
/// what it adds to the stiffness.
/// @param displacements of all DoFs
/// @throws std::invalid_argument as assemble_mesh(); for planar meshes
SparseMatrix stress_stiffness(const Mesh& mesh, const MeshSections& sections,
                              const Eigen::VectorXd& displacements);

/// X ⊗ 1: a matrix between nodes as one between DoFs, `dimension` x node + direction.
SparseMatrix in_every_direction(const SparseMatrix& between_nodes, int dimension);

/// How much a body differs from a body of revolution.
struct Roundness {
  double eccentricity = 0.0;  ///< distance of the centre of mass from the axis, m
  /// |∫ ρ e^{imφ} dV| over the mass for m = 1, 2, …, or the same of tr D in the place of ρ, whichever is more
  std::vector<double> harmonics;
  /// Greatest number of equal sectors that those harmonics allow which are not negligible: 0 for a
  /// body of revolution, 1 for one without any symmetry.
  int num_sectors = 0;

  /// The m of the largest harmonics which together leave fewer than three equal sectors, largest
  /// first; none where there are three or more.
  std::vector<int> without_sectors() const;
};
Roundness roundness(const Mesh& mesh, const MeshSections& sections, const AxisOfRevolution& axis);

}  // namespace stridor
