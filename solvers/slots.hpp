// Small products over the slots of a body, without loops for the sizes that bodies commonly have.
#pragma once

#include <cstddef>
#include <type_traits>

#define STRIDOR_INLINE inline __attribute__((always_inline))
#define STRIDOR_INLINE_LAMBDA __attribute__((always_inline))

namespace stridor {

template <std::size_t n>
using FixedSize = std::integral_constant<std::size_t, n>;

/// Calls `work` with the number of slots, as a constant where it is a common one.
template <class Work>
STRIDOR_INLINE void for_size(std::size_t n, const Work& work) {
  switch (n) {
    case 2:
      return work(FixedSize<2>());
    case 4:
      return work(FixedSize<4>());
    case 8:
      return work(FixedSize<8>());
    default:
      return work(n);
  }
}

/// y += M x, M n x n, column after column.
template <class Size>
STRIDOR_INLINE void add_product(Size n, const double* matrix, const double* x, double* y) {
  for (std::size_t b = 0; b < n; ++b) {
    for (std::size_t a = 0; a < n; ++a) y[a] += matrix[b * n + a] * x[b];
  }
}

#if defined(__GNUC__)
// In registers: left to itself the compiler stores every partial sum. The types are spelled out
// because their attributes are lost in templates.
using Slots2 = double __attribute__((vector_size(16), aligned(8), may_alias));
using Slots4 = double __attribute__((vector_size(32), aligned(8), may_alias));
using Slots8 = double __attribute__((vector_size(64), aligned(8), may_alias));

template <class Slots>
STRIDOR_INLINE void add_vector_product(const double* matrix, const double* x, double* y) {
  constexpr std::size_t n = sizeof(Slots) / sizeof(double);
  Slots sum = *reinterpret_cast<const Slots*>(y);
  for (std::size_t b = 0; b < n; ++b) sum += *reinterpret_cast<const Slots*>(matrix + b * n) * x[b];
  *reinterpret_cast<Slots*>(y) = sum;
}
STRIDOR_INLINE void add_product(FixedSize<2>, const double* matrix, const double* x, double* y) {
  add_vector_product<Slots2>(matrix, x, y);
}
STRIDOR_INLINE void add_product(FixedSize<4>, const double* matrix, const double* x, double* y) {
  add_vector_product<Slots4>(matrix, x, y);
}
STRIDOR_INLINE void add_product(FixedSize<8>, const double* matrix, const double* x, double* y) {
  add_vector_product<Slots8>(matrix, x, y);
}
#endif

/// y = M x.
template <class Size>
STRIDOR_INLINE void product(Size n, const double* matrix, const double* x, double* y) {
  for (std::size_t a = 0; a < n; ++a) y[a] = 0.0;
  add_product(n, matrix, x, y);
}

/// Σ a_k b_k for an even n.
template <class Size>
STRIDOR_INLINE double dot(Size n, const double* a, const double* b) {
  double even = 0.0;
  double odd = 0.0;
  for (std::size_t k = 0; k < n; k += 2) {
    even += a[k] * b[k];
    odd += a[k + 1] * b[k + 1];
  }
  return even + odd;
}

}  // namespace stridor
