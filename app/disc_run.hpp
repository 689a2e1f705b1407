// The verb `run` on a disc between pads.
#pragma once

#include "app/disc_transient.hpp"

namespace stridor {

/// Marches the scene from a perturbed steady sliding, and writes samples and results.
/// @throws ConfigError if the scene is no disc, or lacks keys that a run needs; Interrupted,
/// NumericalError
ExitCode run_disc(const LoadedDiscScene& loaded, const RunOutput& output, const RunEnding& ending);
/// Goes on with such a run.
ExitCode resume_disc(const InterruptedRun& interrupted, const RunEnding& ending);

}  // namespace stridor
