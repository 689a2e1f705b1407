// Amplitudes over time and frequency.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace stridor {

/// The weights w_i under which a piece of a signal is transformed, i = 0 … n − 1, x = 2πi/n
/// (F. J. Harris, Proc. IEEE 66 (1978) 51–83).
///
///     hann              ½ − ½ cos x
///     blackman_harris   0.35875 − 0.48829 cos x + 0.14128 cos 2x − 0.01168 cos 3x
///     rectangular       1
///
/// With lines 1/(n dt) apart, a sine fills 2, 4, 1 lines to either side, falls beyond them below
/// −31, −92, −13 dB, and half-way between two lines reads 1.42, 0.83, 3.92 dB too low.
enum class WindowKind { hann, blackman_harris, rectangular };

/// Every window with the name by which scenes and the command line call it.
const std::vector<std::pair<std::string, WindowKind>>& window_names();

/// The name of a window in window_names().
std::string window_name(WindowKind kind);

/// Lines from the middle of a sine's peak to where the window has its first zero: 2, 4, 1.
std::size_t main_lobe_lines(WindowKind kind);

/// The weights of a window. @throws std::invalid_argument if the length is below 2
std::vector<double> make_window(WindowKind kind, std::size_t length);

/// Division of a signal into pieces.
struct SpectrogramParameters {
  WindowKind window = WindowKind::hann;
  std::size_t length = 0;  ///< n, samples per piece, ≥ 2; must be given
  double overlap = 0.75;   ///< part of a piece shared with the next, 0 ≤ overlap ≤ 1 − 1/n
};

/// Amplitudes over frequency; also the scale of a spectrogram.
struct Spectrum {
  std::vector<double> frequencies;  ///< Hz, k/(n dt), k = 0 … n/2
  std::vector<double> amplitude;    ///< peak amplitude of a sine there, in the unit of the signal
  double noise_bandwidth = 0.0;     ///< Σw²/(Σw)²/dt in Hz, see power_spectral_density()
  bool ends_at_nyquist = false;     ///< n is even: the last line is half the sampling rate
  std::size_t num_pieces = 0;       ///< averaged over
};

/// Amplitudes over time and frequency.
struct Spectrogram {
  std::vector<double> times;        ///< s, centres of the pieces
  std::vector<double> frequencies;  ///< Hz, k/(n dt), k = 0 … n/2
  Eigen::MatrixXd amplitude;        ///< row per frequency, column per time, contiguous
  double noise_bandwidth = 0.0;     ///< Σw²/(Σw)²/dt in Hz, see power_spectral_density()
  bool ends_at_nyquist = false;     ///< n is even: the last line is half the sampling rate
};

/// Short-time Fourier transform of a signal, as amplitudes.
///
///     A_k = c_k |Σ_i w_i x_i exp(−2πi·ik/n)| / Σ_i w_i,   c_k = 2, but 1 at 0 Hz and at Nyquist
///
/// so that a sine of amplitude a at line k has A_k = a, and a constant a has A_0 = |a|. Between two
/// lines a sine reads lower by at most the loss that WindowKind lists.
///
/// Pieces start at sample 0 and follow each other by n (1 − overlap) samples, rounded; samples
/// after the last whole piece are not used. The time of a piece is the centre of gravity of its
/// window.
///
/// @param samples    equidistant, finite, at least one piece
/// @param interval   dt in s
/// @param parameters see there
/// @param first      time of sample 0 in s
/// @throws std::invalid_argument if a parameter or a sample is out of range or the signal is
///         shorter than one piece
///
/// Cost: one FFT of n samples per column, with one plan; nothing is allocated per column.
Spectrogram make_spectrogram(std::span<const double> samples, double interval,
                             const SpectrogramParameters& parameters, double first = 0.0);

/// Amplitude spectrum of a signal, averaged over pieces after Welch.
///
///     A_k = √(mean over the pieces of A_k²)
///
/// with the pieces and A_k of make_spectrogram(). With `length` = the number of samples it is the
/// spectrum of the signal as one piece.
///
/// @throws std::invalid_argument as make_spectrogram()
Spectrum make_spectrum(std::span<const double> samples, double interval,
                       const SpectrogramParameters& parameters);

/// One-sided power spectral density of a spectrogram, in unit²/Hz.
///
///     S_k = A_k²/(2 B),   at 0 Hz and at Nyquist A_k²/B,   B = noise_bandwidth
///
/// Its integral, Σ_k S_k/(n dt), is the mean square of the piece under the window,
/// Σ(w_i x_i)²/Σw_i² (Parseval).
Eigen::MatrixXd power_spectral_density(const Spectrogram& spectrogram);

/// The same of a spectrum.
std::vector<double> power_spectral_density(const Spectrum& spectrum);

/// 20 log₁₀(value/reference) of an amplitude, not of a power; −∞ for 0.
///
/// @param value     ≥ 0
/// @param reference positive, in the same unit; say which wherever the result is shown
/// @throws std::invalid_argument if either is out of range
double decibels(double value, double reference);

/// The reference that ISO 1683:2015 gives for levels of a quantity, in its SI unit.
///
///     m/s^2  1 µm/s²      m/s  1 nm/s      m  1 pm      N  1 µN
///
/// @return 1 for any other unit
double standard_reference(const std::string& units);

}  // namespace stridor
