// Zeros of a secular function below a line, by the argument principle.
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "solvers/algebra/small_matrices.hpp"
#include "solvers/eigenvalues/secular_function.hpp"

namespace stridor {
namespace {

using Complex = std::complex<double>;

/// Angle from a to b, −π … π.
double turn(Complex a, Complex b) {
  return std::arg(b * std::conj(a));
}

}  // namespace

Complex SecularFunction::determinant(const double* inverse_re, const double* inverse_im,
                                     Complex s) {
  const Eigen::Index size = weights_.num_rows();
  const std::size_t padded = poles_.padded_size();
  const auto sum = [&](Eigen::Index a, Eigen::Index b, Eigen::Index power) {
    double re = 0.0;
    double im = 0.0;
    weigh(weights_.of(a, b, power).data(), inverse_re, inverse_im, padded, &re, &im);
    return Complex(re, im);
  };
  if (weights_.is_scalar()) return sum(0, 0, 0);
  if (size == 0) return 1.0;
  Eigen::MatrixXcd matrix(size, size);
  for (Eigen::Index a = 0; a < size; ++a) {
    for (Eigen::Index b = 0; b < size; ++b) {
      matrix(a, b) = sum(a, b, 0);
      Complex factor = s;
      for (Eigen::Index power = 1; power < weights_.num_powers(b); ++power, factor *= s)
        matrix(a, b) += factor * sum(a, b, power);
      if (weights_.has_one(a, b)) matrix(a, b) += 1.0;
    }
    // A positive factor; without it the determinant of many rows leaves the range of a double.
    const double largest = matrix.row(a).cwiseAbs2().maxCoeff();
    if (largest > 0.0) matrix.row(a) *= 1.0 / std::sqrt(largest);
  }
  return determinant_of(matrix);
}

Complex SecularFunction::determinant_at(Complex s) {
  invert_modes(
      poles_.table(), s.real(), s.imag(),
      {value_re_.data(), value_im_.data(), slope_re_.data(), slope_im_.data(), norm_.data()});
  return determinant(value_re_.data(), value_im_.data(), s);
}

SecularFunction::Line& SecularFunction::line_at(double height) {
  const auto found = lines_.find(height);
  if (found != lines_.end()) return found->second;
  // A table of 60 samples of some hundred modes takes 0.2 MB.
  constexpr std::size_t max_lines = 64;
  if (lines_.size() >= max_lines) lines_.clear();

  const std::size_t padded = poles_.padded_size();
  Line line;
  const double end = 1e3 * extent();
  const auto on_side = [&](double x) { return Complex(x, height + std::abs(x)); };
  // Far from all poles det A is a power of s.
  constexpr int num_rises = 4;
  for (int i = 0; i < num_rises; ++i)
    line.places.emplace_back(end, i * on_side(end).imag() / num_rises);
  double x = end;
  while (x > -end) {
    const Complex place = on_side(x);
    line.places.push_back(place);
    const double distance = std::min(place.imag(), poles_.distance_from(place));
    // The floor keeps the number of samples finite.
    constexpr double closest = 1e-9;
    line.meets_pole = line.meets_pole || distance < closest * place.imag();
    const double step = std::max(0.5 * distance / std::numbers::sqrt2, closest * extent());
    // The corner is one of the samples.
    x = x > 0.0 ? std::max(x - step, 0.0) : x - step;
  }
  for (int i = num_rises; i >= 0; --i)
    line.places.emplace_back(-end, i * on_side(end).imag() / num_rises);
  line.inverses = AlignedArray(2 * padded * line.places.size());
  for (std::size_t p = 0; p < line.places.size(); ++p) {
    double* const re = line.inverses.data() + 2 * padded * p;
    invert_modes(poles_.table(), line.places[p].real(), line.places[p].imag(),
                 {re, re + padded, slope_re_.data(), slope_im_.data(), norm_.data()});
  }
  line.values.resize(line.places.size());
  return lines_.emplace(height, std::move(line)).first->second;
}

std::optional<int> SecularFunction::count_zeros_below(double height) {
  Line& line = line_at(height);
  if (line.meets_pole) return std::nullopt;
  const std::size_t padded = poles_.padded_size();
  for (std::size_t p = 0; p < line.places.size(); ++p) {
    const double* const re = line.inverses.data() + 2 * padded * p;
    line.values[p] = determinant(re, re + padded, line.places[p]);
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
  const std::vector<double>& heights = pole_heights();
  const auto num_modes_below =
      std::lower_bound(heights.begin(), heights.end(), height) - heights.begin();
  const double zeros = total / std::numbers::pi + 2.0 * static_cast<double>(num_modes_below);
  // Both ends are real: only rounding keeps the turn from being a multiple of π.
  if (std::abs(zeros - std::round(zeros)) > 0.1) return std::nullopt;
  return static_cast<int>(std::lround(zeros));
}

}  // namespace stridor
