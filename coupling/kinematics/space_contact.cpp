#include "coupling/kinematics/space_contact.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>

namespace stridor {
namespace {

using Rows3 = Eigen::Matrix<double, 3, Eigen::Dynamic, 0, 3, max_tangent_ports>;
using Rows2 = Eigen::Matrix<double, 2, Eigen::Dynamic, 0, 2, max_tangent_ports>;

/// Σ w_k u_k of the nodes, negative for the slave against them, as a 3 x ports matrix.
Rows3 on_nodes(const std::array<double, 4>& weights, int num_nodes, Eigen::Index num_ports) {
  Rows3 rows = Rows3::Zero(3, num_ports);
  for (int k = 0; k < num_nodes; ++k)
    rows.middleCols<3>(3 * k) = weights[static_cast<std::size_t>(k)] * Eigen::Matrix3d::Identity();
  return rows;
}

/// u_C − Σ w_k u_k.
Rows3 relative(const std::array<double, 4>& weights, int num_nodes, Eigen::Index num_ports) {
  Rows3 rows = -on_nodes(weights, num_nodes, num_ports);
  rows.rightCols<3>().setIdentity();
  return rows;
}

Eigen::Matrix<double, 3, 2> slopes_of(const PatchPoint& point) {
  Eigen::Matrix<double, 3, 2> slopes;
  slopes << point.slopes[0], point.slopes[1];
  return slopes;
}

/// ∂(carried)/∂y. With the slopes A of the deformed and B of the undeformed surface and the velocity
/// r = Ω e x (x − p), carried = A c and c = (BᵀB)⁻¹ Bᵀ r, which change with y at constant ξ and η, and
/// with these.
Rows3 carried_change(const SpaceInstant& instant, const Eigen::Vector2d& place, const PatchPoint& on,
                     const std::array<Rows3, 2>& slopes, const Rows2& shift) {
  const PatchPoint before = instant.undeformed.at(place.x(), place.y());
  const Eigen::Matrix<double, 3, 2> A = slopes_of(on);
  const Eigen::Matrix<double, 3, 2> B = slopes_of(before);
  const Eigen::Matrix2d inverse = (B.transpose() * B).inverse();
  const Eigen::Vector3d r = instant.spin.cross(before.place - instant.centre);
  const Eigen::Vector2d c = inverse * (B.transpose() * r);
  Rows3 change = c.x() * slopes[0] + c.y() * slopes[1];
  for (std::size_t k = 0; k < 2; ++k) {
    Eigen::Matrix<double, 3, 2> A_k, B_k;
    A_k << on.curvatures[k], on.curvatures[k + 1];
    B_k << before.curvatures[k], before.curvatures[k + 1];
    const Eigen::Matrix2d metric_k = B_k.transpose() * B + B.transpose() * B_k;
    const Eigen::Vector2d c_k =
        inverse * (B_k.transpose() * r + B.transpose() * instant.spin.cross(before.slopes[k]) -
                   metric_k * c);
    change += (A_k * c + A * c_k) * shift.row(static_cast<Eigen::Index>(k));
  }
  return change;
}

}  // namespace

Eigen::Vector3d reference_for(const Eigen::Vector3d& normal) {
  constexpr double nearly = 0.9;
  return std::abs(normal.x()) < nearly ? Eigen::Vector3d::UnitX() : Eigen::Vector3d::UnitZ();
}

SpaceFrame space_frame(const Eigen::Vector3d& normal, const Eigen::Vector3d& reference) {
  SpaceFrame frame;
  frame.normal = normal;
  frame.tangents[0] = (reference - normal.dot(reference) * normal).normalized();
  frame.tangents[1] = normal.cross(frame.tangents[0]);
  return frame;
}

SpaceInstant space_instant(const SpacePlace& at, const FacetSurface* surface, int facet,
                           double displaced, const TangentPorts& ports, double drawn) {
  SpaceInstant instant;
  const Eigen::Vector3d& origin = surface == nullptr ? at.origin : surface->origin(facet);
  instant.slave = (at.slave - origin) + ports.tail<3>() + displaced * Eigen::Vector3d::UnitX();
  instant.reference = at.reference;
  instant.drawn = drawn;
  instant.is_plane = surface == nullptr;
  instant.plane_normal = at.normal;
  if (instant.is_plane) return instant;
  instant.spin = surface->spin;
  instant.centre = surface->axis_point - origin;
  instant.undeformed = surface->patch(facet);
  instant.deformed = instant.undeformed;
  for (int k = 0; k < instant.deformed.count; ++k)
    instant.deformed.nodes[static_cast<std::size_t>(k)] += ports.segment<3>(3 * k);
  return instant;
}

SpaceGeometry space_geometry(const SpaceInstant& instant, const Eigen::Vector2d& place) {
  SpaceGeometry found;
  if (instant.is_plane) {
    found.frame = space_frame(instant.plane_normal, instant.reference);
    found.gap = found.frame.normal.dot(instant.slave);
    found.material = instant.slave - found.gap * found.frame.normal;
    return found;
  }
  const PatchPoint deformed = instant.deformed.at(place.x(), place.y());
  const PatchPoint undeformed = instant.undeformed.at(place.x(), place.y());
  const Eigen::Vector3d normal = deformed.slopes[0].cross(deformed.slopes[1]).normalized();
  found.frame = space_frame(normal, instant.reference);
  found.gap = normal.dot(instant.slave - deformed.place);
  found.weights = deformed.weights.value;
  found.material = undeformed.place;
  const Eigen::Matrix<double, 3, 2> before = slopes_of(undeformed);
  const Eigen::Matrix<double, 3, 2> after = slopes_of(deformed);
  found.stretch = after * (before.transpose() * before).inverse() * before.transpose();
  found.unstretch = before * (after.transpose() * after).inverse() * after.transpose();
  found.carried = found.stretch * instant.spin.cross(undeformed.place - instant.centre);
  return found;
}

TangentPorts space_row(const Eigen::Vector3d& direction, const std::array<double, 4>& weights,
                       int num_nodes, Eigen::Index num_ports) {
  TangentPorts row = TangentPorts::Zero(num_ports);
  for (int k = 0; k < num_nodes; ++k)
    row.segment<3>(3 * k) = -weights[static_cast<std::size_t>(k)] * direction;
  row.tail<3>() = direction;
  return row;
}

TangentKinematics tangent_kinematics(const SpaceInstant& instant, const Eigen::Vector2d& place,
                                     Eigen::Index num_ports) {
  const SpaceGeometry at = space_geometry(instant, place);
  const int num_nodes = instant.num_nodes();
  const auto& [n, tangents] = at.frame;
  TangentKinematics found;
  found.gap = at.gap;
  found.normal = space_row(n, at.weights, num_nodes, num_ports);
  found.friction.resize(num_ports, 2);
  found.turning.setZero(num_ports, 2);
  for (Eigen::Index i = 0; i < 2; ++i) {
    const Eigen::Vector3d& t = tangents[static_cast<std::size_t>(i)];
    found.friction.col(i) = space_row(t, at.weights, num_nodes, num_ports);
    found.velocity(i) = t.dot(at.carried) - instant.drawn * t.x();
  }
  found.sliding = found.friction;
  found.normal_bending.setZero(num_ports, num_ports);
  for (TangentMatrix& bending : found.friction_bending) bending.setZero(num_ports, num_ports);
  if (instant.is_plane) return found;

  const PatchPoint on = instant.deformed.at(place.x(), place.y());
  const Eigen::Matrix<double, 3, 2> a = slopes_of(on);
  const Eigen::Matrix2d metric = a.transpose() * a;
  Eigen::Matrix2d curvature;  // b = n·a_αβ
  curvature << n.dot(on.curvatures[0]), n.dot(on.curvatures[1]), n.dot(on.curvatures[1]),
      n.dot(on.curvatures[2]);
  const Rows3 seen = relative(at.weights, num_nodes, num_ports);
  const std::array<Rows3, 2> slopes{on_nodes(on.weights.slope[0], num_nodes, num_ports),
                                    on_nodes(on.weights.slope[1], num_nodes, num_ports)};
  // How ξ and η, and the normal, change with y.
  Rows2 tilted(2, num_ports);  // n·δa_α at constant ξ
  tilted << n.transpose() * slopes[0], n.transpose() * slopes[1];
  const Rows2 shift =
      (metric - at.gap * curvature).inverse() * (a.transpose() * seen + at.gap * tilted);
  const Rows3 turn = -(a * metric.inverse()) * (tilted + curvature * shift);
  // And the tangents, by t₁ = p/|p| with p = e − (e·n) n, and t₂ = n × t₁.
  const Eigen::Vector3d& t1 = tangents[0];
  const double along = n.dot(instant.reference);
  const double length = (instant.reference - along * n).norm();
  const Rows3 part = -(n * (instant.reference.transpose() * turn) + along * turn);
  const Rows3 turn1 = (part - t1 * (t1.transpose() * part)) / length;
  Rows3 turn2(3, num_ports);
  for (Eigen::Index k = 0; k < num_ports; ++k) {
    turn2.col(k) = Eigen::Vector3d(turn.col(k)).cross(t1) +
                   n.cross(Eigen::Vector3d(turn1.col(k)));
  }
  const auto bending = [&](const Eigen::Vector3d& direction, const Rows3& turned) -> TangentMatrix {
    return seen.transpose() * turned - slopes[0].transpose() * direction * shift.row(0) -
           slopes[1].transpose() * direction * shift.row(1);
  };
  found.normal_bending = bending(n, turn);
  found.friction_bending = {bending(tangents[0], turn1), bending(tangents[1], turn2)};
  found.turning.col(0) = instant.drawn * turn1.row(0).transpose();
  found.turning.col(1) = instant.drawn * turn2.row(0).transpose();
  if (instant.spin.isZero(0.0)) return found;
  const Rows3 carried = carried_change(instant, place, on, slopes, shift);
  found.turning.col(0) -= turn1.transpose() * at.carried + carried.transpose() * tangents[0];
  found.turning.col(1) -= turn2.transpose() * at.carried + carried.transpose() * tangents[1];
  return found;
}

}  // namespace stridor
