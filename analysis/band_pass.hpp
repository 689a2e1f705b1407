// Zero-phase Butterworth band-pass.
#pragma once

#include <span>
#include <vector>

namespace stridor {

/// A band of frequencies in Hz.
struct Band {
  double lower;  ///< positive
  double upper;  ///< above `lower`, below the Nyquist frequency of the samples
};

/// Gain of band_pass() at a frequency.
///
///     |H|² = 1 / (1 + ((w² − w₁w₂) / (w (w₂ − w₁)))⁸),   w = tan(π f dt)
///
/// the squared magnitude of the digital Butterworth band-pass of order 4 (8 poles) that the
/// bilinear transformation with prewarped edges gives; 1/2 at both edges.
///
/// @param frequency Hz, 0 to the Nyquist frequency
/// @param interval  dt in s
/// @throws std::invalid_argument as band_pass()
double band_pass_gain(double frequency, double interval, Band band);

/// Band-pass of a signal without shift in time.
///
/// The Butterworth band-pass of order 4 run forwards and backwards, that is with the gain
/// band_pass_gain() and no phase, applied to the spectrum. Both ends are continued by odd
/// reflection (about the end value), and by the last reflected value where the signal is too short
/// for that, over the time in which the response of the filter decays to 10⁻¹²; within about
/// 2/(upper − lower) of the ends the result still depends on that continuation.
///
/// @param samples  equidistant, finite; may be empty
/// @param interval dt in s
/// @param band     0 < lower < upper < 1/(2 dt)
/// @return as many samples
/// @throws std::invalid_argument if interval, band or a sample is out of range, or if the padded
///         signal exceeds 2³¹ − 1 samples
///
/// Cost: two FFTs of the padded length, about 32 bytes of memory per padded sample.
std::vector<double> band_pass(std::span<const double> samples, double interval, Band band);

}  // namespace stridor
