// Zero-phase Butterworth band-pass.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "analysis/sample_source.hpp"
#include "analysis/statistics.hpp"
#include "core/fft_plan.hpp"

namespace stridor {

/// A band of frequencies in Hz.
struct Band {
  double lower;  ///< positive
  double upper;  ///< above `lower`, below the Nyquist frequency of the samples

  bool operator==(const Band&) const = default;
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

/// Samples over which the response of band_pass() decays to 10⁻¹². @throws as band_pass()
double band_pass_decay(double interval, Band band);

/// Part of a signal that bands let through.
struct PassedSignal {
  std::vector<double> samples;            ///< x
  std::vector<double> squared_amplitude;  ///< |x + i H x|²/2 with H the Hilbert transform
};

/// The spectrum of a part of a signal, for what several bands let through of it.
///
/// The part is filtered together with the samples to both sides of it, over 1.5 times the time in
/// which the response of the filter decays to 10⁻¹² (to 10⁻¹⁸ then), and with the continuation of
/// band_pass() beyond the ends of the signal. So the parts of a signal fit together but for
/// rounding. A part that is the whole signal is filtered as by band_pass(), bitwise.
class BandSpectrum {
 public:
  /// @param samples  finite, not empty; must live as long
  /// @param part     of them, not empty
  /// @param interval dt in s
  /// @param band     the first to be asked for
  /// @throws std::invalid_argument as band_pass(), or if there are no samples
  BandSpectrum(const SampleSource& samples, IndexRange part, double interval, Band band);

  /// Goes on with another part; nothing is done where it is the present one.
  void move_to(IndexRange part);

  /// The part in a band.
  std::vector<double> in(Band band);
  /// The part that some bands, one after the other, let through, with its amplitude.
  ///
  /// H x comes from the same spectrum as x, with the same continuation at the ends. The gain
  /// vanishes at frequency 0 with its first seven derivatives, so that H x decays as x does: one
  /// end leaks into the other by no more.
  ///
  /// Cost: two Fourier transforms, and another one for the first band that takes longer to decay
  /// than those before.
  PassedSignal pass(const std::vector<Band>& bands);

 private:
  void prepare(const std::vector<Band>& bands);
  void transform();
  enum class Part { itself, hilbert };
  void invert(Part part);

  const SampleSource* samples_;
  IndexRange part_;
  double interval_;
  Band slowest_;                ///< of those asked for
  double decay_ = 0.0;          ///< of it, samples
  std::vector<Band> prepared_;  ///< whose gains are at hand
  std::optional<RealFft> forward_;
  std::optional<InverseRealFft> backward_;
  std::vector<double> gains_;  ///< of every line
};

}  // namespace stridor
