// Contacts with two tangents on undeformed bodies.
#pragma once

#include <optional>

#include "coupling/system/system.hpp"

namespace stridor {

/// Kinematics of a contact with two tangents, and the facet that it is on.
struct UndeformedContact {
  int facet = 0;
  TangentKinematics kinematics;
};

/// @param displacement of the leading drive, m
/// @return nothing where the slave is beside its master
std::optional<UndeformedContact> undeformed_contact(const System& system,
                                                    const ContactPoint& contact,
                                                    double displacement);

}  // namespace stridor
