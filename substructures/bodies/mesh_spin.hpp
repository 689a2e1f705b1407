// Bodies of revolution from meshes that spin about their axis.
#pragma once

#include <vector>

#include "core/schema.hpp"
#include "substructures/bodies/mesh_material.hpp"
#include "substructures/matrices/body_matrices.hpp"

namespace stridor {

/// Whether a body spins as a whole or its surfaces alone.
enum class SpinSliding {
  moving,  ///< the body, which is one of revolution, seen from space
  frozen,  ///< its surfaces alone: the body stands as its mesh has it, whatever its shape
};

/// Spin of a body about its axis (docs/theory.md, 10.9).
struct MeshSpinParameters {
  double speed = 0.0;           ///< Ω, rad/s
  AxisParameters about;         ///< right-handed
  bool centrifugal = true;      ///< whether the stress of the rotation stiffens the body
  SpinSliding sliding = SpinSliding::moving;
  static const Schema& schema();
};

class NamedMesh;
struct MeshBodyParameters;
struct MeshConstraints;

/// Adds BodyMatrices::spin to a body that is complete but for it.
/// @param viscous the damping of its materials beside RayleighDamping, N x N; or empty
/// @throws ConfigError with key paths below the body, where it is not one of revolution
void add_mesh_spin(const MeshBodyParameters& parameters, const NamedMesh& mesh,
                   const MeshConstraints& constraints, const SparseMatrix& viscous,
                   BodyMatrices& body);

/// Warns of a body that repeats itself around the axis: its matrices change with the turn, which is left out.
void warn_of_sectors(const MeshBodyParameters& parameters, std::vector<Problem>& warnings);

}  // namespace stridor
