// Whether what a run records can be summed up at its end.
#pragma once

#include "io/scene.hpp"

namespace stridor {

/// Refuses a scene whose run would record more than memory takes when it is summed up.
/// @throws ConfigError with the place of the key
void require_summary_memory(const LoadedScene& loaded);

}  // namespace stridor
