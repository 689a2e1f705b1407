// Derivatives of one sliding contact on a face of a spinning body.
#include <stdexcept>

#include "solvers/equilibrium/equilibrium.hpp"

namespace stridor {

ContactLinearisation linearise_face(const FaceKinematics& given, const FacePorts& ports,
                                    Eigen::Index num_ports, const FrictionLaw& law,
                                    double friction_factor, const LinearisationTerms& terms) {
  FaceKinematics face = given;
  if (!terms.geometric) {
    face.normal_bending.setZero();
    face.friction_bending.setZero();
  }
  if (!terms.friction_damping) face.turning.setZero();
  const FacePorts normal = face.normal_at(ports);
  Eigen::Matrix<double, num_face_ports, 2> directions, velocities, turned;
  directions << face.along_at(ports), face.across;
  velocities << face.along, face.across;
  turned << FacePorts::Zero(), face.sliding * face.turning;

  ContactLinearisation contact;
  contact.gap = face.gap(ports);
  contact.velocity = face.velocity(ports, FacePorts::Zero());
  const double speed = contact.velocity.norm();
  if (speed > 0.0) contact.sliding_direction = contact.velocity / speed;
  const Eigen::Vector2d& d = contact.sliding_direction;
  contact.slip_velocity = speed;
  if (terms.friction) {
    contact.friction = friction_factor * sliding_friction(law, speed);
    contact.friction_slope = friction_factor * sliding_friction_slope(law, speed);
  }
  contact.gap_row = -normal.head(num_ports);
  contact.force_row = -(normal + contact.friction * (directions * d)).head(num_ports);
  contact.tangent_row = -(velocities * d).head(num_ports);

  Eigen::Matrix2d resistance = Eigen::Matrix2d::Zero();
  if (terms.friction_slope) resistance += contact.friction_slope * d * d.transpose();
  if (terms.friction_damping && contact.friction > 0.0) {
    if (!(speed > 0.0)) {
      throw std::invalid_argument(
          "linearise: friction on a face that does not slide turns without bound; let its body "
          "spin, or leave out the term friction_damping");
    }
    resistance +=
        contact.friction / speed * (Eigen::Matrix2d::Identity() - d * d.transpose());
  }
  const FaceMatrix by_position = directions * resistance * turned.transpose() -
                                 face.normal_bending -
                                 contact.friction * d.x() * face.friction_bending;
  const FaceMatrix by_velocity = directions * resistance * velocities.transpose();
  contact.force_by_position = by_position.topLeftCorner(num_ports, num_ports);
  contact.force_by_velocity = by_velocity.topLeftCorner(num_ports, num_ports);
  contact.shift_row.setZero(num_ports);
  return contact;
}

}  // namespace stridor
