// All eigenvalues of a pencil in a window, from its secular function.
#pragma once

#include <limits>
#include <numbers>
#include <optional>
#include <vector>

#include "solvers/eigenvalues/secular_function.hpp"

namespace stridor {

/// Which eigenvalues are wanted.
struct SpectrumWindow {
  /// As many with positive imaginary part, lowest first; those there are where there are fewer.
  std::optional<int> count;
  double frequency = std::numeric_limits<double>::infinity();  ///< |Im s|/2π up to this, Hz

  static SpectrumWindow lowest(int count) { return {count, inf}; }
  static SpectrumWindow below(double frequency) { return {std::nullopt, frequency}; }
  static SpectrumWindow all() { return {}; }

  /// Whether an eigenvalue lies beyond the window.
  /// @param height   Im s, 1/s
  /// @param num_pairs those with a positive imaginary part up to this one, itself included
  bool ends_before(double height, int num_pairs) const {
    return height > 2.0 * std::numbers::pi * frequency || (count && num_pairs > *count);
  }

 private:
  static constexpr double inf = std::numeric_limits<double>::infinity();
};

/// Eigenvalues in a window, and whether their number is verified.
struct SecularSpectrum {
  /// Im s >= 0, ascending Im s, then ascending Re s; real ones first, all of them. Multiple ones
  /// repeated.
  std::vector<Eigenvalue> eigenvalues;
  /// Every eigenvalue whose SecularFunction::height_of() is less is among `found`: those with
  /// |Im s| < height and all real ones, rad/s.
  double height = 0.0;
  int num_counted = 0;  ///< such eigenvalues by the argument principle, conjugates counted
  /// All zeros below `height` with Im s >= 0, ascending Im s: more than `eigenvalues` where a line
  /// between two poles lies above the window.
  std::vector<std::complex<double>> found;
  bool is_complete = false;  ///< as many distinct ones were found as counted
  int evaluations = 0;       ///< of the secular function
};

/// Zeros of the secular function in a window (docs/theory.md, 7.3).
///
/// A line |Im s| = h + |Re s| is drawn above the window, midway between two poles. The argument
/// principle gives the number N of zeros between it and its conjugate, Ehrlich and Aberth's
/// iteration finds N zeros simultaneously from starts between the poles:
///
///   s_j ← s_j − 1/(P_h′/P_h − Σ_{k≠j} 1/(s_j − s_k))
///
/// with the P_h of SecularFunction::log_slope_below(). The sum keeps the iterates apart, so none is
/// found twice and a double zero is found as two. Where fewer than N come out below the line, the
/// iteration is repeated for all 2 (n − k) zeros of P.
///
/// @return status in is_complete; where it is false, the eigenvalues found
/// @throws std::invalid_argument if the window is empty
/// Cost: about 10 evaluations of n modes per eigenvalue.
SecularSpectrum secular_spectrum(SecularFunction& function, const SpectrumWindow& window);

/// Eigenvalues of secular_spectrum() with residuals.
/// @throws std::invalid_argument as check_pencil(), or if the window is empty
/// @throws NumericalError if the eigenvalues are not complete
std::vector<Eigenvalue> secular_eigenvalues(const Pencil& pencil, const SpectrumWindow& window);

}  // namespace stridor
