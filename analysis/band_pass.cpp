#include "analysis/band_pass.hpp"

#include <fftw3.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <memory>
#include <mutex>
#include <new>
#include <numbers>
#include <stdexcept>
#include <type_traits>

namespace stridor {
namespace {

constexpr int order = 4;

struct FftwFree {
  void operator()(void* memory) const { fftw_free(memory); }
};

// Plans are neither made nor destroyed thread-safely by FFTW, only executed.
std::mutex planner_mutex;

struct PlanDestroy {
  void operator()(fftw_plan plan) const {
    const std::scoped_lock lock(planner_mutex);
    fftw_destroy_plan(plan);
  }
};
using Plan = std::unique_ptr<std::remove_pointer_t<fftw_plan>, PlanDestroy>;

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

// The smallest length ≥ n without prime factors above 7, even, for which FFTW is fast.
double smooth_length(double n) {
  double best = std::exp2(std::ceil(std::log2(std::max(n, 2.0))));
  for (double p7 = 2.0; p7 < best; p7 *= 7.0) {
    for (double p5 = p7; p5 < best; p5 *= 5.0) {
      for (double p3 = p5; p3 < best; p3 *= 3.0) {
        double p = p3;
        while (p < n) p *= 2.0;
        best = std::min(best, p);
      }
    }
  }
  return best;
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
  const double length = smooth_length(count + 2.0 * wanted_pad);
  if (!(length <= std::numeric_limits<int>::max())) {
    throw std::invalid_argument(
        fmt::format("band_pass: the band {:g} to {:g} Hz needs {:g} samples, too many", band.lower,
                    band.upper, length));
  }
  const auto n = static_cast<std::size_t>(length);
  const auto num_lines = n / 2 + 1;
  const std::unique_ptr<double, FftwFree> real(fftw_alloc_real(n));
  const std::unique_ptr<fftw_complex, FftwFree> spectrum(fftw_alloc_complex(num_lines));
  if (!real || !spectrum) throw std::bad_alloc();

  Plan forward;
  Plan backward;
  {
    const std::scoped_lock lock(planner_mutex);
    forward.reset(
        fftw_plan_dft_r2c_1d(static_cast<int>(n), real.get(), spectrum.get(), FFTW_ESTIMATE));
    backward.reset(
        fftw_plan_dft_c2r_1d(static_cast<int>(n), spectrum.get(), real.get(), FFTW_ESTIMATE));
  }
  if (!forward || !backward) throw std::bad_alloc();

  // The signal from the start of the buffer, then its continuation to the right, then that to the
  // left: the spectrum is periodic, so the left one ends where the signal begins.
  const std::span<double> buffer(real.get(), n);
  const std::size_t last = samples.size() - 1;
  std::copy(samples.begin(), samples.end(), buffer.begin());
  const std::size_t right = (n - samples.size()) / 2;
  const std::size_t left = n - samples.size() - right;
  for (std::size_t i = 1; i <= right; ++i) {
    buffer[last + i] = 2.0 * samples[last] - samples[last - std::min(i, last)];
  }
  for (std::size_t i = 1; i <= left; ++i)
    buffer[n - i] = 2.0 * samples[0] - samples[std::min(i, last)];

  fftw_execute(forward.get());
  const double resolution = 1.0 / (length * interval);
  for (std::size_t k = 0; k < num_lines; ++k) {
    // n is even: the last line is the Nyquist frequency, where rounding must not step beyond it.
    const double gain = k + 1 == num_lines
                            ? 0.0
                            : band_pass_gain(static_cast<double>(k) * resolution, interval, band);
    spectrum.get()[k][0] *= gain / length;
    spectrum.get()[k][1] *= gain / length;
  }
  fftw_execute(backward.get());
  return {buffer.begin(), buffer.begin() + static_cast<std::ptrdiff_t>(samples.size())};
}

}  // namespace stridor
