// The verb `precision` on a sphere on a viscoelastic substrate.
#pragma once

#include "app/precision.hpp"

namespace stridor {

/// Error against run time of the fixed steps and of the event-driven integrator.
/// @throws ConfigError, FileError, NumericalError, Interrupted
ExitCode precision_of_sphere(const PrecisionOptions& options);

}  // namespace stridor
