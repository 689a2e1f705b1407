#include "coupling/kinematics/monotone_cubic.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

namespace stridor {

std::vector<double> monotone_slopes(const std::vector<double>& x, const std::vector<double>& y) {
  const std::size_t n = x.size();
  std::vector<double> slopes(n);
  if (n == 2) return {(y[1] - y[0]) / (x[1] - x[0]), (y[1] - y[0]) / (x[1] - x[0])};
  const auto length = [&](std::size_t i) { return x[i + 1] - x[i]; };
  const auto secant = [&](std::size_t i) { return (y[i + 1] - y[i]) / length(i); };
  for (std::size_t i = 1; i + 1 < n; ++i) {
    const double before = secant(i - 1);
    const double after = secant(i);
    if (before * after <= 0.0) continue;
    const double w1 = 2.0 * length(i) + length(i - 1);
    const double w2 = length(i) + 2.0 * length(i - 1);
    slopes[i] = (w1 + w2) / (w1 / before + w2 / after);
  }
  // At the ends the parabola through three points, kept monotone.
  const auto end_slope = [](double h0, double h1, double d0, double d1) {
    const double slope = ((2.0 * h0 + h1) * d0 - h0 * d1) / (h0 + h1);
    if (slope * d0 <= 0.0) return 0.0;
    return d0 * d1 <= 0.0 && std::abs(slope) > 3.0 * std::abs(d0) ? 3.0 * d0 : slope;
  };
  slopes[0] = end_slope(length(0), length(1), secant(0), secant(1));
  slopes[n - 1] = end_slope(length(n - 2), length(n - 3), secant(n - 2), secant(n - 3));
  return slopes;
}

MonotoneCubic::MonotoneCubic(std::vector<double> x, std::vector<double> y)
    : x_(std::move(x)), y_(std::move(y)) {
  if (x_.size() < 2 || x_.size() != y_.size())
    throw std::invalid_argument("MonotoneCubic: needs two points or more, as many x as y");
  for (std::size_t i = 0; i < x_.size(); ++i) {
    if (!std::isfinite(x_[i]) || !std::isfinite(y_[i]))
      throw std::invalid_argument("MonotoneCubic: a point is not finite");
    if (i > 0 && !(x_[i] > x_[i - 1]))
      throw std::invalid_argument("MonotoneCubic: x does not ascend");
  }
  slopes_ = monotone_slopes(x_, y_);
}

CurvePoint MonotoneCubic::at(double x) const {
  const auto after = std::upper_bound(x_.begin() + 1, x_.end() - 1, x);
  const auto i = static_cast<std::size_t>(after - x_.begin()) - 1;
  const double h = x_[i + 1] - x_[i];
  const double t = (x - x_[i]) / h;
  const double rise = y_[i + 1] - y_[i];
  const double a = h * slopes_[i];
  const double b = h * slopes_[i + 1];
  // y = y_i + a t + (3 rise − 2a − b) t² + (a + b − 2 rise) t³
  const double c2 = 3.0 * rise - 2.0 * a - b;
  const double c3 = a + b - 2.0 * rise;
  return {y_[i] + t * (a + t * (c2 + t * c3)), (a + t * (2.0 * c2 + 3.0 * t * c3)) / h,
          (2.0 * c2 + 6.0 * t * c3) / (h * h)};
}

}  // namespace stridor
