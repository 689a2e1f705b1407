#include "solvers/equilibrium/contact_linearisation.hpp"

#include <cmath>
#include <numeric>

namespace stridor {
namespace {

/// The combination of ports that sees `vector` at the nodes of the master, with weights.
PortVector on_nodes(const Stencil& stencil, const std::array<double, max_stencil>& weights,
                    const Eigen::Vector2d& vector) {
  PortVector ports = PortVector::Zero(2 + 2 * stencil.count);
  for (int k = 0; k < stencil.count; ++k)
    ports.segment<2>(2 + 2 * k) = weights[static_cast<std::size_t>(k)] * vector;
  return ports;
}

/// The combination of ports that sees `vector` at the slave against the master below it.
PortVector relative(const Stencil& stencil, const NodeWeights& weights,
                    const Eigen::Vector2d& vector) {
  PortVector ports = on_nodes(stencil, weights.value, -vector);
  ports.head<2>() = vector;
  return ports;
}

Projection projection_of(const ContactPositions& positions) {
  const double guess = positions.prescribed.xi;
  switch (positions.assumption) {
    case ContactAssumption::subs_a:
      return positions.prescribed;
    case ContactAssumption::subs_c:
      return project_along(positions.master, positions.slave, positions.undeformed, guess);
    case ContactAssumption::subs_b:
    case ContactAssumption::film:
      break;
  }
  return project(positions.master, positions.slave, guess);
}

/// How ξ and the angle of the normal change with the displacements.
struct ProjectionRows {
  PortVector shift;
  PortVector turn;
};

/// @param arm of the slave from its projection
ProjectionRows projection_rows(const ContactPositions& positions, const Projection& on,
                               const NodeWeights& weights, const Eigen::Vector2d& arm) {
  const SurfacePiece& master = positions.master;
  const PortVector along_tangent = relative(master.stencil, weights, on.tangent);
  const Eigen::Vector2d along = master.combine(weights.slope);
  const double height = on.normal.dot(arm);
  ProjectionRows rows{PortVector::Zero(along_tangent.size()),
                      PortVector::Zero(along_tangent.size())};
  if (positions.assumption == ContactAssumption::subs_a) return rows;
  if (positions.assumption == ContactAssumption::subs_c) {
    // Curvature of the undeformed surface, by ξ.
    const double turning = on.normal.dot(positions.undeformed.combine(weights.curvature)) /
                           positions.undeformed.combine(weights.slope).norm();
    rows.shift = along_tangent / (on.tangent.dot(along) - height * turning);
    rows.turn = turning * rows.shift;
    return rows;
  }
  const double length = along.norm();
  const double turning = on.normal.dot(master.combine(weights.curvature)) / length;
  rows.turn = on_nodes(master.stencil, weights.slope, on.normal / length);
  rows.shift = (along_tangent + height * rows.turn) / (length - height * turning);
  rows.turn += turning * rows.shift;
  return rows;
}

}  // namespace

ContactLinearisation linearise_contact(const ContactPositions& positions, const FrictionLaw& law,
                                       double friction_factor, const LinearisationTerms& terms) {
  const SurfacePiece& master = positions.master;
  ContactLinearisation contact;
  contact.projection = projection_of(positions);
  const Eigen::Vector2d& tangent = contact.projection.tangent;
  const Eigen::Vector2d& normal = contact.projection.normal;
  const NodeWeights weights = weights_at(master.stencil, contact.projection.xi);
  const Eigen::Vector2d arm = positions.slave - master.combine(weights.value);
  contact.gap = normal.dot(arm);
  contact.slip_velocity = positions.driven_velocity * tangent.x();
  contact.direction = contact.slip_velocity < 0.0 ? -1.0 : 1.0;
  contact.friction = friction_factor * sliding_friction(law, contact.slip_velocity);
  contact.friction_slope =
      contact.direction * friction_factor * sliding_friction_slope(law, contact.slip_velocity);

  const double coefficient = contact.direction * contact.friction;
  const Eigen::Vector2d push = normal - coefficient * tangent;
  const PortVector along_normal = relative(master.stencil, weights, normal);
  const PortVector along_tangent = relative(master.stencil, weights, tangent);
  contact.gap_row = -along_normal;
  contact.tangent_row = along_tangent;
  contact.force_row = -relative(master.stencil, weights, push);
  const Eigen::Index size = along_normal.size();
  contact.force_by_position.setZero(size, size);
  contact.force_by_velocity.setZero(size, size);

  const auto [shift, turn] = projection_rows(positions, contact.projection, weights, arm);
  contact.shift_row = shift;
  // The gap changes with ξ only where the projection is not along the normal of the deformed
  // surface.
  if (positions.assumption == ContactAssumption::subs_c && terms.slope)
    contact.gap_row += normal.dot(master.combine(weights.slope)) * shift;
  if (positions.roughness != nullptr) {
    const auto arc = [&](const std::array<double, max_stencil>& of) {
      return std::inner_product(of.begin(), of.end(), positions.arc_length.begin(), 0.0);
    };
    const RoughnessHeight rough = positions.roughness->at(arc(weights.value));
    contact.gap -= rough.value;
    if (terms.roughness) contact.gap_row += rough.slope * arc(weights.slope) * shift;
  }
  if (terms.turning_normal) contact.force_by_position += along_tangent * turn.transpose();
  if (terms.turning_friction)
    contact.force_by_position += coefficient * along_normal * turn.transpose();
  if (terms.shift) {
    contact.force_by_position += on_nodes(master.stencil, weights.slope, push) * shift.transpose();
  }
  if (terms.friction_slope) {
    const PortVector friction_row = contact.direction * contact.friction_slope * along_tangent;
    contact.force_by_position +=
        positions.driven_velocity * normal.x() * friction_row * turn.transpose();
    contact.force_by_velocity += friction_row * along_tangent.transpose();
  }
  return contact;
}

void set_roughness(ContactPositions& positions, const MasterSurface& surface, int segment) {
  positions.roughness = surface.roughness.is_smooth() ? nullptr : &surface.roughness;
  const Stencil stencil = surface.stencil(segment);
  for (int k = 0; k < stencil.count; ++k)
    positions.arc_length[static_cast<std::size_t>(k)] =
        surface.arc_length[static_cast<std::size_t>(stencil.first + k)];
}

}  // namespace stridor
