#include "analysis/bursts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <utility>
#include <vector>

#include "analysis/quiet_level.hpp"
#include "analysis/spectrogram.hpp"
#include "analysis/vibration_blocks.hpp"
#include "core/fft_plan.hpp"

namespace stridor {
namespace {

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

/// A rise and fall of c = max(e, σ), as indices of the whole signal.
struct Swell {
  std::size_t low;       ///< last minimum before the rise
  std::size_t crossing;  ///< first value above it by the ratio
  std::size_t high;      ///< maximum
  double before;         ///< c at the minimum
};

/// Turning points of a series with hysteresis.
class SwellFinder {
 public:
  /// @param begin index of the first value
  SwellFinder(std::size_t begin, double floor, double ratio)
      : swell_{begin, begin, begin, infinity}, floor_(floor), ratio_(ratio), next_(begin) {}

  void take(std::span<const double> values) {
    for (const double value : values) take(std::max(value, floor_));
  }
  /// All of them, once all values have been taken.
  std::vector<Swell> finish() && {
    if (is_up_) swells_.push_back(swell_);
    return std::move(swells_);
  }

 private:
  static constexpr double infinity = std::numeric_limits<double>::infinity();

  void take(double c) {
    const std::size_t i = next_++;
    if (is_up_) {
      if (c > high_) {
        swell_.high = i;
        high_ = c;
      } else if (c * ratio_ <= high_) {
        swells_.push_back(swell_);
        swell_ = {i, i, i, c};
        is_up_ = false;
      }
    } else if (c <= swell_.before) {
      swell_.low = i;
      swell_.before = c;
    } else if (c >= ratio_ * swell_.before) {
      swell_.crossing = swell_.high = i;
      high_ = c;
      is_up_ = true;
    }
  }

  Swell swell_;
  double floor_;
  double ratio_;
  std::size_t next_;
  double high_ = 0.0;
  bool is_up_ = false;
  std::vector<Swell> swells_;
};

/// Growth of an envelope, not counted below a floor, within the measured part of a signal.
struct Slopes {
  IndexRange measured;
  double interval;
  double floor;

  /// Over i − half … i + half, as far as that is measured; 1/s.
  double at(const VibrationPiece& piece, std::size_t i, std::size_t half) const {
    const std::size_t left = i < measured.begin + half ? measured.begin : i - half;
    const std::size_t right = std::min(i + half, measured.end - 1);
    if (left == right) return -std::numeric_limits<double>::infinity();
    return std::log(std::max(piece.envelope(right), floor) /
                    std::max(piece.envelope(left), floor)) /
           (static_cast<double>(right - left) * interval);
  }
};

struct Rise {
  std::size_t at;
  double slope;  ///< 1/s
};

Rise steepest_rise(VibrationBlocks& vibration, IndexRange range, std::size_t half,
                   const Slopes& slopes) {
  Rise steepest{range.end - 1, -std::numeric_limits<double>::infinity()};
  vibration.for_each(range, [&](const VibrationPiece& piece, IndexRange part) {
    for (std::size_t i = part.begin; i < part.end; ++i) {
      const double slope = slopes.at(piece, i, half);
      if (slope > steepest.slope) steepest = {i, slope};
    }
  });
  return steepest;
}

/// The band in which a vibration can grow and change its frequency within T/2.
Band own_band(double frequency, double interval, double smoothing) {
  const double width = 2.0 / smoothing;
  const double nyquist = 0.5 / interval;
  return {std::max(frequency - width, 0.5 * frequency),
          std::min(frequency + width, 0.5 * (frequency + nyquist))};
}

struct Growth {
  double steepest;  ///< 1/s
  double gain;
};

/// Growth of the envelope of a burst's own frequency. Its steepest rise is sought in `rising`,
/// where the burst is stronger than anything else in the band; it sets in where, going back from
/// there, half of that is left.
/// @param end the last sample of the burst
Growth growth_of(VibrationBlocks& own, IndexRange rising, std::size_t end, std::size_t half,
                 const Slopes& slopes) {
  const Rise rise = steepest_rise(own, rising, 2 * half, slopes);
  std::size_t onset = rise.at;
  while (onset > slopes.measured.begin && slopes.at(own.at(onset), onset, half) > 0.5 * rise.slope)
    --onset;
  const double before = own.at(onset).envelope(onset);
  double largest = before;
  own.for_each({onset, end + 1}, [&](const VibrationPiece& piece, IndexRange part) {
    for (const double e : piece.envelope(part)) largest = std::max(largest, e);
  });
  return {rise.slope, std::log(largest / std::max(before, slopes.floor))};
}

/// Frequency of the strongest line in the band around a sample of the whole signal.
double dominant_frequency(VibrationBlocks& vibration, const BurstParameters& parameters,
                          std::size_t at) {
  const double interval = vibration.interval();
  const double duration = std::max(2.0 * parameters.smoothing, 8.0 / parameters.band.lower);
  const std::size_t wanted = 2 * half_width(interval, duration);
  const std::size_t length = std::min(std::max<std::size_t>(wanted, 2), vibration.size());
  const std::size_t begin =
      std::min(at < length / 2 ? 0 : at - length / 2, vibration.size() - length);
  // Zeros to four times the length: the parabola through three lines is then good to 10⁻³ of the
  // resolution 1/duration.
  RealFft fft(fast_fft_length(4 * length));
  const std::vector<double> window = make_window(WindowKind::hann, length);
  vibration.for_each({begin, begin + length}, [&](const VibrationPiece& piece, IndexRange part) {
    for (std::size_t i = part.begin; i < part.end; ++i)
      fft.input()[i - begin] = window[i - begin] * piece.filtered(i);
  });
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

/// The largest absolute sample of a signal. @throws std::invalid_argument unless all are finite
double largest_of(const SampleSource& samples) {
  constexpr std::size_t at_a_time = std::size_t{1} << 16;
  std::vector<double> piece;
  double largest = 0.0;
  for (std::size_t i = 0; i < samples.size(); i += piece.size()) {
    piece.resize(std::min(at_a_time, samples.size() - i));
    samples.read(i, piece);
    const double here = peak(piece);
    if (!std::isfinite(here)) throw std::invalid_argument("bursts: the samples must be finite");
    largest = std::max(largest, here);
  }
  return largest;
}

/// A signal in which bursts are sought, with its parameters.
struct Measured {
  VibrationBlocks& vibration;
  const BurstParameters& parameters;
  double first;    ///< time of sample 0, s
  double largest;  ///< absolute sample
  QuietLevel level;
  IndexRange range;

  double time_at(std::size_t i) const {
    return first + static_cast<double>(i) * vibration.interval();
  }
  double envelope(std::size_t i) const { return vibration.at(i).envelope(i); }
};

/// Frequency, growth and gain of a burst from its rise.
/// @param end its last sample
void follow_growth(SignalBlocks& blocks, const Measured& measured, const Swell& swell,
                   std::size_t end, Burst& burst) {
  const double interval = blocks.interval();
  const double smoothing = measured.parameters.smoothing;
  const std::size_t half = half_width(interval, smoothing);
  const IndexRange rising{swell.crossing, swell.high + 1};
  const Rise rise = steepest_rise(measured.vibration, rising, 2 * half,
                                  {measured.range, interval, measured.level.rms});
  burst.frequency = dominant_frequency(measured.vibration, measured.parameters, rise.at);
  const Band own = own_band(burst.frequency, interval, smoothing);
  VibrationBlocks vibration(blocks, {measured.parameters.band, own}, 0.5 * smoothing);
  const Growth growth = growth_of(vibration, rising, end, half,
                                  {measured.range, interval, rounding_level * measured.largest});
  burst.growth = growth.steepest;
  burst.gain = growth.gain;
}

/// The burst of a swell; nothing where it is too short.
/// @param limit the last sample that it may have
std::optional<Burst> burst_of(SignalBlocks& blocks, const Measured& measured, const Swell& swell,
                              std::size_t limit) {
  const double edge = std::numbers::sqrt2 * swell.before;
  std::size_t start = swell.crossing;
  while (start > swell.low && measured.envelope(start) > edge) --start;
  std::size_t end = swell.high;
  while (end < limit && measured.envelope(end) > edge) ++end;

  Burst burst{};
  burst.start = measured.time_at(start);
  burst.end = measured.time_at(end);
  if (burst.end - burst.start < measured.parameters.minimum_duration) return std::nullopt;
  std::size_t highest = start;
  burst.peak = -1.0;
  measured.vibration.for_each({start, end + 1}, [&](const VibrationPiece& piece, IndexRange part) {
    for (std::size_t i = part.begin; i < part.end; ++i) {
      const double value = std::abs(piece.filtered(i));
      if (value > burst.peak) {
        burst.peak = value;
        highest = i;
      }
    }
  });
  burst.peak_time = measured.time_at(highest);
  follow_growth(blocks, measured, swell, end, burst);
  return burst;
}

std::vector<Burst> bursts_of(SignalBlocks& blocks, const Measured& measured) {
  const QuietLevel& level = measured.level;
  if (!(level.rms > 0.0) || !std::isfinite(level.threshold)) return {};
  SwellFinder finder(measured.range.begin, level.rms, level.threshold / level.rms);
  measured.vibration.for_each(measured.range, [&](const VibrationPiece& piece, IndexRange part) {
    finder.take(piece.envelope(part));
  });
  const std::vector<Swell> swells = std::move(finder).finish();
  std::vector<Burst> bursts;
  for (std::size_t j = 0; j < swells.size(); ++j) {
    const std::size_t limit = j + 1 < swells.size() ? swells[j + 1].low : measured.range.end - 1;
    if (const auto burst = burst_of(blocks, measured, swells[j], limit)) bursts.push_back(*burst);
  }
  return bursts;
}

}  // namespace

std::vector<double> burst_envelope(std::span<const double> samples, double interval, Band band,
                                   double smoothing) {
  check_smoothing(interval, band, smoothing);
  if (samples.empty()) return {};
  const SampleSpan source(samples);
  SignalBlocks blocks(source, interval, band, smoothing);
  VibrationBlocks vibration(blocks, {band}, smoothing);
  std::vector<double> envelope;
  envelope.reserve(samples.size());
  vibration.for_each({0, samples.size()}, [&](const VibrationPiece& piece, IndexRange part) {
    const std::span<const double> values = piece.envelope(part);
    envelope.insert(envelope.end(), values.begin(), values.end());
  });
  return envelope;
}

QuietLevel find_quiet_level(std::span<const double> samples, double interval,
                            const BurstParameters& parameters, double first) {
  check(interval, parameters, first);
  const IndexRange measured = samples_in(parameters.measured, first, interval, samples.size());
  if (measured.is_empty()) {
    throw std::invalid_argument("bursts: no sample lies in the measured window");
  }
  const SampleSpan source(samples);
  const double largest = largest_of(source);
  SignalBlocks blocks(source, interval, parameters.band, parameters.smoothing);
  VibrationBlocks vibration(blocks, {parameters.band}, parameters.smoothing);
  return quiet_level(vibration, largest, parameters, first, measured);
}

std::vector<Burst> find_bursts(std::span<const double> samples, double interval,
                               const BurstParameters& parameters, double first) {
  return find_vibration(SampleSpan(samples), interval, parameters, first).bursts;
}

Vibration find_vibration(const SampleSource& samples, double interval,
                         const BurstParameters& parameters, double first,
                         std::optional<std::size_t> block) {
  check(interval, parameters, first);
  const IndexRange range = samples_in(parameters.measured, first, interval, samples.size());
  const double largest = largest_of(samples);
  Vibration found;
  if (range.is_empty()) return found;
  SignalBlocks blocks(samples, interval, parameters.band, parameters.smoothing, block);
  VibrationBlocks vibration(blocks, {parameters.band}, parameters.smoothing);
  double square = 0.0;
  vibration.for_each(range, [&](const VibrationPiece& piece, IndexRange part) {
    for (const double x : piece.filtered(part)) square += x * x;
  });
  found.rms = std::sqrt(square / static_cast<double>(range.size()));
  const QuietLevel level = quiet_level(vibration, largest, parameters, first, range);
  found.bursts = bursts_of(blocks, {vibration, parameters, first, largest, level, range});
  return found;
}

}  // namespace stridor
