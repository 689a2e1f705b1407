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

#include "analysis/burst_growth.hpp"
#include "analysis/harmonics.hpp"
#include "analysis/lasting_tone.hpp"
#include "analysis/quiet_level.hpp"
#include "analysis/ridges.hpp"
#include "analysis/vibration_blocks.hpp"

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
};

/// A sound from one of its minima to the next: where and in which band its burst is sought.
struct Sound {
  IndexRange range;
  Band band;
  std::span<const RidgePoint> points;  ///< of the ridge
};

/// Frequency, growth and gain of a burst from its rise.
/// @param own the vibration in the band of the sound
/// @param end its last sample
void follow_growth(SignalBlocks& blocks, const Measured& measured, const Sound& sound,
                   VibrationBlocks& own, const Swell& swell, std::size_t end, Burst& burst) {
  const double interval = blocks.interval();
  const double smoothing = measured.parameters.smoothing;
  const std::size_t half = half_width(interval, smoothing);
  const IndexRange rising{swell.crossing, swell.high + 1};
  const Rise rise =
      steepest_rise(own, rising, 2 * half, {measured.range, interval, measured.level.rms});
  burst.frequency = dominant_frequency(own, measured.parameters, sound.band, rise.at);
  const Band band = own_band(burst.frequency, burst.frequency, interval, smoothing);
  VibrationBlocks narrow(blocks, {measured.parameters.band, band}, 0.5 * smoothing);
  const Growth growth = growth_of(narrow, rising, end, half,
                                  {measured.range, interval, rounding_level * measured.largest});
  burst.growth = growth.steepest;
  burst.gain = growth.gain;
}

/// The burst of a swell; nothing where it is too short.
/// @param limit the last sample that it may have
std::optional<Burst> burst_of(SignalBlocks& blocks, const Measured& measured, const Sound& sound,
                              VibrationBlocks& own, const Swell& swell, std::size_t limit) {
  const auto envelope = [&](std::size_t i) { return own.at(i).envelope(i); };
  // Other vibration in the band adds its power to that of the burst.
  double beside = swell.before;
  const std::size_t lately =
      16 * half_width(measured.vibration.interval(), measured.parameters.smoothing);
  const std::size_t from = swell.low - std::min(lately, swell.low - measured.range.begin);
  own.for_each({from, swell.low + 1}, [&](const VibrationPiece& piece, IndexRange part) {
    for (const double e : piece.envelope(part)) beside = std::min(beside, e);
  });
  const double edge = std::hypot(swell.before, beside);
  std::size_t start = swell.crossing;
  while (start > swell.low && envelope(start) > edge) --start;
  std::size_t end = swell.high;
  while (end < limit && envelope(end) > edge) ++end;

  Burst burst{};
  burst.start = measured.time_at(start);
  burst.end = measured.time_at(end);
  if (burst.end - burst.start < measured.parameters.minimum_duration) return std::nullopt;
  std::size_t highest = start;
  burst.peak = -1.0;
  own.for_each({start, end + 1}, [&](const VibrationPiece& piece, IndexRange part) {
    for (std::size_t i = part.begin; i < part.end; ++i) {
      const double value = std::abs(piece.filtered(i));
      if (value > burst.peak) {
        burst.peak = value;
        highest = i;
      }
    }
  });
  burst.peak_time = measured.time_at(highest);
  burst.start_frequency = sound.points.front().frequency;
  burst.end_frequency = sound.points.back().frequency;
  for (const RidgePoint& point : sound.points)
    if (point.at >= start && point.at <= end)
      burst.course.push_back({measured.time_at(point.at), point.frequency, point.level});
  follow_growth(blocks, measured, sound, own, swell, end, burst);
  return burst;
}

/// The loudest swell of a sound by its envelope at every sample, with where it must end.
std::optional<Burst> burst_of(SignalBlocks& blocks, const Measured& measured, const Sound& sound) {
  const QuietLevel& level = measured.level;
  VibrationBlocks own(blocks, {measured.parameters.band, sound.band},
                      measured.parameters.smoothing);
  SwellFinder finder(sound.range.begin, level.rms, level.threshold / level.rms);
  own.for_each(sound.range, [&](const VibrationPiece& piece, IndexRange part) {
    finder.take(piece.envelope(part));
  });
  const std::vector<Swell> swells = std::move(finder).finish();
  std::optional<Burst> loudest;
  for (std::size_t j = 0; j < swells.size(); ++j) {
    const std::size_t limit = j + 1 < swells.size() ? swells[j + 1].low : sound.range.end - 1;
    const auto burst = burst_of(blocks, measured, sound, own, swells[j], limit);
    if (burst && (!loudest || burst->peak > loudest->peak)) loudest = burst;
  }
  return loudest;
}

/// The parts of a ridge that may hold a burst each.
/// @param hop   samples from one point to the next
/// @param reach samples before and behind a ridge in which its sound may be heard
std::vector<Sound> sounds_of(const Ridge& ridge, const Measured& measured, std::size_t hop,
                             std::size_t reach) {
  const QuietLevel& level = measured.level;
  // Levels of short spectra scatter, and their pieces are longer than T: the envelope decides.
  const double ratio = std::max(1.2, 0.6 * level.threshold / level.rms);
  const bool is_quiet_before = ridge.front().at >= measured.range.begin + hop;
  std::vector<double> levels;
  if (is_quiet_before) levels.push_back(level.rms);
  for (const RidgePoint& point : ridge) levels.push_back(point.level);
  SwellFinder swells(0, level.rms, ratio);
  swells.take(levels);
  const std::vector<Swell> found = std::move(swells).finish();
  const auto point_of = [&](std::size_t i) {
    return std::min(i - std::min<std::size_t>(i, is_quiet_before ? 1 : 0), ridge.size() - 1);
  };
  std::vector<Sound> sounds;
  for (std::size_t j = 0; j < found.size(); ++j) {
    const std::size_t first = point_of(found[j].low);
    const bool is_last = j + 1 == found.size();
    const std::size_t last = is_last ? ridge.size() - 1 : point_of(found[j + 1].low);
    double lowest = ridge[first].frequency;
    double highest = lowest;
    for (std::size_t i = first; i <= last; ++i) {
      lowest = std::min(lowest, ridge[i].frequency);
      highest = std::max(highest, ridge[i].frequency);
    }
    // Before and behind a ridge the sound is there, though not above the floor.
    const std::size_t before = found[j].low == 0 ? reach : 0;
    const std::size_t behind = is_last ? reach : 0;
    const std::size_t begin = ridge[first].at - std::min(before, ridge[first].at - measured.range.begin);
    const std::size_t end = std::min(measured.range.end, ridge[last].at + behind + 1);
    sounds.push_back(
        {{begin, end},
         own_band(lowest, highest, measured.vibration.interval(), measured.parameters.smoothing),
         std::span(ridge).subspan(first, last - first + 1)});
  }
  return sounds;
}

/// Drops bursts that are at the same time as a louder one and nearer to it than bands tell apart.
void keep_loudest(std::vector<Burst>& bursts, double smoothing) {
  const std::vector<Burst> all = bursts;
  std::erase_if(bursts, [&](const Burst& one) {
    return std::any_of(all.begin(), all.end(), [&](const Burst& other) {
      return other.peak > one.peak && other.start < one.end && one.start < other.end &&
             std::abs(other.frequency - one.frequency) < 2.0 / smoothing;
    });
  });
}

std::vector<Burst> bursts_of(SignalBlocks& blocks, const Measured& measured) {
  const QuietLevel& level = measured.level;
  if (!(level.rms > 0.0) || !std::isfinite(level.threshold)) return {};
  RidgeFinder finder(blocks.interval(), measured.parameters.band, measured.parameters.smoothing,
                     level.rms, measured.range, blocks.size());
  measured.vibration.for_each(finder.needed(),
                              [&](const VibrationPiece& piece, IndexRange part) {
                                finder.take(piece.filtered(part));
                              });
  const std::size_t hop = finder.hop();
  const std::size_t reach = hop + finder.half_piece();
  const std::vector<Ridge> ridges = std::move(finder).finish();
  std::vector<Burst> bursts;
  for (const Ridge& ridge : ridges) {
    for (const Sound& sound : sounds_of(ridge, measured, hop, reach)) {
      if (const auto burst = burst_of(blocks, measured, sound)) bursts.push_back(*burst);
    }
  }
  keep_loudest(bursts, measured.parameters.smoothing);
  std::sort(bursts.begin(), bursts.end(), [](const Burst& a, const Burst& b) {
    return std::pair(a.start, a.frequency) < std::pair(b.start, b.frequency);
  });
  name_harmonics(bursts, measured.parameters.smoothing);
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
  SignalBlocks blocks(samples, interval, parameters.band, lasting_smoothing(parameters), block);
  VibrationBlocks vibration(blocks, {parameters.band}, parameters.smoothing);
  double square = 0.0;
  vibration.for_each(range, [&](const VibrationPiece& piece, IndexRange part) {
    for (const double x : piece.filtered(part)) square += x * x;
  });
  found.rms = std::sqrt(square / static_cast<double>(range.size()));
  const QuietLevel level = quiet_level(vibration, largest, parameters, first, range);
  found.bursts = bursts_of(blocks, {vibration, parameters, first, largest, level, range});
  found.lasting = lasting_tone(blocks, parameters, range, found.rms, largest);
  return found;
}

}  // namespace stridor
