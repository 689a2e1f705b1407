#include "tests/support/face_contact.hpp"

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

Eigen::VectorXd FaceContact::turning() const {
  return (pad_phi + lever(*this) * plate.w_r_phi) / radius;
}

Eigen::MatrixXd FaceContact::bending_forces() const {
  const double r = radius;
  Eigen::MatrixXd forces(plate.w.size(), num_bending);
  forces << plate.w_r, plate.w_phi / r, pad_r, pad_phi, plate.w_r_phi / r - plate.w_phi / (r * r),
      plate.w_phi_phi / (r * r) + plate.w_r / r, gap();
  return forces;
}

Eigen::MatrixXd FaceContact::normal_bending() const {
  const Eigen::VectorXd g_phi = plate.w_phi / radius;
  Eigen::MatrixXd depends = Eigen::MatrixXd::Zero(num_bending, plate.w.size());
  depends.row(0) = -half_thickness * plate.w_r - side * pad_r;
  depends.row(1) = -half_thickness * g_phi - side * pad_phi;
  depends.row(2) = -side * plate.w_r;
  depends.row(3) = -side * g_phi;
  return depends;
}

Eigen::MatrixXd FaceContact::friction_bending() const {
  Eigen::MatrixXd depends = Eigen::MatrixXd::Zero(num_bending, plate.w.size());
  depends.row(4) = lever(*this) * across();
  depends.row(5) = lever(*this) * friction();
  depends.row(6) = side / radius * plate.w_phi;
  return depends;
}

FaceContactPoint face_contact_point(const FaceContact& contact, const FaceContactLaw& law,
                                    const Eigen::VectorXd& displacement, double normal_force) {
  FaceContactPoint point;
  point.force = normal_force;
  point.normal = contact.gap();
  point.along = contact.friction();
  point.gap = point.normal.dot(displacement);
  if (law.forces_bend) {
    const Eigen::MatrixXd forces = contact.bending_forces();
    const Eigen::VectorXd turned = forces * (contact.normal_bending() * displacement);
    point.gap += 0.5 * turned.dot(displacement);
    point.normal += turned;
    point.along += forces * (contact.friction_bending() * displacement);
  }
  const double sliding = law.speed * contact.radius;
  point.velocity = {sliding, 0.0};
  if (law.friction_turns) {
    point.velocity.y() = -sliding * contact.turning().dot(displacement);
    point.direction = point.velocity.normalized();
  }
  return point;
}

FaceSlidingState prescribed_sliding_state(const std::vector<FaceContact>& contacts,
                                          const FaceContactLaw& law, double normal_force) {
  FaceSlidingState state;
  for (const FaceContact& contact : contacts) {
    state.displacement = Eigen::VectorXd::Zero(contact.plate.w.size());
    state.contacts.push_back(face_contact_point(contact, law, state.displacement, normal_force));
    // Undeformed bodies overlap as far as springs need for the force.
    if (law.penalty) state.contacts.back().gap = -normal_force / *law.penalty;
  }
  return state;
}

Eigen::VectorXd unit_force(const FaceContact& contact, const FaceContactLaw& law,
                           const FaceContactPoint& point) {
  return point.normal + law.friction * (point.direction.x() * point.along +
                                        point.direction.y() * contact.across());
}

Eigen::Matrix2d turning_resistance(const FaceContactLaw& law, const FaceContactPoint& point) {
  if (!law.friction_turns) return Eigen::Matrix2d::Zero();
  const Eigen::Vector2d& d = point.direction;
  return law.friction * point.force / point.velocity.norm() *
         (Eigen::Matrix2d::Identity() - d * d.transpose());
}

LinearSystem linearise(const LinearSystem& bodies, const std::vector<FaceContact>& contacts,
                       const FaceContactLaw& law, const FaceSlidingState& state) {
  LinearSystem system = bodies;
  const Eigen::Index n = bodies.size();
  std::vector<Eigen::VectorXd> gaps, forces;
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const FaceContact& contact = contacts[i];
    const FaceContactPoint& point = state.contacts[i];
    if (!point.is_closed) continue;
    const double friction_force = law.friction * point.force;
    if (law.forces_bend) {
      system.position -= contact.bending_forces() *
                         (point.force * contact.normal_bending() +
                          friction_force * point.direction.x() * contact.friction_bending());
    }
    if (law.friction_turns && friction_force > 0.0) {
      Eigen::MatrixXd directions(n, 2), velocities(2, n), turned(2, n);
      directions << point.along, contact.across();
      velocities << contact.friction().transpose(), contact.across().transpose();
      turned.row(0).setZero();
      turned.row(1) = law.speed * contact.radius * contact.turning();
      const Eigen::MatrixXd resisting = directions * turning_resistance(law, point);
      system.velocity += resisting * velocities;
      system.position += resisting * turned;
    }
    gaps.push_back(point.normal);
    forces.push_back(unit_force(contact, law, point));
    if (law.penalty) system.position += *law.penalty * forces.back() * gaps.back().transpose();
  }
  const auto num_constraints = law.penalty ? 0 : static_cast<Eigen::Index>(gaps.size());
  system.gaps.resize(num_constraints, n);
  system.forces.resize(num_constraints, n);
  for (Eigen::Index i = 0; i < num_constraints; ++i) {
    system.gaps.row(i) = gaps[static_cast<std::size_t>(i)];
    system.forces.row(i) = forces[static_cast<std::size_t>(i)];
  }
  return system;
}

}  // namespace stridor
