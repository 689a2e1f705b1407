// Where bodies on the faces of a spinning plate stand in space, and the plate itself.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "coupling/system/system.hpp"
#include "substructures/matrices/body_matrices.hpp"

namespace stridor {

/// Where a body stands about the axis of a plate. Frames of such bodies are unrolled: x along the
/// outer edge of the plate, y along its axis, z outwards; in space the axis is along z.
struct FaceSeat {
  double outer_radius = 0.0;  ///< of the plate, m, > 0
  double radius = 0.0;        ///< of z = 0 of the frame, m, > 0
  double angle = 0.0;         ///< of the middle of the body, rad

  /// In space.
  /// @param unrolled m
  Eigen::Vector3d place(const Eigen::Vector3d& unrolled) const;
  /// Directions of x, y and z of the unrolled frame at a place of it, as columns.
  Eigen::Matrix3d directions(const Eigen::Vector3d& unrolled) const;

 private:
  double angle_at(const Eigen::Vector3d& unrolled) const;
};

/// The seat of every body that is a plate or stands on a face of one.
/// @param outer_radii of the bodies with faces, m; 0 for others
std::vector<std::optional<FaceSeat>> face_seats(const std::vector<ContactPoint>& contacts,
                                                const std::vector<double>& outer_radii);

/// Outer radius of the faces of a body; 0 without.
double outer_radius_of_faces(const BodyMatrices& body);

}  // namespace stridor
