// Contacts in space: on rigid planes and on the facets of bodies.
#pragma once

#include "models/contact_pair.hpp"

namespace stridor {

/// Adds the contacts of a pair in space to a system, with the facets of its master.
///
/// Bodies stand where their meshes have them; `start.at` puts the first slave point at a place. Gaps and
/// overlaps up to `adjust` are taken as closed without stress (ContactPoint::overlap).
/// @throws ConfigError where a slave point is beside its master, the slave inside it, or the pair has
///         keys that mean nothing in space
void add_space_contacts(const ContactPair& pair, const PairDrive& drive,
                        std::vector<ModelBody>& bodies, System& system);

}  // namespace stridor
