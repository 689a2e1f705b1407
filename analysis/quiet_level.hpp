// The level of the quiet stretches of a vibration.
#pragma once

#include "analysis/bursts.hpp"
#include "analysis/vibration_blocks.hpp"

namespace stridor {

/// As find_quiet_level(), of a signal in blocks.
/// @param vibration in parameters.band, smoothed as they say
/// @param largest   absolute sample
/// @param measured  not empty
QuietLevel quiet_level(VibrationBlocks& vibration, double largest,
                       const BurstParameters& parameters, double first, IndexRange measured);

/// Of the largest sample: what rounding leaves of a signal outside the band.
inline constexpr double rounding_level = 1e-13;

}  // namespace stridor
