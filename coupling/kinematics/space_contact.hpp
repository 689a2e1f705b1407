// Kinematics of a point on a rigid plane or on the facets of a body.
#pragma once

#include <string>

#include "coupling/kinematics/facet_surface.hpp"
#include "coupling/kinematics/tangent_kinematics.hpp"

namespace stridor {

/// Where a contact in space stands at the start.
struct SpacePlace {
  std::string name;  ///< "<body>.<surface>", or "rigid"
  int body = 0;
  int surface = -1;      ///< index into System::facet_surfaces; −1 on a rigid plane
  int first_facet = 0;   ///< under the undeformed slave point
  Eigen::Vector3d slave = Eigen::Vector3d::Zero();   ///< undeformed, global, m
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();  ///< a point of the rigid plane, m
  Eigen::Vector3d normal = Eigen::Vector3d::UnitY();  ///< of the rigid plane, out of it, unit length
  /// The first tangent is the part of this unit vector along the surface.
  Eigen::Vector3d reference = Eigen::Vector3d::UnitX();
};

/// The direction to which first tangents are referred, by the normal at the start: x, or z where the
/// normal is nearly along x.
Eigen::Vector3d reference_for(const Eigen::Vector3d& normal);

/// Directions at a place of a master.
struct SpaceFrame {
  Eigen::Vector3d normal;                 ///< n, out of the master
  std::array<Eigen::Vector3d, 2> tangents;  ///< t₁ along the reference, t₂ = n × t₁
};
SpaceFrame space_frame(const Eigen::Vector3d& normal, const Eigen::Vector3d& reference);

/// A slave over one facet, or over a rigid plane, for given displacements.
struct SpaceInstant {
  Eigen::Vector3d slave;    ///< displaced, as seen from the undeformed first node of the facet, or from
                            ///< the origin of the plane, m
  FacetPatch undeformed;    ///< of a facet
  FacetPatch deformed;
  bool is_plane = false;
  Eigen::Vector3d plane_normal = Eigen::Vector3d::UnitY();
  Eigen::Vector3d reference = Eigen::Vector3d::UnitX();
  double drawn = 0.0;  ///< velocity of the slave against the master in +x by drives, m/s
  Eigen::Vector3d spin = Eigen::Vector3d::Zero();    ///< FacetSurface::spin
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  ///< of its axis, as seen from the first node, m

  int num_nodes() const { return is_plane ? 0 : deformed.count; }
};

/// @param surface   null on a rigid plane
/// @param facet     of it
/// @param displaced of the slave against the master in +x by drives, m
/// @param ports     y
/// @param drawn     the velocity of that, m/s
SpaceInstant space_instant(const SpacePlace& at, const FacetSurface* surface, int facet,
                           double displaced, const TangentPorts& ports, double drawn = 0.0);

/// Geometry of a contact at one place, (ξ, η) of its facet.
struct SpaceGeometry {
  SpaceFrame frame;
  double gap = 0.0;                          ///< along the normal, m
  std::array<double, 4> weights{};           ///< of the nodes
  Eigen::Vector3d material = Eigen::Vector3d::Zero();  ///< place of the undeformed master, as seen from
                                                       ///< the first node or the origin, m
  /// F: takes small vectors along the undeformed surface of the master to the deformed one.
  Eigen::Matrix3d stretch = Eigen::Matrix3d::Identity();
  Eigen::Matrix3d unstretch = Eigen::Matrix3d::Identity();  ///< and back
  /// F Ω e x (x − p): velocity of the material of a spinning master here while its displacement stays,
  /// along its deformed surface, m/s (docs/theory.md, 10.9).
  Eigen::Vector3d carried = Eigen::Vector3d::Zero();
};

SpaceGeometry space_geometry(const SpaceInstant& instant, const Eigen::Vector2d& place);

/// Rows, e·(u_C − Σ w_k u_k), of a direction e at the ports: nodes x, y, z each, then the slave.
/// @param num_ports at which they end; entries of nodes that a facet lacks are 0
TangentPorts space_row(const Eigen::Vector3d& direction, const std::array<double, 4>& weights,
                       int num_nodes, Eigen::Index num_ports);

/// Gap, rows and their exact derivatives at the closest point (docs/theory.md, 2.7).
/// @param place     of closest_on(), or of the undeformed bodies
/// @param num_ports as of space_row()
TangentKinematics tangent_kinematics(const SpaceInstant& instant, const Eigen::Vector2d& place,
                                     Eigen::Index num_ports);

}  // namespace stridor
