// A kind of scene: a sphere on springs, on a sliding viscoelastic substrate.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "io/scene.hpp"
#include "io/scene_family.hpp"
#include "io/scene_tree.hpp"
#include "models/sphere.hpp"

namespace stridor {

enum class SphereIntegrator {
  event_driven,  ///< adaptive, order 8, steps end at every change between stick, slip and flight
  central_difference,  ///< the fixed steps of the beams
  exact,               ///< likewise, with exact free motion
};

/// How the oscillator moves in time; times are multiples of 1/ω_nx.
struct SphereTimeParameters {
  SphereIntegrator integrator = SphereIntegrator::event_driven;
  std::optional<double> step;     ///< of the fixed-step integrators
  double end = 0.0;               ///< of a transient
  double record_interval = 0.05;  ///< between samples of a transient
  double settle = 2000.0;         ///< before a limit cycle is sought
  double tolerance = 1e-12;       ///< of the event-driven integrator, relative
  /// Indentation at the start in multiples of that in equilibrium, everything else as there.
  double initial_indentation = 1.01;
  static const Schema& schema();
};

/// A scene of this kind is known by its section `sphere`.
struct SphereScene {
  int format = 0;
  NamedNumbers parameters;
  SphereModelParameters model;
  SphereTimeParameters time;
  CheckpointParameters checkpoint;
  std::vector<Expectation> expect;
  static const Schema& schema();
};

/// Whether the sections of a scene make it a SphereScene.
bool is_sphere_scene(const SceneNode& tree);
/// The same of a file. @throws ConfigError, FileError if it cannot be read
bool is_sphere_scene_file(const std::string& path);

/// As LoadedScene.
struct LoadedSphereScene {
  std::string path;
  SceneNode tree;
  SphereScene scene;

  std::string resolved() const;
  std::string hash() const;
};

/// Reads such a scene and applies `--set key.path=value` settings.
/// @throws ConfigError with all problems of the file; FileError if it cannot be read
LoadedSphereScene load_sphere_scene(const std::string& path, const std::vector<std::string>& sets);

/// Reads a resolved scene, as it stands in run files.
/// @param source for messages
/// @throws ConfigError if it is not whole; FileError as above
LoadedSphereScene load_resolved_sphere_scene(const std::string& text, const std::string& source);

/// The scene with some of its numbers set.
/// @param keys, values of as many numbers
/// @throws ConfigError if the values do not fit the others
SphereScene with_values(const LoadedSphereScene& loaded, const std::vector<NumericKey>& keys,
                        std::span<const double> values);

}  // namespace stridor
