// A tone that is there all the time, which therefore is no burst.
#pragma once

#include <optional>

#include "analysis/bursts.hpp"
#include "analysis/vibration_blocks.hpp"

namespace stridor {

/// Smoothing with which a lasting tone is told from noise of a band: T, or longer where the band is
/// so narrow that the tone's own, 4/T wide, would be more than an eighth of it.
double lasting_smoothing(const BurstParameters& parameters);

/// The tone that makes up a vibration throughout the measured window (Vibration::lasting).
///
/// Its frequency is the median of those of the highest lines at 15 moments of the window. With the
/// envelope e of its own band, 2/T to both sides, and the r.m.s. value r of the whole band, it lasts
/// where the mean of e² is at least r²/2, so that noise is none, and the lower quartile of e² at
/// least a quarter of that mean, so that a burst and a vibration that dies out are none.
///
/// @param blocks   made for lasting_smoothing() or more
/// @param rms      of the signal in the band of the parameters, over `measured`
/// @param largest  absolute sample; what is below its rounding is no tone
/// @return nothing where none lasts, or the window is shorter than 8 T
std::optional<LastingTone> lasting_tone(SignalBlocks& blocks, const BurstParameters& parameters,
                                        IndexRange measured, double rms, double largest);

}  // namespace stridor
