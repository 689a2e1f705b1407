// What scenes attach to a mesh: supports, guide, points, rigid regions, ties, masses, loads.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/schema.hpp"
#include "substructures/bodies/mesh_material.hpp"

namespace stridor {

/// Nodes that are held, or a rigid region that is.
struct MeshSupportParameters {
  std::vector<std::string> on;            ///< surfaces, node sets or rigid regions
  std::vector<std::string> held;          ///< directions; empty: all
  std::optional<AxisParameters> about{};  ///< of the directions radial, tangential and axial
  static const Schema& schema();
};

/// Nodes that follow the drive, and share one displacement along y on which its load acts.
struct MeshGuideParameters {
  std::vector<std::string> on;  ///< surfaces or node sets
  static const Schema& schema();
};

/// A point of the body.
struct MeshPointParameters {
  std::vector<double> at;            ///< place in the mesh, m; within an element: interpolated
  std::optional<std::int64_t> node;  ///< label in the file
  std::string mean_of;               ///< a surface: its mean displacement; a node set: its nodes'
  bool rotation = false;             ///< of `mean_of`: its mean rotation is a point as well
  static const Schema& schema();
};

/// Nodes that move as one rigid body.
struct MeshRigidRegionParameters {
  std::vector<std::string> on;  ///< surfaces or node sets
  std::vector<double> at;       ///< place of its point, m; empty: the mean of its nodes
  static const Schema& schema();
};

/// Nodes of one surface that move as the faces of another one do.
struct MeshTieParameters {
  std::string slave, master;        ///< surfaces
  std::optional<double> tolerance;  ///< m; default: 5 % of the size of a face
  bool partial = false;             ///< nodes that are off the master stay free
  static const Schema& schema();
};

/// A rigid mass at a point.
struct MeshMassParameters {
  std::string on;               ///< a point or rigid region
  double mass = 0.0;            ///< kg, >= 0
  std::vector<double> inertia;  ///< of a rigid region: J about z, or J_xx, J_yy, J_zz, kg m²
  static const Schema& schema();
};

/// A load of 1 N on surfaces, along their normals or in one direction.
struct MeshLoadParameters {
  std::vector<std::string> on;    ///< surfaces
  std::vector<double> direction;  ///< of any length; empty: a pressure
  static const Schema& schema();
};

}  // namespace stridor
