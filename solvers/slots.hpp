// Small products over the slots of a body, without loops for the sizes that bodies commonly have.
#pragma once

#include <cstddef>

#define STRIDOR_INLINE inline __attribute__((always_inline))

namespace stridor {

// Two, four or eight slots in arrays that need not be aligned.
using Slots2 = double __attribute__((vector_size(16), aligned(8), may_alias));
using Slots4 = double __attribute__((vector_size(32), aligned(8), may_alias));
using Slots8 = double __attribute__((vector_size(64), aligned(8), may_alias));

/// y += M x, M n x n, column after column.
template <class Slots>
STRIDOR_INLINE void add_product(const double* matrix, const double* x, double* y) {
  constexpr std::size_t n = sizeof(Slots) / sizeof(double);
  Slots sum = *reinterpret_cast<const Slots*>(y);
  for (std::size_t b = 0; b < n; ++b) sum += *reinterpret_cast<const Slots*>(matrix + b * n) * x[b];
  *reinterpret_cast<Slots*>(y) = sum;
}

STRIDOR_INLINE void add_product(std::size_t n, const double* matrix, const double* x, double* y) {
  switch (n) {
    case 2:
      return add_product<Slots2>(matrix, x, y);
    case 4:
      return add_product<Slots4>(matrix, x, y);
    case 8:
      return add_product<Slots8>(matrix, x, y);
    default:
      for (std::size_t b = 0; b < n; ++b) {
        for (std::size_t a = 0; a < n; ++a) y[a] += matrix[b * n + a] * x[b];
      }
  }
}

/// Σ a_k b_k.
template <int n>
STRIDOR_INLINE double dot(const double* a, const double* b) {
  double even = 0.0;
  double odd = 0.0;
  for (int k = 0; k < n; k += 2) {
    even += a[k] * b[k];
    odd += a[k + 1] * b[k + 1];
  }
  return even + odd;
}

/// For even n.
STRIDOR_INLINE double dot(int n, const double* a, const double* b) {
  if (n == 4) return dot<4>(a, b);
  double sum = 0.0;
  for (int k = 0; k < n; k += 2) sum += dot<2>(a + k, b + k);
  return sum;
}

}  // namespace stridor
