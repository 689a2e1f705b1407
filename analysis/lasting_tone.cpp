#include "analysis/lasting_tone.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "analysis/burst_growth.hpp"
#include "analysis/quiet_level.hpp"

namespace stridor {
namespace {

constexpr double least_share = 0.5;      ///< of the power in the band
constexpr double least_quartile = 0.25;  ///< of e², in means of e²
constexpr double widest_own_band = 0.125;

}  // namespace

double lasting_smoothing(const BurstParameters& parameters) {
  const double width = parameters.band.upper - parameters.band.lower;
  return std::max(parameters.smoothing, 4.0 / (widest_own_band * width));
}

std::optional<LastingTone> lasting_tone(SignalBlocks& blocks, const BurstParameters& parameters,
                                        IndexRange measured, double rms, double largest) {
  BurstParameters longer = parameters;
  longer.smoothing = lasting_smoothing(parameters);
  const std::size_t half = std::max<std::size_t>(1, half_width(blocks.interval(), longer.smoothing));
  if (measured.size() < 16 * half || !(rms > rounding_level * largest)) return std::nullopt;

  std::array<double, 15> frequencies{};
  VibrationBlocks whole(blocks, {parameters.band}, longer.smoothing);
  for (std::size_t i = 0; i < frequencies.size(); ++i) {
    const std::size_t moment =
        measured.begin + (2 * i + 1) * measured.size() / (2 * frequencies.size());
    frequencies[i] = dominant_frequency(whole, longer, parameters.band, moment);
  }
  std::ranges::nth_element(frequencies, frequencies.begin() + frequencies.size() / 2);
  const double frequency = frequencies[frequencies.size() / 2];

  VibrationBlocks own(
      blocks,
      {parameters.band, own_band(frequency, frequency, blocks.interval(), longer.smoothing)},
      longer.smoothing);
  std::vector<double> squares;  // of e, T/2 apart
  own.for_each(measured, [&](const VibrationPiece& piece, IndexRange part) {
    while (measured.begin + squares.size() * half < part.end) {
      const double e = piece.envelope(measured.begin + squares.size() * half);
      squares.push_back(e * e);
    }
  });
  double mean = 0.0;
  for (const double square : squares) mean += square / static_cast<double>(squares.size());
  const auto quartile = squares.begin() + static_cast<std::ptrdiff_t>(squares.size() / 4);
  std::ranges::nth_element(squares, quartile);
  const double share = std::min(1.0, mean / (rms * rms));
  if (!(share >= least_share) || !(*quartile >= least_quartile * mean)) return std::nullopt;
  return LastingTone{frequency, std::sqrt(mean), share};
}

}  // namespace stridor
