#include "analysis/band_pass.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <stdexcept>

#include "core/fft_plan.hpp"

namespace stridor {
namespace {

constexpr int order = 4;

void check(double interval, Band band) {
  if (!(interval > 0.0) || !std::isfinite(interval)) {
    throw std::invalid_argument("band_pass: the sampling interval must be positive and finite");
  }
  const double nyquist = 0.5 / interval;
  if (!(band.lower > 0.0 && band.lower < band.upper && band.upper < nyquist)) {
    throw std::invalid_argument(fmt::format(
        "band_pass: the band {:g} to {:g} Hz does not satisfy 0 < lower < upper < {:g} Hz "
        "(half the sampling rate)",
        band.lower, band.upper, nyquist));
  }
}

double warped(double frequency, double interval) {
  return std::tan(std::numbers::pi * frequency * interval);
}

// Samples after which the response of the filter, forwards and backwards, has decayed to 10⁻¹²: the
// slowest of the digital poles z = (1 + s)/(1 − s), with s from the poles of the low-pass
// prototype.
double decay_samples(double interval, Band band) {
  using Complex = std::complex<double>;
  const double w1 = warped(band.lower, interval);
  const double w2 = warped(band.upper, interval);
  double largest = 0.0;
  for (int k = 0; k < order; ++k) {
    const double angle = std::numbers::pi * (2 * k + 1 + order) / (2.0 * order);
    const Complex half = std::polar(0.5 * (w2 - w1), angle);
    const Complex root = std::sqrt(half * half - w1 * w2);
    for (const Complex s : {half + root, half - root}) {
      largest = std::max(largest, std::abs((1.0 + s) / (1.0 - s)));
    }
  }
  // |z|ⁿ = 10⁻¹², and a third more because forwards and backwards make double poles, n |z|ⁿ.
  return 1.33 * 12.0 * std::numbers::ln10 / -std::log(largest);
}

}  // namespace

double band_pass_gain(double frequency, double interval, Band band) {
  check(interval, band);
  if (!(frequency >= 0.0 && frequency <= 0.5 / interval)) {
    throw std::invalid_argument(
        "band_pass_gain: the frequency must be 0 to half the sampling rate");
  }
  if (frequency == 0.0 || frequency == 0.5 / interval) return 0.0;
  const double w1 = warped(band.lower, interval);
  const double w2 = warped(band.upper, interval);
  const double w = warped(frequency, interval);
  const double distance = (w * w - w1 * w2) / (w * (w2 - w1));
  return 1.0 / (1.0 + std::pow(distance, 2 * order));
}

std::vector<double> band_pass(std::span<const double> samples, double interval, Band band) {
  check(interval, band);
  if (!std::all_of(samples.begin(), samples.end(), [](double x) { return std::isfinite(x); })) {
    throw std::invalid_argument("band_pass: the samples must be finite");
  }
  if (samples.empty()) return {};

  const auto count = static_cast<double>(samples.size());
  const double wanted_pad = std::ceil(decay_samples(interval, band));
  const double wanted_length = count + 2.0 * wanted_pad;
  if (!(wanted_length <= std::numeric_limits<int>::max())) {
    throw std::invalid_argument(
        fmt::format("band_pass: the band {:g} to {:g} Hz needs {:g} samples, too many", band.lower,
                    band.upper, wanted_length));
  }
  const std::size_t n = fast_fft_length(static_cast<std::size_t>(wanted_length));
  RealFft forward(n);
  InverseRealFft backward(n);

  // The signal from the start of the buffer, then its continuation to the right, then that to the
  // left: the spectrum is periodic, so the left one ends where the signal begins.
  const std::span<double> buffer = forward.input();
  const std::size_t last = samples.size() - 1;
  std::copy(samples.begin(), samples.end(), buffer.begin());
  const std::size_t right = (n - samples.size()) / 2;
  const std::size_t left = n - samples.size() - right;
  for (std::size_t i = 1; i <= right; ++i) {
    buffer[last + i] = 2.0 * samples[last] - samples[last - std::min(i, last)];
  }
  for (std::size_t i = 1; i <= left; ++i)
    buffer[n - i] = 2.0 * samples[0] - samples[std::min(i, last)];

  forward.execute();
  const auto length = static_cast<double>(n);
  const std::size_t num_lines = n / 2 + 1;
  for (std::size_t k = 0; k < num_lines; ++k) {
    // n is even: the last line is the Nyquist frequency, where rounding must not step beyond it.
    const double gain =
        k + 1 == num_lines
            ? 0.0
            : band_pass_gain(static_cast<double>(k) / (length * interval), interval, band);
    backward.input()[k] = gain / length * forward.output()[k];
  }
  backward.execute();
  const std::span<const double> filtered = backward.output().first(samples.size());
  return {filtered.begin(), filtered.end()};
}

}  // namespace stridor
