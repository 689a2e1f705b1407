#include "coupling/system/undeformed_contact.hpp"

namespace stridor {

std::optional<UndeformedContact> undeformed_contact(const System& system,
                                                    const ContactPoint& contact,
                                                    double displacement) {
  if (contact.face) {
    return UndeformedContact{
        0, tangent_kinematics(make_face_kinematics(*contact.face), FacePorts::Zero())};
  }
  const SpacePlace& space = *contact.space;
  const FacetSurface* const surface = system.facets_of(contact);
  const double displaced = system.path_share(contact) * displacement;
  FacetPlace place{space.first_facet, 0.0, 0.0};
  if (surface != nullptr) {
    place = locate_on(*surface, space.slave + displaced * Eigen::Vector3d::UnitX());
    if (place.facet < 0) return std::nullopt;
  }
  const Eigen::Index num_ports = system.num_master_ports(contact) + 3;
  const SpaceInstant instant =
      space_instant(space, surface, place.facet, displaced, TangentPorts::Zero(num_ports),
                    system.driven_motion(contact).end_velocity());
  return UndeformedContact{place.facet,
                           tangent_kinematics(instant, {place.xi, place.eta}, num_ports)};
}

}  // namespace stridor
