// The secular function of a pencil: its zeros are the eigenvalues.
#pragma once

#include <algorithm>
#include <array>
#include <complex>
#include <map>
#include <optional>
#include <vector>

#include "solvers/algebra/aligned_array.hpp"
#include "solvers/eigenvalues/pencil.hpp"
#include "solvers/eigenvalues/secular_kernel.hpp"
#include "solvers/eigenvalues/secular_poles.hpp"
#include "solvers/eigenvalues/secular_weights.hpp"

namespace stridor {

/// Characteristic function of a pencil, reduced to its contacts (docs/theory.md, 7.3).
///
///   A(s) = [ b_C D⁻¹ b_Eᵀ        b_C D⁻¹ p(s)ᵀ  ]
///          [ v D⁻¹ b_Eᵀ      1 + v D⁻¹ p(s)ᵀ    ],   D = diag(s² + c s + ω²),  p = p_G + s p_H
///   P(s) = det A(s) Π d_i(s)
///
/// P is the characteristic polynomial. With one contact and without G and H, A is the number
/// f(s) = Σ b_C,i b_E,i/(s² + c_i s + ω_i²). Modes whose residue vanishes are zeros of P like the
/// others. Modes that gyroscopic, circulatory and non-proportional damping terms of their body
/// couple are replaced by pairs of its complex modes (CoupledModes), whose weights are polynomials
/// of s; ω² is then the product of the two poles of a pair, and −c their sum.
///
/// P overflows, and f has poles next to its zeros. Evaluated is the logarithmic derivative
/// of F(s) = det A Π_near d_i, in which the pole nearest to s is multiplied out; F is smooth where
/// f is not, and a zero that coincides with a pole is one like any other.
class SecularFunction {
 public:
  /// @throws std::invalid_argument as check_pencil()
  explicit SecularFunction(const Pencil& pencil);

  /// Takes over another pencil; the cost is much lower where its ω, c and coupled terms are the same
  /// as before.
  /// @throws std::invalid_argument as check_pencil(); the function is then unchanged
  void assign(const Pencil& pencil);

  Eigen::Index num_modes() const { return poles_.num_modes(); }
  Eigen::Index num_constraints() const { return weights_.num_constraints(); }
  /// Zeros of P, 2 (n − k).
  Eigen::Index num_zeros() const { return 2 * (num_modes() - num_constraints()); }
  /// SecularPoles::height_of().
  static double height_of(std::complex<double> s) { return SecularPoles::height_of(s); }
  /// Heights of the poles, 0 for those within the wedge, ascending; one per mode.
  const std::vector<double>& pole_heights() const { return poles_.sorted_heights(); }
  /// The poles of mode i, in ascending ω, as SecularPoles::of().
  std::array<std::complex<double>, 2> poles(Eigen::Index i) const {
    return poles_.of(static_cast<std::size_t>(i));
  }
  /// A length beyond every pole and, unless B_C S Sᵀ B_Eᵀ is almost singular, every zero, 1/s.
  double extent() const { return poles_.extent(); }
  /// A zero this much smaller than the smallest pole that is not zero is no different from zero, as
  /// one of this relative error is exact: the size of numbers whose rounding steps are measured by.
  double size_of(std::complex<double> s) const { return std::max(std::abs(s), poles_.smallest()); }

  /// F'/F at a number, and the poles multiplied out.
  struct LogSlope {
    std::complex<double> value;  ///< F'/F
    bool is_zero = false;        ///< F(s) = 0 to the last bit; value is then 0
  };

  /// @param hint mode nearest to s if known, else any; becomes that mode
  LogSlope log_slope(std::complex<double> s, int& hint);

  /// P_W'/P_W, with P_W = det A Π_W d_i for the modes whose poles are below a limit.
  ///
  /// Has no poles below the limit, so that the zeros below it can be divided out one by one.
  LogSlope log_slope_below(std::complex<double> s, double height, int& hint);

  /// A zero by Newton's method on F.
  struct Zero {
    std::complex<double> s;
    bool is_converged = false;
    int evaluations = 0;
  };

  /// @param guess   where to start; a real start stays real
  /// @param spacing distance from which on other zeros can be felt; the error of a step δ is taken
  ///                to be δ²/spacing
  /// @param hint    as log_slope()
  Zero find_zero(std::complex<double> guess, double spacing, int& hint);

  /// Zeros with height_of() below a limit h, conjugates and real ones counted one by one, by the
  /// argument principle; all with |Im s| < h and all real ones are among them.
  ///
  ///   zeros − poles = (1/π) change of arg det A along +X, +X + j(h + X), jh, −X + j(h + X), −X
  ///
  /// with X of a thousand times extent(): next to jamming, where B_C S Sᵀ B_Eᵀ is almost singular,
  /// real zeros lie far beyond the poles. Two samples are closer together than half their distance
  /// to the nearest pole and to the real axis, so that even several real zeros in one place turn
  /// arg by little from sample to sample. Another one is put between where it turns by more than 1
  /// rad.
  /// @return nothing where a zero or pole is too close to the line to tell on which side it is
  std::optional<int> count_zeros_below(double height);

 private:
  using Complex = std::complex<double>;

  /// Samples of 1/d along the line of count_zeros_below().
  struct Line {
    std::vector<Complex> places;  ///< from right to left
    AlignedArray inverses;        ///< of each place: real parts of 1/d, then imaginary parts
    std::vector<Complex> values;  ///< det A
    bool meets_pole = false;
  };

  /// Sets near_ to the modes whose poles are multiplied out of F(s), and hint to the nearest.
  void find_near(Complex s, double least, int& hint);
  LogSlope scalar_log_slope(Complex s, int& hint);
  LogSlope matrix_log_slope(Complex s, int& hint);
  /// Bordered matrix of F and its derivative, for the modes in near_.
  void form_bordered(Complex s);
  /// det A from 1/d of every mode.
  Complex determinant(const double* inverse_re, const double* inverse_im, Complex s);
  Complex determinant_at(Complex s);
  Line& line_at(double height);

  SecularPoles poles_;
  SecularWeights weights_;
  std::map<double, Line> lines_;

  AlignedArray mask_;
  double mask_height_ = -1.0;
  AlignedArray value_re_, value_im_, slope_re_, slope_im_, norm_;  ///< scratch
  std::vector<int> near_;
  BorderedMatrix bordered_;
};

}  // namespace stridor
