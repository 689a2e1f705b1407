// A scene as a family of systems: some of its numbers are free.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "io/scene/numeric_key.hpp"
#include "io/scene/scene.hpp"
#include "models/body_cache.hpp"

namespace stridor {

/// Name under which verbs vary how far the drive has moved the bodies since the start, m. It is no
/// key of scenes, where that is 0.
inline constexpr const char* drive_displacement_name = "drive.displacement";

/// Values of keys by their paths.
using Settings = std::vector<std::pair<std::string, double>>;

/// A scene with some of its keys set anew.
/// @throws ConfigError naming the values if one is not allowed, or does not fit the others
LoadedScene with_settings(const LoadedScene& scene, const Settings& settings);
/// Its model. @throws likewise
Model build_model_with(const LoadedScene& scene, const Settings& settings, BodyCache& cache);

/// The systems of a scene for any values of some of its keys.
///
/// For the position at which a single pair starts, the drive displaces the slave instead, where
/// that is the same, and for `drive.displacement` the drive is where that says; else the keys are
/// set, the scene is read again and its model made with the bodies that did not change.
class SceneFamily {
 public:
  /// @param loaded what stays as it is
  /// @param keys   that vary
  SceneFamily(LoadedScene loaded, std::vector<NumericKey> keys);

  struct Member {
    const Model* model = nullptr;     ///< until the next call
    double drive_displacement = 0.0;  ///< from where the model stands to where it is wanted, m
    /// Where the only pair of the scene is to be in contact, along the undeformed master, m;
    /// nothing where the drive cannot put it anywhere else than the scene does.
    std::optional<double> position;
    bool is_on_the_way =
        false;  ///< whether a run of the scene may come there, as far as the drive goes
  };

  /// @param values one per key
  /// @throws ConfigError if a value is not allowed, or does not fit the others
  /// @throws std::invalid_argument if the number of values is wrong
  Member at(std::span<const double> values);

  const std::vector<NumericKey>& keys() const { return keys_; }
  const BodyCache& cache() const { return cache_; }

 private:
  void build(const Settings& settings);
  std::optional<double> displacement_to(double start) const;
  std::optional<double> position() const;

  LoadedScene loaded_;
  std::vector<NumericKey> keys_;
  std::optional<LoadedScene> changed_;  ///< the scene with changed_keys_ set to some values
  std::vector<std::string> changed_keys_;
  BodyCache cache_;
  std::optional<std::size_t> start_key_;  ///< that of the position of the only pair
  std::optional<std::size_t> drive_key_;  ///< that of the displacement of the drive
  Settings built_;                        ///< of model_
  double start_ = 0.0;                    ///< of the first pair of model_, m
  std::optional<Model> model_;
};

/// Path of the position at which the only pair of a scene starts; nothing where there are several.
std::optional<std::string> start_key(const ModelParameters& model);

}  // namespace stridor
