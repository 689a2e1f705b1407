// Contact between slave points and a master surface: kinematics and the rows of B_C and B_E.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>

#include "coupling/kinematics/surface.hpp"

namespace stridor {

/// Rule for segment, position on it and normal of a contact (docs/theory.md, table in 2.2).
enum class ContactAssumption {
  subs_a,  ///< prescribed rigid sliding on the undeformed master
  subs_b,  ///< predicted positions of both bodies, normal of the predicted surface
  subs_c,  ///< predicted positions of both bodies, normal of the undeformed surface
  film,    ///< kinematics of subs_b; sticks, slips and lifts off (FiLM)
};

/// Ends of a straight master segment, T1 to T2, with the body on the right-hand side of that
/// direction.
struct Segment {
  Eigen::Vector2d first;
  Eigen::Vector2d second;
};

/// Position of a slave point on a master segment.
struct Projection {
  double xi = 0.0;  ///< 0 at T1, 1 at T2
  Eigen::Vector2d tangent = Eigen::Vector2d::UnitX();
  Eigen::Vector2d normal = Eigen::Vector2d::UnitY();  ///< tangent turned by +90°, out of the master
  std::array<double, max_stencil> weights{};          ///< of the nodes, at ξ
};

inline Eigen::Vector2d turned_left(const Eigen::Vector2d& vector) {
  return {-vector.y(), vector.x()};
}

/// A place with the tangent given; `along` need not have unit length.
inline Projection make_projection(const Stencil& stencil, double xi, const Eigen::Vector2d& along) {
  Projection projection;
  projection.xi = xi;
  projection.tangent = along / along.norm();
  projection.normal = turned_left(projection.tangent);
  projection.weights = weights_at(stencil, xi).value;
  return projection;
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
  projection.weights = {1.0 - projection.xi, projection.xi, 0.0, 0.0};
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
  projection.weights = {1.0 - projection.xi, projection.xi, 0.0, 0.0};
  return projection;
}

/// Projection of a slave on a piece of surface, along the normal of another piece with the same
/// stencil: T'(ξ)·(C − M(ξ)) = 0 with the points M = Σ w_k x_k of the one and the tangents
/// T' = Σ w'_k x'_k of the other (docs/theory.md, 2.5).
///
/// Newton's method in ξ, kept within one segment length on either side of the segment. Beyond its
/// ends the segment is continued, so ξ < 0 and ξ > 1 tell on which side the slave is.
/// @param directions the piece itself for the orthogonal projection, the undeformed one for Subs-c
/// @param guess      of ξ
inline Projection project_along(const SurfacePiece& piece, const Eigen::Vector2d& slave,
                                const SurfacePiece& directions, double guess) {
  if (piece.stencil.count == 2) {
    const Eigen::Vector2d along = directions.nodes[1] - directions.nodes[0];
    return project_along(Segment{piece.nodes[0], piece.nodes[1]}, slave, along / along.norm());
  }
  // A step of this size leaves an error of about its square, which is rounding.
  constexpr double last_step = 1e-8;
  constexpr int max_iterations = 60;
  double low = -1.0;
  double high = 2.0;
  double xi = std::clamp(guess, 0.0, 1.0);
  const auto ahead_at = [&](double at) {
    const NodeWeights w = weights_at(piece.stencil, at);
    return directions.combine(w.slope).dot(slave - piece.combine(w.value));
  };
  for (int iteration = 0; iteration < max_iterations; ++iteration) {
    const NodeWeights w = weights_at(piece.stencil, xi);
    const Eigen::Vector2d arm = slave - piece.combine(w.value);
    const Eigen::Vector2d direction = directions.combine(w.slope);
    const double ahead = direction.dot(arm);
    const double square = direction.dot(piece.combine(w.slope));
    const double slope = square - directions.combine(w.curvature).dot(arm);
    (ahead > 0.0 ? low : high) = xi;
    // If the slave is further away than the centre of curvature, the distance has no minimum.
    double next = xi + ahead / (slope > 0.0 ? slope : square);
    // Its continuation may turn back and be orthogonal once more: the segment itself goes first.
    if (iteration == 0 && (next < 0.0 || next > 1.0) && ahead_at(0.0) > 0.0 && ahead_at(1.0) < 0.0) {
      low = 0.0;
      high = 1.0;
    }
    const bool is_within = low <= next && next <= high;
    if (!is_within) next = 0.5 * (low + high);
    const double step = next - xi;
    xi = next;
    if (std::abs(step) <= last_step) break;
  }
  return make_projection(piece.stencil, xi,
                         directions.combine(weights_at(piece.stencil, xi).slope));
}

/// Orthogonal projection on a piece of surface.
/// @param guess of ξ
inline Projection project(const SurfacePiece& piece, const Eigen::Vector2d& slave, double guess) {
  if (piece.stencil.count == 2) return project(Segment{piece.nodes[0], piece.nodes[1]}, slave);
  return project_along(piece, slave, piece, guess);
}

/// One row of B_C or B_E: entries at the slave point (x, y) and at the nodes of the stencil (x, y
/// each; zero beyond it).
struct ContactRow {
  std::array<double, 2> slave;
  std::array<double, 2 * max_stencil> master;
};

struct ContactRows {
  ContactRow compatibility;  ///< of B_C: B_C U = −gap
  ContactRow equilibrium;    ///< of B_E: the bodies feel −B_Eᵀ λ, λ > 0 is compression
};

/// Rows of one sliding contact (docs/theory.md, 2.2; BDF (20), (21) with the sign of friction
/// corrected):
///
///   B_C: −n on C, w_k n on the nodes
///   B_E: B_C + χ μ ( t on C, −w_k t on the nodes )
///
/// @param projection t, n and the weights w; of a straight segment 1 − ξ on T1 and ξ on T2
/// @param friction   μ >= 0
/// @param direction  χ = ±1, sign of the sliding velocity of C along t
inline ContactRows make_rows(const Projection& projection, double friction, double direction) {
  const Eigen::Vector2d& n = projection.normal;
  const Eigen::Vector2d pull = n - (direction * friction) * projection.tangent;
  ContactRows rows{{{-n.x(), -n.y()}, {}}, {{-pull.x(), -pull.y()}, {}}};
  for (std::size_t k = 0; k < max_stencil; ++k) {
    const double weight = projection.weights[k];
    rows.compatibility.master[2 * k] = weight * n.x();
    rows.compatibility.master[2 * k + 1] = weight * n.y();
    rows.equilibrium.master[2 * k] = weight * pull.x();
    rows.equilibrium.master[2 * k + 1] = weight * pull.y();
  }
  return rows;
}

}  // namespace stridor
