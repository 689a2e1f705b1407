// Which eigenvalues at one value of a parameter go on as which ones at the next, where they have
// been found anew.
#pragma once

#include <complex>
#include <vector>

#include "analysis/spectrum_source.hpp"

namespace stridor {

/// Eigenvalues at a value of the parameter.
struct FormerSpectrum {
  double value = 0.0;
  std::vector<std::complex<double>> s;
  std::vector<double> spacing;  ///< of each: distance to the nearest one not tied to it
};

/// For every eigenvalue of the former spectrum, the index of the one that continues it, or −1.
///
/// Those that have hardly moved go on as they are nearest to; of the others several may be equally
/// near, and those of like shape go together.
///
/// @param source at `value`; is there again afterwards
/// @param after  eigenvalues at `value`
std::vector<int> continuations(SpectrumSource& source, const FormerSpectrum& former,
                               const std::vector<std::complex<double>>& after, double value);

}  // namespace stridor
