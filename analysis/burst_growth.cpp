#include "analysis/burst_growth.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "analysis/quiet_level.hpp"
#include "analysis/spectrogram.hpp"
#include "core/fft_plan.hpp"

namespace stridor {

double Slopes::at(const VibrationPiece& piece, std::size_t i, std::size_t half) const {
  const std::size_t left = i < measured.begin + half ? measured.begin : i - half;
  const std::size_t right = std::min(i + half, measured.end - 1);
  if (left == right) return -std::numeric_limits<double>::infinity();
  return std::log(std::max(piece.envelope(right), floor) /
                  std::max(piece.envelope(left), floor)) /
         (static_cast<double>(right - left) * interval);
}

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

Band own_band(double lowest, double highest, double interval, double smoothing) {
  const double width = 2.0 / smoothing;
  const double nyquist = 0.5 / interval;
  return {std::max(lowest - width, 0.5 * lowest),
          std::min(highest + width, 0.5 * (highest + nyquist))};
}

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

double dominant_frequency(VibrationBlocks& vibration, const BurstParameters& parameters, Band band,
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
      std::max<std::size_t>(1, static_cast<std::size_t>(band.lower / resolution));
  const auto highest = std::min(
      lines.size() - 2, static_cast<std::size_t>(std::ceil(band.upper / resolution)));
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

}  // namespace stridor
