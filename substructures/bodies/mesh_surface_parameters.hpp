// Surfaces of meshes by where they are, as scenes describe them.
#pragma once

#include <optional>
#include <vector>

#include "core/schema.hpp"
#include "substructures/elements/mesh_surfaces.hpp"

namespace stridor {

/// Two or three components of a scene; the third is 0 where it is not given.
Eigen::Vector3d in_space(const std::vector<double>& components);
/// Adds a problem unless there are two or three, or none where that may be.
void expect_components(const std::vector<double>& given, const char* key, bool may_be_empty,
                       std::vector<Problem>& problems);

/// A flat surface.
struct MeshPlaneParameters {
  std::vector<double> normal;  ///< two or three components, of any length
  double offset = 0.0;         ///< of the plane from the origin along the normal, m
  static const Schema& schema();
};

/// A round surface.
struct MeshCylinderParameters {
  std::vector<double> point;  ///< of the axis, m; empty: the origin
  std::vector<double> axis;   ///< of any length; empty: z
  double radius = 0.0;        ///< m
  static const Schema& schema();
};

/// What is between two corners.
struct MeshBoxParameters {
  std::vector<double> lowest, highest;  ///< m
  static const Schema& schema();
};

/// A surface of the mesh by where it is: outer sides of elements of which all nodes lie there.
struct MeshSurfaceParameters {
  std::optional<MeshPlaneParameters> plane;
  std::optional<MeshCylinderParameters> cylinder;
  std::optional<MeshBoxParameters> box;
  std::optional<double> tolerance;  ///< m; default: 1e-6 of the extent of the mesh
  static const Schema& schema();

  MeshRegion region() const;
};

}  // namespace stridor
