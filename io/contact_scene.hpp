// The other kind of scene: sliding contact of an indenter on a viscoelastic half-space.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "coupling/indenter_profile.hpp"
#include "io/scene.hpp"
#include "io/scene_tree.hpp"
#include "solvers/sliding_contact.hpp"
#include "substructures/viscoelastic_material.hpp"

namespace stridor {

/// Speeds and indentations, or loads, at which contacts are computed; all dimensionless.
struct SlidingPoints {
  std::vector<double> speeds;        ///< v̂ = v τ_1/R, of either sign
  std::vector<double> indentations;  ///< ŷ = y/R > 0
  std::vector<double> loads;         ///< F̃ = F/(E_0* R²) > 0; instead of indentations
  static const Schema& schema();
};

/// A scene of this kind is known by its section `profile` or `contact_solver`.
struct ContactScene {
  int format = 0;
  NamedNumbers parameters;
  ViscoelasticMaterial material;
  ProfileParameters profile;
  SlidingContactParameters contact_solver;
  SlidingPoints sliding;
  std::vector<Expectation> expect;
  static const Schema& schema();
};

/// Whether the sections of a scene make it a ContactScene.
bool is_contact_scene(const SceneNode& tree);

/// JSON Schema and reference page of scenes of all kinds: docs/scene.schema.json and
/// docs/scene_reference.md.
std::string all_scenes_json_schema();
std::string all_scenes_reference();

/// As LoadedScene.
struct LoadedContactScene {
  std::string path;
  SceneNode tree;
  ContactScene scene;

  std::string resolved() const;
  std::string hash() const;
  /// A problem of the scene that was found later, with its place.
  ConfigError problem(const std::string& key, const std::string& message) const;
};

/// Reads such a scene and applies `--set key.path=value` settings.
/// @throws ConfigError with all problems of the file, also if it is a scene of the other kind;
///         FileError if it cannot be read
LoadedContactScene load_contact_scene(const std::string& path,
                                      const std::vector<std::string>& sets);

/// v τ_k of a scene at a dimensionless speed, m.
CreepLengths creep_lengths(const ContactScene& scene, double speed);

}  // namespace stridor
