// How alike two frequency responses are.
#pragma once

#include <cmath>
#include <complex>
#include <span>

namespace stridor {

/// Frequency response assurance criterion |Σ a* b|²/(Σ|a|² Σ|b|²) over the same frequencies (Heylen
/// and Lammens 1996): 1 for the same shape at any scale, 0 for nothing in common or where one is zero.
inline double response_assurance(std::span<const std::complex<double>> a,
                                 std::span<const std::complex<double>> b) {
  std::complex<double> common = 0.0;
  double of_a = 0.0, of_b = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    common += std::conj(a[i]) * b[i];
    of_a += std::norm(a[i]);
    of_b += std::norm(b[i]);
  }
  return of_a > 0.0 && of_b > 0.0 ? std::norm(common) / (of_a * of_b) : 0.0;
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
