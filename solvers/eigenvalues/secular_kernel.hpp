// The innermost loops of the secular eigenvalue method: sums over modes at one complex number.
#pragma once

#include <cstddef>

namespace stridor {

/// Arrays over modes are padded to whole multiples of this many; padding has ω = `padding_omega`
/// and zero weights.
inline constexpr std::size_t secular_block = 8;
inline constexpr double padding_omega = 1e70;

/// Modes as the loops want them: 64-byte aligned, padded.
struct SecularModes {
  const double* omega = nullptr;    ///< ω, rad/s
  const double* damping = nullptr;  ///< c, 1/s
  std::size_t size = 0;             ///< padded
};

/// Sums of one weight per mode, with d = s² + c s + ω².
struct SecularSums {
  double value_re = 0.0;  ///< Σ w/d
  double value_im = 0.0;
  double slope_re = 0.0;  ///< −d/ds Σ w/d = Σ w (2 s + c)/d²
  double slope_im = 0.0;
  double least = 0.0;  ///< min |d|²
};

/// 1/d and −d/ds(1/d) of every mode, one array after the other.
struct InverseModes {
  double* value_re = nullptr;
  double* value_im = nullptr;
  double* slope_re = nullptr;
  double* slope_im = nullptr;
  double* norm = nullptr;  ///< |d|²
};

/// Weighted sums at s = x + iy (docs/theory.md, 7.3). A mode of weight zero adds nothing, even
/// where s is its pole.
SecularSums sum_modes(const SecularModes& modes, const double* weights, double x, double y);

/// The same mode by mode, for sums with several weights.
/// @return min |d|²
double invert_modes(const SecularModes& modes, double x, double y, const InverseModes& inverse);

/// Σ w_i re_i and Σ w_i im_i.
void weigh(const double* weights, const double* re, const double* im, std::size_t size,
           double* sum_re, double* sum_im);

/// Σ m (2 s + c)/d at s = x + iy: logarithmic derivative of the product of the d with m = 1.
void sum_pole_slopes(const SecularModes& modes, const double* mask, double x, double y,
                     double* sum_re, double* sum_im);

/// What repels an iterate of Ehrlich and Aberth's search.
struct Repulsion {
  double re = 0.0;  ///< Σ 1/(z − z_i)
  double im = 0.0;
  double least = padding_omega * padding_omega;  ///< min |z − z_i|²
};

/// Of all z_i but those that equal z = x + iy.
/// @param re, im 64-byte aligned and padded with numbers far away
Repulsion sum_repulsion(const double* re, const double* im, std::size_t size, double x, double y);

}  // namespace stridor
