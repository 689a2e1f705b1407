// Derivatives of one sliding contact with two tangents.
#include <stdexcept>

#include "solvers/equilibrium/equilibrium.hpp"

namespace stridor {
namespace {

/// Directions and velocity of the undeformed bodies; the gap is linear in the displacements.
TangentKinematics undeformed_in_space(const System& system, const ContactPoint& point,
                                      const ContactEquilibrium& contact) {
  const TangentPorts rest = TangentPorts::Zero(contact.ports.size());
  const SpaceInstant instant = space_instant(*point.space, system.facets_of(point), contact.segment,
                                             contact.displaced, rest, contact.drawn);
  TangentKinematics found = tangent_kinematics(instant, contact.place, rest.size());
  found.drop_bending();
  found.turning.setZero();
  found.gap += found.normal.dot(contact.ports);
  return found;
}

}  // namespace

TangentKinematics tangent_kinematics(const System& system, const ContactPoint& point,
                                     const ContactEquilibrium& contact, ContactGeometry geometry,
                                     const LinearisationTerms& terms) {
  if (point.face) {
    FaceKinematics face = make_face_kinematics(*point.face);
    if (!terms.geometric) {
      face.normal_bending.setZero();
      face.friction_bending.setZero();
    }
    if (!terms.friction_damping) face.turning.setZero();
    return tangent_kinematics(face, contact.ports);
  }
  if (geometry == ContactGeometry::undeformed) return undeformed_in_space(system, point, contact);
  const SpaceInstant instant = space_instant(*point.space, system.facets_of(point), contact.segment,
                                             contact.displaced, contact.ports, contact.drawn);
  TangentKinematics found = tangent_kinematics(instant, contact.place, contact.ports.size());
  if (!terms.geometric) found.drop_bending();
  if (!terms.friction_damping) found.turning.setZero();
  return found;
}

ContactLinearisation linearise_face(const TangentKinematics& kinematics, Eigen::Index num_ports,
                                    const FrictionLaw& law, double friction_factor,
                                    const LinearisationTerms& terms) {
  ContactLinearisation contact;
  contact.gap = kinematics.gap;
  contact.velocity = kinematics.velocity;
  const double speed = contact.velocity.norm();
  if (speed > 0.0) contact.sliding_direction = contact.velocity / speed;
  const Eigen::Vector2d& d = contact.sliding_direction;
  contact.slip_velocity = speed;
  if (terms.friction) {
    contact.friction = friction_factor * sliding_friction(law, speed);
    contact.friction_slope = friction_factor * sliding_friction_slope(law, speed);
  }
  const TangentPorts& normal = kinematics.normal;
  contact.gap_row = -normal.head(num_ports);
  contact.force_row = -(normal + contact.friction * (kinematics.friction * d)).head(num_ports);
  contact.tangent_row = -(kinematics.sliding * d).head(num_ports);

  Eigen::Matrix2d resistance = Eigen::Matrix2d::Zero();
  if (terms.friction_slope) resistance += contact.friction_slope * d * d.transpose();
  if (terms.friction_damping && contact.friction > 0.0) {
    if (!(speed > 0.0)) {
      throw std::invalid_argument(
          "linearise: friction on a face that does not slide turns without bound; let its body "
          "spin, or a drive move one of the two, or leave out the term friction_damping");
    }
    resistance +=
        contact.friction / speed * (Eigen::Matrix2d::Identity() - d * d.transpose());
  }
  const TangentMatrix by_position =
      kinematics.friction * resistance * kinematics.turning.transpose() -
      kinematics.normal_bending -
      contact.friction * (d.x() * kinematics.friction_bending[0] +
                          d.y() * kinematics.friction_bending[1]);
  const TangentMatrix by_velocity =
      kinematics.friction * resistance * kinematics.sliding.transpose();
  contact.force_by_position = by_position.topLeftCorner(num_ports, num_ports);
  contact.force_by_velocity = by_velocity.topLeftCorner(num_ports, num_ports);
  contact.shift_row.setZero(num_ports);
  return contact;
}

}  // namespace stridor
