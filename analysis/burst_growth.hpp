// How the sound of a burst rises: where, how fast, at which frequency.
#pragma once

#include "analysis/bursts.hpp"
#include "analysis/vibration_blocks.hpp"

namespace stridor {

/// Growth of an envelope, not counted below a floor, within the measured part of a signal.
struct Slopes {
  IndexRange measured;
  double interval;
  double floor;

  /// Over i − half … i + half, as far as that is measured; 1/s.
  double at(const VibrationPiece& piece, std::size_t i, std::size_t half) const;
};

struct Rise {
  std::size_t at;
  double slope;  ///< 1/s
};

/// The largest slope over 2 half in a range.
Rise steepest_rise(VibrationBlocks& vibration, IndexRange range, std::size_t half,
                   const Slopes& slopes);

/// The band in which sounds between two frequencies can grow and change their frequency within T/2.
Band own_band(double lowest, double highest, double interval, double smoothing);

struct Growth {
  double steepest;  ///< 1/s
  double gain;
};

/// Growth of the envelope of a burst's own frequency. Its steepest rise is sought in `rising`,
/// where the burst is stronger than anything else in the band; it sets in where, going back from
/// there, half of that is left.
/// @param end the last sample of the burst
Growth growth_of(VibrationBlocks& own, IndexRange rising, std::size_t end, std::size_t half,
                 const Slopes& slopes);

/// Frequency of the strongest line in a band around a sample of the whole signal.
double dominant_frequency(VibrationBlocks& vibration, const BurstParameters& parameters, Band band,
                          std::size_t at);

}  // namespace stridor
