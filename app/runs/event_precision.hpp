// The verb `precision` on a scene with the event-driven integrator.
#pragma once

#include "app/runs/precision.hpp"
#include "io/scene/scene.hpp"

namespace stridor {

/// Error against run time of the fixed steps and of the event-driven integrator.
/// @throws ConfigError, FileError, NumericalError, Interrupted
ExitCode precision_of_events(const PrecisionOptions& options, const LoadedScene& loaded);

}  // namespace stridor
