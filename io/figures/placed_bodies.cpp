#include "io/figures/placed_bodies.hpp"

#include <Eigen/Geometry>

#include "substructures/reduction/recovery.hpp"

namespace stridor {

std::optional<Eigen::Vector3d> normal_in_space(const System& system, const ContactPoint& contact) {
  if (!contact.space) return std::nullopt;
  const FacetSurface* surface = system.facets_of(contact);
  if (surface == nullptr) return contact.space->normal;
  const auto& nodes = surface->facets[static_cast<std::size_t>(contact.space->first_facet)].nodes;
  const auto corner = [&](std::size_t k) -> const Eigen::Vector3d& {
    return surface->positions[static_cast<std::size_t>(nodes[k])];
  };
  return (corner(1) - corner(0)).cross(corner(2) - corner(0)).normalized();
}

PlacedBodies::PlacedBodies(const PlacedModel& model) : model_(&model) {
  std::vector<double> outer_radii;
  for (const ModelBody& body : model.bodies) {
    outer_radii.push_back(outer_radius_of_faces(body.matrices));
    has_faces_ = has_faces_ || !body.matrices.faces.empty();
  }
  seats_ = face_seats(model.system.contacts, outer_radii);
  for (std::size_t b = 0; b < model.bodies.size(); ++b) {
    Eigen::MatrixX3d& places = nodes_.emplace_back(0, 3);
    if (model.bodies[b].parameters == nullptr) continue;
    places = node_places(model.bodies[b].matrices);
    for (Eigen::Index i = 0; i < places.rows(); ++i)
      places.row(i) = at(b, places.row(i).transpose()).transpose();
  }
}

Eigen::Vector3d PlacedBodies::at(std::size_t body, const Eigen::Vector3d& in_body) const {
  const Eigen::Vector3d place = unrolled(body, in_body);
  return seats_[body] ? seats_[body]->place(place) : place;
}

/// Before a body on a face stands about its axis.
Eigen::Vector3d PlacedBodies::unrolled(std::size_t body, const Eigen::Vector3d& in_body) const {
  const ModelBody& one = model_->bodies[body];
  Eigen::Vector3d place = in_body;
  place.head(one.place.size()) += one.place;
  if (one.is_mirrored) place.y() *= -1.0;
  return place;
}

Eigen::Vector3d PlacedBodies::direction(std::size_t body, const Eigen::Vector3d& in_body,
                                        Eigen::Vector3d along) const {
  if (model_->bodies[body].is_mirrored) along.y() *= -1.0;
  return seats_[body] ? seats_[body]->directions(unrolled(body, in_body)) * along : along;
}

std::optional<Eigen::Vector3d> PlacedBodies::normal_of(const ContactPoint& contact) const {
  if (contact.face) return Eigen::Vector3d(contact.face->side * Eigen::Vector3d::UnitZ());
  if (contact.surface < 0) return std::nullopt;
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
  const Eigen::Vector2d slave = contact.slave_position.head(2);
  normal.head(2) =
      model_->system.surface_of(contact).project_undeformed(contact.first_segment, slave).normal;
  return normal;
}

Eigen::Vector3d PlacedBodies::ground_side(std::size_t body, const BodySpring& spring) const {
  const Eigen::Vector3d behind = -direction(body, spring.at, spring.along);
  for (const ContactPoint& contact : model_->system.contacts) {
    if (contact.slave_body != static_cast<int>(body)) continue;
    const std::optional<Eigen::Vector3d> away =
        contact.space ? normal_in_space(model_->system, contact) : normal_of(contact);
    if (!away) continue;
    constexpr double along_the_normal = 0.5;
    return away->dot(behind) < -along_the_normal ? Eigen::Vector3d(-behind) : behind;
  }
  return behind;
}

}  // namespace stridor
