// Where a contact on a face of a spinning body stands.
#pragma once

#include <array>
#include <string>

namespace stridor {

/// A place on a face of a body that spins about an axis along z of space, seen from space: it stays where
/// it is while material passes with Ω r (docs/theory.md, 10.2).
struct FacePlace {
  std::string name;             ///< "<body>.<face>"
  int body = 0;
  /// Rows of ReducedBody::rows that carry w, w_r, w_φ, w_rφ and w_φφ here.
  std::array<int, 5> rows{};
  double radius = 0.0;          ///< r, m
  double angle = 0.0;           ///< φ, rad
  double half_thickness = 0.0;  ///< h/2, m
  int side = 1;                 ///< s: +1 on the face of larger z, −1 on the other
  double spin = 0.0;            ///< Ω, rad/s
  /// Angle of the circumference here against x of the slave's frame, rad:
  /// p_φ = cos x − sin z, p_r = cos z + sin x, p_z = s y of the slave's point.
  double turned = 0.0;
};

}  // namespace stridor
