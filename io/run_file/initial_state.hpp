// The state in which the bodies of a scene start.
#pragma once

#include <complex>
#include <optional>

#include "io/scene/scene.hpp"

namespace stridor {

/// How a system starts, beyond where its bodies are.
struct InitialState {
  /// The eigenvalue of `initial.perturbation`, 1/s.
  std::optional<std::complex<double>> perturbation;
};

/// Adds the state that `initial.state` names, and the eigenvector of `initial.perturbation`, to the
/// displacements and velocities that the system starts with.
///
/// @param system of the scene's model
/// @throws ConfigError with the place in the scene if there is no such equilibrium or eigenvalue,
///         the run file is of other bodies, or a contact starts with a gap that its forces would
///         close in the first step: an overlap, or any gap of a bilateral contact
/// @throws FileError naming file and dataset if the run file cannot be read
InitialState set_initial_state(System& system, const LoadedScene& loaded);

}  // namespace stridor
