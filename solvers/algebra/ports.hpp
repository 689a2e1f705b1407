// Small products over the ports of a body, without loops for the sizes that bodies commonly have.
#pragma once

#include <cstddef>
#include <type_traits>

#define STRIDOR_INLINE inline __attribute__((always_inline))
#define STRIDOR_INLINE_LAMBDA __attribute__((always_inline))

namespace stridor {

template <std::size_t n>
using FixedSize = std::integral_constant<std::size_t, n>;

using Ports1 = double __attribute__((vector_size(8)));
using Ports2 = double __attribute__((vector_size(16)));
using Ports4 = double __attribute__((vector_size(32)));
using Ports8 = double __attribute__((vector_size(64)));

/// Some of the n ports of a body, from `first` on, as one vector: without it the compiler stores
/// every partial sum.
template <class Ports>
struct PortLanes {
  std::size_t n;
  std::size_t first;

  STRIDOR_INLINE Ports load(const double* values) const {
    Ports ports;
    __builtin_memcpy(&ports, values + first, sizeof(Ports));
    return ports;
  }
  STRIDOR_INLINE void store(double* values, const Ports& ports) const {
    __builtin_memcpy(values + first, &ports, sizeof(Ports));
  }
  /// M x, M n x n, column after column.
  STRIDOR_INLINE Ports product(const double* matrix, const double* x) const {
    Ports sum = load(matrix) * x[0];
    for (std::size_t b = 1; b < n; ++b) sum += load(matrix + b * n) * x[b];
    return sum;
  }
};

/// Calls work(lanes) for all n ports: in one call where n is a common number. Values that `work`
/// writes must not be read through other lanes.
template <class Work>
STRIDOR_INLINE void for_lanes(std::size_t n, const Work& work) {
  switch (n) {
    case 2:
      return work(PortLanes<Ports2>{2, 0});
    case 4:
      return work(PortLanes<Ports4>{4, 0});
    case 8:
      return work(PortLanes<Ports8>{8, 0});
    default:
      std::size_t first = 0;
      for (; first + 8 <= n; first += 8) work(PortLanes<Ports8>{n, first});
      for (; first + 2 <= n; first += 2) work(PortLanes<Ports2>{n, first});
      if (first < n) work(PortLanes<Ports1>{n, first});
  }
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
