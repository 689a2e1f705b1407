#include "solvers/eigenvalues/secular_function.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "solvers/algebra/small_matrices.hpp"

namespace stridor {
namespace {

using Complex = std::complex<double>;

/// |z| without the care for overflow that the library takes: no number here is near it.
double magnitude(Complex z) {
  return std::sqrt(std::norm(z));
}

}  // namespace

SecularFunction::SecularFunction(const Pencil& pencil) {
  assign(pencil);
}

void SecularFunction::assign(const Pencil& pencil) {
  check_pencil(pencil);
  if (poles_.assign(pencil)) {
    for (AlignedArray* scratch : {&mask_, &value_re_, &value_im_, &slope_re_, &slope_im_, &norm_}) {
      *scratch = AlignedArray(poles_.padded_size());
    }
    lines_.clear();
    mask_height_ = -1.0;
  }
  weights_.assign(pencil, poles_);
}

void SecularFunction::find_near(Complex s, double least, int& hint) {
  // Somewhat farther than the nearest is as good, and saves the search.
  const bool is_good =
      hint >= 0 && hint < poles_.num_modes() &&
      std::norm(poles_.denominator(static_cast<std::size_t>(hint), s)) <= 4.0 * least;
  if (!is_good) hint = poles_.nearest(s);
  near_.assign(1, hint);
  const auto& cluster = poles_.cluster(static_cast<std::size_t>(hint));
  near_.insert(near_.end(), cluster.begin(), cluster.end());
}

SecularFunction::LogSlope SecularFunction::log_slope(Complex s, int& hint) {
  return weights_.is_scalar() ? scalar_log_slope(s, hint) : matrix_log_slope(s, hint);
}

SecularFunction::LogSlope SecularFunction::scalar_log_slope(Complex s, int& hint) {
  AlignedArray& weights = weights_.only();
  if (hint < 0 || hint >= poles_.num_modes()) hint = poles_.nearest(s);
  for (;;) {
    const auto i = static_cast<std::size_t>(hint);
    if (!poles_.cluster(i).empty()) return matrix_log_slope(s, hint);
    const double weight = std::exchange(weights[i], 0.0);
    const SecularSums sums = sum_modes(poles_.table(), weights.data(), s.real(), s.imag());
    weights[i] = weight;
    const Complex d = poles_.denominator(i, s);
    if (std::norm(d) > 4.0 * sums.least) {
      const int nearest = poles_.nearest(s);
      if (nearest != hint) {
        hint = nearest;
        continue;
      }
    }
    near_.assign(1, hint);
    const Complex g(sums.value_re, sums.value_im);
    const Complex slope(sums.slope_re, sums.slope_im);
    const Complex value = weight + d * g;
    if (value == 0.0) return {0.0, true};
    return {(poles_.denominator_slope(i, s) * g - d * slope) * reciprocal(value), false};
  }
}

void SecularFunction::form_bordered(Complex s) {
  const Eigen::Index size = weights_.num_rows();
  Eigen::Index num_borders = 0;
  for (const int i : near_) {
    const auto mode = static_cast<std::size_t>(i);
    for (AlignedArray* array : {&value_re_, &value_im_, &slope_re_, &slope_im_}) {
      (*array)[mode] = 0.0;
    }
    num_borders += SecularWeights::border_size(poles_, mode);
  }
  bordered_.value.setZero(size + num_borders, size + num_borders);
  bordered_.slope.setZero(size + num_borders, size + num_borders);
  const std::size_t padded = poles_.padded_size();
  for (Eigen::Index a = 0; a < size; ++a) {
    for (Eigen::Index b = 0; b < size; ++b) {
      // Σ over powers p of s^p T_p, and its derivative.
      Complex factor = 1.0;
      Complex factor_slope = 0.0;
      for (Eigen::Index power = 0; power < weights_.num_powers(b); ++power) {
        const double* weights = weights_.of(a, b, power).data();
        double re = 0.0;
        double im = 0.0;
        weigh(weights, value_re_.data(), value_im_.data(), padded, &re, &im);
        bordered_.value(a, b) += factor * Complex(re, im);
        bordered_.slope(a, b) += factor_slope * Complex(re, im);
        weigh(weights, slope_re_.data(), slope_im_.data(), padded, &re, &im);
        bordered_.slope(a, b) -= factor * Complex(re, im);
        factor_slope = static_cast<double>(power + 1) * factor;
        factor *= s;
      }
      if (weights_.has_one(a, b)) bordered_.value(a, b) += 1.0;
    }
  }
  Eigen::Index border = size;
  for (const int i : near_) {
    const auto mode = static_cast<std::size_t>(i);
    weights_.border(poles_, s, mode, border, bordered_);
    border += SecularWeights::border_size(poles_, mode);
  }
}

SecularFunction::LogSlope SecularFunction::matrix_log_slope(Complex s, int& hint) {
  const double least = invert_modes(
      poles_.table(), s.real(), s.imag(),
      {value_re_.data(), value_im_.data(), slope_re_.data(), slope_im_.data(), norm_.data()});
  find_near(s, least, hint);
  form_bordered(s);
  // Rows and columns differ by many orders of magnitude in unit; pivoting wants them alike. The
  // trace of B⁻¹ B′ does not change.
  if (!equilibrate(bordered_.value, bordered_.slope)) return {0.0, true};
  const std::optional<Complex> trace = trace_of_solution(bordered_.value, bordered_.slope);
  if (!trace) return {0.0, true};
  return {*trace, false};
}

SecularFunction::LogSlope SecularFunction::log_slope_below(Complex s, double height, int& hint) {
  if (height != mask_height_) {
    for (std::size_t i = 0; i < poles_.size(); ++i)
      mask_[i] = poles_.heights()[i] < height ? 1.0 : 0.0;
    mask_height_ = height;
  }
  LogSlope slope = log_slope(s, hint);
  if (slope.is_zero) return slope;
  // The poles near s are out of F already: one of them below the limit must not count twice, one
  // above it comes back.
  std::vector<double> present;
  for (const int i : near_)
    present.push_back(std::exchange(mask_[static_cast<std::size_t>(i)], 0.0));
  double re = 0.0;
  double im = 0.0;
  sum_pole_slopes(poles_.table(), mask_.data(), s.real(), s.imag(), &re, &im);
  slope.value += Complex(re, im);
  for (std::size_t j = 0; j < near_.size(); ++j) {
    const auto i = static_cast<std::size_t>(near_[j]);
    mask_[i] = present[j];
    if (present[j] == 0.0) slope.value -= poles_.denominator_slope(i, s) / poles_.denominator(i, s);
  }
  return slope;
}

SecularFunction::Zero SecularFunction::find_zero(Complex guess, double spacing, int& hint) {
  Zero zero{guess, false, 0};
  constexpr int max_evaluations = 60;
  constexpr int num_expected = 20;
  constexpr double eps = std::numeric_limits<double>::epsilon();
  double last = std::numeric_limits<double>::infinity();
  while (zero.evaluations < max_evaluations) {
    const LogSlope slope = log_slope(zero.s, hint);
    ++zero.evaluations;
    if (slope.is_zero) {
      zero.is_converged = true;
      return zero;
    }
    Complex step = -reciprocal(slope.value);
    if (guess.imag() == 0.0) step.imag(0.0);
    zero.s += step;
    const double size = magnitude(step);
    const double distance_to_origin = magnitude(zero.s);
    const double size_of_zero = std::max(distance_to_origin, poles_.smallest());
    const double rounding = eps * size_of_zero;
    if (!std::isfinite(size)) return zero;
    // Poles that were not multiplied out bend F as other zeros do.
    for (const int i : {hint - 1, hint + 1}) {
      if (i < 0 || i >= poles_.num_modes()) continue;
      const double distance = 0.5 *
                              magnitude(poles_.denominator(static_cast<std::size_t>(i), zero.s)) /
                              distance_to_origin;
      spacing = std::min(spacing, 0.2 * distance);
    }
    // Newton's error after a small step is step²/spacing. Next to a double zero steps end when they
    // have reached the rounding of F; between two close zeros they go astray for a while, so that
    // growing ones alone do not mean much.
    const bool has_stalled =
        zero.evaluations > num_expected && size >= 0.9 * last && size <= 1e-7 * size_of_zero;
    if (size * size <= rounding * spacing || size <= 4.0 * rounding || has_stalled) {
      zero.is_converged = true;
      return zero;
    }
    last = size;
  }
  return zero;
}

}  // namespace stridor
