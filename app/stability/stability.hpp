// Functions common to the verbs about small vibrations: sliding state of a scene and eigenvalues.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "analysis/growth_field.hpp"
#include "analysis/locus.hpp"
#include "analysis/sampled_locus.hpp"
#include "app/terminal/command.hpp"
#include "io/scene/scene_family.hpp"
#include "solvers/eigenvalues/secular_eigenvalues.hpp"
#include "solvers/eigenvalues/sparse_pencil.hpp"
#include "solvers/equilibrium/linearise.hpp"

namespace stridor {

enum class EigenvalueMethod { secular, dense };

/// Options as the user wrote them.
struct StabilityOptions {
  CommonOptions common;
  std::string scene;
  std::string about;   ///< empty until make_choices() where none was asked for
  std::string method;  ///< likewise
  int count = 20;
  std::optional<std::string> below;           ///< frequency, as written
  const CLI::Option* count_option = nullptr;  ///< tells whether a count was given

  /// The eigenvalues wanted: the lowest ones, or all below a frequency.
  /// @throws ConfigError if the frequency is none
  SpectrumWindow window() const;
  /// That of locus_options(): the lowest ones, and none above the frequency.
  SpectrumWindow locus_window() const;
  ContactGeometry geometry() const;
  EigenvalueMethod eigenvalue_method() const;
  LocusOptions locus_options() const;
};

/// A range of one key, as written.
struct RangeOptions {
  std::string parameter;  ///< empty: the position at which the pair starts
  std::string from;
  std::string to;
  int points = 101;
};

/// The values of a key in a range.
/// @throws ConfigError as parse_value() and spaced_values(), or if the range ends before it starts
std::vector<double> range_values(const NumericKey& key, const RangeOptions& options,
                                 Spacing spacing);

/// --parameter, --from, --to, --points.
void add_range_options(CLI::App& verb, RangeOptions& options);

/// What was not asked for: the method is the secular function; the geometry is the undeformed one,
/// with contacts on the faces of spinning bodies that of the equilibrium, to which the loads press
/// them.
void make_choices(StabilityOptions& options, const Scene& scene);

/// The scene, --about, --method, --count, --set, --threads and --json.
void add_stability_options(CLI::App& verb, StabilityOptions& options);

/// The key that a verb varies. Only keys of bodies, contacts and drive change eigenvalues.
/// @param option where the path was written
/// @throws ConfigError as find_numeric_key(), or if the key changes no eigenvalue
NumericKey find_stability_key(const Scene& scene, const std::string& path,
                              const std::string& option);

/// A sliding equilibrium and the small motion about it.
struct SlidingState {
  Equilibrium equilibrium;
  Pencil pencil;
  bool is_on_the_way = false;  ///< the drive puts the scene there, by `equilibrium.state`
  Drive leading_drive{};       ///< of the system
};

/// The state of a member of a family, with what the scene keeps of its terms. In the deformed geometry the contact is at the position on
/// the deformed master that the member specifies; the drive is displaced accordingly.
/// @param what names the member in messages, e.g. "contact.start = 0.05"; empty where there is one
/// @throws NumericalError if there is no equilibrium, or every contact is open
SlidingState sliding_state_of(const SceneFamily::Member& member, ContactGeometry geometry,
                              const KeptTerms& terms, const std::string& what);

/// The pencil with the modes above `time.retain` as residual modes (docs/theory.md, 7.1); all modes
/// where the scene keeps all.
Pencil retained(const Pencil& pencil, const System& system,
                const std::optional<TimeParameters>& time);

/// asked_frequency() of a scene; infinite where it has no `time`.
double asked_frequency(const System& system, const std::optional<TimeParameters>& time);

/// The unit of a key as it is printed and stored: "1/s" for "s-1", "kg/m^3" for "kg m-3", "1" where
/// dimensionless.
std::string printed_units(const NumericKey& key);

/// "contact.start = 0.05 m".
std::string value_text(const NumericKey& key, double value);

/// A key and the values at which eigenvalues are wanted.
struct KeyRange {
  NumericKey key;
  std::vector<double> values;  ///< strictly ascending
};

/// How eigenvalues along a key are found, by what the system is.
enum class SpectrumMethod {
  followed,  ///< from value to value, by the problem on the ports that contacts join
  sampled,   ///< all of the dense problem at every value (analysis/sampled_locus.hpp)
  counted,   ///< those in a window of large sparse matrices (analysis/counted_spectra.hpp)
};

/// Small motions of a scene as some of its keys vary.
class StabilityFamily {
 public:
  virtual ~StabilityFamily() = default;

  /// @param values one per key
  /// @throws ConfigError, NumericalError naming the values
  virtual Pencil pencil(std::span<const double> values) = 0;
  /// Frequency up to which the model responds as the bodies do, Hz; may be infinite.
  virtual double trusted_frequency(std::span<const double> values) = 0;
  /// Where eigenvalues are counted there is no pencil(), and spectra() takes its place.
  /// @throws as pencil()
  virtual SpectrumMethod method(std::span<const double>) { return SpectrumMethod::followed; }
  /// The eigenvalues wanted along one of the keys; arguments as of along(). They throw
  /// NumericalError naming the values if one may be missing.
  SpectrumFamily spectra(std::size_t key, const std::vector<double>& values,
                         const LocusOptions& options);

  /// The pencils along one of the keys.
  /// @param key      its index
  /// @param values   of all keys; that of `key` varies
  /// @param from, to where master nodes count as kinks
  /// @return refers to this object
  PencilFamily along(std::size_t key, std::vector<double> values, double from, double to);

  /// Called with the value of the key that varies whenever a pencil along it is made.
  void on_value(std::function<void(double)> report) { report_ = std::move(report); }

 private:
  /// M, P and Q where eigenvalues are counted.
  virtual SparseSystem sparse_system(std::span<const double>) { return {}; }
  virtual std::vector<double> kinks(std::size_t, const std::vector<double>&, double, double) {
    return {};
  }

  std::function<void(double)> report_;
};

/// That of bodies, in contact or not.
class BodyStabilityFamily : public StabilityFamily {
 public:
  BodyStabilityFamily(const LoadedScene& loaded, std::vector<NumericKey> keys,
                      ContactGeometry geometry);

  /// With the modes that `time.retain` keeps.
  SlidingState at(std::span<const double> values);
  Pencil pencil(std::span<const double> values) override { return at(values).pencil; }
  double trusted_frequency(std::span<const double> values) override;
  SpectrumMethod method(std::span<const double> values) override;

 private:
  std::string values_text(std::span<const double> values) const;
  SparseSystem sparse_system(std::span<const double> values) override;
  std::vector<double> kinks(std::size_t key, const std::vector<double>& values, double from,
                            double to) override;

  SceneFamily family_;
  std::optional<TimeParameters> time_;
  KeptTerms terms_;
  std::optional<double> asked_;  ///< asked_frequency() of the first values
  ContactGeometry geometry_;
  std::optional<std::string> start_key_;
};

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

/// Follows eigenvalues along one key of a family. Along a key of whole numbers nothing is put
/// between the values, there are no branches, and windows end at the first and last value at which
/// something grows.
/// @param key    index of the one that varies
/// @param values of all keys
/// @param range  values of that key, strictly ascending
/// @param wanted where stability alone is wanted, sampled loci have a window for every stretch in
///               which anything grows
/// @throws ConfigError, NumericalError
Locus locus_along(StabilityFamily& family, const NumericKey& varied, std::size_t key,
                  const std::vector<double>& values, const std::vector<double>& range,
                  const LocusOptions& options, SearchFor wanted = SearchFor::every_window);

/// A value at which the system as a whole becomes stable or unstable.
struct StabilityChange {
  double value = 0.0;
  double frequency = 0.0;  ///< Hz, of the eigenvalue on the imaginary axis
  bool is_unstable_beyond = false;
};

/// Of all crossings those at which the number of growing eigenvalues leaves or reaches zero.
std::vector<StabilityChange> stability_changes(const Locus& locus);

/// Real eigenvalues, then those of a window with positive imaginary part, lowest first; those there
/// are where there are fewer.
/// @throws NumericalError if they cannot be found
std::vector<Eigenvalue> lowest_eigenvalues(const Pencil& pencil, EigenvalueMethod method,
                                           const SpectrumWindow& window);

/// The same, and by which method they were found.
struct LowestEigenvalues {
  std::vector<Eigenvalue> eigenvalues;
  EigenvalueMethod method = EigenvalueMethod::secular;
  /// Why it is not the method asked for; empty where it is.
  std::string remark;

  const char* method_name() const {
    return method == EigenvalueMethod::dense ? "dense" : "secular";
  }
};

/// If the search for zeros of the secular function does not converge, all eigenvalues are
/// computed by the dense method, if there are no more than 2,000.
/// @throws NumericalError if there are more, or as dense_eigenvalues()
LowestEigenvalues find_lowest(const Pencil& pencil, EigenvalueMethod method,
                              const SpectrumWindow& window);

/// Leaves real eigenvalues, and those of a window with positive imaginary part.
/// @param all ascending Im s
void keep_window(std::vector<Eigenvalue>& all, const SpectrumWindow& window);

/// Up to where a verdict over some of the lowest eigenvalues holds, Hz: to the highest that was
/// computed, to where the window ends, and no further than the model is valid.
double verdict_limit(std::span<const std::complex<double>> eigenvalues,
                     const SpectrumWindow& window, double trusted);
/// The same for all values of a locus.
double verdict_limit(const Locus& locus, const SpectrumWindow& window, double trusted);
/// "the verdict holds between 0 and 7494.83 Hz"
std::string window_text(double highest);
/// Why a verdict reaches no further, in brackets; empty where it does not end.
/// @param trusted up to where the model is valid, Hz
std::string limit_text(double highest, double trusted);

/// Validity of a verdict between the values of a range: "everywhere", or "at all values
/// looked at" where something may have been missed.
std::string reach_text(const Locus& locus);
/// Prints which parts of a locus may have been missed, if any.
void print_resolution(const Locus& locus, const NumericKey& key);

/// Whether a motion grows: Re s > 0 by more than rounding, 1e-10 |s|.
bool is_growing(const Eigenvalue& eigenvalue);

/// Frequency up to which the reduced bodies respond as the full ones, Hz; infinite where no mode is
/// truncated.
///
/// It is half the frequency of the highest fixed-interface mode that any body keeps. Below it the
/// contribution of the truncated modes is quasi-static up to a share of (f/f_cut)² ≤ 1/4, and that
/// is a share of a residual flexibility which the constraint modes already carry. The first
/// fixed-interface mode of a body that keeps none is unknown; such a body gives no limit.
double trusted_frequency(const System& system);

Json eigenvalues_json(const std::vector<Eigenvalue>& eigenvalues);

/// Force, place and sliding of every contact, and displacements.
Json equilibrium_json(const Model& model, const Equilibrium& equilibrium);

}  // namespace stridor
