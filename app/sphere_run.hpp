// The verb `run` on a sphere on a viscoelastic substrate.
#pragma once

#include "app/run_keeping.hpp"
#include "io/sphere_scene.hpp"

namespace stridor {

/// Marches the scene with the integrator that it names, and writes samples and results.
/// @throws NumericalError, FileError, Interrupted
ExitCode run_sphere(const LoadedSphereScene& loaded, const RunOutput& output,
                    const RunEnding& ending);
/// Goes on with such a run.
ExitCode resume_sphere(const InterruptedRun& interrupted, const RunEnding& ending);

}  // namespace stridor
