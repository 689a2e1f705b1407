// A whole scene: the model, how it is run, what is recorded and what is expected of it.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "io/scene/scene_sections.hpp"
#include "io/scene/scene_tree.hpp"
#include "io/scene/sliding_points.hpp"
#include "models/model.hpp"
#include "solvers/equilibrium/equilibrium.hpp"
#include "solvers/transient/simulation.hpp"

namespace stridor {

/// What every kind of scene says of its key `parameters`.
PlainKey parameters_key();

/// Terms that the linearised equations keep; the steps of Hetzler and Seemann.
struct KeptTerms {
  bool gyroscopic = true;          ///< and centrifugal ones, of bodies that spin
  bool friction = true;            ///< of normal forces that vary
  bool friction_damping = true;    ///< all damping that contacts bring
  bool geometric = true;           ///< contact forces turn and shift with the motion
  bool structural_damping = true;  ///< all that bodies bring

  /// Whether nothing is left out but damping.
  bool has_all_but_damping() const { return gyroscopic && friction && geometric; }
};

struct Scene {
  int format = 0;
  NamedNumbers parameters;
  ModelParameters model;
  std::optional<TimeParameters> time;             ///< needed by what marches in time
  std::optional<std::vector<std::string>> terms;  ///< absent: all
  std::optional<CycleParameters> cycle;
  std::optional<SlidingPoints> sliding;  ///< of `contact`
  std::optional<RecordParameters> record;
  MeasureParameters measure;
  std::optional<SpectrogramSection> spectrogram;
  CheckpointParameters checkpoint;
  std::vector<Expectation> expect;
  static const Schema& schema();
};

/// Whether `terms` keeps one of its names.
bool keeps_term(const Scene& scene, const std::string& name);
/// What `terms` keeps.
KeptTerms kept_terms(const Scene& scene);
/// What it keeps of contacts on the faces of spinning bodies.
LinearisationTerms contact_terms(const KeptTerms& kept);
/// Whether a master, "<body>.<face>", is the face of a body.
bool is_face(const ModelParameters& model, const std::string& master);
/// Whether the contacts of a pair have two tangents: on the face of a plate, or in space.
bool has_two_tangents(const ModelParameters& model, const ContactParameters& pair);
/// Whether a contact of the scene has.
bool has_face_contacts(const ModelParameters& model);

/// What a run of the scene keeps account of.
Accounts accounts_of(const Scene& scene);

/// A scene together with where its keys stand.
struct LoadedScene {
  std::string path;
  std::string text;  ///< as given, before --set
  SceneNode tree;    ///< with --set applied
  Scene scene;
  std::vector<std::string> sets;
  /// Points whose motion a verb asks for besides those of `record`, and the option that names each.
  std::vector<std::pair<PointName, std::string>> observed;

  /// The scene with every key and default written out.
  std::string resolved() const;
  /// 16 hexadecimal digits of the resolved scene and the files that it names (FNV-1a).
  std::string hash() const;
  /// The same error with the places of its keys in this scene.
  ConfigError located(const ConfigError& error) const;
  /// Refuses a scene without a section that a verb needs.
  /// @param section `time`, `contact` (or `contacts`) or `record`
  /// @throws ConfigError naming section and verb
  void require_section(const std::string& section, const std::string& verb) const;
};

/// @throws ConfigError if a scene, or a contact of it, is only one for `contact` to evaluate
void require_bodies(const LoadedScene& loaded);

/// 16 hexadecimal digits that change with any character of a resolved scene (FNV-1a).
std::string scene_hash(const std::string& resolved);

/// Reads a scene file and applies `--set key.path=value` settings.
/// @throws ConfigError with all problems of the file, each with its place
/// @throws FileError if the file cannot be read
LoadedScene load_scene(const std::string& path, const std::vector<std::string>& sets);

/// Reads a scene from its resolved text, as run files hold it.
/// @param source what messages call it
/// @throws ConfigError as load_scene
LoadedScene load_resolved_scene(const std::string& text, const std::string& source);

/// Bodies, contacts and drives of a scene, the bodies with what their files hold.
/// @throws ConfigError with key paths, or the place in a file; FileError
ModelParameters parameters_with_files(const LoadedScene& loaded, BodyCache& cache);

/// The model of a scene with the points that its channels ask for, for a run.
/// @throws ConfigError with the place of the key in the scene; also as require_modes()
Model build_model(const LoadedScene& loaded);
/// The same with bodies, reductions and matrices from a cache where it has them.
Model build_runnable_model(const LoadedScene& loaded, BodyCache& cache);
/// The same for eigenvalues: it may be sparse.
Model build_model(const LoadedScene& loaded, BodyCache& cache);

}  // namespace stridor
