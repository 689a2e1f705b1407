// Contacts with two tangents: gap, slip and directions of forces at the ports of both bodies.
#pragma once

#include <Eigen/Core>

#include "coupling/kinematics/face_kinematics.hpp"

namespace stridor {

/// Ports of a contact with two tangents: those of the master, then x, y and z of the slave's point.
/// On the face of a spinning body these are FacePorts, on facets x, y and z of their nodes; a rigid
/// plane has none.
inline constexpr int max_facet_ports = 12;
inline constexpr int max_tangent_ports = max_facet_ports + 3;
using TangentPorts = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, max_tangent_ports, 1>;
using TangentMatrix =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, max_tangent_ports, max_tangent_ports>;
using TangentPair =
    Eigen::Matrix<double, Eigen::Dynamic, 2, 0, max_tangent_ports, 2>;

/// Gap, sliding velocity and directions of a contact with two tangents where it is, and their
/// derivatives by the displacements y of its ports (docs/theory.md, 10.2 and 2.7). Forces act along
/// N λ + F τ; the master slides past the slave with v − Tᵀ ẏ.
struct TangentKinematics {
  double gap = 0.0;                  ///< m
  Eigen::Vector2d velocity{0.0, 0.0};  ///< v for ẏ = 0, m/s
  TangentPorts normal;               ///< N, also the derivative of the gap
  TangentPair friction;              ///< F
  TangentPair sliding;               ///< T
  TangentMatrix normal_bending;      ///< ∂N/∂y, 1/m
  std::array<TangentMatrix, 2> friction_bending;  ///< ∂F/∂y of either direction, 1/m
  TangentPair turning;               ///< −∂v/∂y, 1/s

  Eigen::Index num_ports() const { return normal.size(); }
  /// Leaves out how directions turn and shift.
  void drop_bending();
};

/// Of the face of a spinning body.
/// @param ports y
TangentKinematics tangent_kinematics(const FaceKinematics& face, const FacePorts& ports);

}  // namespace stridor
