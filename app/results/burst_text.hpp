// A burst in one line, as `run` and `info` list it.
#pragma once

#include <string>

#include "app/terminal/command.hpp"

namespace stridor {

/// "0.875 to 0.929 s, 6406 Hz, peak 179.6 m/s^2, gain 4.61".
/// @param burst object with the numbers start, end (s), frequency (Hz), peak (m/s^2) and gain; one
///              that is null, because it is not finite, is shown as "nan"
std::string burst_text(const Json& burst);

}  // namespace stridor
