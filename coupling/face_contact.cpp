#include "coupling/face_contact.hpp"

namespace stridor {
namespace {

/// s (h/2), m.
double lever(const FaceContact& contact) {
  return contact.side * contact.half_thickness;
}

}  // namespace

Eigen::VectorXd FaceContact::gap() const {
  return side * (pad_z - plate.w);
}

Eigen::VectorXd FaceContact::friction() const {
  return lever(*this) / radius * plate.w_phi + pad_phi;
}

Eigen::VectorXd FaceContact::across() const {
  return lever(*this) * plate.w_r + pad_r;
}

Eigen::MatrixXd normal_preload_stiffness(const FaceContact& contact, double normal_force) {
  const Eigen::VectorXd& g_r = contact.plate.w_r;
  const Eigen::VectorXd g_phi = contact.plate.w_phi / contact.radius;
  const Eigen::MatrixXd slope = g_r * g_r.transpose() + g_phi * g_phi.transpose();
  const Eigen::MatrixXd shift =
      g_r * contact.pad_r.transpose() + g_phi * contact.pad_phi.transpose();
  return normal_force *
         (contact.half_thickness * slope + contact.side * (shift + shift.transpose()));
}

Eigen::MatrixXd friction_preload_stiffness(const FaceContact& contact, double friction_force) {
  const PlateRows& plate = contact.plate;
  const double r = contact.radius;
  const Eigen::VectorXd g_phi = plate.w_phi / r;
  const Eigen::VectorXd H_r_phi = plate.w_r_phi / r - plate.w_phi / (r * r);
  const Eigen::VectorXd H_phi_phi = plate.w_phi_phi / (r * r) + plate.w_r / r;
  return friction_force * ((plate.w - contact.pad_z) * g_phi.transpose() -
                           lever(contact) * (H_r_phi * contact.across().transpose() +
                                             H_phi_phi * contact.friction().transpose()));
}

Eigen::MatrixXd friction_damping(const FaceContact& contact, double friction_force, double speed) {
  const Eigen::VectorXd a = contact.across();
  return friction_force / (speed * contact.radius) * a * a.transpose();
}

Eigen::MatrixXd friction_turning_stiffness(const FaceContact& contact, double friction_force) {
  const Eigen::VectorXd turning =
      (contact.pad_phi + lever(contact) * contact.plate.w_r_phi) / contact.radius;
  return friction_force * contact.across() * turning.transpose();
}

}  // namespace stridor
