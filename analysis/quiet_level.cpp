#include "analysis/quiet_level.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <vector>

#include "analysis/order_statistics.hpp"

namespace stridor {
namespace {

// Of a burst in a record of noise: half for the largest value, half for the level.
constexpr double false_alarm = 1e-4;

// γ_k ≤ x and γ_k > x, each without cancellation where it is the smaller.
struct Tails {
  double lower;
  double upper;
};

// Regularised incomplete gamma functions: power series below the mean, Legendre's continued
// fraction (modified Lentz) above.
Tails gamma_tails(double k, double x) {
  const double scale = std::exp(k * std::log(x) - x - std::lgamma(k));
  constexpr double precision = 1e-14;
  constexpr int limit = 100000;
  if (x < k + 1.0) {
    double term = 1.0 / k;
    double sum = term;
    for (int i = 1; i < limit && term > precision * sum; ++i) {
      term *= x / (k + i);
      sum += term;
    }
    return {scale * sum, 1.0 - scale * sum};
  }
  double b = x + 1.0 - k;
  double c = std::numeric_limits<double>::max();
  double d = 1.0 / b;
  double h = d;
  for (int i = 1; i < limit; ++i) {
    const double a = -i * (i - k);
    b += 2.0;
    d = 1.0 / (a * d + b);
    c = b + a / c;
    h *= c * d;
    if (std::abs(c * d - 1.0) < precision) break;
  }
  return {1.0 - scale * h, scale * h};
}

// The x between 10⁻³⁰⁰ and k·10⁶ where is_below(x) turns false.
template <class Predicate>
double bisect(double k, Predicate is_below) {
  double low = std::log(1e-300);
  double high = std::log(k * 1e6);
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (is_below(std::exp(middle)) ? low : high) = middle;
  }
  return std::exp(high);
}

double lower_quantile(double k, double probability) {
  return bisect(k, [&](double x) { return gamma_tails(k, x).lower < probability; });
}

double upper_quantile(double k, double probability) {
  return bisect(k, [&](double x) { return gamma_tails(k, x).upper > probability; });
}

// The shape k in [1, largest] at which quartile and decile of γ_k have the given ratio, which falls
// with k.
double shape_from_ratio(double ratio, double largest) {
  const auto ratio_at = [](double k) { return lower_quantile(k, 0.25) / lower_quantile(k, 0.1); };
  if (!(ratio < ratio_at(1.0))) return 1.0;
  if (ratio <= ratio_at(largest)) return largest;
  double low = 0.0;
  double high = std::log(largest);
  for (int i = 0; i < 40; ++i) {
    const double middle = 0.5 * (low + high);
    (ratio_at(std::exp(middle)) > ratio ? low : high) = middle;
  }
  return std::exp(low);
}

// The u below which the quartile of n independent values lies with at most the given probability.
double quartile_bound(double n, double probability) {
  const double wanted = -std::log(probability) / n;
  double low = std::log(1e-300);
  double high = std::log(0.25);
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    const double divergence =
        0.25 * (std::log(0.25) - middle) + 0.75 * std::log(0.75 / (1.0 - std::exp(middle)));
    (divergence > wanted ? low : high) = middle;
  }
  return std::exp(low);
}

// (∫g²df)²/∫g⁴df over where g² is above 10⁻⁸.
double noise_bandwidth(double interval, Band band) {
  const double nyquist = 0.5 / interval;
  const double width = band.upper - band.lower;
  const double from = std::max(0.0, band.lower - 2.0 * width);
  const double to = std::min(nyquist, band.upper + 2.0 * width);
  constexpr int points = 4000;
  double second = 0.0;
  double fourth = 0.0;
  const double step = (to - from) / points;
  for (int i = 0; i < points; ++i) {
    const double gain = band_pass_gain(from + (i + 0.5) * step, interval, band);
    const double power = gain * gain;
    second += power * step;
    fourth += power * power * step;
  }
  return second * second / fourth;
}

/// σ² and k of a vibration, and how far σ² may be off.
struct Spread {
  double square;  ///< σ²
  double shape;   ///< k
  double bound;   ///< σ₊²/σ²
};

/// From a stretch known to hold no burst.
Spread spread_in(VibrationBlocks& vibration, IndexRange quiet, double bandwidth,
                 double largest_shape) {
  const auto count = static_cast<double>(quiet.size());
  Spread spread{0.0, 1.0, 0.0};
  vibration.for_each(quiet, [&](const VibrationPiece& piece, IndexRange part) {
    for (const double e : piece.envelope(part)) spread.square += e * e / count;
  });
  const double square = spread.square;
  double variance = 0.0;
  vibration.for_each(quiet, [&](const VibrationPiece& piece, IndexRange part) {
    for (const double e : piece.envelope(part))
      variance += (e * e - square) * (e * e - square) / count;
  });
  spread.shape =
      variance > 0.0 ? std::clamp(square * square / variance, 1.0, largest_shape) : largest_shape;
  const double freedom =
      std::max(1.0, bandwidth * count * vibration.interval() * spread.shape / largest_shape);
  spread.bound = freedom / lower_quantile(freedom, 0.5 * false_alarm);
  return spread;
}

/// From the lower decile and quartile of the squared envelope of all that is measured.
Spread spread_below(VibrationBlocks& vibration, IndexRange measured, double bandwidth,
                    double largest_shape, double smoothing) {
  const auto rank = [&](double probability) {
    return static_cast<std::size_t>(
        std::floor(probability * static_cast<double>(measured.size() - 1)));
  };
  const auto each = [&](const TakeValues& take) {
    vibration.for_each(measured, [&](const VibrationPiece& piece, IndexRange part) {
      take(piece.envelope(part));
    });
  };
  const std::vector<double> found =
      order_statistics(each, measured.size(), {rank(0.1), rank(0.25)}, SignalBlocks::usual_length);
  const double decile = found[0] * found[0];
  const double quartile = found[1] * found[1];
  Spread spread{0.0, 1.0, 0.0};
  if (decile > 0.0) spread.shape = shape_from_ratio(quartile / decile, largest_shape);
  const double middle = lower_quantile(spread.shape, 0.25);
  spread.square = quartile * spread.shape / middle;
  const double independent =
      static_cast<double>(measured.size()) * vibration.interval() / (smoothing + 1.0 / bandwidth);
  spread.bound =
      middle / lower_quantile(spread.shape, quartile_bound(independent, 0.5 * false_alarm));
  return spread;
}

}  // namespace

QuietLevel quiet_level(VibrationBlocks& vibration, double largest,
                       const BurstParameters& parameters, double first, IndexRange measured) {
  const double interval = vibration.interval();
  const double bandwidth = noise_bandwidth(interval, parameters.band);
  const double largest_shape = std::max(1.0, bandwidth * parameters.smoothing);
  Spread spread{};
  if (parameters.quiet) {
    const IndexRange quiet = samples_in(*parameters.quiet, first, interval, vibration.size());
    if (quiet.is_empty()) {
      throw std::invalid_argument(
          fmt::format("bursts: no sample lies in the quiet window {:g} to {:g} s",
                      parameters.quiet->from, parameters.quiet->to));
    }
    spread = spread_in(vibration, quiet, bandwidth, largest_shape);
  } else {
    spread = spread_below(vibration, measured, bandwidth, largest_shape, parameters.smoothing);
  }
  const double trials =
      std::max(1.0, 4.0 * bandwidth * static_cast<double>(measured.size()) * interval);
  const double extreme =
      spread.bound * upper_quantile(spread.shape, 0.5 * false_alarm / trials) / spread.shape;

  QuietLevel level{};
  level.rms = std::max(std::sqrt(spread.square), rounding_level * largest);
  level.threshold = level.rms * std::max(parameters.threshold, std::sqrt(extreme));
  level.freedom = spread.shape;
  return level;
}

}  // namespace stridor
