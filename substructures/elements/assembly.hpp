// Mass, stiffness and loads of a whole mesh.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <vector>

#include "substructures/elements/mesh.hpp"
#include "substructures/elements/solid_element.hpp"
#include "substructures/matrices/body_matrices.hpp"

namespace stridor {

/// What the elements of a mesh are made of.
struct MeshSections {
  std::vector<ElementSection> sections;
  std::vector<int> of_element;  ///< of `sections`, one per element of the mesh

  const ElementSection& of(std::size_t element) const {
    return sections[static_cast<std::size_t>(of_element[element])];
  }
};
/// One section for all elements.
MeshSections one_section(const Mesh& mesh, const ElementSection& section);

/// Both triangles; DoF `dimension` x node + direction.
struct MeshMatrices {
  SparseMatrix stiffness;  ///< K, N/m
  SparseMatrix mass;       ///< M, kg, consistent; couples no direction with another
};

/// Sum of all elements. Nodes of no element have empty rows: see nodes_without_elements().
///
/// Memory is that of the result, 12 bytes per entry, and 4 bytes per pair of neighbouring nodes;
/// time is linear in the number of elements.
///
/// @throws std::invalid_argument naming the first element whose Jacobian is not positive; for a
///   section of another dimension, without positive density or thickness; for other than one
///   section per element; if the stiffness had 2³¹ entries or more
MeshMatrices assemble_mesh(const Mesh& mesh, const MeshSections& sections);

/// What the matrices of the elements of a section are multiplied by.
struct SectionFactors {
  double stiffness = 0.0;
  double mass = 0.0;
};
/// Σ of factor x element matrix, over the elements of which the section has one that is not 0.
/// @param factors one per section
/// @throws std::invalid_argument as assemble_mesh(), or for another number of factors
MeshMatrices assemble_mesh(const Mesh& mesh, const MeshSections& sections,
                           std::span<const SectionFactors> factors);

/// Nodes that no element has, ascending.
std::vector<int> nodes_without_elements(const Mesh& mesh);

/// Displacements of all DoFs in unit translations along the axes (2 or 3 columns), then in
/// rotations by 1 rad about the axes through the mean of the nodes (1 or 3, in a plane about z).
Eigen::MatrixXd rigid_motions(const Mesh& mesh);

struct MassProperties {
  double volume = 0.0;                               ///< m³
  double mass = 0.0;                                 ///< m, kg
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  ///< of mass, m
  Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();  ///< ∫ ρ (|r|² 1 − r rᵀ) dV about it, kg m²
};
/// Of all elements; planar ones have no inertia from their thickness.
/// @throws std::invalid_argument as assemble_mesh()
MassProperties mass_properties(const Mesh& mesh, const MeshSections& sections);

/// A side of an element: what follows of its shape functions.
struct SideGeometry {
  double area = 0.0;                                 ///< m²; of planar elements length x thickness
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();  ///< mean, out of the body, of length 1
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  ///< mean place, m
};
/// @throws std::invalid_argument for a side without area
SideGeometry side_geometry(const Mesh& mesh, const MeshSections& sections, const ElementSide& side);

/// ∫ N_a dA of every node of the mesh over sides, m²: its share of an even load. Negative at the
/// corners of quad8 faces and zero at those of tri6 faces, as is right.
Eigen::VectorXd node_areas(const Mesh& mesh, const MeshSections& sections,
                           std::span<const ElementSide> sides);

/// Forces on all DoFs of a traction that is the same everywhere on sides: ∫ N_a t dA, N.
/// @param traction t, Pa; the third component does not matter in a plane
Eigen::VectorXd traction_load(const Mesh& mesh, const MeshSections& sections,
                              std::span<const ElementSide> sides, const Eigen::Vector3d& traction);

/// Forces on all DoFs of an even pressure, against the normal: −∫ N_a p n dA, N.
/// @param pressure p, Pa
Eigen::VectorXd pressure_load(const Mesh& mesh, const MeshSections& sections,
                              std::span<const ElementSide> sides, double pressure);

}  // namespace stridor
