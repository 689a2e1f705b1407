#include "coupling/kinematics/face_kinematics.hpp"

#include <cmath>

namespace stridor {

FaceKinematics make_face_kinematics(const FacePlace& place) {
  const auto port = [](int i) -> FacePorts { return FacePorts::Unit(i); };
  const FacePorts w = port(0), w_r = port(1), w_phi = port(2), w_r_phi = port(3),
                  w_phi_phi = port(4);
  const FacePorts x = port(5), y = port(6), z = port(7);
  const double cosine = std::cos(place.turned);
  const double sine = std::sin(place.turned);
  const FacePorts p_phi = cosine * x - sine * z;
  const FacePorts p_r = cosine * z + sine * x;
  const double r = place.radius;
  const double s = place.side;
  const double lever = s * place.half_thickness;
  const FacePorts p_z = s * y;

  FaceKinematics face;
  face.normal = s * (p_z - w);
  face.along = p_phi + lever / r * w_phi;
  face.across = p_r + lever * w_r;
  face.turning = (p_phi + lever * w_r_phi) / r;
  face.sliding = place.spin * r;
  const FacePorts slope = w_phi / r;
  face.normal_bending =
      -place.half_thickness * (w_r * w_r.transpose() + slope * slope.transpose()) -
      s * (w_r * p_r.transpose() + slope * p_phi.transpose() + p_r * w_r.transpose() +
           p_phi * slope.transpose());
  face.friction_bending =
      (p_z - w) * slope.transpose() +
      lever * ((w_r_phi / r - w_phi / (r * r)) * face.across.transpose() +
               (w_phi_phi / (r * r) + w_r / r) * face.along.transpose());
  return face;
}

}  // namespace stridor
