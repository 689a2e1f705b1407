// Scenes of a disc between two pads.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "io/scene.hpp"
#include "io/scene_family.hpp"
#include "io/scene_tree.hpp"
#include "models/disc_model.hpp"
#include "models/initial_parameters.hpp"

namespace stridor {

/// How a disc with pads moves in time.
struct DiscTimeParameters {
  double step = 0.0;  ///< s, > 0
  double end = 0.0;   ///< s, > 0
  static const Schema& schema();
};

/// Where it starts: about steady sliding.
struct DiscInitialParameters {
  PerturbationParameters perturbation;  ///< amplitude: of the pads
  static const Schema& schema();
};

struct DiscRecordParameters {
  double interval = 0.0;              ///< between samples, s, a multiple of time.step
  std::vector<std::string> channels;  ///< of disc_channels(); empty: all
  static const Schema& schema();
};

/// A scene of this kind is known by its section `disc`. From `time` on its sections are for `run`.
struct DiscScene {
  int format = 0;
  NamedNumbers parameters;
  DiscModelParameters model;
  std::optional<DiscTimeParameters> time;
  std::optional<DiscInitialParameters> initial;
  std::optional<DiscRecordParameters> record;
  CheckpointParameters checkpoint;
  std::vector<Expectation> expect;
  static const Schema& schema();
};

bool is_disc_scene(const SceneNode& tree);

/// As LoadedScene.
struct LoadedDiscScene {
  std::string path;
  SceneNode tree;
  DiscScene scene;
  /// Plate and pads of the models made so far: made when they are first needed; copies share them.
  mutable std::shared_ptr<DiscBodyCache> bodies;

  std::string resolved() const;
  std::string hash() const;
  /// @throws ConfigError with the place of the key
  DiscModel model() const;
  /// The same with some numbers set. @throws ConfigError also if they do not fit the others
  DiscModel model(const std::vector<NumericKey>& keys, std::span<const double> values) const;
};

/// Whether a file holds such a scene. @throws ConfigError, FileError if it cannot be read
bool is_disc_scene_file(const std::string& path);

/// Reads such a scene from its resolved text, as run files hold it.
/// @param source what messages call it
/// @throws ConfigError as load_disc_scene
LoadedDiscScene load_resolved_disc_scene(const std::string& text, const std::string& source);

/// Reads such a scene and applies `--set key.path=value` settings.
/// @throws ConfigError with all problems of the file; FileError if it cannot be read
LoadedDiscScene load_disc_scene(const std::string& path, const std::vector<std::string>& sets);

}  // namespace stridor
