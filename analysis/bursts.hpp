// Bursts of vibration in a signal: when, at which frequency, how strong, grown by how much.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "analysis/band_pass.hpp"
#include "analysis/sample_source.hpp"
#include "analysis/statistics.hpp"

namespace stridor {

/// Definition of a burst; see find_bursts().
struct BurstParameters {
  Band band;                      ///< Hz, in which the vibration is sought; must be given
  Window measured{};              ///< s, where bursts are sought; by default everywhere
  std::optional<Window> quiet{};  ///< s, a stretch known to hold no burst; by default the level is
                                  ///< estimated from the measured window
  double threshold = 4.0;         ///< F, least rise of the envelope over the level before, ≥ 2
  double smoothing = 5.0e-3;      ///< T in s, of the envelope; at least one period of band.lower
  double minimum_duration = 10.0e-3;  ///< s, of a burst from start to end, ≥ 0
};

/// A burst at one moment.
struct BurstPoint {
  double time;       ///< s
  double frequency;  ///< Hz
  double level;      ///< r.m.s. value, of the sound alone
};

/// That a burst sounds at a whole multiple of the frequency of a louder one at the same time.
struct Harmonic {
  std::size_t of;  ///< index of the louder burst
  int order;       ///< 2 and more
};

/// A stretch in which a sound grows, and dies out or is cut off.
struct Burst {
  double start;      ///< s, where the envelope leaves √2 times the level before for good
  double end;        ///< s, where it is back there, at latest before the next burst
  double frequency;  ///< Hz, at the steepest rise
  double growth;     ///< 1/s, of ln envelope of its own frequency at the steepest rise
  double peak;       ///< largest |value| in the band of its own frequencies
  double peak_time;  ///< s, of that value
  double gain;       ///< ln of the rise of the envelope of its own frequency
  double start_frequency;  ///< Hz, where it was first heard: above the quiet level
  double end_frequency;    ///< Hz, where it was heard last
  std::vector<BurstPoint> course{};  ///< from start to end, T/2 apart, where above the quiet level
  std::optional<Harmonic> harmonic{};  ///< see name_harmonics()
};

/// Level that the envelope of a signal without bursts keeps to.
struct QuietLevel {
  double rms;        ///< of the band-passed signal
  double threshold;  ///< the envelope that counts as a burst, ≥ F·rms; infinite if the signal is
                     ///< too short to tell
  double freedom;    ///< k, half the degrees of freedom of the squared envelope
};

/// Envelope of a signal in a band, as a running r.m.s. value.
///
///     e(t)² = mean over [t − T/2, t + T/2] of |z|²/2,   z = x + i H x
///
/// with x the band-passed signal (band_pass()) and H x its Hilbert transform: |z| is the amplitude
/// of the vibration, e is that over √2. At the ends the mean is over what there is; both x and H x
/// are those of the signal continued as band_pass() does (BandSpectrum), so
/// that one end does not leak into the other.
///
/// @param smoothing T in s, at least one period of band.lower
/// @return as many values as samples
/// @throws std::invalid_argument as band_pass(), or if the smoothing is out of range
std::vector<double> burst_envelope(std::span<const double> samples, double interval, Band band,
                                   double smoothing);

/// The level of the quiet stretches of a signal, and what rises above it by more than chance.
///
/// For stationary Gaussian noise e² is to good approximation distributed as e² = σ² γ_k/k, with γ_k
/// a gamma variable of shape k and, at most, k = max(1, B T): B = (∫g²df)²/∫g⁴df is the noise
/// bandwidth of the filter g = band_pass_gain(), T the smoothing. Noise that does not fill the
/// band, or is not stationary, fluctuates more: k is lower. From the lower decile and the lower
/// quartile of e² over the measured window follow k (from their ratio, within 1 … max(1, B T)) and
/// then σ (from the quartile); bursts in less than about half of the window move neither by much.
/// With `quiet` given, σ² is the mean of e² there, and k is σ⁴/variance, within the same limits.
///
/// The threshold is the larger of F σ and the value that e exceeds in the whole measured window
/// with a probability below 10⁻⁴ if the window holds only such noise:
///
///     θ² = σ₊² Q_k(10⁻⁴/(2N))/k,   N = 4 B·(length of the measured window)
///
/// Q_k: upper quantile of γ_k; N: more than Rice's number of up-crossings. σ₊ ≥ σ allows for the
/// error of σ itself in a short signal: that the quartile of n = length/(T + 1/B) independent
/// values lies below the u-quantile has, by Chernoff, a probability of at most exp(−n (¼ ln(¼/u) +
/// ¾ ln(¾/(1−u)))), set to 10⁻⁴/2; of a given quiet window, that the mean over its length has 2
/// B·length·k/max(1, B T) degrees of freedom.
///
/// σ is at least 10⁻¹³ of the largest sample: below is rounding.
///
/// @throws std::invalid_argument as find_bursts()
QuietLevel find_quiet_level(std::span<const double> samples, double interval,
                            const BurstParameters& parameters, double first = 0.0);

/// The bursts of a signal, any number at the same time.
///
/// With σ and θ of find_quiet_level(): sounds are the ridges of the signal above σ (RidgeFinder). Of each
/// sound e is the envelope in the band of its own frequencies, from 2/T below the lowest to 2/T above
/// the highest of them, and c = max(e, σ). A burst is a rise of c from a minimum to a maximum by at least
/// the factor θ/σ ≥ F, and hence above θ. Two maxima are two bursts if c falls between them by that factor
/// below the lower one; else they are one. Since F ≥ 2, a dip of less than 6 dB never divides, and a fall
/// to the quiet level always does if both maxima are bursts. Bursts of less than the minimum duration are
/// dropped, and those beside a louder one at the same time, nearer to it than 2/T.
///
/// The level before, L, is the minimum of c before the rise: the quiet level, or what is left of
/// the burst before; n is the minimum of e over 8 T before, at most L: what is in the own band
/// besides. Start is the last time before the rise at which e² ≤ L² + n², when the burst itself has
/// become as strong as the level; end is the first time after the maximum at which it is so again,
/// at latest the minimum before the next burst or the end of the measured window. Steepest rise is
/// the largest difference of ln e over 2 T, sought from where the envelope has risen by θ/σ to the
/// maximum, so that the noise before does not count; the frequency f is that of the highest line in
/// its own band of the spectrum (Hann window of 2 T, at least 8 periods of band.lower, lines
/// interpolated) around that time.
///
/// Growth and gain are those of the burst's own frequency, so that they do not depend on what else
/// the band holds: of the envelope e_f over T/2 in the band f ± 2/T. The growth is the steepest
/// rise of ln e_f over 2 T. The gain is ln of the largest e_f over that at the onset of the growth,
/// which is where, going back from the steepest rise, the slope of ln e_f over T has fallen to half
/// of it. That leaves out what seeded the burst, be it a blow or noise: for an unstable window in
/// which the growth varies as √(1 − x²) it leaves out 3 % of its integral.
///
/// Limits: sounds nearer to each other than 4/T are one; T blurs the envelope; an apex between growth
/// a and decay b loses about (a + b) T/16 of the gain. The growth, a maximum, reads some 1/s too
/// high in noise. A blow later than about T before the onset counts as growth. Where noise fills the band around f, growth is followed back
/// to a few times that noise only, and the gain is uncertain by about 1.5. A blow that rings down
/// is also a burst, with a growth of the order of 1/T. A vibration that already decays when the
/// measured window begins has no rise, and is none. Bursts that fill a third of the window raise an
/// estimated quiet level by up to a fifth where the quiet itself swings; give `quiet` where it is
/// known. Noise that swings more slowly than T, as that of a lightly damped resonance, passes for a
/// burst in some percent of windows that hold only a few of its swings.
///
/// @param samples    equidistant, finite; may be empty
/// @param interval   dt in s
/// @param parameters see there; the filter runs over all samples, inside the measured window or not
/// @param first      time of sample 0 in s
/// @return in order of their start
/// @throws std::invalid_argument if a parameter or sample is out of range, or if no sample lies in
///         the given quiet window
std::vector<Burst> find_bursts(std::span<const double> samples, double interval,
                               const BurstParameters& parameters, double first = 0.0);

/// A tone that is there all the time: half the power of the band or more, a quarter of the time at
/// most below half its r.m.s. value. What fills the window is no rise, and so no burst.
struct LastingTone {
  double frequency;  ///< Hz
  double rms;        ///< of the vibration within 2/T of it
  double share;      ///< of the power in the band
};

/// Vibration in the band of the bursts, where it is measured.
struct Vibration {
  double rms = 0.0;  ///< of band_pass() over parameters.measured; 0 where that holds no sample
  std::vector<Burst> bursts{};
  std::optional<LastingTone> lasting{};
};

/// find_bursts() of a signal that need not fit into memory, and its r.m.s. value in their band.
///
/// The signal is read and filtered in blocks (SignalBlocks), five to six times as a whole and
/// about eight times where there are bursts; a signal of one block once. The length of a block does
/// not change the result but for rounding.
///
/// @param block samples to a block; about a million where it is not given
/// @throws std::invalid_argument as find_bursts()
Vibration find_vibration(const SampleSource& samples, double interval,
                         const BurstParameters& parameters, double first = 0.0,
                         std::optional<std::size_t> block = std::nullopt);

}  // namespace stridor
