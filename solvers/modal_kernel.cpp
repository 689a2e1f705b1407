#include "solvers/modal_kernel.hpp"

#define STRIDOR_INLINE inline __attribute__((always_inline))

namespace stridor {
namespace {

// Vectors of 4 and 8 doubles. The compiler splits them where the instruction set has shorter ones,
// so one source serves every processor.
using Vector4 = double __attribute__((vector_size(32)));
using Vector8 = double __attribute__((vector_size(64)));

template <class Vector>
constexpr std::size_t lanes = sizeof(Vector) / sizeof(double);

template <class Vector>
STRIDOR_INLINE const Vector& at(const double* values, std::size_t i) {
  return *reinterpret_cast<const Vector*>(
      static_cast<const double*>(__builtin_assume_aligned(values, 64)) + i);
}

template <class Vector>
STRIDOR_INLINE Vector& at(double* values, std::size_t i) {
  return *reinterpret_cast<Vector*>(static_cast<double*>(__builtin_assume_aligned(values, 64)) + i);
}

template <class Vector>
STRIDOR_INLINE double sum_of(const Vector& vector) {
  // Pairwise, so that the order does not depend on how the compiler splits the vector.
  double partial[lanes<Vector>];
  for (std::size_t i = 0; i < lanes<Vector>; ++i) partial[i] = vector[i];
  for (std::size_t width = lanes<Vector> / 2; width > 0; width /= 2) {
    for (std::size_t i = 0; i < width; ++i) partial[i] += partial[i + width];
  }
  return partial[0];
}

/// The fused pass for 0, 2 or 4 slots.
template <class Vector, int num_slots>
STRIDOR_INLINE void fused_pass(const ModalArrays& modes, const double* const* rows,
                               const double* forces, double* predicted) {
  constexpr bool has2 = num_slots >= 2;
  constexpr bool has4 = num_slots >= 4;
  const double* const row0 = has2 ? rows[0] : nullptr;
  const double* const row1 = has2 ? rows[1] : nullptr;
  const double* const row2 = has4 ? rows[2] : nullptr;
  const double* const row3 = has4 ? rows[3] : nullptr;
  const double force0 = has2 ? forces[0] : 0.0;
  const double force1 = has2 ? forces[1] : 0.0;
  const double force2 = has4 ? forces[2] : 0.0;
  const double force3 = has4 ? forces[3] : 0.0;
  double* const q = modes.position;
  double* const d = modes.increment;
  const double* const keep = modes.keep;
  const double* const pull = modes.pull;
  const double* const gain = modes.gain;
  const double* const load = modes.load;
  const std::size_t size = modes.size;
  Vector sum0{};
  Vector sum1{};
  Vector sum2{};
  Vector sum3{};
  for (std::size_t i = 0; i < size; i += lanes<Vector>) {
    Vector increment = at<Vector>(d, i);
    if constexpr (has2) {
      Vector modal_force = at<Vector>(row0, i) * force0 + at<Vector>(row1, i) * force1;
      if constexpr (has4)
        modal_force += at<Vector>(row2, i) * force2 + at<Vector>(row3, i) * force3;
      increment += at<Vector>(gain, i) * modal_force;
    }
    const Vector position = at<Vector>(q, i) + increment;
    const Vector next =
        at<Vector>(keep, i) * increment - (at<Vector>(pull, i) * position - at<Vector>(load, i));
    at<Vector>(q, i) = position;
    at<Vector>(d, i) = next;
    const Vector ahead = position + next;
    if constexpr (has2) {
      sum0 += at<Vector>(row0, i) * ahead;
      sum1 += at<Vector>(row1, i) * ahead;
    }
    if constexpr (has4) {
      sum2 += at<Vector>(row2, i) * ahead;
      sum3 += at<Vector>(row3, i) * ahead;
    }
  }
  if constexpr (has2) {
    predicted[0] = sum_of(sum0);
    predicted[1] = sum_of(sum1);
  }
  if constexpr (has4) {
    predicted[2] = sum_of(sum2);
    predicted[3] = sum_of(sum3);
  }
}

template <class Vector>
STRIDOR_INLINE void advance(const ModalArrays& modes, const double* const* rows,
                            const double* forces, int num_slots, double* predicted) {
  // Slots beyond the fused ones stream the rows once more; a body rarely has any.
  const int fused = num_slots >= 4 ? 4 : num_slots >= 2 ? 2 : 0;
  for (int j = fused; j < num_slots; ++j) {
    for (std::size_t i = 0; i < modes.size; i += lanes<Vector>) {
      at<Vector>(modes.increment, i) +=
          at<Vector>(modes.gain, i) * (at<Vector>(rows[j], i) * forces[j]);
    }
  }
  if (fused == 4) {
    fused_pass<Vector, 4>(modes, rows, forces, predicted);
  } else if (fused == 2) {
    fused_pass<Vector, 2>(modes, rows, forces, predicted);
  } else {
    fused_pass<Vector, 0>(modes, rows, forces, predicted);
  }
  for (int j = fused; j < num_slots; ++j) {
    Vector sum{};
    for (std::size_t i = 0; i < modes.size; i += lanes<Vector>) {
      sum +=
          at<Vector>(rows[j], i) * (at<Vector>(modes.position, i) + at<Vector>(modes.increment, i));
    }
    predicted[j] = sum_of(sum);
  }
}

template <class Vector>
STRIDOR_INLINE double dot_product(const double* a, const double* b, std::size_t size) {
  Vector even{};
  Vector odd{};
  std::size_t i = 0;
  for (; i + 2 * lanes<Vector> <= size; i += 2 * lanes<Vector>) {
    even += at<Vector>(a, i) * at<Vector>(b, i);
    odd += at<Vector>(a, i + lanes<Vector>) * at<Vector>(b, i + lanes<Vector>);
  }
  if (i < size) even += at<Vector>(a, i) * at<Vector>(b, i);
  return sum_of<Vector>(even + odd);
}

using Advance = void (*)(const ModalArrays&, const double* const*, const double*, int, double*);
using Dot = double (*)(const double*, const double*, std::size_t);

struct Kernel {
  Advance advance;
  Dot dot;
};

void advance_portable(const ModalArrays& modes, const double* const* rows, const double* forces,
                      int num_slots, double* predicted) {
  advance<Vector4>(modes, rows, forces, num_slots, predicted);
}
double dot_portable(const double* a, const double* b, std::size_t size) {
  return dot_product<Vector4>(a, b, size);
}

#if defined(__x86_64__)
__attribute__((target("arch=x86-64-v3"))) void advance_v3(const ModalArrays& modes,
                                                          const double* const* rows,
                                                          const double* forces, int num_slots,
                                                          double* predicted) {
  advance<Vector4>(modes, rows, forces, num_slots, predicted);
}
__attribute__((target("arch=x86-64-v3"))) double dot_v3(const double* a, const double* b,
                                                        std::size_t size) {
  return dot_product<Vector4>(a, b, size);
}
__attribute__((target("arch=x86-64-v4,prefer-vector-width=512"))) void advance_v4(
    const ModalArrays& modes, const double* const* rows, const double* forces, int num_slots,
    double* predicted) {
  advance<Vector8>(modes, rows, forces, num_slots, predicted);
}
__attribute__((target("arch=x86-64-v4,prefer-vector-width=512"))) double dot_v4(const double* a,
                                                                                const double* b,
                                                                                std::size_t size) {
  return dot_product<Vector8>(a, b, size);
}
#endif

Kernel kernel_of_this_processor() {
#if defined(__x86_64__)
  __builtin_cpu_init();
  const bool has_v3 = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") &&
                      __builtin_cpu_supports("bmi2");
  const bool has_v4 = has_v3 && __builtin_cpu_supports("avx512f") &&
                      __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512cd") &&
                      __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl");
  if (has_v4) return {advance_v4, dot_v4};
  if (has_v3) return {advance_v3, dot_v3};
#endif
  return {advance_portable, dot_portable};
}

const Kernel kernel = kernel_of_this_processor();

}  // namespace

void advance_modes(const ModalArrays& modes, const double* const* rows, const double* forces,
                   int num_slots, double* predicted) {
  kernel.advance(modes, rows, forces, num_slots, predicted);
}

double dot(const double* a, const double* b, std::size_t size) {
  return kernel.dot(a, b, size);
}

}  // namespace stridor
