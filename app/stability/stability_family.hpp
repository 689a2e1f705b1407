// Small motions of a scene as some of its keys vary.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "analysis/locus.hpp"
#include "analysis/sampled_locus.hpp"
#include "app/stability/sliding_state.hpp"
#include "io/scene/scene_family.hpp"
#include "solvers/eigenvalues/sparse_pencil.hpp"

namespace stridor {

/// How eigenvalues along a key are found, by what the system is.
enum class SpectrumMethod {
  followed,  ///< from value to value, by the problem on the ports that contacts join
  sampled,   ///< all of the dense problem at every value (analysis/sampled_locus.hpp)
  /// Those in a window of a dense problem so large that all at every value would take long, from
  /// those of the nearest value (analysis/followed_spectra.hpp).
  from_neighbours,
  counted,  ///< those in a window of large sparse matrices (analysis/counted_spectra.hpp)
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
  /// The eigenvalues wanted along one of the keys where they come from neighbours or are counted;
  /// arguments as of along(). They throw NumericalError naming the values if one may be missing.
  /// @param range of the key, where many values of it will be asked for
  SpectrumFamily spectra(std::size_t key, const std::vector<double>& values,
                         const LocusOptions& options,
                         std::optional<std::pair<double, double>> range = std::nullopt);

  /// The pencils along one of the keys.
  /// @param key      its index
  /// @param values   of all keys; that of `key` varies
  /// @param from, to where master nodes count as kinks
  /// @return refers to this object
  PencilFamily along(std::size_t key, std::vector<double> values, double from, double to);

  /// Called with the value of the key that varies whenever a pencil along it is made.
  void on_value(std::function<void(double)> report) { report_ = std::move(report); }

 private:
  /// M, P and Q where eigenvalues come from neighbours or are counted.
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
  SlidingState at(std::span<const double> values) { return at(family_.at(values), values); }
  Pencil pencil(std::span<const double> values) override { return at(values).pencil; }
  double trusted_frequency(std::span<const double> values) override;
  SpectrumMethod method(std::span<const double> values) override;

 private:
  SlidingState at(const SceneFamily::Member& member, std::span<const double> values);
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

/// Up to where the bodies resolve at both ends of a range of the only key, Hz.
double trusted_along(StabilityFamily& family, const std::vector<double>& range);

}  // namespace stridor
