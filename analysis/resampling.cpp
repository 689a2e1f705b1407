#include "analysis/resampling.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

namespace stridor {
namespace {

constexpr double num_zeros = 64.0;    ///< W
constexpr double kaiser_shape = 9.0;  ///< β

/// sinc(u) w(u/W) on a fine grid of u, between whose values it is linear.
class InterpolationKernel {
 public:
  InterpolationKernel() : values_(static_cast<std::size_t>(num_zeros * per_zero) + 2) {
    const double highest = std::cyl_bessel_i(0.0, kaiser_shape);
    for (std::size_t i = 0; i < values_.size(); ++i) {
      const double u = static_cast<double>(i) / per_zero;
      const double part = u / num_zeros;
      if (part >= 1.0) continue;
      const double angle = std::numbers::pi * u;
      values_[i] = (u > 0.0 ? std::sin(angle) / angle : 1.0) *
                   std::cyl_bessel_i(0.0, kaiser_shape * std::sqrt(1.0 - part * part)) / highest;
    }
  }

  double operator()(double u) const {
    const double at = std::abs(u) * per_zero;
    if (at >= num_zeros * per_zero) return 0.0;
    const auto i = static_cast<std::size_t>(at);
    const double part = at - static_cast<double>(i);
    return values_[i] + part * (values_[i + 1] - values_[i]);
  }

 private:
  static constexpr double per_zero = 512.0;  // linear to 1e-6
  std::vector<double> values_;
};

}  // namespace

std::vector<double> resampled(std::span<const double> samples, double ratio) {
  if (!(ratio > 0.0) || !std::isfinite(ratio))
    throw std::invalid_argument("resampled: the ratio of the rates must be positive");
  if (samples.empty()) return {};
  const InterpolationKernel kernel;
  const double bandwidth = std::min(1.0, ratio);
  const double reach = num_zeros / bandwidth;
  const double last = static_cast<double>(samples.size() - 1);
  std::vector<double> result(static_cast<std::size_t>(std::floor(last * ratio)) + 1);
  for (std::size_t j = 0; j < result.size(); ++j) {
    const double time = static_cast<double>(j) / ratio;
    const auto first = static_cast<std::size_t>(std::max(0.0, std::ceil(time - reach)));
    const auto end = static_cast<std::size_t>(std::min(last, std::floor(time + reach)));
    double sum = 0.0;
    for (std::size_t k = first; k <= end; ++k)
      sum += samples[k] * kernel(bandwidth * (time - static_cast<double>(k)));
    result[j] = bandwidth * sum;
  }
  return result;
}

}  // namespace stridor
