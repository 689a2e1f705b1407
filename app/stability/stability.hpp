// The options of the verbs about small vibrations, and the scene with the key that they vary.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "analysis/growth_field.hpp"
#include "analysis/locus.hpp"
#include "app/stability/key_range.hpp"
#include "app/stability/lowest_eigenvalues.hpp"
#include "app/stability/stability_family.hpp"
#include "app/terminal/command.hpp"
#include "io/scene/scene_family.hpp"
#include "solvers/eigenvalues/secular_eigenvalues.hpp"
#include "solvers/equilibrium/linearise.hpp"

namespace stridor {

/// Options as the user wrote them.
struct StabilityOptions {
  CommonOptions common;
  std::string scene;
  std::string about;   ///< empty until make_choices() where none was asked for
  std::string method;  ///< likewise
  std::optional<int> count;
  std::optional<std::string> below;  ///< frequency, as written

  /// The eigenvalues wanted: all below a frequency, or the lowest ones, of those below it where
  /// both are given; the lowest 20 where nothing is asked for.
  /// @throws ConfigError if the frequency is none
  SpectrumWindow window() const;
  /// "20 lowest eigenvalues", "eigenvalues below 5000 Hz", for captions.
  std::string window_words() const;
  ContactGeometry geometry() const;
  EigenvalueMethod eigenvalue_method() const;
  LocusOptions locus_options() const;
};

/// Defaults of a request: the method is the secular function; the geometry is the undeformed one,
/// with contacts on the faces of spinning bodies that of the equilibrium, to which the loads press
/// them.
void make_choices(StabilityOptions& options, const Scene& scene);

/// The scene, --about, --method, --count, --below, --set, --threads and --json.
void add_stability_options(CLI::App& verb, StabilityOptions& options);

/// The key that a verb varies. Only keys of bodies, contacts and drive change eigenvalues.
/// @param option where the path was written
/// @throws ConfigError as find_numeric_key(), or if the key changes no eigenvalue
NumericKey find_stability_key(const Scene& scene, const std::string& path,
                              const std::string& option);

/// A scene whose small motions can be followed along its keys.
class StabilityScene {
 public:
  explicit StabilityScene(LoadedScene loaded) : loaded_(std::move(loaded)) {}

  /// As find_stability_key().
  NumericKey find_key(const std::string& path, const std::string& option) const {
    return find_stability_key(loaded_.scene, path, option);
  }
  /// The key that is varied where the user names none: the place along a master.
  std::optional<std::string> default_key() const;
  std::unique_ptr<StabilityFamily> family(std::vector<NumericKey> keys,
                                          ContactGeometry geometry) const {
    return std::make_unique<BodyStabilityFamily>(loaded_, std::move(keys), geometry);
  }
  /// The fast way to growth rates over two keys, one field per thread; null where there is none.
  std::unique_ptr<GrowthField> growth_field(const std::vector<NumericKey>& keys) const;
  /// Whether its lines must be traced by one thread: dense products go to BLAS.
  bool needs_one_thread() const { return loaded_.scene.model.pairs().empty(); }
  const LoadedScene& loaded() const { return loaded_; }
  /// For captions: about which geometry its eigenvalues are, where there is a choice.
  std::string about_text(const StabilityOptions& options) const;

 private:
  LoadedScene loaded_;
};

/// Reads the scene and makes the choices that the options leave to it.
/// @throws ConfigError, FileError as load_scene()
StabilityScene load_stability_scene(StabilityOptions& options);

/// @throws ConfigError if the key, an end of the range or the number of points is wrong
KeyRange make_range(const StabilityScene& scene, const RangeOptions& options);

}  // namespace stridor
