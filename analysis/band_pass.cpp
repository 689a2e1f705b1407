#include "analysis/band_pass.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <stdexcept>

#include "core/clones.hpp"

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

void check(std::span<const double> samples) {
  if (!std::all_of(samples.begin(), samples.end(), [](double x) { return std::isfinite(x); })) {
    throw std::invalid_argument("band_pass: the samples must be finite");
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

/// Length of a transform that holds `count` samples and `pad` more at each end; more than memory
/// holds is refused.
std::size_t transform_length(std::size_t count, double pad, Band band) {
  const double length = static_cast<double>(count) + 2.0 * pad;
  if (!(length <= std::numeric_limits<int>::max())) {
    throw std::invalid_argument(
        fmt::format("band_pass: the band {:g} to {:g} Hz needs {:g} samples, too many", band.lower,
                    band.upper, length));
  }
  return fast_fft_length(static_cast<std::size_t>(length));
}

/// Samples `begin` … of a signal that is continued oddly about both its end values, by the last
/// reflected value beyond its length.
void read_continued(const SampleSource& samples, std::ptrdiff_t begin, std::span<double> target) {
  const auto count = static_cast<std::ptrdiff_t>(samples.size());
  const std::ptrdiff_t end = begin + static_cast<std::ptrdiff_t>(target.size());
  const std::ptrdiff_t first = std::clamp<std::ptrdiff_t>(begin, 0, count);
  const std::ptrdiff_t last = std::clamp<std::ptrdiff_t>(end, first, count);
  const auto piece = [&](std::ptrdiff_t from, std::ptrdiff_t to) {
    return target.subspan(static_cast<std::size_t>(from - begin),
                          static_cast<std::size_t>(to - from));
  };
  if (last > first) samples.read(static_cast<std::size_t>(first), piece(first, last));
  std::vector<double> mirrored;
  const auto reflect = [&](std::ptrdiff_t from, std::ptrdiff_t to, std::ptrdiff_t about) {
    // Distances from the end value, at most the length of the signal.
    const auto distance = [&](std::ptrdiff_t i) {
      return std::min(std::abs(i - about), count - 1);
    };
    const std::ptrdiff_t furthest = std::max(distance(from), distance(to - 1));
    mirrored.resize(static_cast<std::size_t>(furthest) + 1);
    samples.read(static_cast<std::size_t>(about == 0 ? 0 : about - furthest), mirrored);
    if (about != 0) std::reverse(mirrored.begin(), mirrored.end());
    const std::span<double> values = piece(from, to);
    for (std::ptrdiff_t i = from; i < to; ++i) {
      values[static_cast<std::size_t>(i - from)] =
          2.0 * mirrored[0] - mirrored[static_cast<std::size_t>(distance(i))];
    }
  };
  if (begin < 0) reflect(begin, std::min<std::ptrdiff_t>(end, 0), 0);
  if (end > count) reflect(std::max(begin, count), end, count - 1);
}

/// The gain of band_pass_gain() by the sine s and the cosine c of π f dt in the place of the
/// tangent: the root of (distance²) is (s² − w₁w₂ c²)/(s c (w₂ − w₁)).
struct Gain {
  double product;  ///< w₁w₂
  double width;    ///< w₂ − w₁

  double operator()(double s, double c) const {
    const double distance = (s * s - product * c * c) / (s * c * width);
    const double second = distance * distance;
    const double fourth = second * second;
    return 1.0 / (1.0 + fourth * fourth);
  }
};

/// Multiplies lines 0 … n/2 of a transform of even length n by the gains of a band.
///
/// Sines and cosines of the angles π k/n come from those of two coarser sets, by the addition
/// theorems, for k up to n/4; beyond that they are those of n/2 − k exchanged, so that both keep
/// their relative accuracy to the ends. There distance is infinite, and the gain 0.
STRIDOR_CLONES
void multiply_by_gains(double interval, Band band, std::vector<double>& gains) {
  constexpr std::size_t block = 256;
  static_assert(order == 4, "Gain");
  const double w1 = warped(band.lower, interval);
  const double w2 = warped(band.upper, interval);
  const Gain gain{w1 * w2, w2 - w1};
  const std::size_t half = gains.size() - 1;
  const double angle = std::numbers::pi / (2.0 * static_cast<double>(half));
  double fine_sine[block];
  double fine_cosine[block];
  for (std::size_t j = 0; j < block; ++j) {
    fine_sine[j] = std::sin(angle * static_cast<double>(j));
    fine_cosine[j] = std::cos(angle * static_cast<double>(j));
  }
  double* const lines = gains.data();
  for (std::size_t first = 0; 2 * first <= half; first += block) {
    const double sine = std::sin(angle * static_cast<double>(first));
    const double cosine = std::cos(angle * static_cast<double>(first));
    const std::size_t count = std::min(block, half / 2 + 1 - first);
    double here[block];
    double there[block];
    for (std::size_t j = 0; j < count; ++j) {
      const double s = sine * fine_cosine[j] + cosine * fine_sine[j];
      const double c = cosine * fine_cosine[j] - sine * fine_sine[j];
      here[j] = gain(s, c);
      there[j] = gain(c, s);
    }
    for (std::size_t j = 0; j < count; ++j) lines[first + j] *= here[j];
    for (std::size_t j = 0; j < count; ++j) {
      const std::size_t mirrored = half - first - j;
      if (mirrored != first + j) lines[mirrored] *= there[j];
    }
  }
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

double band_pass_decay(double interval, Band band) {
  check(interval, band);
  return std::ceil(decay_samples(interval, band));
}

std::vector<double> band_pass(std::span<const double> samples, double interval, Band band) {
  check(interval, band);
  if (samples.empty()) return {};
  const SampleSpan source(samples);
  return BandSpectrum(source, {0, samples.size()}, interval, band).in(band);
}

BandSpectrum::BandSpectrum(const SampleSource& samples, IndexRange part, double interval, Band band)
    : samples_(&samples), part_(part), interval_(interval), slowest_(band) {
  if (part.is_empty()) throw std::invalid_argument("BandSpectrum: there are no samples");
  decay_ = band_pass_decay(interval, band);
  transform();
}

void BandSpectrum::move_to(IndexRange part) {
  if (part.begin == part_.begin && part.end == part_.end) return;
  part_ = part;
  transform();
}

/// Takes the spectrum of the part with what is to both sides of it.
void BandSpectrum::transform() {
  const bool is_whole = part_.size() == samples_->size();
  const double pad = is_whole ? decay_ : std::ceil(1.5 * decay_);
  const std::size_t n = transform_length(part_.size(), pad, slowest_);
  if (!forward_ || forward_->length() != n) {
    forward_.emplace(n);
    backward_.emplace(n);
    prepared_.clear();
  }
  // The part from the start of the buffer, then what follows on it, then what comes before: the
  // spectrum is periodic, so the latter ends where the part begins.
  const std::span<double> buffer = forward_->input();
  const std::size_t left = n - part_.size() - (n - part_.size()) / 2;
  const auto begin = static_cast<std::ptrdiff_t>(part_.begin);
  read_continued(*samples_, begin, buffer.first(n - left));
  read_continued(*samples_, begin - static_cast<std::ptrdiff_t>(left), buffer.last(left));
  check(buffer);
  forward_->execute();
}

/// Gains of some bands together, over the length of the transform.
void BandSpectrum::prepare(const std::vector<Band>& bands) {
  for (const Band& band : bands) {
    const double decay = band_pass_decay(interval_, band);
    if (decay > decay_) {
      decay_ = decay;
      slowest_ = band;
      transform();
    }
  }
  if (prepared_ == bands) return;
  prepared_ = bands;
  const std::size_t n = forward_->length();
  gains_.assign(n / 2 + 1, 1.0 / static_cast<double>(n));
  for (const Band& band : bands) multiply_by_gains(interval_, band, gains_);
}

/// The signal of all lines times their gains, or its Hilbert transform.
void BandSpectrum::invert(Part part) {
  const auto lines = forward_->output();
  const auto passed = backward_->input();
  for (std::size_t k = 0; k < passed.size(); ++k) {
    const std::complex<double> line = gains_[k] * lines[k];
    passed[k] = part == Part::itself ? line : std::complex<double>(line.imag(), -line.real());
  }
  backward_->execute();
}

std::vector<double> BandSpectrum::in(Band band) {
  prepare({band});
  invert(Part::itself);
  const std::span<const double> filtered = backward_->output().first(part_.size());
  return {filtered.begin(), filtered.end()};
}

PassedSignal BandSpectrum::pass(const std::vector<Band>& bands) {
  prepare(bands);
  PassedSignal passed;
  invert(Part::itself);
  const auto values = backward_->output().first(part_.size());
  passed.samples.assign(values.begin(), values.end());
  invert(Part::hilbert);
  passed.squared_amplitude.resize(part_.size());
  for (std::size_t i = 0; i < passed.samples.size(); ++i) {
    const double x = passed.samples[i];
    passed.squared_amplitude[i] = 0.5 * (x * x + values[i] * values[i]);
  }
  return passed;
}

}  // namespace stridor
