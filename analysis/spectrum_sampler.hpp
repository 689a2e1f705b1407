// Spectra of a system at single values of a parameter: growing eigenvalues and their matching.
#pragma once

#include <complex>
#include <functional>
#include <vector>

#include "analysis/locus.hpp"

namespace stridor {

/// Eigenvalues at one value of a parameter.
struct SampledSpectrum {
  std::vector<std::complex<double>> eigenvalues;  ///< Im s >= 0, ascending Im s
  std::vector<double> rounding;  ///< possible rounding error of each real part, 1/s
  bool is_counted = true;        ///< whether it is verified that these are all
};

/// Those of a system that depends on one parameter; called in any order.
struct SpectrumFamily {
  /// All that are wanted.
  std::function<SampledSpectrum(double value)> at;
  /// Where `at` takes longer: with all that grow, not verified; and with those closest to a place in
  /// the complex plane. Both or none.
  std::function<SampledSpectrum(double value)> near;
  std::function<SampledSpectrum(double value, std::complex<double> place)> around;
};

/// The spectra of pencils by the dense method.
/// @param family referenced
SpectrumFamily dense_spectra(const PencilFamily& family);

/// The eigenvalues wanted at one value, and how fast they grow.
struct Sample {
  double value = 0.0;
  std::vector<std::complex<double>> eigenvalues;  ///< Im s >= 0, ascending Im s
  /// Of each: its real part less the possible rounding error, 1/s; −∞ above the trusted frequency.
  std::vector<double> excess;
  bool is_counted = true;  ///< as that of the spectrum

  bool is_growing(std::size_t i) const { return excess[i] > 0.0; }
  std::size_t num_growing() const;
  /// The eigenvalues that grow.
  std::vector<std::complex<double>> growing() const;
  /// The rank-th largest excess, 1 for the largest; −∞ where there are fewer.
  double ranked_excess(std::size_t rank) const;
  /// The eigenvalue of the largest excess; there must be one.
  std::complex<double> fastest() const;
};

/// Takes the samples of a family that a locus needs.
class SpectrumSampler {
 public:
  /// @param family, options referenced
  SpectrumSampler(const SpectrumFamily& family, const LocusOptions& options)
      : family_(family), options_(options) {}

  /// Whether around() gives but a part of the eigenvalues.
  bool has_parts() const { return family_.around != nullptr; }
  Sample at(double value) const { return sample_of(value, family_.at(value)); }
  /// With all that grow.
  Sample near(double value) const {
    return family_.near ? sample_of(value, family_.near(value)) : at(value);
  }
  /// With those closest to a place.
  Sample around(double value, std::complex<double> place) const {
    return family_.around ? sample_of(value, family_.around(value, place)) : at(value);
  }

 private:
  Sample sample_of(double value, SampledSpectrum all) const;

  const SpectrumFamily& family_;
  const LocusOptions& options_;
};

/// Which of the eigenvalues found continues which of those expected, the closest first.
/// @return for each expected one the index of the one found, −1 where none is left
std::vector<int> continuations(const std::vector<std::complex<double>>& expected,
                               const std::vector<std::complex<double>>& found);

}  // namespace stridor
