#include "models/face_seats.hpp"

#include <cmath>

namespace stridor {

double FaceSeat::angle_at(const Eigen::Vector3d& unrolled) const {
  return angle + (unrolled.x() - outer_radius * angle) / radius;
}

Eigen::Vector3d FaceSeat::place(const Eigen::Vector3d& unrolled) const {
  const double at = angle_at(unrolled);
  const double distance = radius + unrolled.z();
  return {distance * std::cos(at), distance * std::sin(at), unrolled.y()};
}

Eigen::Matrix3d FaceSeat::directions(const Eigen::Vector3d& unrolled) const {
  const double at = angle_at(unrolled);
  Eigen::Matrix3d columns;
  columns.col(0) << -std::sin(at), std::cos(at), 0.0;
  columns.col(1) = Eigen::Vector3d::UnitZ();
  columns.col(2) << std::cos(at), std::sin(at), 0.0;
  return columns;
}

std::vector<std::optional<FaceSeat>> face_seats(const std::vector<ContactPoint>& contacts,
                                                const std::vector<double>& outer_radii) {
  std::vector<std::optional<FaceSeat>> seats(outer_radii.size());
  for (std::size_t b = 0; b < outer_radii.size(); ++b)
    if (outer_radii[b] > 0.0) seats[b] = FaceSeat{outer_radii[b], outer_radii[b], 0.0};
  for (const ContactPoint& contact : contacts) {
    if (!contact.face) continue;
    const FacePlace& face = *contact.face;
    seats[static_cast<std::size_t>(contact.slave_body)] = FaceSeat{
        outer_radii[static_cast<std::size_t>(face.body)], face.radius, face.angle - face.turned};
  }
  return seats;
}

double outer_radius_of_faces(const BodyMatrices& body) {
  return body.faces.empty() ? 0.0 : body.faces.begin()->second.outer_radius;
}

}  // namespace stridor
