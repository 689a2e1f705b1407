#include "solvers/secular_function.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <utility>

namespace stridor {
namespace {

using Complex = std::complex<double>;

std::size_t padded_size(Eigen::Index size) {
  return (static_cast<std::size_t>(size) + secular_block - 1) / secular_block * secular_block;
}

/// 1/z and |z| without the care for overflow that the library takes: no number here is near it.
Complex reciprocal(Complex z) {
  return std::conj(z) / std::norm(z);
}
double magnitude(Complex z) {
  return std::sqrt(std::norm(z));
}

/// Angle from a to b, −π … π.
double turn(Complex a, Complex b) {
  return std::arg(b * std::conj(a));
}

/// Scales columns and then rows of B, and B′ likewise, to largest entries of 1; false where one of
/// B is zero.
bool equilibrate(Eigen::MatrixXcd& B, Eigen::MatrixXcd& slope) {
  const Eigen::Index size = B.rows();
  for (Eigen::Index j = 0; j < size; ++j) {
    const double largest = std::sqrt(B.col(j).cwiseAbs2().maxCoeff());
    if (largest == 0.0) return false;
    for (Eigen::Index i = 0; i < size; ++i) {
      B(i, j) *= 1.0 / largest;
      slope(i, j) *= 1.0 / largest;
    }
  }
  for (Eigen::Index i = 0; i < size; ++i) {
    const double largest = std::sqrt(B.row(i).cwiseAbs2().maxCoeff());
    if (largest == 0.0) return false;
    for (Eigen::Index j = 0; j < size; ++j) {
      B(i, j) *= 1.0 / largest;
      slope(i, j) *= 1.0 / largest;
    }
  }
  return true;
}

/// det B by elimination with row pivoting, B destroyed. By hand as below, and because BLAS may
/// serve one thread at a time (core/tasks.hpp).
Complex determinant_of(Eigen::MatrixXcd& B) {
  const Eigen::Index size = B.rows();
  Complex product = 1.0;
  for (Eigen::Index k = 0; k < size; ++k) {
    Eigen::Index pivot = k;
    for (Eigen::Index i = k + 1; i < size; ++i) {
      if (std::norm(B(i, k)) > std::norm(B(pivot, k))) pivot = i;
    }
    if (B(pivot, k) == 0.0) return 0.0;
    if (pivot != k) {
      B.row(k).swap(B.row(pivot));
      product = -product;
    }
    product *= B(k, k);
    const Complex scale = reciprocal(B(k, k));
    for (Eigen::Index i = k + 1; i < size; ++i) {
      const Complex factor = B(i, k) * scale;
      for (Eigen::Index j = k + 1; j < size; ++j) B(i, j) -= factor * B(k, j);
    }
  }
  return product;
}

/// tr(B⁻¹ C) by elimination with row pivoting, both destroyed; nothing where B is singular. For
/// matrices of a few rows, where a call of LAPACK would take longer than the work.
std::optional<Complex> trace_of_solution(Eigen::MatrixXcd& B, Eigen::MatrixXcd& C) {
  const Eigen::Index size = B.rows();
  for (Eigen::Index k = 0; k < size; ++k) {
    Eigen::Index pivot = k;
    for (Eigen::Index i = k + 1; i < size; ++i) {
      if (std::norm(B(i, k)) > std::norm(B(pivot, k))) pivot = i;
    }
    if (B(pivot, k) == 0.0) return std::nullopt;
    if (pivot != k) {
      B.row(k).swap(B.row(pivot));
      C.row(k).swap(C.row(pivot));
    }
    const Complex scale = reciprocal(B(k, k));
    for (Eigen::Index j = k + 1; j < size; ++j) B(k, j) *= scale;
    for (Eigen::Index j = 0; j < size; ++j) C(k, j) *= scale;
    for (Eigen::Index i = 0; i < size; ++i) {
      if (i == k) continue;
      const Complex factor = B(i, k);
      for (Eigen::Index j = k + 1; j < size; ++j) B(i, j) -= factor * B(k, j);
      for (Eigen::Index j = 0; j < size; ++j) C(i, j) -= factor * C(k, j);
    }
  }
  return C.trace();
}

}  // namespace

SecularFunction::SecularFunction(const Pencil& pencil) {
  assign(pencil);
}

void SecularFunction::assign(const Pencil& pencil) {
  check_pencil(pencil);
  const bool has_same_modes = pencil.num_modes() == num_modes_ && pencil.omega == given_omega_ &&
                              pencil.damping == given_damping_;
  if (!has_same_modes) assign_modes(pencil);
  assign_rows(pencil);
}

void SecularFunction::assign_modes(const Pencil& pencil) {
  num_modes_ = pencil.num_modes();
  given_omega_ = pencil.omega;
  given_damping_ = pencil.damping;
  order_.resize(static_cast<std::size_t>(num_modes_));
  std::iota(order_.begin(), order_.end(), 0);
  std::sort(order_.begin(), order_.end(), [&](Eigen::Index a, Eigen::Index b) {
    return std::pair(pencil.omega(a), pencil.damping(a)) <
           std::pair(pencil.omega(b), pencil.damping(b));
  });

  padded_ = padded_size(num_modes_);
  omega_ = AlignedArray(padded_);
  damping_ = AlignedArray(padded_);
  for (AlignedArray* scratch : {&mask_, &value_re_, &value_im_, &slope_re_, &slope_im_, &norm_}) {
    *scratch = AlignedArray(padded_);
  }
  std::fill_n(omega_.data(), padded_, padding_omega);
  extent_ = 0.0;
  smallest_pole_ = std::numeric_limits<double>::infinity();
  height_of_.clear();
  for (std::size_t i = 0; i < order_.size(); ++i) {
    omega_[i] = pencil.omega(order_[i]);
    damping_[i] = pencil.damping(order_[i]);
    height_of_.push_back(std::max(0.0, height_of(poles(static_cast<Eigen::Index>(i)).front())));
    extent_ = std::max({extent_, omega_[i], std::abs(damping_[i])});
    for (const Complex pole : poles(static_cast<Eigen::Index>(i)))
      if (pole != 0.0) smallest_pole_ = std::min(smallest_pole_, std::abs(pole));
  }
  if (extent_ == 0.0) extent_ = 1.0;
  smallest_pole_ = std::min(smallest_pole_, extent_);
  heights_ = height_of_;
  std::sort(heights_.begin(), heights_.end());

  // Poles so close together that multiplying out one leaves nothing but rounding of the other.
  constexpr double closeness = 1e-5;
  clusters_.assign(order_.size(), {});
  for (std::size_t i = 0; i < order_.size(); ++i) {
    for (std::size_t j = i + 1; j < order_.size() && omega_[j] <= omega_[i] * (1.0 + closeness);
         ++j) {
      if (std::abs(damping_[j] - damping_[i]) > closeness * omega_[i]) continue;
      clusters_[i].push_back(static_cast<int>(j));
      clusters_[j].push_back(static_cast<int>(i));
    }
  }
  lines_.clear();
  mask_height_ = -1.0;
}

void SecularFunction::assign_rows(const Pencil& pencil) {
  rows_ = modal_rows(pencil);
  const auto num_outputs = static_cast<std::size_t>(rows_.outputs.rows());
  const auto num_inputs = static_cast<std::size_t>(rows_.inputs.rows());
  if (num_outputs * num_inputs != weights_.size()) {
    weights_.clear();
    for (std::size_t pair = 0; pair < num_outputs * num_inputs; ++pair) {
      weights_.emplace_back(padded_);
    }
  }
  for (AlignedArray& weights : weights_) {
    if (weights.size() != padded_) weights = AlignedArray(padded_);
  }
  for (std::size_t b = 0; b < num_inputs; ++b) {
    for (std::size_t a = 0; a < num_outputs; ++a) {
      AlignedArray& weights = weights_[a + num_outputs * b];
      for (std::size_t i = 0; i < order_.size(); ++i) {
        weights[i] = rows_.outputs(static_cast<Eigen::Index>(a), order_[i]) *
                     rows_.inputs(static_cast<Eigen::Index>(b), order_[i]);
      }
    }
  }
}

std::array<Complex, 2> SecularFunction::poles(Eigen::Index i) const {
  const auto mode = static_cast<std::size_t>(i);
  const double half = 0.5 * damping_[mode];
  const double square = (omega_[mode] - half) * (omega_[mode] + half);
  if (square >= 0.0) {
    const double height = std::sqrt(square);
    return {Complex(-half, height), Complex(-half, -height)};
  }
  // The one farther from zero first, the other from the product of both: no difference of equals.
  const double far = -half - std::copysign(std::sqrt(-square), half);
  const double near = far == 0.0 ? 0.0 : omega_[mode] * omega_[mode] / far;
  return {Complex(std::max(far, near), 0.0), Complex(std::min(far, near), 0.0)};
}

Complex SecularFunction::denominator(std::size_t i, Complex s) const {
  const double x = s.real();
  const double y = s.imag();
  return {(omega_[i] - y) * (omega_[i] + y) + x * (damping_[i] + x), y * (damping_[i] + 2.0 * x)};
}

Complex SecularFunction::denominator_slope(std::size_t i, Complex s) const {
  return 2.0 * s + damping_[i];
}

int SecularFunction::nearest_mode(Complex s) const {
  std::size_t nearest = 0;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < order_.size(); ++i) {
    const double norm = std::norm(denominator(i, s));
    if (norm < least) {
      least = norm;
      nearest = i;
    }
  }
  return static_cast<int>(nearest);
}

void SecularFunction::find_near(Complex s, double least, int& hint) {
  // Somewhat farther than the nearest is as good, and saves the search.
  const bool is_good = hint >= 0 && hint < num_modes_ &&
                       std::norm(denominator(static_cast<std::size_t>(hint), s)) <= 4.0 * least;
  if (!is_good) hint = nearest_mode(s);
  near_.assign(1, hint);
  const auto& cluster = clusters_[static_cast<std::size_t>(hint)];
  near_.insert(near_.end(), cluster.begin(), cluster.end());
}

SecularFunction::LogSlope SecularFunction::log_slope(Complex s, int& hint) {
  return is_scalar() ? scalar_log_slope(s, hint) : matrix_log_slope(s, hint);
}

SecularFunction::LogSlope SecularFunction::scalar_log_slope(Complex s, int& hint) {
  AlignedArray& weights = weights_.front();
  if (hint < 0 || hint >= num_modes_) hint = nearest_mode(s);
  for (;;) {
    const auto i = static_cast<std::size_t>(hint);
    if (!clusters_[i].empty()) return matrix_log_slope(s, hint);
    const double weight = std::exchange(weights[i], 0.0);
    const SecularSums sums =
        sum_modes({omega_.data(), damping_.data(), padded_}, weights.data(), s.real(), s.imag());
    weights[i] = weight;
    const Complex d = denominator(i, s);
    if (std::norm(d) > 4.0 * sums.least) {
      const int nearest = nearest_mode(s);
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
    return {(denominator_slope(i, s) * g - d * slope) * reciprocal(value), false};
  }
}

void SecularFunction::form_bordered(Complex s) {
  const Eigen::Index k = rows_.num_constraints;
  const Eigen::Index r = rows_.rank;
  const Eigen::Index size = k + r;
  const auto num_near = static_cast<Eigen::Index>(near_.size());
  for (const int i : near_) {
    const auto mode = static_cast<std::size_t>(i);
    for (AlignedArray* array : {&value_re_, &value_im_, &slope_re_, &slope_im_}) {
      (*array)[mode] = 0.0;
    }
  }
  bordered_.setZero(size + num_near, size + num_near);
  bordered_slope_.setZero(size + num_near, size + num_near);
  const auto sums = [&](Eigen::Index a, Eigen::Index b, Complex& value, Complex& slope) {
    const double* weights = weights_[static_cast<std::size_t>(a + size * b)].data();
    double re = 0.0;
    double im = 0.0;
    weigh(weights, value_re_.data(), value_im_.data(), padded_, &re, &im);
    value = {re, im};
    weigh(weights, slope_re_.data(), slope_im_.data(), padded_, &re, &im);
    slope = {-re, -im};
  };
  Complex value;
  Complex slope;
  for (Eigen::Index a = 0; a < size; ++a) {
    for (Eigen::Index b = 0; b < size; ++b) {
      sums(a, b, bordered_(a, b), bordered_slope_(a, b));
      if (b < k) continue;
      sums(a, b + r, value, slope);
      bordered_(a, b) += s * value;
      bordered_slope_(a, b) += value + s * slope;
      if (a == b) bordered_(a, b) += 1.0;
    }
  }
  for (Eigen::Index j = 0; j < num_near; ++j) {
    const auto i = static_cast<std::size_t>(near_[static_cast<std::size_t>(j)]);
    const Eigen::Index mode = order_[i];
    const Eigen::Index border = size + j;
    for (Eigen::Index a = 0; a < size; ++a) {
      bordered_(a, border) = rows_.outputs(a, mode);
      bordered_(border, a) = -rows_.inputs(a, mode);
      if (a < k) continue;
      bordered_(border, a) -= s * rows_.inputs(a + r, mode);
      bordered_slope_(border, a) = -rows_.inputs(a + r, mode);
    }
    bordered_(border, border) = denominator(i, s);
    bordered_slope_(border, border) = denominator_slope(i, s);
  }
}

SecularFunction::LogSlope SecularFunction::matrix_log_slope(Complex s, int& hint) {
  const double least = invert_modes(
      {omega_.data(), damping_.data(), padded_}, s.real(), s.imag(),
      {value_re_.data(), value_im_.data(), slope_re_.data(), slope_im_.data(), norm_.data()});
  find_near(s, least, hint);
  form_bordered(s);
  // Rows and columns differ by many orders of magnitude in unit; pivoting wants them alike. The
  // trace of B⁻¹ B′ does not change.
  if (!equilibrate(bordered_, bordered_slope_)) return {0.0, true};
  const std::optional<Complex> trace = trace_of_solution(bordered_, bordered_slope_);
  if (!trace) return {0.0, true};
  return {*trace, false};
}

SecularFunction::LogSlope SecularFunction::log_slope_below(Complex s, double height, int& hint) {
  if (height != mask_height_) {
    for (std::size_t i = 0; i < order_.size(); ++i) mask_[i] = height_of_[i] < height ? 1.0 : 0.0;
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
  sum_pole_slopes({omega_.data(), damping_.data(), padded_}, mask_.data(), s.real(), s.imag(), &re,
                  &im);
  slope.value += Complex(re, im);
  for (std::size_t j = 0; j < near_.size(); ++j) {
    const auto i = static_cast<std::size_t>(near_[j]);
    mask_[i] = present[j];
    if (present[j] == 0.0) slope.value -= denominator_slope(i, s) / denominator(i, s);
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
    const double size_of_zero = std::max(distance_to_origin, smallest_pole_);
    const double rounding = eps * size_of_zero;
    if (!std::isfinite(size)) return zero;
    // Poles that were not multiplied out bend F as other zeros do.
    for (const int i : {hint - 1, hint + 1}) {
      if (i < 0 || i >= num_modes_) continue;
      const double distance =
          0.5 * magnitude(denominator(static_cast<std::size_t>(i), zero.s)) / distance_to_origin;
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

Complex SecularFunction::determinant(const double* inverse_re, const double* inverse_im,
                                     Complex s) {
  const Eigen::Index k = rows_.num_constraints;
  const Eigen::Index r = rows_.rank;
  const Eigen::Index size = k + r;
  const auto sum = [&](Eigen::Index a, Eigen::Index b) {
    double re = 0.0;
    double im = 0.0;
    weigh(weights_[static_cast<std::size_t>(a + size * b)].data(), inverse_re, inverse_im, padded_,
          &re, &im);
    return Complex(re, im);
  };
  if (is_scalar()) return sum(0, 0);
  if (size == 0) return 1.0;
  Eigen::MatrixXcd matrix(size, size);
  for (Eigen::Index a = 0; a < size; ++a) {
    for (Eigen::Index b = 0; b < size; ++b) {
      matrix(a, b) = sum(a, b);
      if (b >= k) matrix(a, b) += s * sum(a, b + r);
      if (b >= k && a == b) matrix(a, b) += 1.0;
    }
    // A positive factor; without it the determinant of many rows leaves the range of a double.
    const double largest = matrix.row(a).cwiseAbs2().maxCoeff();
    if (largest > 0.0) matrix.row(a) *= 1.0 / std::sqrt(largest);
  }
  return determinant_of(matrix);
}

Complex SecularFunction::determinant_at(Complex s) {
  invert_modes(
      {omega_.data(), damping_.data(), padded_}, s.real(), s.imag(),
      {value_re_.data(), value_im_.data(), slope_re_.data(), slope_im_.data(), norm_.data()});
  return determinant(value_re_.data(), value_im_.data(), s);
}

SecularFunction::Line& SecularFunction::line_at(double height) {
  const auto found = lines_.find(height);
  if (found != lines_.end()) return found->second;
  // A table of 60 samples of some hundred modes takes 0.2 MB.
  constexpr std::size_t max_lines = 64;
  if (lines_.size() >= max_lines) lines_.clear();

  Line line;
  const double end = 1e3 * extent_;
  const auto on_side = [&](double x) { return Complex(x, height + std::abs(x)); };
  // Far from all poles det A is a power of s.
  constexpr int num_rises = 4;
  for (int i = 0; i < num_rises; ++i)
    line.places.emplace_back(end, i * on_side(end).imag() / num_rises);
  double x = end;
  while (x > -end) {
    const Complex place = on_side(x);
    line.places.push_back(place);
    double distance = place.imag();
    for (std::size_t i = 0; i < order_.size(); ++i) {
      for (const Complex pole : poles(static_cast<Eigen::Index>(i)))
        distance = std::min(distance, std::abs(pole - place));
    }
    // The floor keeps the number of samples finite.
    constexpr double closest = 1e-9;
    line.meets_pole = line.meets_pole || distance < closest * place.imag();
    const double step = std::max(0.5 * distance / std::numbers::sqrt2, closest * extent_);
    // The corner is one of the samples.
    x = x > 0.0 ? std::max(x - step, 0.0) : x - step;
  }
  for (int i = num_rises; i >= 0; --i)
    line.places.emplace_back(-end, i * on_side(end).imag() / num_rises);
  line.inverses = AlignedArray(2 * padded_ * line.places.size());
  for (std::size_t p = 0; p < line.places.size(); ++p) {
    double* const re = line.inverses.data() + 2 * padded_ * p;
    invert_modes({omega_.data(), damping_.data(), padded_}, line.places[p].real(),
                 line.places[p].imag(),
                 {re, re + padded_, slope_re_.data(), slope_im_.data(), norm_.data()});
  }
  line.values.resize(line.places.size());
  return lines_.emplace(height, std::move(line)).first->second;
}

std::optional<int> SecularFunction::count_zeros_below(double height) {
  Line& line = line_at(height);
  if (line.meets_pole) return std::nullopt;
  for (std::size_t p = 0; p < line.places.size(); ++p) {
    const double* const re = line.inverses.data() + 2 * padded_ * p;
    line.values[p] = determinant(re, re + padded_, line.places[p]);
  }
  constexpr double largest_turn = 1.0;
  constexpr int max_halvings = 30;
  double total = 0.0;
  std::vector<std::pair<Complex, Complex>> waiting;  // places and values yet to be reached
  for (std::size_t p = 0; p + 1 < line.places.size(); ++p) {
    Complex place = line.places[p];
    Complex value = line.values[p];
    waiting.assign(1, {line.places[p + 1], line.values[p + 1]});
    while (!waiting.empty()) {
      const auto [next_place, next_value] = waiting.back();
      const double angle = turn(value, next_value);
      if (!std::isfinite(angle)) return std::nullopt;
      if (std::abs(angle) > largest_turn) {
        if (waiting.size() > max_halvings) return std::nullopt;
        const Complex middle = 0.5 * (place + next_place);
        waiting.emplace_back(middle, determinant_at(middle));
        continue;
      }
      total += angle;
      place = next_place;
      value = next_value;
      waiting.pop_back();
    }
  }
  const auto num_modes_below =
      std::lower_bound(heights_.begin(), heights_.end(), height) - heights_.begin();
  const double zeros = total / std::numbers::pi + 2.0 * static_cast<double>(num_modes_below);
  // Both ends are real: only rounding keeps the turn from being a multiple of π.
  if (std::abs(zeros - std::round(zeros)) > 0.1) return std::nullopt;
  return static_cast<int>(std::lround(zeros));
}

}  // namespace stridor
