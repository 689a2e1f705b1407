// Spectra of large sparse systems along a parameter, counted so that none is missed.
#pragma once

#include <complex>
#include <functional>
#include <map>
#include <utility>

#include "analysis/spectrum_sampler.hpp"
#include "solvers/eigenvalues/sparse_spectrum.hpp"

namespace stridor {

/// All eigenvalues of sparse_spectrum() in a window. A count within a frequency is taken from all
/// below it.
/// @throws NumericalError unless every one was found; as sparse_spectrum()
SparseSpectrum whole_spectrum(const SparseSystem& system, SpectrumWindow window);

/// Spectra of large matrices along a parameter, for sample_locus(). All eigenvalues take a search;
/// between two values where they are known their eigenvectors say where to look. Those of the
/// values looked at are kept, up to 1 GB of them.
class CountedSpectra {
 public:
  using System = std::function<SparseSystem(double value)>;
  /// @param window of the eigenvalues wanted
  CountedSpectra(System system, const SpectrumWindow& window);

  // As the members of SpectrumFamily. They throw as whole_spectrum().
  SampledSpectrum at(double value);
  SampledSpectrum near(double value);
  SampledSpectrum around(double value, std::complex<double> place);
  SampledSpectrum glimpse(double value);

 private:
  const SpectrumBasis* basis_at(double value);

  System system_;
  SpectrumWindow window_;
  std::map<double, SparseSpectrum> known_;
  Eigen::Index kept_ = 0;  ///< complex numbers in known_
  SpectrumBasis basis_;
  std::pair<double, double> basis_of_{0.0, 0.0};
};

/// The members of CountedSpectra as a family, which keeps it.
SpectrumFamily counted_spectra(CountedSpectra::System system, const SpectrumWindow& window);

}  // namespace stridor
