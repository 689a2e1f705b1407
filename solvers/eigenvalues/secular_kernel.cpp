#include "solvers/eigenvalues/secular_kernel.hpp"

#include "core/processor.hpp"

#define STRIDOR_INLINE inline __attribute__((always_inline))

namespace stridor {
namespace {

// Vectors of 4 and 8 doubles, chosen when the program starts, as in modal_kernel.cpp.
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
  double partial[lanes<Vector>];
  for (std::size_t i = 0; i < lanes<Vector>; ++i) partial[i] = vector[i];
  for (std::size_t width = lanes<Vector> / 2; width > 0; width /= 2) {
    for (std::size_t i = 0; i < width; ++i) partial[i] += partial[i + width];
  }
  return partial[0];
}

template <class Vector>
STRIDOR_INLINE double least_of(const Vector& vector) {
  double least = vector[0];
  for (std::size_t i = 1; i < lanes<Vector>; ++i) least = vector[i] < least ? vector[i] : least;
  return least;
}

/// 1/d of some modes, with |d|².
template <class Vector>
struct Inverse {
  Vector re, im, norm;
};

template <class Vector>
STRIDOR_INLINE Inverse<Vector> invert(const Vector& omega, const Vector& damping, double x,
                                      double y) {
  // (ω − y)(ω + y) keeps its relative accuracy next to a lightly damped pole; ω² − y² does not.
  const Vector re = (omega - y) * (omega + y) + x * (damping + x);
  const Vector im = y * (damping + 2.0 * x);
  // Far below any |d|², but at a pole itself it makes of 0/0 a finite number.
  constexpr double tiny = 1e-290;
  const Vector norm = re * re + (im * im + tiny);
  const Vector scale = 1.0 / norm;
  return {re * scale, -im * scale, norm};
}

template <class Vector>
STRIDOR_INLINE SecularSums sums(const SecularModes& modes, const double* weights, double x,
                                double y) {
  Vector value_re{}, value_im{}, slope_re{}, slope_im{};
  Vector least = padding_omega * padding_omega + Vector{};
  const double twice_x = 2.0 * x;
  const double twice_y = 2.0 * y;
  for (std::size_t i = 0; i < modes.size; i += lanes<Vector>) {
    const Vector damping = at<Vector>(modes.damping, i);
    const Vector weight = at<Vector>(weights, i);
    const Inverse<Vector> inverse = invert(at<Vector>(modes.omega, i), damping, x, y);
    const Vector term_re = weight * inverse.re;
    const Vector term_im = weight * inverse.im;
    value_re += term_re;
    value_im += term_im;
    // (2 s + c)/d of the mode.
    const Vector rate_re = (damping + twice_x) * inverse.re - twice_y * inverse.im;
    const Vector rate_im = (damping + twice_x) * inverse.im + twice_y * inverse.re;
    slope_re += term_re * rate_re - term_im * rate_im;
    slope_im += term_re * rate_im + term_im * rate_re;
    least = inverse.norm < least ? inverse.norm : least;
  }
  return {sum_of(value_re), sum_of(value_im), sum_of(slope_re), sum_of(slope_im), least_of(least)};
}

template <class Vector>
STRIDOR_INLINE double invert_all(const SecularModes& modes, double x, double y,
                                 const InverseModes& all) {
  Vector least = padding_omega * padding_omega + Vector{};
  const double twice_x = 2.0 * x;
  const double twice_y = 2.0 * y;
  for (std::size_t i = 0; i < modes.size; i += lanes<Vector>) {
    const Vector damping = at<Vector>(modes.damping, i);
    const Inverse<Vector> inverse = invert(at<Vector>(modes.omega, i), damping, x, y);
    const Vector rate_re = (damping + twice_x) * inverse.re - twice_y * inverse.im;
    const Vector rate_im = (damping + twice_x) * inverse.im + twice_y * inverse.re;
    at<Vector>(all.value_re, i) = inverse.re;
    at<Vector>(all.value_im, i) = inverse.im;
    at<Vector>(all.slope_re, i) = inverse.re * rate_re - inverse.im * rate_im;
    at<Vector>(all.slope_im, i) = inverse.re * rate_im + inverse.im * rate_re;
    at<Vector>(all.norm, i) = inverse.norm;
    least = inverse.norm < least ? inverse.norm : least;
  }
  return least_of(least);
}

template <class Vector>
STRIDOR_INLINE void weigh_all(const double* weights, const double* re, const double* im,
                              std::size_t size, double* sum_re, double* sum_im) {
  // Two sums each, so that an addition need not wait for the one before.
  Vector even_re{}, even_im{}, odd_re{}, odd_im{};
  std::size_t i = 0;
  for (; i + 2 * lanes<Vector> <= size; i += 2 * lanes<Vector>) {
    even_re += at<Vector>(weights, i) * at<Vector>(re, i);
    even_im += at<Vector>(weights, i) * at<Vector>(im, i);
    odd_re += at<Vector>(weights, i + lanes<Vector>) * at<Vector>(re, i + lanes<Vector>);
    odd_im += at<Vector>(weights, i + lanes<Vector>) * at<Vector>(im, i + lanes<Vector>);
  }
  for (; i < size; i += lanes<Vector>) {
    even_re += at<Vector>(weights, i) * at<Vector>(re, i);
    even_im += at<Vector>(weights, i) * at<Vector>(im, i);
  }
  *sum_re = sum_of<Vector>(even_re + odd_re);
  *sum_im = sum_of<Vector>(even_im + odd_im);
}

template <class Vector>
STRIDOR_INLINE void pole_slopes(const SecularModes& modes, const double* mask, double x, double y,
                                double* sum_re, double* sum_im) {
  Vector total_re{}, total_im{};
  const double twice_x = 2.0 * x;
  const double twice_y = 2.0 * y;
  for (std::size_t i = 0; i < modes.size; i += lanes<Vector>) {
    const Vector damping = at<Vector>(modes.damping, i);
    const Vector present = at<Vector>(mask, i);
    const Inverse<Vector> inverse = invert(at<Vector>(modes.omega, i), damping, x, y);
    total_re += present * ((damping + twice_x) * inverse.re - twice_y * inverse.im);
    total_im += present * ((damping + twice_x) * inverse.im + twice_y * inverse.re);
  }
  *sum_re = sum_of(total_re);
  *sum_im = sum_of(total_im);
}

template <class Vector>
STRIDOR_INLINE Repulsion repulsion(const double* re, const double* im, std::size_t size, double x,
                                   double y) {
  Vector sum_re{}, sum_im{};
  const Vector far = padding_omega * padding_omega + Vector{};
  Vector least = far;
  for (std::size_t i = 0; i < size; i += lanes<Vector>) {
    const Vector away_re = x - at<Vector>(re, i);
    const Vector away_im = y - at<Vector>(im, i);
    const Vector square = away_re * away_re + away_im * away_im;
    // Nothing where they are equal.
    const Vector apart = square == 0.0 ? far : square;
    const Vector scale = 1.0 / apart;
    sum_re += away_re * scale;
    sum_im -= away_im * scale;
    least = apart < least ? apart : least;
  }
  return {sum_of(sum_re), sum_of(sum_im), least_of(least)};
}

struct Kernel {
  SecularSums (*sums)(const SecularModes&, const double*, double, double);
  double (*invert)(const SecularModes&, double, double, const InverseModes&);
  void (*weigh)(const double*, const double*, const double*, std::size_t, double*, double*);
  void (*pole_slopes)(const SecularModes&, const double*, double, double, double*, double*);
  Repulsion (*repulsion)(const double*, const double*, std::size_t, double, double);
};

// The five loops compiled for one instruction set.
#define STRIDOR_SECULAR_KERNEL(name, target, Vector)                                           \
  target SecularSums sums_##name(const SecularModes& modes, const double* weights, double x,   \
                                 double y) {                                                   \
    return sums<Vector>(modes, weights, x, y);                                                 \
  }                                                                                            \
  target double invert_##name(const SecularModes& modes, double x, double y,                   \
                              const InverseModes& inverse) {                                   \
    return invert_all<Vector>(modes, x, y, inverse);                                           \
  }                                                                                            \
  target void weigh_##name(const double* weights, const double* re, const double* im,          \
                           std::size_t size, double* sum_re, double* sum_im) {                 \
    weigh_all<Vector>(weights, re, im, size, sum_re, sum_im);                                  \
  }                                                                                            \
  target void pole_slopes_##name(const SecularModes& modes, const double* mask, double x,      \
                                 double y, double* sum_re, double* sum_im) {                   \
    pole_slopes<Vector>(modes, mask, x, y, sum_re, sum_im);                                    \
  }                                                                                            \
  target Repulsion repulsion_##name(const double* re, const double* im, std::size_t size,      \
                                    double x, double y) {                                      \
    return repulsion<Vector>(re, im, size, x, y);                                              \
  }                                                                                            \
  constexpr Kernel kernel_##name{sums_##name, invert_##name, weigh_##name, pole_slopes_##name, \
                                 repulsion_##name};

STRIDOR_SECULAR_KERNEL(portable, , Vector4)
#if defined(__x86_64__)
STRIDOR_SECULAR_KERNEL(v3, STRIDOR_V3, Vector4)
STRIDOR_SECULAR_KERNEL(v4, STRIDOR_V4, Vector8)
#endif
#undef STRIDOR_SECULAR_KERNEL

Kernel kernel_of_this_processor() {
#if defined(__x86_64__)
  const KernelSet set = kernel_set();
  if (set == KernelSet::v4) return kernel_v4;
  if (set == KernelSet::v3) return kernel_v3;
#endif
  return kernel_portable;
}

const Kernel kernel = kernel_of_this_processor();

}  // namespace

SecularSums sum_modes(const SecularModes& modes, const double* weights, double x, double y) {
  return kernel.sums(modes, weights, x, y);
}

double invert_modes(const SecularModes& modes, double x, double y, const InverseModes& inverse) {
  return kernel.invert(modes, x, y, inverse);
}

void weigh(const double* weights, const double* re, const double* im, std::size_t size,
           double* sum_re, double* sum_im) {
  kernel.weigh(weights, re, im, size, sum_re, sum_im);
}

void sum_pole_slopes(const SecularModes& modes, const double* mask, double x, double y,
                     double* sum_re, double* sum_im) {
  kernel.pole_slopes(modes, mask, x, y, sum_re, sum_im);
}

Repulsion sum_repulsion(const double* re, const double* im, std::size_t size, double x, double y) {
  return kernel.repulsion(re, im, size, x, y);
}

}  // namespace stridor
