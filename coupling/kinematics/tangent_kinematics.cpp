#include "coupling/kinematics/tangent_kinematics.hpp"

namespace stridor {

void TangentKinematics::drop_bending() {
  normal_bending.setZero();
  for (TangentMatrix& bending : friction_bending) bending.setZero();
}

TangentKinematics tangent_kinematics(const FaceKinematics& face, const FacePorts& ports) {
  TangentKinematics found;
  found.gap = face.gap(ports);
  found.velocity = face.velocity(ports, FacePorts::Zero());
  found.normal = face.normal_at(ports);
  found.friction.resize(num_face_ports, 2);
  found.sliding.resize(num_face_ports, 2);
  found.turning.resize(num_face_ports, 2);
  found.friction << face.along_at(ports), face.across;
  found.sliding << face.along, face.across;
  found.turning << FacePorts::Zero(), face.sliding * face.turning;
  found.normal_bending = face.normal_bending;
  found.friction_bending = {face.friction_bending, FaceMatrix::Zero()};
  return found;
}

}  // namespace stridor
