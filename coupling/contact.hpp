// Contact between slave points and a master polyline: kinematics and the rows of B_C and B_E.
#pragma once

#include <Eigen/Core>
#include <array>

namespace stridor {

/// How segment, position on it and normal of a contact are found (docs/theory.md, table in 2.2).
enum class ContactAssumption {
  subs_a,  ///< prescribed rigid sliding on the undeformed master
  subs_b,  ///< predicted positions of both bodies, normal of the predicted segment
  subs_c,  ///< predicted positions of both bodies, normal of the undeformed segment
  film,    ///< kinematics of subs_b; sticks, slips and lifts off (FiLM)
};

/// Ends of a master segment, T1 to T2, with the body on the right-hand side of that direction.
struct Segment {
  Eigen::Vector2d first;
  Eigen::Vector2d second;
};

/// Where a slave point stands on a master segment.
struct Projection {
  double xi = 0.0;  ///< 0 at T1, 1 at T2
  Eigen::Vector2d tangent = Eigen::Vector2d::UnitX();
  Eigen::Vector2d normal = Eigen::Vector2d::UnitY();  ///< tangent turned by +90°, out of the master
};

inline Eigen::Vector2d turned_left(const Eigen::Vector2d& vector) {
  return {-vector.y(), vector.x()};
}

/// Orthogonal projection along the segment's own normal:
/// t = (T2 − T1)/|T2 − T1|, ξ = t·(C − T1)/|T2 − T1|.
inline Projection project(const Segment& segment, const Eigen::Vector2d& slave) {
  const Eigen::Vector2d along = segment.second - segment.first;
  const double inverse_length = 1.0 / along.norm();
  Projection projection;
  projection.tangent = along * inverse_length;
  projection.normal = turned_left(projection.tangent);
  projection.xi = projection.tangent.dot(slave - segment.first) * inverse_length;
  return projection;
}

/// Projection along a given normal, which Subs-c takes from the undeformed segment:
/// ξ = t·(C − T1)/t·(T2 − T1).
inline Projection project_along(const Segment& segment, const Eigen::Vector2d& slave,
                                const Eigen::Vector2d& tangent) {
  Projection projection;
  projection.tangent = tangent;
  projection.normal = turned_left(tangent);
  projection.xi = tangent.dot(slave - segment.first) / tangent.dot(segment.second - segment.first);
  return projection;
}

/// One row of B_C or B_E: entries at the slave point (x, y) and at T1 and T2 (x, y each).
struct ContactRow {
  std::array<double, 2> slave;
  std::array<double, 4> master;
};

struct ContactRows {
  ContactRow compatibility;  ///< of B_C: B_C U = −gap
  ContactRow equilibrium;    ///< of B_E: the bodies feel −B_Eᵀ λ, λ > 0 is compression
};

/// Rows of one sliding contact (docs/theory.md, 2.2; BDF (20), (21) with the sign of friction
/// mended):
///
///   B_C: −n on C, (1 − ξ) n on T1, ξ n on T2
///   B_E: B_C + χ μ ( t on C, −(1 − ξ) t on T1, −ξ t on T2 )
///
/// @param projection ξ, t, n
/// @param friction   μ >= 0
/// @param direction  χ = ±1, sign of the sliding velocity of C along t
inline ContactRows make_rows(const Projection& projection, double friction, double direction) {
  const Eigen::Vector2d& n = projection.normal;
  const Eigen::Vector2d pull = n - (direction * friction) * projection.tangent;
  const double w1 = 1.0 - projection.xi;
  const double w2 = projection.xi;
  return {{{-n.x(), -n.y()}, {w1 * n.x(), w1 * n.y(), w2 * n.x(), w2 * n.y()}},
          {{-pull.x(), -pull.y()}, {w1 * pull.x(), w1 * pull.y(), w2 * pull.x(), w2 * pull.y()}}};
}

}  // namespace stridor
