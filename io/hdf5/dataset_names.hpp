// What datasets of result files are called for people.
#pragma once

#include <string>

namespace stridor {

/// The attribute `long_name` of a dataset, from its path (docs/files.md):
///
///     /channels/cantilever.free_end.y.acceleration   "acceleration of cantilever.free_end along y"
///     /modal/disc/frequency                          "natural frequency of disc by itself"
///     /unstable/from                                 "value of the parameter where the unstable
///     window begins" /new/thing                                     "thing, new": to be given a
///     text
std::string long_name_of(const std::string& path);

}  // namespace stridor
