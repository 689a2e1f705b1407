#include "coupling/kinematics/roughness.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "core/schema.hpp"

namespace stridor {
namespace {

constexpr double knots_per_correlation_length = 8.0;

/// One of 2⁶⁴ well mixed numbers (SplitMix64: Steele, Lea, Flood 2014).
std::uint64_t mixed(std::uint64_t number) {
  number += 0x9e3779b97f4a7c15ULL;
  number = (number ^ (number >> 30)) * 0xbf58476d1ce4e5b9ULL;
  number = (number ^ (number >> 27)) * 0x94d049bb133111ebULL;
  return number ^ (number >> 31);
}

/// Noise of a knot: mean 0, variance 1, the sum of twelve uniform numbers, which the smoothing over
/// some ten knots makes Gaussian for every practical purpose.
double noise_of(std::uint64_t seed, std::int64_t knot) {
  constexpr int num_pairs = 6;
  constexpr double one = 4294967296.0;  // 2³²
  const std::uint64_t stream = mixed(mixed(seed) ^ static_cast<std::uint64_t>(knot));
  std::uint64_t sum = 0;
  for (std::uint64_t k = 0; k < num_pairs; ++k) {
    const std::uint64_t number = mixed(stream + k);
    sum += (number >> 32) + (number & 0xffffffffULL);
  }
  return static_cast<double>(sum) / one - num_pairs;
}

/// Weights of the noise around a knot in its coefficient.
///
/// White noise smoothed by a kernel of variance ℓ²/4 has the autocorrelation exp(−(d/ℓ)²). The
/// B-spline itself smooths with a variance of a third of a squared knot distance; the rest is left
/// to this Gaussian. Cut off at eight standard deviations: a jump further in would click.
class SmoothingKernel {
 public:
  static constexpr int reach = 32;

  SmoothingKernel() {
    constexpr double variance =
        knots_per_correlation_length * knots_per_correlation_length / 4.0 - 1.0 / 3.0;
    double square_sum = 0.0;
    for (int k = 0; k <= reach; ++k) {
      weights_[static_cast<std::size_t>(k)] = std::exp(-0.5 * k * k / variance);
    }
    // Variance of the spline at a knot, where it is (c₋₁ + 4 c₀ + c₁)/6.
    for (int k = -reach - 1; k <= reach + 1; ++k) {
      const double at_knot = (weight(k - 1) + 4.0 * weight(k) + weight(k + 1)) / 6.0;
      square_sum += at_knot * at_knot;
    }
    for (double& weight : weights_) weight /= std::sqrt(square_sum);
  }

  double weight(int distance) const {
    const int k = std::abs(distance);
    return k > reach ? 0.0 : weights_[static_cast<std::size_t>(k)];
  }

 private:
  std::array<double, reach + 1> weights_;
};

}  // namespace

const Schema& RoughnessParameters::schema() {
  static const Schema keys =
      SchemaOf<RoughnessParameters>("roughness")
          .real("rms", &RoughnessParameters::rms,
                {.doc = "R.m.s. height.", .unit = "m", .range = Range::non_negative()})
          .real("correlation_length", &RoughnessParameters::correlation_length,
                {.doc = "Distance over which the autocorrelation exp(-(d/l)^2) of the height falls "
                        "to 1/e.",
                 .unit = "m",
                 .range = Range::positive()})
          .integer("seed", &RoughnessParameters::seed,
                   {.doc = "Of the random profile: another seed, another surface of the same kind.",
                    .range = Range::between(0, 1e15)});
  return keys;
}

Roughness::Roughness(const RoughnessParameters& parameters, double length) {
  if (!(parameters.correlation_length > 0.0))
    throw std::invalid_argument("Roughness: the correlation length is not positive");
  if (!(length <= max_correlation_lengths * parameters.correlation_length))
    throw std::invalid_argument("Roughness: the correlation length is too small for the master");
  knots_per_metre_ = knots_per_correlation_length / parameters.correlation_length;
  const auto num_intervals =
      std::max<std::int64_t>(1, static_cast<std::int64_t>(std::ceil(length * knots_per_metre_)));
  const std::int64_t num_coefficients = num_intervals + 3;

  const auto seed = static_cast<std::uint64_t>(parameters.seed);
  constexpr int reach = SmoothingKernel::reach;
  std::vector<double> noise;
  noise.reserve(static_cast<std::size_t>(num_coefficients + 2 * reach));
  for (std::int64_t knot = -reach; knot < num_coefficients + reach; ++knot)
    noise.push_back(noise_of(seed, knot));

  const SmoothingKernel kernel;
  coefficients_.resize(static_cast<std::size_t>(num_coefficients));
  for (std::size_t j = 0; j < coefficients_.size(); ++j) {
    double sum = 0.0;
    for (int k = -reach; k <= reach; ++k)
      sum += kernel.weight(k) * noise[j + static_cast<std::size_t>(k + reach)];
    coefficients_[j] = parameters.rms * sum;
  }
}

RoughnessHeight Roughness::height_at(double arc) const {
  if (std::isnan(arc)) return {arc, arc};
  const double place = arc * knots_per_metre_;
  const double last = static_cast<double>(coefficients_.size()) - 4.0;
  const double knot = std::clamp(std::floor(place), 0.0, last);
  const double x = place - knot;
  const double* const c = coefficients_.data() + static_cast<std::size_t>(knot);
  const double y = 1.0 - x;
  const double value = y * y * y * c[0] + (4.0 + x * x * (3.0 * x - 6.0)) * c[1] +
                       (4.0 + y * y * (3.0 * y - 6.0)) * c[2] + x * x * x * c[3];
  const double slope =
      y * y * (c[1] - c[0]) + (1.0 + 2.0 * x * y) * (c[2] - c[1]) + x * x * (c[3] - c[2]);
  return {value / 6.0, 0.5 * slope * knots_per_metre_};
}

}  // namespace stridor
