#include "analysis/bursts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstddef>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <utility>

#include "analysis/spectrogram.hpp"
#include "core/fft_plan.hpp"

namespace stridor {
namespace {

// Of a burst in a record of noise: half for the largest value, half for the level.
constexpr double false_alarm = 1e-4;
// Of the largest sample: what rounding leaves of a signal outside the band.
constexpr double rounding = 1e-13;

void check_smoothing(double interval, Band band, double smoothing) {
  band_pass_gain(0.0, interval, band);  // its checks of interval and band
  if (!(smoothing >= 1.0 / band.lower) || !std::isfinite(smoothing)) {
    throw std::invalid_argument(
        fmt::format("bursts: the smoothing of {:g} s is not one period of the lower edge of the "
                    "band, {:g} s, or more",
                    smoothing, 1.0 / band.lower));
  }
}

void check(double interval, const BurstParameters& parameters, double first) {
  check_smoothing(interval, parameters.band, parameters.smoothing);
  if (!(parameters.threshold >= 2.0) || !std::isfinite(parameters.threshold)) {
    throw std::invalid_argument(
        fmt::format("bursts: the threshold {:g} is not 2 or more", parameters.threshold));
  }
  if (!(parameters.minimum_duration >= 0.0) || !std::isfinite(parameters.minimum_duration)) {
    throw std::invalid_argument(fmt::format("bursts: the minimum duration {:g} s is not 0 or more",
                                            parameters.minimum_duration));
  }
  if (!std::isfinite(first)) {
    throw std::invalid_argument("bursts: the time of the first sample must be finite");
  }
}

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

std::size_t half_width(double interval, double smoothing) {
  return static_cast<std::size_t>(std::llround(0.5 * smoothing / interval));
}

// Means over i − half … i + half, as far as there are values. Sums of neighbours, not differences
// of one running sum: a quiet stretch after a burst of 10⁸ times its power must not drown in the
// rounding of the latter. Blocks of the window's length carry sums from both their ends, so that
// every window is the end of one block and the start of the next.
std::vector<double> running_mean(std::span<const double> values, std::size_t half) {
  const std::size_t count = values.size();
  const std::size_t width = 2 * half + 1;
  std::vector<double> from_left(count);
  std::vector<double> from_right(count);
  for (std::size_t i = 0; i < count; ++i) {
    from_left[i] = values[i] + (i % width == 0 ? 0.0 : from_left[i - 1]);
  }
  for (std::size_t i = count; i-- > 0;) {
    const bool is_last = i + 1 == count || (i + 1) % width == 0;
    from_right[i] = values[i] + (is_last ? 0.0 : from_right[i + 1]);
  }
  std::vector<double> means(count);
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t begin = i < half ? 0 : i - half;
    const std::size_t last = std::min(i + half, count - 1);
    double sum = 0.0;
    if (begin % width == 0) {
      sum = from_left[last];
    } else if (last / width != begin / width) {
      sum = from_right[begin] + from_left[last];
    } else {
      // Cut off by the right end, inside the last block.
      sum = from_right[begin];
    }
    means[i] = sum / static_cast<double>(last - begin + 1);
  }
  return means;
}

std::vector<double> smoothed_envelope(std::span<const double> squared_amplitude, double interval,
                                      double smoothing) {
  std::vector<double> envelope = running_mean(squared_amplitude, half_width(interval, smoothing));
  for (double& e : envelope) e = std::sqrt(e);
  return envelope;
}

double squared_quantile(std::span<const double> envelope, double probability) {
  std::vector<double> values(envelope.begin(), envelope.end());
  const auto rank =
      static_cast<std::ptrdiff_t>(std::floor(probability * static_cast<double>(values.size() - 1)));
  std::nth_element(values.begin(), values.begin() + rank, values.end());
  const double value = values[static_cast<std::size_t>(rank)];
  return value * value;
}

// `measured` is not empty.
QuietLevel quiet_level(std::span<const double> samples, std::span<const double> envelope,
                       double interval, const BurstParameters& parameters, double first,
                       IndexRange measured) {
  const double bandwidth = noise_bandwidth(interval, parameters.band);
  const double largest_shape = std::max(1.0, bandwidth * parameters.smoothing);
  const double floor = rounding * peak(samples);

  double square = 0.0;
  double bound = 0.0;  // σ₊²/σ²
  double shape = 1.0;
  if (parameters.quiet) {
    const IndexRange quiet = samples_in(*parameters.quiet, first, interval, samples.size());
    if (quiet.is_empty()) {
      throw std::invalid_argument(
          fmt::format("bursts: no sample lies in the quiet window {:g} to {:g} s",
                      parameters.quiet->from, parameters.quiet->to));
    }
    const auto values = quiet.of(envelope);
    const auto count = static_cast<double>(values.size());
    for (const double e : values) square += e * e / count;
    double variance = 0.0;
    for (const double e : values) variance += (e * e - square) * (e * e - square) / count;
    shape =
        variance > 0.0 ? std::clamp(square * square / variance, 1.0, largest_shape) : largest_shape;
    const double freedom = std::max(1.0, bandwidth * count * interval * shape / largest_shape);
    bound = freedom / lower_quantile(freedom, 0.5 * false_alarm);
  } else {
    const double decile = squared_quantile(measured.of(envelope), 0.1);
    const double quartile = squared_quantile(measured.of(envelope), 0.25);
    shape = decile > 0.0 ? shape_from_ratio(quartile / decile, largest_shape) : 1.0;
    const double middle = lower_quantile(shape, 0.25);
    square = quartile * shape / middle;
    const double independent =
        static_cast<double>(measured.size()) * interval / (parameters.smoothing + 1.0 / bandwidth);
    bound = middle / lower_quantile(shape, quartile_bound(independent, 0.5 * false_alarm));
  }
  const double trials =
      std::max(1.0, 4.0 * bandwidth * static_cast<double>(measured.size()) * interval);
  const double extreme = bound * upper_quantile(shape, 0.5 * false_alarm / trials) / shape;

  QuietLevel level{};
  level.rms = std::max(std::sqrt(square), floor);
  level.threshold = level.rms * std::max(parameters.threshold, std::sqrt(extreme));
  level.freedom = shape;
  return level;
}

// A rise and fall of c = max(e, σ), as indices into the measured part.
struct Swell {
  std::size_t low;       // last minimum before the rise
  std::size_t crossing;  // first value above it by the ratio
  std::size_t high;      // maximum
};

// Turning points of a series with hysteresis.
std::vector<Swell> find_swells(std::span<const double> values, double floor, double ratio) {
  std::vector<Swell> swells;
  const auto value = [&](std::size_t i) { return std::max(values[i], floor); };
  Swell swell{0, 0, 0};
  bool is_up = false;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double c = value(i);
    if (is_up) {
      if (c > value(swell.high)) {
        swell.high = i;
      } else if (c * ratio <= value(swell.high)) {
        swells.push_back(swell);
        swell = {i, i, i};
        is_up = false;
      }
    } else if (c <= value(swell.low)) {
      swell.low = i;
    } else if (c >= ratio * value(swell.low)) {
      swell.crossing = swell.high = i;
      is_up = true;
    }
  }
  if (is_up) swells.push_back(swell);
  return swells;
}

struct Rise {
  std::size_t at;
  double slope;  // 1/s
};

// Growth of the envelope, not counted below a floor, over i − half … i + half; 1/s.
double growth_at(std::span<const double> envelope, std::size_t i, std::size_t half, double interval,
                 double floor) {
  const std::size_t left = i < half ? 0 : i - half;
  const std::size_t right = std::min(i + half, envelope.size() - 1);
  if (left == right) return -std::numeric_limits<double>::infinity();
  return std::log(std::max(envelope[right], floor) / std::max(envelope[left], floor)) /
         (static_cast<double>(right - left) * interval);
}

Rise steepest_rise(std::span<const double> envelope, std::size_t from, std::size_t to,
                   std::size_t half, double interval, double floor) {
  Rise steepest{to, -std::numeric_limits<double>::infinity()};
  for (std::size_t i = from; i <= to; ++i) {
    const double slope = growth_at(envelope, i, half, interval, floor);
    if (slope > steepest.slope) steepest = {i, slope};
  }
  return steepest;
}

// The band in which a vibration can grow and change its frequency within T/2.
Band own_band(double frequency, double interval, double smoothing) {
  const double width = 2.0 / smoothing;
  const double nyquist = 0.5 / interval;
  return {std::max(frequency - width, 0.5 * frequency),
          std::min(frequency + width, 0.5 * (frequency + nyquist))};
}

struct Growth {
  double steepest;  // 1/s
  double gain;
};

// Growth of the envelope of a burst's own frequency. Its steepest rise is sought from `seen` to
// `high`, where the burst is stronger than anything else in the band; it sets in where, going back
// from there, half of that is left.
Growth growth_of(std::span<const double> own, std::size_t seen, std::size_t high, std::size_t end,
                 std::size_t half, double interval, double floor) {
  const Rise rise = steepest_rise(own, seen, high, 2 * half, interval, floor);
  std::size_t onset = rise.at;
  while (onset > 0 && growth_at(own, onset, half, interval, floor) > 0.5 * rise.slope) --onset;
  const auto begin = own.begin() + static_cast<std::ptrdiff_t>(onset);
  const double largest =
      *std::max_element(begin, own.begin() + static_cast<std::ptrdiff_t>(end) + 1);
  return {rise.slope, std::log(largest / std::max(own[onset], floor))};
}

// Frequency of the strongest line in the band around a sample of the whole signal.
double dominant_frequency(std::span<const double> filtered, double interval,
                          const BurstParameters& parameters, std::size_t at) {
  const double duration = std::max(2.0 * parameters.smoothing, 8.0 / parameters.band.lower);
  const std::size_t wanted = 2 * half_width(interval, duration);
  const std::size_t length = std::min(std::max<std::size_t>(wanted, 2), filtered.size());
  const std::size_t begin =
      std::min(at < length / 2 ? 0 : at - length / 2, filtered.size() - length);
  // Zeros to four times the length: the parabola through three lines is then good to 10⁻³ of the
  // resolution 1/duration.
  RealFft fft(fast_fft_length(4 * length));
  const std::vector<double> window = make_window(WindowKind::hann, length);
  for (std::size_t i = 0; i < length; ++i) fft.input()[i] = window[i] * filtered[begin + i];
  fft.execute();

  const auto lines = fft.output();
  const double resolution = 1.0 / (static_cast<double>(fft.length()) * interval);
  const auto lowest =
      std::max<std::size_t>(1, static_cast<std::size_t>(parameters.band.lower / resolution));
  const auto highest = std::min(
      lines.size() - 2, static_cast<std::size_t>(std::ceil(parameters.band.upper / resolution)));
  std::size_t best = lowest;
  for (std::size_t k = lowest; k <= highest; ++k) {
    if (std::norm(lines[k]) > std::norm(lines[best])) best = k;
  }
  const double left = std::log(std::norm(lines[best - 1]));
  const double centre = std::log(std::norm(lines[best]));
  const double right = std::log(std::norm(lines[best + 1]));
  const double curvature = left - 2.0 * centre + right;
  const double offset = curvature < 0.0 ? 0.5 * (left - right) / curvature : 0.0;
  return resolution * (static_cast<double>(best) + std::clamp(offset, -0.5, 0.5));
}

}  // namespace

std::vector<double> burst_envelope(std::span<const double> samples, double interval, Band band,
                                   double smoothing) {
  check_smoothing(interval, band, smoothing);
  if (samples.empty()) return {};
  const PassedSignal passed = BandSpectrum(samples, interval, band).pass({band});
  return smoothed_envelope(passed.squared_amplitude, interval, smoothing);
}

QuietLevel find_quiet_level(std::span<const double> samples, double interval,
                            const BurstParameters& parameters, double first) {
  check(interval, parameters, first);
  const IndexRange measured = samples_in(parameters.measured, first, interval, samples.size());
  if (measured.is_empty()) {
    throw std::invalid_argument("bursts: no sample lies in the measured window");
  }
  const std::vector<double> envelope =
      burst_envelope(samples, interval, parameters.band, parameters.smoothing);
  return quiet_level(samples, envelope, interval, parameters, first, measured);
}

std::vector<Burst> find_bursts(std::span<const double> samples, double interval,
                               const BurstParameters& parameters, double first) {
  return find_vibration(samples, interval, parameters, first).bursts;
}

Vibration find_vibration(std::span<const double> samples, double interval,
                         const BurstParameters& parameters, double first) {
  check(interval, parameters, first);
  if (samples.empty()) return {};
  const Band band = parameters.band;
  const double smoothing = parameters.smoothing;
  BandSpectrum spectrum(samples, interval, band);
  PassedSignal passed = spectrum.pass({band});
  Vibration vibration{std::move(passed.samples), {}};
  const std::span<const double> filtered = vibration.filtered;
  const IndexRange measured = samples_in(parameters.measured, first, interval, samples.size());
  if (measured.is_empty()) return vibration;
  const std::vector<double> whole =
      smoothed_envelope(passed.squared_amplitude, interval, smoothing);
  const QuietLevel level = quiet_level(samples, whole, interval, parameters, first, measured);
  if (!(level.rms > 0.0) || !std::isfinite(level.threshold)) return vibration;

  const auto envelope = measured.of(whole);
  const std::size_t half = half_width(interval, smoothing);
  const auto time_at = [&](std::size_t i) {
    return first + static_cast<double>(measured.begin + i) * interval;
  };
  const std::vector<Swell> swells = find_swells(envelope, level.rms, level.threshold / level.rms);
  for (std::size_t j = 0; j < swells.size(); ++j) {
    const Swell& swell = swells[j];
    const double before = std::max(envelope[swell.low], level.rms);
    const double edge = std::numbers::sqrt2 * before;
    std::size_t start = swell.crossing;
    while (start > swell.low && envelope[start] > edge) --start;
    const std::size_t limit = j + 1 < swells.size() ? swells[j + 1].low : envelope.size() - 1;
    std::size_t end = swell.high;
    while (end < limit && envelope[end] > edge) ++end;

    Burst burst{};
    burst.start = time_at(start);
    burst.end = time_at(end);
    if (burst.end - burst.start < parameters.minimum_duration) continue;
    const auto part = measured.of(filtered).subspan(start, end - start + 1);
    const auto largest = std::max_element(
        part.begin(), part.end(), [](double a, double b) { return std::abs(a) < std::abs(b); });
    burst.peak = std::abs(*largest);
    burst.peak_time = time_at(start + static_cast<std::size_t>(largest - part.begin()));
    const Rise rise =
        steepest_rise(envelope, swell.crossing, swell.high, 2 * half, interval, level.rms);
    burst.frequency = dominant_frequency(filtered, interval, parameters, measured.begin + rise.at);
    const Band own = own_band(burst.frequency, interval, smoothing);
    const std::vector<double> own_envelope =
        smoothed_envelope(spectrum.pass({band, own}).squared_amplitude, interval, 0.5 * smoothing);
    const Growth growth = growth_of(measured.of(own_envelope), swell.crossing, swell.high, end,
                                    half, interval, rounding * peak(samples));
    burst.growth = growth.steepest;
    burst.gain = growth.gain;
    vibration.bursts.push_back(burst);
  }
  return vibration;
}

}  // namespace stridor
