// Simultaneous iteration on the zeros of the secular function.
#pragma once

#include <cmath>
#include <complex>
#include <limits>
#include <vector>

#include "solvers/eigenvalues/secular_function.hpp"

namespace stridor {

/// AberthIterates of one search. A pair stands for itself and its conjugate.
struct AberthIterates {
  std::vector<std::complex<double>> pairs;
  std::vector<std::complex<double>> singles;
};

/// Ehrlich-Aberth iteration on the zeros of P_h for one set of starts.
class Aberth {
 public:
  Aberth(SecularFunction& function, double height) : function_(function), height_(height) {}

  /// @param is_done iterates that stay where they are, pairs first; the others become true as they
  ///                converge
  /// @return whether every iterate has converged
  bool run(AberthIterates& iterates, std::vector<bool>& is_done) {
    constexpr int max_sweeps = 100;
    hints_.assign(is_done.size(), -1);
    last_.assign(is_done.size(), std::numeric_limits<double>::infinity());
    for (int sweep = 0; sweep < max_sweeps; ++sweep) {
      bool all_done = true;
      for (std::size_t j = 0; j < is_done.size(); ++j) {
        if (!is_done[j]) is_done[j] = improve(iterates, j, sweep);
        all_done = all_done && is_done[j];
      }
      if (all_done) return true;
    }
    return false;
  }

  int evaluations() const { return evaluations_; }

 private:
  /// One step of iterate j; whether it was the last one needed.
  bool improve(AberthIterates& iterates, std::size_t j, int sweep) {
    const std::size_t num_pairs = iterates.pairs.size();
    std::complex<double>& s = j < num_pairs ? iterates.pairs[j] : iterates.singles[j - num_pairs];
    const SecularFunction::LogSlope slope = function_.log_slope_below(s, height_, hints_[j]);
    ++evaluations_;
    if (slope.is_zero) return true;
    std::complex<double> repulsion = 0.0;
    double spacing = std::numeric_limits<double>::infinity();
    const auto repel = [&](std::complex<double> other) {
      const std::complex<double> difference = s - other;
      const double square = std::norm(difference);
      // Two iterates on the same spot are a double zero, or part company by rounding.
      if (square == 0.0) return;
      spacing = std::min(spacing, square);
      repulsion += std::conj(difference) / square;
    };
    for (std::size_t k = 0; k < num_pairs; ++k) {
      if (k != j) repel(iterates.pairs[k]);
      repel(std::conj(iterates.pairs[k]));
    }
    for (std::size_t k = 0; k < iterates.singles.size(); ++k) {
      if (num_pairs + k != j) repel(iterates.singles[k]);
    }
    spacing = std::sqrt(spacing);
    std::complex<double> step = -1.0 / (slope.value - repulsion);
    if (j >= num_pairs && s.imag() == 0.0) step.imag(0.0);
    // Beyond its surroundings a step tells nothing.
    const double farthest = std::abs(s) + 0.1 * function_.extent();
    double length = std::abs(step);
    if (!std::isfinite(length)) step = 1e-3 * farthest;
    if (length > farthest) step *= farthest / length;
    s += step;
    length = std::abs(step);
    const double size = function_.size_of(s);
    const double rounding = std::numeric_limits<double>::epsilon() * size;
    // A small step next to another iterate is the other's doing, unless a zero is as close.
    constexpr double nearby = 1e-6;
    const bool is_near_zero = 1.0 <= std::abs(slope.value) * std::max(spacing, nearby * size);
    // Steps towards a double zero end when they have reached the rounding of P_h.
    constexpr int num_expected = 20;
    const bool has_stalled =
        sweep > num_expected && length >= 0.9 * last_[j] && length <= 1e-7 * size;
    const bool is_small =
        length * length <= 1e-2 * rounding * spacing || length <= 4.0 * rounding || has_stalled;
    last_[j] = length;
    return is_small && is_near_zero;
  }

  SecularFunction& function_;
  double height_;
  std::vector<int> hints_;
  std::vector<double> last_;
  int evaluations_ = 0;
};

}  // namespace stridor
