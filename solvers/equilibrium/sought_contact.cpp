#include "solvers/equilibrium/sought_contact.hpp"

#include <fmt/format.h>

#include <limits>
#include <stdexcept>

#include "core/errors.hpp"

namespace stridor {
namespace {

std::size_t at(int index) {
  return static_cast<std::size_t>(index);
}

/// Of the body by the drive that it follows, m/s.
double velocity_of(const System& system, const EquilibriumState& state, int body) {
  const int drive = system.bodies[at(body)].drive;
  return drive < 0 || state.drives.empty() ? 0.0 : state.drives[at(drive)].velocity;
}

/// Friction of a contact in space that does not slide has no direction.
void require_sliding(const EquilibriumState& state, const SoughtContact& contact) {
  const ContactPoint& point = *contact.point;
  const bool spins = contact.facets != nullptr && !contact.facets->spin.isZero(0.0);
  const bool has_friction = state.friction_factor > 0.0 && state.terms.friction &&
                            point.friction.static_coefficient > 0.0;
  if (!point.space || contact.result.drawn != 0.0 || spins || !has_friction ||
      !state.terms.friction_damping)
    return;
  throw NumericalError(
      Refusal::no_equilibrium,
      fmt::format("equilibrium: '{}' does not slide, so that its friction has no direction; let a "
                  "drive move its "
                  "slave or its master, or its master spin, or leave friction out",
                  point.name));
}

void project_on_facet(SoughtContact& contact, const TangentPorts& ports) {
  ContactEquilibrium& result = contact.result;
  const SpaceInstant instant =
      space_instant(*contact.point->space, contact.facets, result.segment, result.displaced, ports);
  result.place = closest_on(instant.deformed, instant.slave, result.place);
}

}  // namespace

std::pair<int, double> place_on(const MasterSurface& surface, double position) {
  const double length = surface.arc_length.back();
  constexpr double rounding = 1e-12;
  if (!surface.is_endless && !(position >= 0.0 && position <= length * (1.0 + rounding))) {
    throw std::invalid_argument(fmt::format("position {:g} m is off the master {}, 0 to {:g} m",
                                            position, surface.name, length));
  }
  int segment = 0;
  while (segment + 1 < surface.num_segments() &&
         surface.arc_length[at(segment + 1)] < position - rounding * length)
    ++segment;
  const double start = surface.arc_length[at(segment)];
  return {segment, (position - start) / (surface.arc_length[at(segment + 1)] - start)};
}

SoughtContact sought_contact(const System& system, const EquilibriumState& state,
                             const ContactPoint& point) {
  const double driven = velocity_of(system, state, point.slave_body) -
                        velocity_of(system, state, system.master_of(point));
  SoughtContact contact;
  contact.point = &point;
  contact.path_share = system.path_share(point);
  contact.is_unilateral = point.unilateral_from() < std::numeric_limits<double>::infinity();
  contact.result.segment = point.first_segment;
  if (point.has_two_tangents()) {
    contact.facets = system.facets_of(point);
    if (point.space) contact.result.segment = point.space->first_facet;
    contact.result.ports.setZero(system.num_master_ports(point) + 3);
    contact.result.drawn = driven;
    require_sliding(state, contact);
  } else {
    contact.surface = &system.surfaces[at(point.surface)];
  }
  contact.result.positions.assumption =
      state.geometry == ContactGeometry::undeformed ? ContactAssumption::subs_a : point.assumption;
  contact.result.positions.driven_velocity = driven;
  return contact;
}

void prescribe(SoughtContact& contact, double drive_displacement) {
  const double displacement = contact.path_share * drive_displacement;
  contact.result.positions.prescribed = contact.surface->project_undeformed(
      contact.result.segment, contact.point->slave_position + Eigen::Vector2d(displacement, 0.0));
}

bool stand_on_facets(SoughtContact& contact, double drive_displacement) {
  ContactEquilibrium& result = contact.result;
  result.displaced = contact.path_share * drive_displacement;
  if (contact.facets == nullptr) return true;
  const TangentPorts rest = TangentPorts::Zero(result.ports.size());
  FacetSearch search;
  while (true) {
    project_on_facet(contact, rest);
    FacetPlace place{result.segment, result.place.x(), result.place.y()};
    const FacetSearch::Step step = search.look(*contact.facets, place);
    result.segment = place.facet;
    if (step != FacetSearch::Step::moved) return step == FacetSearch::Step::stay;
  }
}

FacetSearch::Step look_for_facet(SoughtContact& contact, ContactGeometry geometry) {
  if (contact.facets == nullptr || geometry == ContactGeometry::undeformed)
    return FacetSearch::Step::stay;
  ContactEquilibrium& result = contact.result;
  FacetPlace place{result.segment, result.place.x(), result.place.y()};
  const FacetSearch::Step step = contact.facet_search.look(*contact.facets, place);
  result.segment = place.facet;
  return step;
}

void place(SoughtContact& contact, const EquilibriumState& state, const PortVector& ports) {
  if (contact.has_two_tangents()) {
    contact.result.ports.head(ports.size()) = ports;
    contact.result.displaced = contact.path_share * state.drive_displacement;
    if (contact.facets != nullptr && state.geometry == ContactGeometry::deformed)
      project_on_facet(contact, contact.result.ports);
    return;
  }
  prescribe(contact, state.drive_displacement);
  const Eigen::Vector2d& origin = contact.surface->positions[at(contact.result.segment)];
  ContactPositions& positions = contact.result.positions;
  positions.slave = contact.point->slave_position - origin + ports.head<2>();
  positions.slave.x() += contact.path_share * state.drive_displacement;
  positions.undeformed = contact.surface->undeformed_piece(contact.result.segment);
  positions.master = positions.undeformed;
  set_roughness(positions, *contact.surface, contact.result.segment);
  for (int k = 0; k < positions.master.stencil.count; ++k)
    positions.master.nodes[at(k)] += ports.segment<2>(2 + 2 * k);
}

LawState law_state(const SoughtContact& contact, double force, double friction_factor) {
  if (!(force > 0.0)) return {};
  const ContactPositions& positions = contact.result.positions;
  const double slip = positions.driven_velocity * positions.prescribed.tangent.x();
  const double direction = slip < 0.0 ? -1.0 : 1.0;
  const SubstrateForces found = contact.point->substrate->under(force, slip, direction);
  const double stiffness = found.normal.by_indentation;
  const double against = -direction * friction_factor;
  const double friction = against * found.tangential.value / force;
  return {found.indentation, 1.0 / stiffness, friction,
          against * found.tangential.by_indentation / stiffness - friction};
}

ContactLinearisation linearised_face(const System& system, const EquilibriumState& state,
                                     const SoughtContact& contact) {
  ContactLinearisation local = linearise_face(
      tangent_kinematics(system, *contact.point, contact.result, state.geometry, state.terms),
      contact.num_ports, contact.point->friction, state.friction_factor, state.terms);
  local.gap -= contact.point->overlap;
  return local;
}

double length_of(const SoughtContact& contact) {
  if (!contact.point->space) return 0.0;
  const SpaceInstant instant =
      space_instant(*contact.point->space, contact.facets, contact.result.segment,
                    contact.result.displaced, contact.result.ports);
  return instant.slave.norm();
}

double position_of(const SoughtContact& contact) {
  const ContactPoint& point = *contact.point;
  if (point.face) return point.face->radius * point.face->angle;
  const SpaceInstant instant = space_instant(*point.space, contact.facets, contact.result.segment,
                                             contact.result.displaced, contact.result.ports);
  const Eigen::Vector3d material = space_geometry(instant, contact.result.place).material;
  const Eigen::Vector3d from =
      contact.facets == nullptr ? Eigen::Vector3d(Eigen::Vector3d::Zero())
                                : Eigen::Vector3d(contact.facets->origin(contact.result.segment) -
                                                  contact.facets->positions.front());
  return (from + material).dot(point.space->reference);
}

}  // namespace stridor
