// What datasets of result files are called for people.
#pragma once

#include <string>

namespace stridor {

/// The attribute `long_name` of a dataset, from its path (docs/files.md):
///
///     /channels/cantilever.free_end.y.acceleration   "acceleration of cantilever.free_end along y"
///     /contact/pad/slip_velocity                     "slip velocity of the contact pad"
///     /branches/003/growth                           "growth, branches 003"
std::string long_name_of(const std::string& path);

}  // namespace stridor
