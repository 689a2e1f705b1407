// Contacts on curves: where slaves stand on their masters.
#pragma once

#include "models/contact_pair.hpp"

namespace stridor {

/// Places the slave of a pair on the curve of its master, and adds surface and contacts to a system.
/// @throws ConfigError where the slave stands off its master or on its inner side
void add_curve_contacts(const ContactPair& pair, const PairDrive& drive,
                        std::vector<ModelBody>& bodies, System& system);

}  // namespace stridor
