// Scenes of small motion: a disc between pads, and bodies given by matrices.
#pragma once

#include <map>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "io/scene.hpp"
#include "io/scene_family.hpp"
#include "io/scene_tree.hpp"
#include "models/disc_model.hpp"
#include "models/initial_parameters.hpp"
#include "substructures/matrix_body.hpp"

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

/// A scene of this kind is known by a substructure of the type `matrices` that nothing touches: it
/// has no contacts, no drive and no time. It has no other substructure.
struct MatrixScene {
  int format = 0;
  NamedNumbers parameters;
  std::map<std::string, std::variant<MatrixBodyParameters>> substructures;
  static const Schema& schema();
};

using LinearScene = std::variant<DiscScene, MatrixScene>;

bool is_disc_scene(const SceneNode& tree);
bool is_matrix_scene(const SceneNode& tree);
/// Whether a scene is of either kind.
bool is_linear_scene(const SceneNode& tree);

/// @throws ConfigError with all problems
LinearScene read_linear_scene(const SceneNode& tree);

const Schema& schema_of(const LinearScene& scene);
/// The struct that schema_of() describes.
const void* object_of(const LinearScene& scene);

/// Matrices of a scene and where they come from.
struct LinearModel {
  LinearSystem dense;                  ///< empty where there is `sparse`
  std::optional<SparseSystem> sparse;  ///< of more than `largest_dense_size` unknowns
  std::optional<DiscModel> disc;       ///< of a disc
  double highest_frequency = 0.0;      ///< up to which the model answers, Hz; may be infinite
};

/// Number of unknowns up to which all eigenvalues are computed, at a cost of its third power.
constexpr Eigen::Index largest_dense_size = 1000;

/// As LoadedScene.
struct LoadedLinearScene {
  std::string path;
  SceneNode tree;
  LinearScene scene;
  /// Read when they are first needed and when a parameter has changed a row; copies share them.
  mutable std::shared_ptr<const NamedMatrices> matrices;
  /// Plate and pads of the models made so far, likewise.
  mutable std::shared_ptr<DiscBodyCache> bodies;
  mutable MatrixBodyParameters matrices_of;  ///< what names `matrices`

  std::string resolved() const;
  std::string hash() const;
  /// @throws ConfigError with the place of the key, or the place in a matrix file; FileError
  LinearModel model() const;
  /// The same with some numbers set. @throws ConfigError also if they do not fit the others
  LinearModel model(const std::vector<NumericKey>& keys, std::span<const double> values) const;
};

/// Whether a file holds a scene of either kind. @throws ConfigError, FileError if it cannot be read
bool is_linear_scene_file(const std::string& path);

/// Reads such a scene from its resolved text, as run files hold it.
/// @param source what messages call it
/// @throws ConfigError as load_linear_scene
LoadedLinearScene load_resolved_linear_scene(const std::string& text, const std::string& source);

/// Reads such a scene and applies `--set key.path=value` settings.
/// @throws ConfigError with all problems of the file; FileError if it cannot be read
LoadedLinearScene load_linear_scene(const std::string& path, const std::vector<std::string>& sets);

}  // namespace stridor
