// Signals at another sampling rate.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace stridor {

/// Samples of a signal at another rate, its content above half of the lower rate taken away:
///
///     y_j = Σ_k x_k b h(b (j/r − k)),   b = min(1, r),   h(u) = sinc(u) w(u/W)
///
/// with the ratio r of the rates and w the window of Kaiser, β = 9, W = 64 zeros of the sinc long on
/// either side (Oppenheim and Schafer, Discrete-Time Signal Processing, 3rd ed., 7.5.3). Below 0.95 of
/// the limit amplitudes are right to 1e-4; what is more than 1.05 of it is 85 dB lower. Outside the
/// samples the signal is zero.
/// @param ratio new rate over the old one, > 0 and finite
/// @return ⌊(n − 1) r⌋ + 1 samples, the first at the time of the first; none of none
/// @throws std::invalid_argument if the ratio is out of range
/// Cost: 128 products for every sample of the higher rate.
std::vector<double> resampled(std::span<const double> samples, double ratio);

}  // namespace stridor
