// How alike two frequency responses, or two shapes, are.
#pragma once

#include <cmath>
#include <complex>
#include <span>

namespace stridor {

/// |Σ a* b|²/(Σ|a|² Σ|b|²): 1 for the same values at any scale and phase, 0 for nothing in common
/// or where one is zero. Over frequencies this is the frequency response assurance criterion (FRAC,
/// Heylen and Lammens 1996), over the directions of points the modal one (MAC, Allemang and Brown
/// 1982).
inline double assurance_criterion(std::span<const std::complex<double>> a,
                                  std::span<const std::complex<double>> b) {
  std::complex<double> common = 0.0;
  double of_a = 0.0, of_b = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    common += std::conj(a[i]) * b[i];
    of_a += std::norm(a[i]);
    of_b += std::norm(b[i]);
  }
  return of_a > 0.0 && of_b > 0.0 ? std::norm(common) / of_a / of_b : 0.0;
}

/// ‖a − b‖/‖b‖ over the same frequencies; 0 where both are zero.
inline double response_difference(std::span<const std::complex<double>> a,
                                  std::span<const std::complex<double>> b) {
  double difference = 0.0, size = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    difference += std::norm(a[i] - b[i]);
    size += std::norm(b[i]);
  }
  return difference == 0.0 ? 0.0 : std::sqrt(difference / size);
}

}  // namespace stridor
